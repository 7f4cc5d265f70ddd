#include "datasets/sources/folder_damage.hpp"

#include <gtest/gtest.h>

namespace clearway {
namespace folder_damage_test {

TEST(FolderDamage, NamesTheFirstAndCountsTheOthers) {
  FolderDamage damage;
  EXPECT_FALSE(damage.sentence(9, "clouds"));
  damage.note("'a.pcd' is damaged: it is empty");
  EXPECT_EQ(damage.sentence(9, "clouds"), "'a.pcd' is damaged: it is empty");
  damage.note("'b.pcd' is damaged: it holds no points");
  EXPECT_EQ(damage.sentence(9, "clouds"),
            "'a.pcd' is damaged: it is empty; 1 more of 9 clouds is damaged, too");
  damage.note("'c.pcd' is no file");
  EXPECT_EQ(damage.sentence(9, "clouds"),
            "'a.pcd' is damaged: it is empty; 2 more of 9 clouds are damaged, too");
}

}  // namespace folder_damage_test
}  // namespace clearway

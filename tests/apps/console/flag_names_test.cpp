#include "apps/console/flag_names.hpp"

#include <gtest/gtest.h>

namespace clearway {
namespace flag_names_test {

TEST(FlagNames, FlagsBecomeTheKeysOfFiles) {
  EXPECT_EQ(with_keys("--policy: robot 'a' has no part 'b'"), "policies: robot 'a' has no part 'b'");
  EXPECT_EQ(with_keys("with --padding 0.1 (metres): too large"), "with padding 0.1 (metres): too large");
  EXPECT_EQ(with_keys("expected one of them or --fix elbow=VALUE"),
            "expected one of them or fixed={'elbow': VALUE}");
  EXPECT_EQ(with_keys("--package 'a', by --srdf or --xacro: x"), "packages 'a', by srdf or xacro: x");
}

TEST(FlagNames, OtherWordsStay) {
  for (const char* sentence : {"file '--fix.urdf': --frobnicate is none", "a--scale, --scales", ""})
    EXPECT_EQ(with_keys(sentence), sentence);
}

}  // namespace flag_names_test
}  // namespace clearway

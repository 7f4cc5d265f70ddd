#include "apps/teach/session_folder.hpp"

#include <gtest/gtest.h>

#include "mapping/files/cloud_file.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace session_folder_test {

TEST(SessionFolder, AScanThatIsALinkToNothingIsDamageInTheSessionToo) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "scans");
  folder.write("scans/1.pcd", format_pcd({{1.0F, 0.0F, 0.0F}}));
  std::filesystem::create_symlink("gone", folder / "scans/2.pcd");
  RecordedSession session;
  session.source = folder / "scans";
  save_session(session, {}, folder / "session");
  const auto kept = open_frames(load_session(folder / "session").source, {});
  int scans = 0;
  while (kept->next()) ++scans;
  EXPECT_EQ(scans, 1);
  ASSERT_TRUE(kept->damage());
  EXPECT_NE(kept->damage()->find("2.pcd' cannot be read: No such file"), std::string::npos);
}

}  // namespace session_folder_test
}  // namespace clearway

#include "apps/teach/session_folder.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cerrno>
#include <csignal>
#include <cstring>

#include "mapping/files/cloud_file.hpp"
#include "tests/datasets/complaint.hpp"
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

/// Of a recording that is one file this is so, too.
TEST(SessionFolder, AFolderOfWhichAFileIsGoneOrAnotherOrMoreIsNotTheOneItWasMadeFrom) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "scans/more");
  for (const char* name : {"scans/1.pcd", "scans/more/2.pcd"})
    folder.write(name, format_pcd({{1.0F, 0.0F, 0.0F}}));
  RecordedSession session;
  session.source = folder / "scans";
  save_session(session, {}, folder / "session");
  const auto load = [&] { return complaint([&] { load_session(folder / "session"); }); };
  EXPECT_EQ(load(), "");
  EXPECT_NE(complaint([&] { require_no_session(folder / "session"); }).find("stays as it is"),
            std::string::npos);
  EXPECT_EQ(complaint([&] { require_no_session(folder / "scans"); }), "");
  const std::filesystem::path kept = folder / "session/source/scans";
  std::filesystem::rename(kept / "1.pcd", kept / "3.pcd");
  EXPECT_NE(load().find("its recording 'source/scans' is not the one that it was made from"),
            std::string::npos);
  std::filesystem::rename(kept / "3.pcd", kept / "1.pcd");
  EXPECT_EQ(load(), "");
  folder.write("session/source/scans/4.pcd", "");
  EXPECT_NE(load(), "");
  std::filesystem::remove(kept / "4.pcd");
  std::filesystem::remove(kept / "more/2.pcd");
  folder.write("session/source/scans/more/2.pcd", format_pcd({{2.0F, 0.0F, 0.0F}}));
  EXPECT_NE(load(), "");
}

TEST(SessionFolder, ARecordingThatIsWrittenOverLaterIsStillTheSessions) {
  const TemporaryFolder folder;
  const std::string before = format_pcd({{1.0F, 0.0F, 0.0F}});
  folder.write("scan.pcd", before);
  RecordedSession session;
  session.source = folder / "scan.pcd";
  save_session(session, {}, folder / "session");
  folder.write("scan.pcd", format_pcd({{2.0F, 0.0F, 0.0F}}));  // the same file, not another of its name
  EXPECT_EQ(complaint([&] { load_session(folder / "session"); }), "");
}

/// A limit on the size of files stands for a full disk: std::filesystem calls either an input/output error.
TEST(SessionFolder, APictureThatCannotBeCopiedIsReportedWithTheReasonOfTheDisk) {
  const std::filesystem::path memory = "/dev/shm";  // no links from there
  if (!std::filesystem::is_directory(memory)) GTEST_SKIP() << "no other file system";
  const TemporaryFolder folder;
  const std::filesystem::path pictures = memory / folder.path().filename();
  std::filesystem::create_directory(pictures);
  write_file(pictures / "1.pcd", format_pcd(std::vector<Eigen::Vector3f>(40000, Eigen::Vector3f::Zero())));
  RecordedSession session;
  session.source = pictures;
  rlimit unlimited{};
  ::getrlimit(RLIMIT_FSIZE, &unlimited);
  const rlimit small{100000, unlimited.rlim_max};
  const auto before = std::signal(SIGXFSZ, SIG_IGN);
  ::setrlimit(RLIMIT_FSIZE, &small);
  const std::string reason =
      complaint<std::runtime_error>([&] { save_session(session, {}, folder / "session"); });
  ::setrlimit(RLIMIT_FSIZE, &unlimited);
  std::signal(SIGXFSZ, before);
  std::filesystem::remove_all(pictures);
  EXPECT_NE(reason.find("cannot write"), std::string::npos) << reason;
  EXPECT_NE(reason.find(std::strerror(EFBIG)), std::string::npos) << reason;
}

/// A question may end in a slash, names may be long, of dots alone, or no UTF-8.
TEST(SessionFolder, KeepsInputsOfAnyName) {
  const TemporaryFolder folder;
  const std::string recording = folder.write(
      "m\xf6"
      "bel.pcd",
      format_pcd({{1.0F, 0.0F, 0.0F}}));
  std::string umlauts;
  for (int i = 0; i < 60; ++i) umlauts += "\u00e4";
  std::map<std::string, std::string> inputs{{"xacro /a/arm.xacro meshes:=/a/meshes/", "1"},
                                            {"xacro /a/arm.xacro meshes:=/a/..", "2"},
                                            {"package://a/b.stl from /", "3"},
                                            {"/a/" + umlauts + ".stl", "4"},
                                            {"/a/a b.STL", "5"}};
  RecordedSession session;
  session.source = recording;
  save_session(session, inputs, folder / "session");
  const RecordedSession loaded = load_session(folder / "session");
  EXPECT_EQ(read_file(loaded.source), read_file(recording));
  std::map<std::string, std::string> read;
  for (const auto& [name, place] : loaded.inputs) {
    read[name] = read_file(place);
    EXPECT_TRUE(place.string().starts_with((folder / "session/files/").string())) << place;
  }
  EXPECT_EQ(read, inputs);
  EXPECT_EQ(loaded.inputs.at("/a/a b.STL").extension(), ".STL");
  EXPECT_EQ(loaded.inputs.at("/a/" + umlauts + ".stl").extension(), ".stl");
}

}  // namespace session_folder_test
}  // namespace clearway

#include "mapping/system/atomic_file.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <stdexcept>

#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace atomic_file_test {

namespace fs = std::filesystem;

std::size_t files_in(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(SaveFile, ReplacesTheWholeContent) {
  const TemporaryFolder folder;
  save_file(folder / "a", "a long first content");
  save_file(folder / "a", std::string_view("x\0y", 3));
  EXPECT_EQ(read_file(folder / "a"), std::string("x\0y", 3));
  EXPECT_EQ(files_in(folder.path()), 1U);
}

TEST(AtomicFile, WithoutItsEndLeavesTheOldFileAndNothingElse) {
  const TemporaryFolder folder;
  save_file(folder / "a", "old");
  {
    AtomicFile file(folder / "a");
    file.append("half");
    EXPECT_EQ(files_in(folder.path()), 2U);
    EXPECT_EQ(read_file(folder / "a"), "old");
  }
  EXPECT_EQ(read_file(folder / "a"), "old");
  EXPECT_EQ(files_in(folder.path()), 1U);
}

TEST(AtomicFile, ADiskThatIsFullLeavesTheOldFileAndNothingElse) {
  const TemporaryFolder folder;
  save_file(folder / "a", "old");
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, SIG_IGN);
  const rlimit full{100, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &full);
  EXPECT_THROW(save_file(folder / "a", std::string(1000, 'x')), std::runtime_error);
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_EQ(read_file(folder / "a"), "old");
  EXPECT_EQ(files_in(folder.path()), 1U);
}

TEST(AtomicFile, KeepsThePermissionsOfTheFileThatItReplaces) {
  const TemporaryFolder folder;
  save_file(folder / "a", "old");
  fs::permissions(folder / "a", fs::perms::owner_read | fs::perms::owner_write);
  save_file(folder / "a", "new");
  EXPECT_EQ(fs::status(folder / "a").permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

/// The names of temporary files cannot be guessed, so nobody can lay a link there first; two never meet.
TEST(AtomicFile, TwoWritersOfOneFileDoNotMeet) {
  const TemporaryFolder folder;
  AtomicFile one(folder / "a"), two(folder / "a");
  one.append("one");
  two.append("two");
  EXPECT_EQ(files_in(folder.path()), 2U);
  one.finish();
  EXPECT_EQ(read_file(folder / "a"), "one");
  two.finish();
  EXPECT_EQ(read_file(folder / "a"), "two");
}

TEST(SaveFile, NamesTheFileThatCannotBeWritten) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "folder");
  for (const fs::path& bad :
       {folder / "missing/a", folder / "folder", fs::path("/dev/full"), fs::path("/proc/x")}) {
    try {
      save_file(bad, "content");
      FAIL() << bad;
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find(bad.string()), std::string::npos) << error.what();
    }
  }
}

TEST(SaveFile, RefusesEarlyWhatItWouldRefuseLateAndTouchesNothing) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "folder");
  for (const fs::path& bad : {folder / "missing/a", folder / "folder", fs::path("/dev/full"), fs::path("")}) {
    EXPECT_THROW(require_writable(bad), std::runtime_error) << bad;
  }
  save_file(folder / "old", "content");
  EXPECT_NO_THROW(require_writable(folder / "old"));
  EXPECT_NO_THROW(require_writable(folder / "new"));
  EXPECT_EQ(read_file(folder / "old"), "content");
  EXPECT_FALSE(fs::exists(folder / "new"));
}

TEST(SaveFile, WritesThroughALinkToTheFileBehindIt) {
  const TemporaryFolder folder;
  save_file(folder / "real", "old");
  fs::create_symlink(folder / "real", folder / "link");
  save_file(folder / "link", "new");
  EXPECT_EQ(read_file(folder / "real"), "new");
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
}

}  // namespace atomic_file_test
}  // namespace clearway

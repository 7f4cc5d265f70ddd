#include "mapping/system/temporary_name.hpp"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <set>

#include "mapping/system/atomic_file.hpp"
#include "mapping/system/file_descriptor.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace temporary_name_test {

namespace fs = std::filesystem;

/// Runs `work` in a process of its own, which ends without any cleaning up.
template <class Work>
void in_killed_process(const Work& work) {
  const pid_t child = ::fork();
  if (child == 0) {
    work();
    ::kill(::getpid(), SIGKILL);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
}

std::size_t entries_in(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(TemporaryName, NoTwoAreAlikeAndAllAreHiddenBesideTheirTarget) {
  std::set<fs::path> names;
  for (int i = 0; i < 1000; ++i) {
    const fs::path name = temporary_name("/a/b.json");
    EXPECT_EQ(name.parent_path(), "/a");
    EXPECT_TRUE(name.filename().string().starts_with(".b.json."));
    EXPECT_TRUE(is_temporary_name(name));
    names.insert(name);
  }
  EXPECT_EQ(names.size(), 1000U);
  EXPECT_LE(temporary_name("/a/" + std::string(255, 'x')).filename().string().size(), 255U);
  for (const char* other : {".b.json", ".b.clearway-123", "b.clearway-0123456789abcdef", ".clearway_files"})
    EXPECT_FALSE(is_temporary_name(other)) << other;
}

TEST(TemporaryName, WhatAKilledProcessLeftGoesWithTheNextFileWrittenThere) {
  const TemporaryFolder folder;
  in_killed_process([&] {
    AtomicFile file(folder / "a");
    file.append("half");
    ::kill(::getpid(), SIGKILL);
  });
  EXPECT_EQ(entries_in(folder.path()), 1U);
  save_file(folder / "b", "whole");
  EXPECT_EQ(entries_in(folder.path()), 1U);
  EXPECT_EQ(read_file(folder / "b"), "whole");
}

TEST(TemporaryName, NeverRemovesTheFileOfALivingProcess) {
  const TemporaryFolder folder;
  AtomicFile file(folder / "a");
  file.append("half");
  in_killed_process([&] { save_file(folder / "b", "of another process"); });
  file.append(" and half");
  file.finish();
  EXPECT_EQ(read_file(folder / "a"), "half and half");
}

TEST(TemporaryName, RemovesNeitherOtherNamesNorThroughLinks) {
  const TemporaryFolder folder, elsewhere;
  write_file(elsewhere / "kept", "x");
  write_file(folder / ".a.clearway-123", "x");
  const fs::path abandoned = temporary_name(folder / "map");
  fs::create_directory(abandoned);
  fs::create_directory_symlink(elsewhere.path(), abandoned / "link");
  fs::create_directory_symlink(elsewhere.path(), temporary_name(folder / "link"));
  remove_abandoned(folder.path());
  EXPECT_FALSE(fs::exists(abandoned));
  EXPECT_TRUE(fs::exists(folder / ".a.clearway-123"));
  EXPECT_TRUE(fs::exists(elsewhere / "kept"));
}

TEST(TemporaryName, AFolderThatWasMovedAsideAndHasNoSuccessorGetsItsNameBack) {
  const TemporaryFolder folder;
  const fs::path aside = moved_aside_name(folder / "map");
  fs::create_directory(aside);
  write_file(aside / "map.ot", "old");
  remove_abandoned(folder.path());
  EXPECT_EQ(read_file(folder / "map" / "map.ot"), "old");
}

}  // namespace temporary_name_test
}  // namespace clearway

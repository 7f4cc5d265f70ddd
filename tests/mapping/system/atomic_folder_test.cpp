#include "mapping/system/atomic_folder.hpp"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include <map>
#include <stdexcept>

#include "mapping/system/atomic_file.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace atomic_folder_test {

namespace fs = std::filesystem;

bool nothing_is_ours(const fs::path&) { return false; }
bool text_is_ours(const fs::path& relative) { return relative.extension() == ".txt"; }

/// Contents by name of all files below a folder; the list of our files apart.
std::map<std::string, std::string> content(const fs::path& folder) {
  std::map<std::string, std::string> found;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().lexically_relative(folder).string();
    if (entry.is_regular_file() && name != own_files_name) found[name] = read_file(entry.path());
  }
  return found;
}
using Content = std::map<std::string, std::string>;

void publish(const fs::path& folder, const Content& files) {
  AtomicFolder out(folder, text_is_ours);
  for (const auto& [name, text] : files) {
    fs::create_directories((out.path() / name).parent_path());
    save_file(out.path() / name, text);
  }
  out.publish();
}

std::string refusal(const fs::path& folder) {
  try {
    const AtomicFolder out(folder, nothing_is_ours);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

std::size_t entries_in(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(AtomicFolder, IsAsItWasUntilItIsPublishedAndThenAnotherOne) {
  const TemporaryFolder folder;
  const fs::path out = folder / "out";
  publish(out, {{"a.txt", "old"}, {"only_old.txt", "old"}, {"plans/p.txt", "old"}});
  {
    AtomicFolder next(out, text_is_ours);
    save_file(next.path() / "a.txt", "new");
    fs::create_directory(next.path() / "plans");
    save_file(next.path() / "plans" / "q.txt", "new");
    EXPECT_EQ(fs::status(next.path()).permissions(), fs::perms::owner_all);
    EXPECT_EQ(content(out), (Content{{"a.txt", "old"}, {"only_old.txt", "old"}, {"plans/p.txt", "old"}}));
    next.publish();
  }
  EXPECT_EQ(content(out), (Content{{"a.txt", "new"}, {"plans/q.txt", "new"}}));
  EXPECT_EQ(entries_in(folder.path()), 1U);
}

TEST(AtomicFolder, UnpublishedLeavesNothingNotEvenTheFoldersAbove) {
  const TemporaryFolder folder;
  { const AtomicFolder out(folder / "a/b/c", nothing_is_ours); }
  EXPECT_EQ(entries_in(folder.path()), 0U);
  publish(folder / "a/b/c", {{"x.txt", "x"}});
  EXPECT_EQ(content(folder / "a/b/c"), (Content{{"x.txt", "x"}}));
}

TEST(AtomicFolder, KeepsWhatIsNotOurs) {
  const TemporaryFolder folder;
  const fs::path out = folder / "out";
  fs::create_directories(out / "mine/deep");
  fs::create_directory(out / "empty");
  write_file(out / "recording.rawlog", "mine");
  write_file(out / "mine/deep/note.md", "mine");
  fs::create_symlink("recording.rawlog", out / "link");
  publish(out, {{"a.txt", "first"}});
  EXPECT_EQ(content(out), (Content{{"a.txt", "first"},
                                   {"mine/deep/note.md", "mine"},
                                   {"recording.rawlog", "mine"},
                                   {"link", "mine"}}));
  EXPECT_TRUE(fs::is_symlink(out / "link"));
  EXPECT_TRUE(fs::is_directory(out / "empty"));
  write_file(out / "theirs.dat", "theirs");
  publish(out, {{"b.txt", "second"}});
  EXPECT_EQ(content(out), (Content{{"b.txt", "second"},
                                   {"mine/deep/note.md", "mine"},
                                   {"recording.rawlog", "mine"},
                                   {"theirs.dat", "theirs"},
                                   {"link", "mine"}}));
}

/// What a command wrote is what the list says, whatever names it uses: a copy may lack the list, and a person
/// may choose any name.
TEST(AtomicFolder, ReplacesNoFileOfOthersUnderANameOfOurs) {
  const TemporaryFolder folder;
  const fs::path out = folder / "out";
  const auto refusal_of = [&](const Content& files) -> std::string {
    try {
      publish(out, files);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  };
  for (const bool is_listed : {false, true}) {
    SCOPED_TRACE(is_listed);
    fs::remove_all(out);
    fs::create_directory(out);
    if (is_listed) publish(out, {{"a.txt", "ours"}, {"plans/p.txt", "ours"}});
    fs::create_directories(out / "plans");
    write_file(out / "plans/mine.txt", "mine");
    EXPECT_EQ(refusal_of({{"a.txt", "new"}}), "") << "of a file below nothing is said";
    EXPECT_EQ(content(out), (Content{{"a.txt", "new"}, {"plans/mine.txt", "mine"}}));
    EXPECT_NE(refusal_of({{"a.txt", "newer"}, {"plans/mine.txt", "other"}}).find("it holds 'plans/mine.txt'"),
              std::string::npos);
    write_file(out / "mine.txt", "mine");
    fs::create_symlink("plans/mine.txt", out / "link.txt");
    EXPECT_NE(refusal_of({{"a.txt", "newer"}}).find("it holds 'link.txt'"), std::string::npos);
    fs::remove(out / "link.txt");
    EXPECT_NE(refusal_of({{"a.txt", "newer"}}).find("it holds 'mine.txt'"), std::string::npos);
    EXPECT_EQ(content(out), (Content{{"a.txt", "new"}, {"mine.txt", "mine"}, {"plans/mine.txt", "mine"}}));
  }
  EXPECT_EQ(entries_in(folder.path()), 1U);
}

TEST(AtomicFolder, AFileThatCannotBeWrittenIsToldWithTheFolderThatItIsFor) {
  const TemporaryFolder folder;
  const fs::path out = folder / "out";
  for (const std::string state : {"is not there", "is as it was"}) {
    {
      AtomicFolder next(out, text_is_ours);
      fs::create_directory(next.path() / "plans");
      try {
        fail_to_write(next.path() / "plans/p.txt", "no space");
      } catch (const std::runtime_error& error) {
        EXPECT_EQ(error.what(),
                  "cannot write 'p.txt' for '" + out.string() + "', which " + state + ": no space");
      }
    }
    publish(out, {{"a.txt", "old"}});
  }
}

TEST(AtomicFolder, WhatAnotherCommandWroteDoesNotGo) {
  const TemporaryFolder folder;
  const fs::path out = folder / "out";
  {
    AtomicFolder other(out, [](const fs::path& relative) { return relative.extension() == ".yaml"; });
    fs::create_directory(other.path() / "deep");
    save_file(other.path() / "deep/setup.yaml", "of another command");
    other.publish();
  }
  try {
    publish(out, {{"a.txt", "new"}});
    ADD_FAILURE();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("it holds 'deep/setup.yaml', which another command wrote"),
              std::string::npos)
        << error.what();
  }
  EXPECT_EQ(content(out), (Content{{"deep/setup.yaml", "of another command"}}));
  fs::remove_all(out / "deep");
  publish(out, {{"a.txt", "new"}});
  EXPECT_EQ(content(out), (Content{{"a.txt", "new"}}));
}

TEST(AtomicFolder, WhatAnotherCommandFinishedMeanwhileDoesNotGoAndNeitherDoesTheLongWork) {
  const TemporaryFolder folder;
  const fs::path out = folder / "out";
  {
    AtomicFolder slow(
        out, [](const fs::path& relative) { return relative.extension() == ".log"; }, Unpublished::kept);
    save_file(slow.path() / "runs.log", "hours");
    slow.note_progress("3 problems are");
    publish(out, {{"map.txt", "of a quick command"}});
    try {
      slow.publish();
      ADD_FAILURE();
    } catch (const std::runtime_error& error) {
      EXPECT_NE(std::string(error.what()).find("it holds 'map.txt', which another command wrote"),
                std::string::npos)
          << error.what();
    }
    EXPECT_EQ(slow.unfinished_work(), "3 problems are in '" + out.string() + ".partial'");
    slow.note_progress("4 problems are", "`more` goes on");
    EXPECT_EQ(slow.unfinished_work(), "4 problems are in '" + out.string() + ".partial'; `more` goes on");
  }
  EXPECT_EQ(content(out), (Content{{"map.txt", "of a quick command"}}));
  EXPECT_EQ(content(AtomicFolder::partial_of(out)), (Content{{"runs.log", "hours"}}));
}

TEST(AtomicFolder, FilesOfOthersThatComeOrChangeMeanwhileAreKeptAsTheyAreThen) {
  const TemporaryFolder folder;
  const fs::path out = folder / "out";
  fs::create_directory(out);
  write_file(out / "changes.md", "before");
  AtomicFolder next(out, text_is_ours);
  save_file(out / "changes.md", "after");  // a new file under the old name
  write_file(out / "comes.md", "late");
  next.publish();
  EXPECT_EQ(content(out), (Content{{"changes.md", "after"}, {"comes.md", "late"}}));
}

TEST(AtomicFolder, KeepsPermissionsOfTheFolderThatItReplaces) {
  const TemporaryFolder folder;
  publish(folder / "new", {});
  fs::create_directory(folder / "made");
  EXPECT_EQ(fs::status(folder / "new").permissions(), fs::status(folder / "made").permissions());
  ::chmod((folder / "made").c_str(), 0750);
  publish(folder / "made", {});
  EXPECT_EQ(static_cast<unsigned>(fs::status(folder / "made").permissions()), 0750U);
}

/// Owner and group, too, where whoever runs the tests may give them away.
TEST(AtomicFolder, KeepsPermissionsOfFoldersOfOthersWithinIt) {
  const TemporaryFolder folder;
  publish(folder / "made", {});
  fs::create_directories(folder / "made" / "notes" / "old");
  write_file(folder / "made" / "notes" / "old" / "mine.md", "mine");
  ::chmod((folder / "made" / "notes").c_str(), 02750);
  const bool may_give = ::chown((folder / "made" / "notes" / "old").c_str(), 1234, 8) == 0;
  ::chmod((folder / "made" / "notes" / "old").c_str(), 02770);
  publish(folder / "made", {{"a.txt", "a"}});
  EXPECT_EQ(static_cast<unsigned>(fs::status(folder / "made" / "notes").permissions()), 02750U);
  struct stat status {};
  ASSERT_EQ(::stat((folder / "made" / "notes" / "old").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777U, 02770U);
  EXPECT_TRUE(!may_give || (status.st_uid == 1234 && status.st_gid == 8));
  EXPECT_EQ(read_file(folder / "made" / "notes" / "old" / "mine.md"), "mine");
}

TEST(AtomicFolder, ALinkToAFolderStaysALink) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "real");
  fs::create_directory_symlink("real", folder / "link");
  publish(folder / "link", {{"a.txt", "new"}});
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(content(folder / "real"), (Content{{"a.txt", "new"}}));
}

TEST(AtomicFolder, RefusesBeforeTheWorkWhatCannotBeReplaced) {
  const TemporaryFolder folder;
  write_file(folder / "file", "x");
  fs::create_directory(folder / "sockets");
  sockaddr_un address{AF_UNIX, {}};
  const std::string name = folder / "sockets/s";
  name.copy(address.sun_path, sizeof address.sun_path - 1);
  const FileDescriptor socket(::socket(AF_UNIX, SOCK_STREAM, 0));
  ASSERT_EQ(::bind(socket.number(), reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  fs::create_symlink("nowhere", folder / "broken");

  EXPECT_NE(refusal(".").find("'.'"), std::string::npos);
  EXPECT_NE(refusal("/").find("'/'"), std::string::npos);
  EXPECT_NE(refusal("/proc").find("mount point"), std::string::npos);
  EXPECT_NE(refusal("/proc/new").find("'/proc/new'"), std::string::npos);
  EXPECT_NE(refusal(folder / "file").find("not a folder"), std::string::npos);
  EXPECT_NE(refusal(folder / "file/below").find("not a folder"), std::string::npos);
  EXPECT_NE(refusal(folder / "sockets").find("'s'"), std::string::npos);
  EXPECT_NE(refusal(folder / "broken").find("leads nowhere"), std::string::npos);
  EXPECT_NE(refusal(""), "");
  EXPECT_EQ(entries_in(folder.path()), 3U);
}

TEST(AtomicFolder, KeptWorkHasANameAndMakesWayForTheNext) {
  const TemporaryFolder folder;
  const fs::path out = folder / "out", partial = folder / "out.partial";
  publish(out, {{"a.txt", "old"}});
  {
    AtomicFolder next(out, text_is_ours, Unpublished::kept);
    save_file(next.path() / "b.txt", "half");
    EXPECT_EQ(next.unfinished_work(), "");
    next.note_progress("2 problems are");
    EXPECT_EQ(next.unfinished_work(), "2 problems are in '" + partial.string() + "'");
    EXPECT_THROW(AtomicFolder(out, text_is_ours, Unpublished::kept), std::runtime_error);  // one at a time
    EXPECT_TRUE(fs::exists(partial / "b.txt"));
  }
  EXPECT_EQ(content(out), (Content{{"a.txt", "old"}}));
  EXPECT_EQ(content(partial), (Content{{"b.txt", "half"}}));
  {
    AtomicFolder next(out, text_is_ours, Unpublished::kept);
    save_file(next.path() / "c.txt", "new");
    next.publish();
  }
  EXPECT_EQ(content(out), (Content{{"c.txt", "new"}}));
  EXPECT_FALSE(fs::exists(partial));
  fs::create_directory(partial);
  { const AtomicFolder next(out, text_is_ours, Unpublished::kept); }  // was killed at its very beginning
  fs::create_directory(partial);
  write_file(partial / "theirs", "of somebody else");
  EXPECT_THROW(AtomicFolder(out, text_is_ours, Unpublished::kept), std::runtime_error);
  EXPECT_TRUE(fs::exists(partial));
}

TEST(AtomicFolder, ContinuedWorkGoesOnWithWhatIsThereAndLosesNothing) {
  const TemporaryFolder folder;
  const fs::path out = folder / "out", partial = folder / "out.partial";
  publish(out, {{"a.txt", "old"}});
  write_file(out / "mine.dat", "of a person");
  {
    AtomicFolder first(out, text_is_ours, Unpublished::continued);  // nothing there: begins
    EXPECT_EQ(first.unfinished_work(), "");
    save_file(first.path() / "b.txt", "half");
    first.note_progress("1 problem is");
  }
  for (int times = 0; times < 2; ++times) {  // given up at once, it stays
    const AtomicFolder next(out, text_is_ours, Unpublished::continued);
    EXPECT_NE(next.unfinished_work(), "");
    EXPECT_THROW(AtomicFolder(out, text_is_ours, Unpublished::continued), std::runtime_error);
    EXPECT_EQ(content(partial).at("b.txt"), "half");
  }
  save_file(out / "mine.dat", "of a person, edited");  // a new file under the old name
  {
    AtomicFolder last(out, text_is_ours, Unpublished::continued);
    EXPECT_EQ(content(last.path()).at("b.txt"), "half");
    save_file(last.path() / "c.txt", "rest");
    last.publish();
  }
  EXPECT_EQ(content(out),
            (Content{{"b.txt", "half"}, {"c.txt", "rest"}, {"mine.dat", "of a person, edited"}}));
  publish(out, {{"d.txt", "next"}});  // what a person put there is not taken for ours
  EXPECT_EQ(content(out), (Content{{"d.txt", "next"}, {"mine.dat", "of a person, edited"}}));
}

}  // namespace atomic_folder_test
}  // namespace clearway

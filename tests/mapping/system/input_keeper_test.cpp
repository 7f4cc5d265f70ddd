// What is kept of what was read, and read again.
#include <gtest/gtest.h>

#include <thread>

#include "mapping/system/child_process.hpp"
#include "mapping/system/input_file.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace input_keeper_test {

std::string read(const std::filesystem::path& file) { return read_input(file, "file", 1000); }

TEST(InputKeeper, KeepsWhatIsReadButForWhatIsApart) {
  const TemporaryFolder folder;
  folder.write("a.txt", "first");
  folder.write("b.txt", "second");
  std::filesystem::create_directory(folder / "scans");
  folder.write("scans/c.txt", "third");
  folder.write("scans.txt", "fourth");
  const InputKeeper keeper({}, {folder / "scans", ""});
  EXPECT_EQ(read(folder / "a.txt"), "first");
  EXPECT_EQ(read(folder / "scans/c.txt"), "third");
  EXPECT_EQ(read(folder / "scans/../b.txt"), "second");
  EXPECT_EQ(read(folder / "scans.txt"), "fourth");
  EXPECT_THROW(read(folder / "none.txt"), std::invalid_argument);
  folder.write("a.txt", "changed");  // after it was read
  EXPECT_EQ(keeper.kept(), (std::map<std::string, std::string>{{folder.file("a.txt"), "first"},
                                                               {folder.file("b.txt"), "second"},
                                                               {folder.file("scans.txt"), "fourth"}}));
}

TEST(InputKeeper, WhatIsGivenIsReadInPlaceOfTheDisk) {
  const TemporaryFolder folder;
  const std::string changed = folder.write("a.txt", "changed");
  const std::string gone = folder.file("gone.txt");
  {
    const std::map<std::string, std::filesystem::path> given{{changed, folder.write("kept1", "first")},
                                                             {gone, folder.write("kept2", "second")}};
    const InputKeeper keeper(given);
    EXPECT_EQ(read(changed), "first");
    EXPECT_TRUE(is_input_there(gone));
    EXPECT_FALSE(is_input_there(folder.file("nothing")));
    EXPECT_FALSE(is_input_there(folder.file("late")));
    EXPECT_EQ(read(gone), "second");
    EXPECT_EQ(input_place(gone), folder.file("kept2"));
    // What was given is kept as what was read: a session that is done again can be done a third time.
    EXPECT_EQ(keeper.kept(), (std::map<std::string, std::string>{{changed, "first"},
                                                                 {gone, "second"},
                                                                 {"absent: " + folder.file("late"), ""},
                                                                 {"absent: " + folder.file("nothing"), ""}}));
  }
  folder.write("late", "it was not there");
  EXPECT_TRUE(is_input_there(folder.file("late")));
  {
    const std::map<std::string, std::filesystem::path> given{
        {"absent: " + folder.file("late"), folder.write("kept3", "")}};
    const InputKeeper keeper(given);
    EXPECT_FALSE(is_input_there(folder.file("late")));
    EXPECT_TRUE(is_input_there(changed));
  }
  EXPECT_EQ(read(changed), "changed");
  EXPECT_FALSE(is_input_there(gone));
  EXPECT_EQ(input_place(gone), gone);
}

TEST(InputKeeper, RelativePathsAreOfItsFolder) {
  const TemporaryFolder folder;
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::create_directory(folder / "there");
  folder.write("there/a.txt", "first");
  std::filesystem::current_path(folder / "there");
  {
    const InputKeeper keeper;
    EXPECT_EQ(read("a.txt"), "first");
    EXPECT_EQ(read("../there/./a.txt"), "first");
    EXPECT_EQ(whole_input_path("b"), folder / "there/b");
    EXPECT_EQ(keeper.kept(), (std::map<std::string, std::string>{{folder.file("there/a.txt"), "first"}}));
  }
  std::filesystem::current_path(before);
  const std::map<std::string, std::filesystem::path> given{
      {folder.file("there/a.txt"), folder.write("kept", "first")}};
  const InputKeeper keeper(given, {}, folder / "there");
  EXPECT_EQ(read("a.txt"), "first");
  EXPECT_EQ(read(folder / "there/a.txt"), "first");
  EXPECT_EQ(whole_input_path("b"), folder / "there/b");
}

TEST(InputKeeper, NamesThatAreNoUtf8AreKept) {
  const TemporaryFolder folder;
  folder.write("j\xf6rg", "first");
  const InputKeeper keeper;
  EXPECT_EQ(read(folder / "j\xf6rg"), "first");
  EXPECT_EQ(keeper.kept(), (std::map<std::string, std::string>{{folder.file("j\\xf6rg"), "first"}}));
}

TEST(InputKeeper, AnswersAreAskedForOnceAndGivenBack) {
  const TemporaryFolder folder;
  int asked = 0;
  const auto ask = [&] {
    ++asked;
    return std::string("answer");
  };
  EXPECT_EQ(kept_answer("question", ask), "answer");
  EXPECT_EQ(asked, 1);
  {
    const InputKeeper keeper;
    EXPECT_EQ(kept_answer("question", ask), "answer");
    EXPECT_EQ(keeper.kept(), (std::map<std::string, std::string>{{"question", "answer"}}));
  }
  const std::map<std::string, std::filesystem::path> given{{"question", folder.write("kept", "another")}};
  const InputKeeper keeper(given);
  EXPECT_EQ(kept_answer("question", ask), "another");
  EXPECT_EQ(kept_answer("other", ask), "answer");
  EXPECT_EQ(asked, 3);
  EXPECT_THROW(InputKeeper{}, std::logic_error);
}

TEST(InputKeeper, ThreadsMayReadAtTheSameTime) {
  const TemporaryFolder folder;
  for (int i = 0; i < 20; ++i) folder.write(std::to_string(i), std::string(100, static_cast<char>('a' + i)));
  const InputKeeper keeper;
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&] {
      for (int i = 0; i < 20; ++i) EXPECT_EQ(read(folder / std::to_string(i)).size(), 100U);
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(keeper.kept().size(), 20U);
}

/// Children are made while other threads read; each reads to its end.
TEST(InputKeeper, ChildrenReadWhateverThreadsDoWhenTheyAreMade) {
  const TemporaryFolder folder;
  for (int i = 0; i < 200; ++i) folder.write(std::to_string(i), std::string(10'000, 'a'));
  const InputKeeper keeper;
  const std::jthread reader([&](const std::stop_token& end) {
    for (int i = 0; !end.stop_requested(); i = (i + 1) % 200) input_place(folder / std::to_string(i));
  });
  for (int i = 0; i < 50; ++i) {
    const ChildOutcome run = run_in_child([&] { return read_input(folder / "7", "file", 100'000); },
                                          {.memory = 64U << 20U, .output = 100'000, .seconds = 5});
    ASSERT_TRUE(run.finished) << run.failure;
    EXPECT_EQ(run.parts.front().size(), 10'000U);
  }
}

}  // namespace input_keeper_test
}  // namespace clearway

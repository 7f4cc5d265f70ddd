#include "tests/mutation/test_stages.hpp"

#include <gtest/gtest.h>

#include <fstream>

namespace clearway::mutation {
namespace test_stages_test {

namespace fs = std::filesystem;

class TestStages : public ::testing::Test {
 protected:
  TestStages() : folder_(fs::path(::testing::TempDir()) / "clearway_test_stages") {
    fs::remove_all(folder_);
    write("planning/check/known.cpp", "");
    write("planning/check/hidden.cpp", "");
    write("planning/user.cpp", "#include \"planning/check/hidden.hpp\"\n");
    write("tests/planning/check/known_test.cpp", "TEST(Known, IsRight) {}\n");
    write("tests/planning/check/other_test.cpp", "TEST_F(Other, IsRight) {}\n");
    write(
        "tests/planning/user_test.cpp",
        "#include \"planning/user.hpp\"\n#include \"planning/check/known.hpp\"\nTEST_P(User, IsRight) {}\n");
  }
  ~TestStages() override { fs::remove_all(folder_); }

  void write(const fs::path& name, const std::string& text) const {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text;
  }
  static std::string suite(const std::string& name) { return name + ".*:*/" + name + ".*:" + name + "/*"; }

  fs::path folder_;
};

std::vector<std::string> filters(const std::vector<Stage>& stages, Trials trials) {
  std::vector<std::string> filters;
  for (const Stage& stage : stages)
    if (stage.trials == trials) filters.push_back(stage.filter);
  return filters;
}

TEST_F(TestStages, TheMirroredFileAndThoseThatIncludeTheHeaderComeFirstThenItsFolderThenTheOthers) {
  const std::string near = suite("Known") + ":" + suite("User");
  EXPECT_EQ(filters(stages_for(folder_, "planning/check/known.cpp"), Trials::few),
            (std::vector<std::string>{near, suite("Other") + "-" + near, "-" + near + ":" + suite("Other")}));
}

TEST_F(TestStages, WhatNoTestIncludesIsTriedFirstByTheTestsOfWhatIncludesIt) {
  EXPECT_EQ(stages_for(folder_, "planning/check/hidden.cpp").front().filter, suite("User"));
}

TEST_F(TestStages, WhatOnlyAHeaderIncludesIsTriedFirstByTheTestsOfThatHeader) {
  write("planning/check/inner.cpp", "");
  write("planning/user.hpp", "#include \"planning/check/inner.hpp\"\n");
  EXPECT_EQ(stages_for(folder_, "planning/check/inner.cpp").front().filter, suite("User"));
}

TEST_F(TestStages, WhatNoTestKnowsAtAllIsTriedFirstByTheTestsOfItsFolder) {
  write("planning/check/alone.cpp", "");
  EXPECT_EQ(filters(stages_for(folder_, "planning/check/alone.cpp"), Trials::few),
            (std::vector<std::string>{suite("Known") + ":" + suite("Other"),
                                      "-" + suite("Known") + ":" + suite("Other")}));
}

TEST_F(TestStages, OnlyTestsThatDrawCasesAreRunWithMany) {
  write("tests/planning/far/drawing_test.cpp",
        "TEST(Drawing, IsRight) { for (int i = 0; i < trials(1, 9);) }\n");
  write("tests/planning/far/other_test.cpp", "TEST(Other2, IsRight) { make_trials(3); }\n");
  EXPECT_EQ(filters(stages_for(folder_, "planning/check/known.cpp"), Trials::many),
            std::vector<std::string>{suite("Drawing")});
}

TEST_F(TestStages, OfAppsNoOtherFoldersTestsAreRunWithMany) {
  write("apps/check/known.cpp", "");
  write("tests/apps/check/known_test.cpp", "TEST(Known, IsRight) { trials(1, 9); }\n");
  write("tests/apps/check/beside_test.cpp", "TEST(Beside, IsRight) { trials(1, 9); }\n");
  write("tests/apps/far/drawing_test.cpp", "TEST(Drawing, IsRight) { trials(1, 9); }\n");
  EXPECT_EQ(filters(stages_for(folder_, "apps/check/known.cpp"), Trials::many),
            std::vector<std::string>{suite("Beside") + ":" + suite("Known")});
}

}  // namespace test_stages_test
}  // namespace clearway::mutation

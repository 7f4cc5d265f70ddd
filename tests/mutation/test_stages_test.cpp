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

TEST_F(TestStages, TheMirroredFileAndThoseThatIncludeTheHeaderComeFirstThenItsFolderThenTheOthers) {
  const std::string near = suite("Known") + ":" + suite("User");
  EXPECT_EQ(stages_for(folder_, "planning/check/known.cpp"),
            (std::vector<std::string>{near, suite("Other") + "-" + near, "-" + near + ":" + suite("Other")}));
}

TEST_F(TestStages, WhatNoTestIncludesIsTriedFirstByTheTestsOfWhatIncludesIt) {
  EXPECT_EQ(stages_for(folder_, "planning/check/hidden.cpp").front(), suite("User"));
}

}  // namespace test_stages_test
}  // namespace clearway::mutation

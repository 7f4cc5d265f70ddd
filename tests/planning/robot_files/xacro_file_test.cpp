#include "planning/robot_files/xacro_file.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>

#include "planning/check/path_check.hpp"
#include "planning/robot_files/torque_terms.hpp"
#include "tests/worlds/hostile_robots.hpp"

namespace clearway {
namespace xacro_file_test {

/// A folder first in the PATH with a program of the name xacro, made here: what is said to it, and what it
/// answers, is the program's own contract (arguments: the file; stdout: URDF; status 0).
class XacroFile : public ::testing::Test {
 protected:
  void SetUp() override {
    path_ = std::getenv("PATH") ? std::getenv("PATH") : "";
    ::setenv("PATH", (folder_.path().string() + ":/usr/bin:/bin").c_str(), 1);
    const std::string urdf = two_links(sphere_collision(), "revolute", free_turn());
    folder_.write("two.urdf.xacro", "<robot name='xacro'/>");
    folder_.write("expanded", urdf);
  }
  void TearDown() override { ::setenv("PATH", path_.c_str(), 1); }

  void make_program(const std::string& body) const {
    const std::filesystem::path program = folder_.write("xacro", "#!/bin/sh\n" + body + "\n");
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  }

  std::string refusal(const std::map<std::string, std::string>& arguments = {},
                      const std::string& name = "two.urdf.xacro") const {
    try {
      RobotRequest request{folder_.file(name)};
      request.xacro = arguments;
      load_robot(request);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "accepted";
  }

  RobotFolder folder_;
  std::string path_;
};

TEST_F(XacroFile, WhatTheProgramMakesIsTheRobotForPlannersAndCheck) {
  make_program("[ \"$1\" = '" + folder_.file("two.urdf.xacro") + "' ] && cat '" + folder_.file("expanded") +
               "'");
  const Robot robot = load_robot(folder_.file("two.urdf.xacro"));
  EXPECT_EQ(robot.dof(), 1U);
  const std::string said = check_path(robot, Snapshot(), {}, 0.0, {Configuration::Zero(1)}).first_contact;
  EXPECT_EQ(said.find("is not what its file"), std::string::npos) << said;
}

/// The stand-in wants exactly these words, in the order of the names.
TEST_F(XacroFile, ArgumentsArePassedOnForPlannersTorquesAndCheckAlike) {
  make_program("[ \"$2 $3\" = 'far:=1 side:=left arm' ] || exit 2; cat '" + folder_.file("expanded") + "'");
  EXPECT_NE(refusal().find("--xacro NAME:=VALUE"), std::string::npos) << refusal();
  RobotRequest request{folder_.file("two.urdf.xacro")};
  request.xacro = {{"side", "left arm"}, {"far", "1"}};
  const Robot robot = load_robot(request);
  EXPECT_EQ(robot.xacro, request.xacro);
  EXPECT_NO_THROW(torque_terms(robot, {}));
  const std::string said = check_path(robot, Snapshot(), {}, 0.0, {Configuration::Zero(1)}).first_contact;
  EXPECT_EQ(said.find("is not what its file"), std::string::npos) << said;

  folder_.write("two.yaml", "xacro: {side: right, far: 1}\n");
  request.xacro = {{"side", "left arm"}};  // goes before the settings'
  EXPECT_EQ(load_robot(request).xacro, robot.xacro);
  folder_.write("two.yaml", "xacro: {si-de: right}\n");
  EXPECT_NE(refusal().find("'xacro.si-de' must be named by letters, digits and underscores"),
            std::string::npos)
      << refusal();
}

TEST_F(XacroFile, ArgumentsOfNoNameOrForAnotherKindOfFileAreRefused) {
  make_program("cat '" + folder_.file("expanded") + "'");
  for (const char* name : {"", "a b", "-x", "a:"})
    EXPECT_NE(refusal({{name, "1"}}).find("expected a name of letters, digits and underscores"),
              std::string::npos)
        << refusal({{name, "1"}});
  folder_.write("plain.urdf", two_links(sphere_collision(), "revolute", free_turn()));
  folder_.write("plain.yaml", "xacro: {side: left}\n");  // of a plain.urdf.xacro, perhaps
  EXPECT_EQ(refusal({}, "plain.urdf"), "accepted");
  EXPECT_NE(refusal({{"side", "left"}}, "plain.urdf").find("is no .xacro file, expected one"),
            std::string::npos);
  EXPECT_NE(refusal({}, "plain.yaml").find("is no .xacro file, expected one"), std::string::npos);
}

TEST_F(XacroFile, ARefusalOrAMissingProgramIsReportedInOurWords) {
  make_program("echo 'Traceback'; echo 'Traceback' >&2; exit 2");
  EXPECT_NE(refusal().find("xacro could not expand it, expected"), std::string::npos) << refusal();
  make_program("yes '<robot>'");  // without end
  EXPECT_NE(refusal().find("its content is larger than it may be"), std::string::npos) << refusal();
  std::filesystem::remove(folder_.path() / "xacro");
  ::setenv("PATH", folder_.path().c_str(), 1);
  EXPECT_NE(refusal().find("the program 'xacro' is not installed"), std::string::npos) << refusal();
}

/// By hand: which names the files declare or use, through their includes.
TEST_F(XacroFile, AnArgumentThatNoFileDeclaresIsTold) {
  std::filesystem::create_directories(folder_ / "parts");
  std::filesystem::create_directories(folder_ / "kit/urdf");
  folder_.write(
      "parts/hand.xacro",
      "<robot xmlns:xacro='http://ros.org/wiki/xacro'><xacro:macro name='m'><xacro:arg name='fingers' "
      "default='2'/></xacro:macro></robot>");
  folder_.write("kit/urdf/base.xacro",
                "<robot xmlns:xacro='http://ros.org/wiki/xacro'><link name='$(arg prefix)base'/></robot>");
  const std::string head =
                        "<robot name='a' xmlns:xacro='http://ros.org/wiki/xacro'><xacro:arg name='side' "
                        "default='left'/>",
                    hand = "<xacro:include filename='parts/hand.xacro'/>",
                    base = "<xacro:include filename='$(find kit)/urdf/base.xacro'/>";
  const XacroArguments good{{"side", "right"}, {"fingers", "3"}, {"prefix", "x"}};
  XacroArguments slip = good;
  slip["sid"] = "left";
  const std::string whole = folder_.write("whole.xacro", head + hand + base + "</robot>");
  EXPECT_TRUE(xacro_notes(whole, good).empty());
  EXPECT_TRUE(xacro_notes(whole, {}).empty());
  const auto notes = xacro_notes(whole, slip, {{"kit", folder_ / "kit"}});
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].find("xacro argument 'sid' has no effect"), std::string::npos) << notes[0];
  EXPECT_NE(notes[0].find("did you mean 'side'?"), std::string::npos) << notes[0];
  const std::string alone = folder_.write("alone.xacro", head + "</robot>");
  EXPECT_EQ(xacro_notes(alone, good).size(), 2U);
  // What is included and cannot be found may declare it, and a file that includes itself ends.
  for (const char* lost :
       {"<xacro:include filename='no.xacro'/>", "<xacro:include filename='${kind}.xacro'/>",
        "<xacro:include filename='$(find nowhere)/a.xacro'/>"})
    EXPECT_TRUE(xacro_notes(folder_.write("lost.xacro", head + lost + "</robot>"), slip).empty()) << lost;
  const std::string circle =
      folder_.write("circle.xacro", head + "<xacro:include filename='circle.xacro'/>" + "</robot>");
  EXPECT_EQ(xacro_notes(circle, {{"sid", "left"}}).size(), 1U);
  EXPECT_TRUE(xacro_notes(folder_.write("broken.xacro", "<robot"), slip).empty());
}

/// By the robot that is loaded, also for the arguments of its settings.
TEST_F(XacroFile, NotesOfARobotNameItsArgumentsThatHaveNoEffect) {
  make_program("cat '" + folder_.file("expanded") + "'");
  folder_.write("two.yaml", "xacro: {colour: red}\n");
  const auto notes = robot_notes(load_robot(folder_.file("two.urdf.xacro")));
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_NE(notes[0].find("xacro argument 'colour' has no effect"), std::string::npos) << notes[0];
}

}  // namespace xacro_file_test
}  // namespace clearway

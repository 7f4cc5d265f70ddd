#include "datasets/yaml/moved_files.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

namespace clearway {
namespace moved_files_test {

const std::string setup =
    "# mine\n"
    "camera: {file: cam.yaml, name: left}  # its lens\n"
    "robot:\n"
    "  name: arms/ur5.urdf\n"
    "  joint_file: 'j.csv'\n"
    "sensors:\n"
    "  - {name: laser, poses: \"walk.txt\"}\n"
    "  - {name: depth, poses: /abs/walk.txt}\n"
    "loads:\n"
    "  - {name: poses, mesh: m/cup.stl}\n";

TEST(MovedFiles, AreNamedAsTheOtherFolderSeesThemAndAllElseStays) {
  EXPECT_EQ(with_files_from(setup, "/a/b", "/a/b"), setup);
  EXPECT_EQ(with_files_from(setup, "/a/b", "/a/c/d"),
            "# mine\n"
            "camera: {file: \"../../b/cam.yaml\", name: left}  # its lens\n"
            "robot:\n"
            "  name: \"../../b/arms/ur5.urdf\"\n"
            "  joint_file: \"../../b/j.csv\"\n"
            "sensors:\n"
            "  - {name: laser, poses: \"../../b/walk.txt\"}\n"
            "  - {name: depth, poses: /abs/walk.txt}\n"
            "loads:\n"
            "  - {name: poses, mesh: \"../../b/m/cup.stl\"}\n");
}

TEST(MovedFiles, OfARobotAreItsSrdfAndFoldersOfPackagesToo) {
  EXPECT_EQ(with_files_from("robot: {name: arm, srdf: arm.srdf, group: srdf, packages: {name: ., b: /m}}\n",
                            "/a", "/b"),
            "robot: {name: arm, srdf: \"../a/arm.srdf\", group: srdf, packages: {name: \"../a/\", b: /m}}\n");
}

TEST(MovedFiles, RobotsOfOursKeepTheirNames) {
  EXPECT_EQ(with_files_from("robot: {name: puma560}\n", "/a", "/b"), "robot: {name: puma560}\n");
}

TEST(MovedFiles, ARobotsFileWithoutAFolderIsMovedAndAliasesOnce) {
  EXPECT_EQ(with_files_from("robot: {name: ur5.urdf}\n", "/a", "/b"), "robot: {name: \"../a/ur5.urdf\"}\n");
  EXPECT_EQ(with_files_from("loads: [&l {mesh: cup.stl}]\nmore: [*l]\n", "/a", "/b"),
            "loads: [&l {mesh: \"../a/cup.stl\"}]\nmore: [*l]\n");
}

TEST(MovedFiles, NamesThatAreNotInOneLineAreRefused) {
  EXPECT_THROW(with_files_from("camera:\n  file: a\n    b.yaml\n", "/a", "/b"), std::invalid_argument);
  EXPECT_THROW(with_files_from("camera: {file: \"a\\\"b.yaml\"}\n", "/a", "/b"), std::invalid_argument);
}

}  // namespace moved_files_test
}  // namespace clearway

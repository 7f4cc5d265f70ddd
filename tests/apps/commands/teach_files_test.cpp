// What a recorded session rests on beside its recording: kept in its folder, and used when it is done again.

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "mapping/files/cloud_file.hpp"
#include "tests/apps/run_command.hpp"

namespace clearway {
namespace teach_files_test {

namespace fs = std::filesystem;

/// A tetrahedron as STL.
std::string mesh(double size) {
  std::string text = "solid can\n";
  const std::string corners[] = {"0 0 0", std::to_string(size) + " 0 0", "0 " + std::to_string(size) + " 0",
                                 "0 0 " + std::to_string(size)};
  for (int left_out = 0; left_out < 4; ++left_out) {
    text += "facet normal 0 0 1\nouter loop\n";
    for (int i = 0; i < 4; ++i)
      if (i != left_out) text += "vertex " + corners[i] + "\n";
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid can\n";
}

std::string urdf(double reach) {
  return "<robot name='stick'><link name='base'/><link name='rod'><collision><geometry><mesh "
         "filename='package://stick_parts/rod.stl'/></geometry></collision></link><joint name='turn' "
         "type='revolute'><parent link='base'/><child link='rod'/><origin xyz='" +
         std::to_string(reach) +
         " 0 0'/><axis xyz='0 0 1'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint></robot>";
}

class SessionFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    for (const char* name : {"scans", "stick_parts", "home"}) fs::create_directory(folder_ / name);
    std::vector<Eigen::Vector3f> points;
    for (int i = 0; i < 40; ++i) points.emplace_back(2.0F, 0.05F * static_cast<float>(i) - 1.0F, 0.0F);
    folder_.write("scans/1.pcd", format_pcd(points));
    folder_.write("home/camera.yaml",
                  "image_width: 752\nimage_height: 480\ncamera_matrix: {rows: 3, cols: 3, data: [458.6, 0, "
                  "367.2, 0, 457.2, 248.3, 0, 0, 1]}\ndistortion_model: plumb_bob\ndistortion_coefficients: "
                  "{rows: 1, cols: 5, data: [0, 0, 0, 0, 0]}\n");
    folder_.write("home/setup.yaml", "map: {resolution: 0.1}\ncamera: {file: camera.yaml}\n");
    folder_.write("home/can.stl", mesh(0.1));
    folder_.write("stick_parts/rod.stl", mesh(0.2));
    folder_.write("stick.urdf", urdf(0.5));
    folder_.write("home/events.jsonl",
                  "{\"time\": 0, \"action\": \"robot\", \"robot\": \"" + folder_.file("stick.urdf") +
                      "\"}\n{\"time\": 0, \"action\": \"attach\", \"load\": {\"name\": \"can\", \"mesh\": "
                      "\"can.stl\", \"link\": \"rod\"}}\n");
    first_ =
        run_command({"teach", folder_.file("scans"), "--setup", folder_.file("home/setup.yaml"), "--events",
                     folder_.file("home/events.jsonl"), "--headless", "--out", folder_.file("taught")});
  }

  CommandRun again(const std::string& out) const {
    return run_command({"replay", folder_.file("taught/session"), "--out", folder_.file(out)});
  }

  void expect_same(const std::string& out) const {
    for (const char* name : {"map.ot", "session/session.json", "session/events.jsonl", "session/setup.yaml"})
      EXPECT_EQ(read_file(folder_ / out / name), read_file(folder_ / "taught" / name)) << name;
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / "taught/session/files")) {
      const fs::path relative = fs::relative(entry.path(), folder_ / "taught");
      if (!entry.is_regular_file()) continue;
      EXPECT_EQ(read_file(entry.path()), read_file(folder_ / out / relative));
    }
  }

  TemporaryFolder folder_;
  CommandRun first_;
};

TEST_F(SessionFiles, AreUsedWhenTheFilesAreGoneOrOthers) {
  ASSERT_EQ(first_.status, exit_done) << first_.log;
  const auto session = nlohmann::json::parse(read_file(folder_ / "taught/session/session.json"));
  std::set<std::string> kept;
  for (const auto& file : session["files"]) kept.insert(fs::path(file["of"].get<std::string>()).filename());
  for (const char* name : {"camera.yaml", "stick.urdf", "rod.stl", "can.stl"})
    EXPECT_TRUE(kept.contains(name)) << name;
  EXPECT_FALSE(kept.contains("1.pcd"));  // the recording is kept as a whole
  EXPECT_FALSE(kept.contains("events.jsonl"));

  const CommandRun same = again("same");
  EXPECT_EQ(same.status, exit_done) << same.log;
  expect_same("same");

  folder_.write("home/camera.yaml", "nothing of use");
  folder_.write("stick.urdf", urdf(0.7));
  folder_.write("stick_parts/rod.stl", mesh(0.4));
  const CommandRun changed = again("changed");
  EXPECT_EQ(changed.status, exit_done) << changed.log;
  EXPECT_EQ(changed.log, same.log);
  expect_same("changed");

  for (const char* name : {"home", "stick_parts", "stick.urdf", "scans"}) fs::remove_all(folder_ / name);
  const CommandRun moved = again("moved");
  EXPECT_EQ(moved.status, exit_done) << moved.log;
  expect_same("moved");
}

/// As most people call it: from the folder where their files are. A file that was not there then is none now.
TEST_F(SessionFiles, OfRelativePathsAreUsedWhereverItIsDoneAgain) {
  const fs::path before = fs::current_path();
  folder_.write("home/events.jsonl",
                "{\"time\": 0, \"action\": \"robot\", \"robot\": \"stick.urdf\"}\n{\"time\": 0, \"action\": "
                "\"attach\", \"load\": {\"name\": \"can\", \"mesh\": \"can.stl\", \"link\": \"rod\"}}\n");
  fs::remove_all(folder_ / "taught");
  fs::current_path(folder_.path());
  first_ = run_command({"teach", "scans", "--setup", "home/setup.yaml", "--events", "home/events.jsonl",
                        "--headless", "--out", "taught"});
  fs::current_path(before);
  ASSERT_EQ(first_.status, exit_done) << first_.log;
  const CommandRun same = again("same");
  EXPECT_EQ(same.status, exit_done) << same.log;
  expect_same("same");
  folder_.write("stick.yaml", "no settings");
  folder_.write("stick.srdf", "no semantics");
  const CommandRun beside = again("beside");
  EXPECT_EQ(beside.status, exit_done) << beside.log;
  expect_same("beside");
  for (const char* name : {"home", "stick_parts", "stick.urdf", "scans"}) fs::remove_all(folder_ / name);
  const CommandRun moved = again("moved");
  EXPECT_EQ(moved.status, exit_done) << moved.log;
  expect_same("moved");
  fs::create_directory(folder_ / "elsewhere");
  fs::current_path(folder_ / "elsewhere");
  const CommandRun away = run_command({"replay", "../taught/session", "--out", "../away"});
  fs::current_path(before);
  EXPECT_EQ(away.status, exit_done) << away.log;
  expect_same("away");
}

TEST_F(SessionFiles, ThatWereChangedInTheSessionAreRefused) {
  ASSERT_EQ(first_.status, exit_done) << first_.log;
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "taught/session/files"))
    if (entry.path().filename() == "stick.urdf") std::ofstream(entry.path(), std::ios::app) << " ";
  const CommandRun run = again("again");
  EXPECT_EQ(run.status, exit_bad_input);
  EXPECT_TRUE(run.complains_in_one_sentence()) << run.log;
  EXPECT_NE(run.log.find("stick.urdf' is not the one that it was made from"), std::string::npos) << run.log;
}

/// The counts of a search that the clock ended are not repeated, and whoever compares is told.
TEST_F(SessionFiles, OfAPlanThatTookAllOfItsTimeAreSaidToMayDiffer) {
  folder_.write("home/events.jsonl",
                "{\"time\": 0, \"action\": \"robot\", \"robot\": \"" + folder_.file("stick.urdf") +
                    "\"}\n{\"time\": 0, \"action\": \"start\", \"q\": \"0.5\"}\n{\"time\": 0, "
                    "\"action\": \"goal\", \"q\": \"-0.5\"}\n{\"time\": 0, \"action\": \"plan\", "
                    "\"name\": \"swing\"}\n");
  for (const bool is_short : {true, false}) {
    fs::remove_all(folder_ / "taught");
    fs::remove_all(folder_ / "again");
    const CommandRun taught =
        run_command({"teach", folder_.file("scans"), "--setup", folder_.file("home/setup.yaml"), "--events",
                     folder_.file("home/events.jsonl"), "--headless", "--time-limit",
                     is_short ? "1e-9" : "1000", "--out", folder_.file("taught")});
    for (const CommandRun& run : {taught, again("again")})
      EXPECT_EQ(run.log.find("note: plan 'swing' took all of its time limit of 1e-09 s: done again, it may "
                             "report other counts") != std::string::npos,
                is_short)
          << run.log;
  }
}

}  // namespace teach_files_test
}  // namespace clearway

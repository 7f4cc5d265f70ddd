// What `plan` makes of maps that other programs wrote, with nothing but its defaults.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "mapping/files/cloud_file.hpp"
#include "tests/apps/run_command.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace plan_test {

using Json = nlohmann::json;
using Arguments = std::vector<std::string>;

/// A disc of 16 mm that slides along x, towards a wall.
constexpr const char* blade =
    "<robot name='blade'><link name='base'/><link name='disc'><collision><geometry><cylinder radius='0.008' "
    "length='0.01'/></geometry></collision></link><joint name='x' type='prismatic'><parent link='base'/>"
    "<child link='disc'/><axis xyz='1 0 0'/><limit lower='-1' upper='1' effort='1' velocity='1'/></joint>"
    "</robot>";

class PlanInCloud : public ::testing::Test {
 protected:
  PlanInCloud() {
    std::vector<Eigen::Vector3f> wall;  // a point in each cell of 5 cm, none of them before the disc
    for (int y = -10; y < 10; ++y)
      for (int z = -10; z < 10; ++z)
        wall.push_back(
            {0.01F, 0.025F + 0.05F * static_cast<float>(y), 0.025F + 0.05F * static_cast<float>(z)});
    folder_.write("wall.pcd", format_pcd(wall));
    folder_.write("blade.urdf", blade);
  }
  CommandRun run(const std::string& command, const Arguments& more) const {
    Arguments arguments{
        command,           "--map", folder_.file("wall.pcd"), "--robot", folder_.file("blade.urdf"),
        "--allow-outside", "all"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_command(arguments);
  }
  TemporaryFolder folder_;
};

TEST_F(PlanInCloud, AThinnedWallIsAWallUnlessItsVoxelsAreStatedSmaller) {
  const Arguments query{"--start=-0.3", "--goal=0.3", "--out", folder_.file("plan.json")};
  const CommandRun blocked = run("plan", query);
  EXPECT_EQ(blocked.status, exit_no) << blocked.out;
  EXPECT_NE(blocked.out.find("the cloud's points are some 50 mm apart and stand for voxels of 63 mm"),
            std::string::npos)
      << blocked.out;
  Arguments fine = query;
  fine.insert(fine.end(), {"--cloud-resolution", "0.02"});
  const CommandRun through = run("plan", fine);
  EXPECT_EQ(through.status, exit_done) << through.out;
  EXPECT_NE(through.out.find("100 % of the cloud's voxels of 20 mm touch fewer than four others"),
            std::string::npos)
      << through.out;
  const CommandRun coarse = run("check", {folder_.file("plan.json")});
  EXPECT_EQ(coarse.status, exit_no);
  EXPECT_NE(coarse.out.find("the plan was made on those of 20 mm (--cloud-resolution)"), std::string::npos)
      << coarse.out;
  const CommandRun checked =
      run("check", {folder_.file("plan.json"), "--cloud-resolution", "0.02", "--json"});
  EXPECT_EQ(checked.status, exit_done) << checked.out;
  EXPECT_NE(Json::parse(checked.out)["map_caveat"].get<std::string>().find("touch fewer than four others"),
            std::string::npos);
  EXPECT_EQ(run("plan", {"--start=-0.3", "--goal=0.3", "--cloud-resolution", "0"}).status, exit_bad_input);
}

TEST_F(PlanInCloud, WhoAsksForKnownFreeSpaceWhereNoneIsIsTold) {
  const Arguments panda{"plan",
                        "--map",
                        folder_.file("wall.pcd"),
                        "--robot",
                        "panda",
                        "--start",
                        "0,-0.5,0,-2,0,1.5,0.7",
                        "--goal",
                        "0.5,-0.5,0,-2,0,1.5,0.7"};
  const CommandRun run = run_command(panda);
  EXPECT_EQ(run.status, exit_no);
  EXPECT_NE(run.log.find("nothing in the map is known to be free"), std::string::npos) << run.log;
  Arguments stated = panda;
  stated.insert(stated.end(), {"--policy", "known_free"});
  EXPECT_EQ(run_command(stated).log.find("nothing in the map"), std::string::npos);
}

/// The points of a trajectory are as far apart as asked, and the check accepts what a controller makes of
/// them.
TEST_F(PlanInCloud, NoFileOfTheRobotIsWrittenOver) {
  const std::string settings = folder_.write("blade.yaml", "position_accuracy: 0.002\n");
  for (const Arguments& output : {Arguments{"--trajectory", "ros", settings}, {"--out", settings}}) {
    Arguments query{"--start=-0.3", "--goal=-0.2"};
    query.insert(query.end(), output.begin(), output.end());
    const CommandRun refused = run("plan", query);
    EXPECT_EQ(refused.status, exit_bad_input);
    EXPECT_NE(refused.log.find("is read by --robot"), std::string::npos) << refused.log;
    EXPECT_EQ(read_file(settings), "position_accuracy: 0.002\n");
  }
}

TEST(PlanPeriod, PointsAreAsFarApartAsAskedAndTheFileHoldsAsATrajectory) {
  TemporaryFolder folder;
  std::vector<Eigen::Vector3f> wall;
  for (int y = -20; y <= 0; ++y)
    for (int z = -5; z < 5; ++z)
      wall.push_back({2.5F, 0.02F * static_cast<float>(y), 0.02F * static_cast<float>(z)});
  folder.write("wall.pcd", format_pcd(wall));
  for (const double period : {0.001, 0.008, 0.05}) {
    const std::string file = folder.file("motion.json");
    const Arguments at{
        "--map", folder.file("wall.pcd"), "--robot", "planar2", "--policy", "not_occupied", "--allow-outside",
        "all",   "--cloud-resolution",    "0.02"};
    Arguments plan{"plan",
                   "--start=-1.2,0.5",
                   "--goal=1.2,-0.4",
                   "--period",
                   std::to_string(period),
                   "--trajectory",
                   "ros-json",
                   file};
    plan.insert(plan.end(), at.begin(), at.end());
    const CommandRun run = run_command(plan);
    ASSERT_EQ(run.status, exit_done) << run.out << run.log;
    const Json points = Json::parse(read_file(file))["points"];
    ASSERT_GT(points.size(), 10U);
    const auto time = [&](std::size_t i) {
      const Json& stamp = points[i]["time_from_start"];
      return stamp["sec"].get<double>() + 1e-9 * stamp["nanosec"].get<double>();
    };
    for (std::size_t i = 1; i < points.size(); ++i) EXPECT_NEAR(time(i) - time(i - 1), period, 2e-9);
    Arguments check{"check", file};
    check.insert(check.end(), at.begin(), at.end());
    const CommandRun checked = run_command(check);
    EXPECT_EQ(checked.status, exit_done) << period << checked.out << checked.log;
  }
}

/// A post bars the way that the goal says; the other way round is free.
TEST(PlanOtherWay, OfAJointWithoutLimitsIsNamedWhereNoWayWasFound) {
  TemporaryFolder folder;
  std::vector<Eigen::Vector3f> post;
  for (int z = -10; z < 10; ++z) post.push_back({0.01F, 0.51F, 0.01F + 0.02F * static_cast<float>(z)});
  folder.write("post.pcd", format_pcd(post));
  folder.write(
      "arm.urdf",
      "<robot name='arm'><link name='base'/><link name='rod'><collision><origin xyz='0.3 0 0'/>"
      "<geometry><box size='0.6 0.04 0.04'/></geometry></collision></link><joint name='turn' "
      "type='continuous'><parent link='base'/><child link='rod'/><axis xyz='0 0 1'/></joint></robot>");
  const auto plan = [&](const std::string& goal) {
    return run_command({"plan", "--map", folder.file("post.pcd"), "--robot", folder.file("arm.urdf"),
                        "--allow-outside", "all", "--cloud-resolution", "0.02", "--policy", "not_occupied",
                        "--start=0.5", "--goal=" + goal, "--time-limit", "1"});
  };
  const CommandRun barred = plan("2.5");
  EXPECT_EQ(barred.status, exit_no) << barred.out;
  EXPECT_NE(
      barred.log.find("joint turn turns without limits; -3.783 rad is the same place, the other way round"),
      std::string::npos)
      << barred.log;
  EXPECT_EQ(plan("-3.783").status, exit_done);
}

}  // namespace plan_test
}  // namespace clearway

#include "planning/check/check_legs.hpp"

#include <gtest/gtest.h>

#include "planning/plan_and_check.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/trials.hpp"
#include "tests/worlds/urdf_robots.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace check_legs_test {

Load rod(const std::string& link, double length) {
  Load load;
  load.name = "rod";
  load.link = link;
  load.link_from_load.translation().z() = 0.15 + length / 2;
  load.shape = Shape::box({0.04, 0.04, length});
  return load;
}

Policies anywhere() {
  Policies policies;
  policies.critical_by_default = false;
  return policies;
}

/// A load lies in the painted volumes of the first link from its own towards the root that has bodies; where
/// there is none, in those of what it touches.
TEST(CheckLegs, ALoadLiesInTheVolumesOfItsCarrierElseOfWhatItTouches) {
  const TemporaryFolder folder;
  const std::string sphere = "<sphere radius='0.05'/>", turn = worlds::urdf_limit(-2, 2);
  const Robot arm = load_robot(folder.write(
      "arm.urdf",
      "<robot name='arm'><link name='base'/><link name='bare'/>" +
          worlds::urdf_link("upper", "0.4 0 0", sphere) + worlds::urdf_link("finger", "0.4 0 0", sphere) +
          worlds::urdf_joint("a", "revolute", "base", "bare", "0 0 0", "0 0 1", turn) +
          worlds::urdf_joint("b", "revolute", "bare", "upper", "0.4 0 0", "0 0 1", turn) +
          worlds::urdf_joint("c", "revolute", "upper", "finger", "0.8 0 0", "0 0 1", turn) + "</robot>"));
  const auto valid_in = [&](const std::string& link, const std::string& touched, double x) {
    Load load;
    load.name = "box";
    load.link = link;
    load.link_from_load.translation() = Eigen::Vector3d(x, 0.0, 0.0);
    load.shape = Shape::box({0.1, 0.1, 0.1});
    load.touches = {touched};
    const Robot robot = with_load(arm, load);
    const Configuration q = Configuration::Zero(static_cast<Eigen::Index>(robot.dof()));
    const Eigen::Vector3d place =
        forward_kinematics(robot, q)[static_cast<std::size_t>(robot.bodies.back().link)] *
        robot.bodies.back().link_from_shape.translation();
    std::set<std::string> valid;
    for (const std::string part : {"upper", "finger"}) {
      FreeSpaceMap builder({.resolution = 0.05});
      for (const std::string volume : {"upper", "finger"}) {
        const int number = builder.add_volume("of " + volume, {volume});
        if (volume == part) builder.paint(number, {place, 0.3});
      }
      if (check_path(robot, builder.snapshot(), {{"box", Policy::painted}}, 0.0, {q}).valid)
        valid.insert(part);
    }
    return valid;
  };
  using Parts = std::set<std::string>;
  EXPECT_EQ(valid_in("bare", "upper", -0.5), Parts{"upper"});
  EXPECT_EQ(valid_in("bare", "finger", -0.5), Parts{"finger"});
  EXPECT_EQ(valid_in("finger", "upper", 1.0), Parts{"finger"});
  EXPECT_EQ(valid_in("upper", "finger", 0.4), Parts{"upper"});
}

/// Edges of a robot with a load among random voxels: what the planners prove the check does not refuse, and
/// what it proves is free at many places of the planners'.
TEST(CheckLegs, AgreesWithTheSpaceOfALoadedRobot) {
  int both = 0, neither = 0;
  for (const char* name : {"arm6", "puma560", "panda"}) {
    Random random(7);
    const Robot robot = load_robot(name);
    const std::string hand = robot.links[static_cast<std::size_t>(robot.tip_link)].name;
    const Robot loaded = with_load(robot, rod(hand, 0.25));
    FreeSpaceMap builder({.resolution = 0.05});
    for (int i = 0; i < 15; ++i) {
      const Eigen::Vector3d at = tip_pose(robot, random.configuration(robot)).translation();
      occupy(builder, ((at / 0.05).array().floor() + 0.5) * 0.05);
    }
    const ConfigurationSpace space(loaded, builder.snapshot(), anywhere());
    for (int i = 0; i < 60; ++i) {
      const Configuration from = random.configuration(robot);
      const Configuration to = from + 0.1 * (random.configuration(robot) - from);
      const PathVerdict verdict = check_legs({{loaded, space.map(), {from, to}}}, space.policies(), 0.0);
      const bool is_free = space.is_edge_free(from, to);
      EXPECT_TRUE(!is_free || verdict.valid || verdict.undecided) << verdict.first_contact;
      for (int k = 0; verdict.valid && k <= 20; ++k)
        EXPECT_TRUE(space.is_free(Configuration(from + k / 20.0 * (to - from))));
      both += is_free && verdict.valid;
      neither += !is_free && !verdict.valid;
    }
  }
  EXPECT_GT(both, 20);
  EXPECT_GT(neither, 20);
}

/// The check believes Robot::loads alone: a body that planners shrank, moved or dropped is refused.
TEST(CheckLegs, RefusesALoadThatIsNotAsItIsStated) {
  const Robot robot = load_robot("arm6");
  const Robot loaded = with_load(robot, rod("hand", 0.25));
  const Snapshot map = VoxelScene{0.05, {box_of(5.0, 5.0, 5.0, 5.1, 5.1, 5.1)}, {}, {}}.snapshot();
  const Configuration q = (Configuration(6) << 0.0, -1.2, 1.2, 0.0, 0.5, 0.0).finished();
  const auto verdict = [&](const Robot& spoilt) { return check_path(spoilt, map, {}, 0.0, {q}); };
  ASSERT_TRUE(verdict(loaded).valid) << verdict(loaded).first_contact;

  Robot moved = loaded;
  moved.links.back().parent_from_link.translation().x() += 1e-6;
  EXPECT_FALSE(verdict(moved).valid);
  Robot in_body = loaded;
  in_body.bodies.back().link_from_shape.translation().x() += 1e-6;
  EXPECT_FALSE(verdict(in_body).valid);
  Robot dropped = loaded;
  dropped.bodies.pop_back();
  EXPECT_FALSE(verdict(dropped).valid);
  EXPECT_NE(verdict(dropped).first_contact.find("does not carry its load 'rod'"), std::string::npos);
  Robot elsewhere = loaded;
  elsewhere.bodies.back().link = 0;
  EXPECT_FALSE(verdict(elsewhere).valid);
  Robot renamed = loaded;
  renamed.links.back().name = "another";
  EXPECT_NE(verdict(renamed).first_contact.find("there is no link of it"), std::string::npos)
      << verdict(renamed).first_contact;
  Robot forgotten = loaded;  // a load that Robot::loads does not have is a link that the file does not have
  forgotten.loads.clear();
  EXPECT_FALSE(verdict(forgotten).valid);
}

/// Each load has its own link and body, in their order: of two as of one.
TEST(CheckLegs, ARobotMayCarryTwoLoadsEachOfWhichIsAsItIsStated) {
  const Robot robot = load_robot("arm6");
  Load second = rod("hand", 0.1);
  second.name = "hook";
  second.link_from_load.translation() = Eigen::Vector3d(0.3, 0.0, 0.1);
  const Robot loaded = with_load(with_load(robot, rod("hand", 0.25)), second);
  const Configuration q = (Configuration(6) << 0.0, -1.2, 1.2, 0.0, 0.5, 0.0).finished();
  const auto verdict = [&](const Robot& carrying) { return check_path(carrying, Snapshot(), {}, 0.0, {q}); };
  EXPECT_TRUE(verdict(loaded).valid) << verdict(loaded).first_contact;
  for (const std::size_t i : {0U, 1U}) {
    Robot elsewhere = loaded, renamed = loaded;
    elsewhere.bodies[elsewhere.bodies.size() - 2 + i].link = 0;
    renamed.bodies[renamed.bodies.size() - 2 + i].part = "another";
    for (const Robot& spoilt : {elsewhere, renamed})
      EXPECT_NE(verdict(spoilt).first_contact.find(i == 0 ? "'rod'" : "'hook'"), std::string::npos)
          << verdict(spoilt).first_contact;
  }
}

/// Where a planner's body is smaller than the load that is stated, and may touch what that may not, the
/// stated one counts.
TEST(CheckLegs, TakesShapeAndHoldersFromTheStatedLoad) {
  const Robot robot = load_robot("arm6");
  const Configuration q = (Configuration(6) << 0.0, -1.2, 1.2, 0.0, 0.5, 0.0).finished();
  const Robot loaded = with_load(robot, rod("hand", 0.25));
  const Eigen::Vector3d end = forward_kinematics(loaded, q).back() * Eigen::Vector3d(0.0, 0.0, 0.12);
  FreeSpaceMap builder({.resolution = 0.01});
  occupy(builder, ((end / 0.01).array().floor() + 0.5) * 0.01);
  const Snapshot map = builder.snapshot();
  Robot shrunk = loaded;
  shrunk.bodies.back().shape = Shape::box({0.01, 0.01, 0.01});
  EXPECT_TRUE(ConfigurationSpace(shrunk, map, anywhere()).is_free(q));
  const PathVerdict refused = check_path(shrunk, map, {}, 0.0, {q});
  EXPECT_NE(refused.first_contact.find("rod touches a voxel that is occupied"), std::string::npos)
      << refused.first_contact;

  Load backwards = rod("hand", 0.9);  // through the forearm
  backwards.link_from_load.translation().z() = -0.3;
  const Snapshot nothing = VoxelScene{0.05, {box_of(5.0, 5.0, 5.0, 5.1, 5.1, 5.1)}, {}, {}}.snapshot();
  Robot exempted = with_load(robot, backwards);
  EXPECT_NE(check_path(exempted, nothing, {}, 0.0, {q}).first_contact.find(" touches "), std::string::npos);
  const int rod_body = static_cast<int>(exempted.bodies.size()) - 1;
  for (int body = 0; body < rod_body; ++body) exempted.exempt.emplace_back(body, rod_body);
  EXPECT_TRUE(ConfigurationSpace(exempted, nothing, anywhere()).is_free(q));
  EXPECT_FALSE(check_path(exempted, nothing, {}, 0.0, {q}).valid);
}

/// Two legs, the load on one: an obstacle that only the load meets refuses that leg alone, and edges are
/// numbered over both.
TEST(CheckLegs, ChecksEachLegWithItsOwnRobot) {
  const Robot robot = load_robot("arm6"), loaded = with_load(robot, rod("hand", 0.25));
  const Configuration a = (Configuration(6) << 0.0, -1.2, 1.2, 0.0, 0.5, 0.0).finished();
  Configuration b = a, c = a;
  b[0] = 0.4, c[0] = 0.8;
  const Configuration middle = 0.5 * (b + c);
  const Eigen::Vector3d end = forward_kinematics(loaded, middle).back() * Eigen::Vector3d(0.0, 0.0, 0.12);
  FreeSpaceMap builder({.resolution = 0.01});
  occupy(builder, ((end / 0.01).array().floor() + 0.5) * 0.01);
  const Snapshot map = builder.snapshot();
  const auto verdict = [&](const Robot& first, const Robot& second) {
    return check_legs({{first, map, {a, b}}, {second, map, {b, c}}}, {}, 0.0);
  };
  EXPECT_TRUE(verdict(robot, robot).valid);
  EXPECT_TRUE(verdict(loaded, robot).valid) << verdict(loaded, robot).first_contact;
  EXPECT_EQ(verdict(loaded, robot).clearance.size(), 3U);
  const PathVerdict refused = verdict(robot, loaded);
  EXPECT_FALSE(refused.valid);
  EXPECT_EQ(refused.edge, 1);
  EXPECT_TRUE(refused.first_contact.starts_with("edge 1 at ")) << refused.first_contact;
  // A gap between the legs is an edge of the later one.
  const PathVerdict jumped = check_legs({{robot, map, {a, b}}, {loaded, map, {c}}}, {}, 0.0);
  EXPECT_FALSE(jumped.valid);
  EXPECT_FALSE(check_legs({}, {}, 0.0).valid);
}

/// The same through the whole door: the plan goes round with its load what it passes without.
TEST(CheckLegs, PlansGoRoundWithALoadWhatTheyPassWithout) {
  const Robot robot = load_robot("arm6"), loaded = with_load(robot, rod("hand", 0.25));
  const Configuration a = (Configuration(6) << 0.0, -1.2, 1.2, 0.0, 0.5, 0.0).finished();
  Configuration b = a;
  b[0] = 0.8;
  const Configuration middle = 0.5 * (a + b);
  const Eigen::Vector3d end = forward_kinematics(loaded, middle).back() * Eigen::Vector3d(0.0, 0.0, 0.12);
  FreeSpaceMap builder({.resolution = 0.01});
  occupy(builder, ((end / 0.01).array().floor() + 0.5) * 0.01);
  const ConfigurationSpace space(robot, builder.snapshot(), anywhere());
  PlanQuery query{.space = space, .start = a, .goals = {b, a}, .survey = std::nullopt};
  query.loads = {{rod("hand", 0.25), {1}}};
  const Plan plan = plan_and_check(query);
  ASSERT_TRUE(plan.is_proved()) << plan.explanation() << plan.validation.first_contact;
  EXPECT_EQ(plan.legs[0].waypoints.size(), 2U);
  EXPECT_GT(plan.legs[1].waypoints.size(), 2U);
  EXPECT_EQ(plan.policies.at("rod"), Policy::not_occupied);
  query.loads.front().legs = {2};
  EXPECT_THROW(plan_and_check(query), std::invalid_argument);
}

/// Of a waypoint that two legs share the lesser clearance is reported, whichever leg it belongs to.
TEST(CheckLegs, OfAWaypointOfTwoLegsTheLesserClearanceIsReported) {
  const Robot robot = load_robot("arm6"), loaded = with_load(robot, rod("hand", 0.25));
  const Configuration a = (Configuration(6) << 0.0, -1.2, 1.2, 0.0, 0.5, 0.0).finished();
  Configuration b = a, beyond = a;
  b[0] = 0.4, beyond[0] = 0.6;
  const Eigen::Vector3d end = forward_kinematics(loaded, beyond).back() * Eigen::Vector3d(0.0, 0.0, 0.12);
  const Eigen::Vector3d voxel = ((end / 0.01).array().floor() + 0.5) * 0.01;
  FreeSpaceMap builder({.resolution = 0.01});
  occupy(builder, voxel);
  const Snapshot map = builder.snapshot();
  const auto of_load = [&](const Configuration& q) {
    const Body& load = loaded.bodies.back();
    const Eigen::Isometry3d pose = forward_kinematics(loaded, q).back() * load.link_from_shape;
    return distance_to_cube(load.shape, pose, voxel, 0.01).lower;
  };
  ASSERT_GT(of_load(b), 0.01);
  ASSERT_LT(of_load(b), of_load(a) - 0.01);
  const double without = check_path(robot, map, {}, 0.0, {b}, 1.0).clearance.front();
  ASSERT_GT(without, of_load(b) + 0.01);
  for (const bool is_first : {true, false}) {
    const PathVerdict verdict = check_legs(
        {{is_first ? loaded : robot, map, {a, b}}, {is_first ? robot : loaded, map, {b, a}}}, {}, 0.0, 1.0);
    ASSERT_TRUE(verdict.valid) << verdict.first_contact;
    ASSERT_EQ(verdict.clearance.size(), 3U);
    EXPECT_NEAR(verdict.clearance[1], of_load(b), 1e-6) << is_first;
    EXPECT_NEAR(verdict.clearance[is_first ? 0 : 2], of_load(a), 1e-6) << is_first;
    EXPECT_GT(verdict.clearance[is_first ? 2 : 0], of_load(a) + 0.01) << is_first;
  }
}

/// The least clearance of a path is that of all its legs, whichever is the nearest.
TEST(CheckLegs, TheLeastClearanceIsThatOfAllLegs) {
  const Robot disc = load_robot("point");
  const auto at = [](double x, double y) { return Configuration(Eigen::Vector2d(x, y)); };
  const Snapshot map = VoxelScene{0.05, {box_of(0.41, 0.31, -0.04, 0.44, 0.34, 0.04)}, {}, {}}.snapshot();
  const LegsToCheck near{disc, map, {at(0, 0), at(1, 0)}}, back{disc, map, {at(1, 0), at(1, -1)}},
      first{disc, map, {at(0, -1), at(0, 0)}};
  const std::map<std::string, Policy> policies{{"base", Policy::not_occupied}};
  constexpr double truth = 0.3 - 0.2;  // from the voxel's side to the disc below it
  for (const auto& legs : std::vector<std::vector<LegsToCheck>>{{near}, {near, back}, {first, near}}) {
    const PathVerdict verdict = check_legs(legs, policies, 0.0, 0.5);
    ASSERT_TRUE(verdict.valid) << verdict.first_contact;
    EXPECT_LE(verdict.min_clearance, truth + 1e-9) << legs.size();
    EXPECT_GE(verdict.min_clearance, 0.7 * truth) << legs.size();
  }
}

/// A load may be turned in its link's frame: it is as far from a voxel as where it is stated to ride.
TEST(CheckLegs, PlacesALoadThatIsTurnedWhereItIsStatedToRide) {
  Random random(11);
  const Robot robot = load_robot("arm6");
  const Configuration q = (Configuration(6) << 0.3, -1.2, 1.2, 0.4, 0.5, -0.6).finished();
  const Eigen::Isometry3d hand = forward_kinematics(robot, q)[static_cast<std::size_t>(robot.tip_link)];
  const Eigen::Vector3d voxel =
      ((hand * Eigen::Vector3d(0.0, 0.05, 0.4) / 0.01).array().floor() + 0.5) * 0.01;
  FreeSpaceMap builder({.resolution = 0.01});
  occupy(builder, voxel);
  const double without = check_path(robot, builder.snapshot(), {}, 0.0, {q}, 2.0).clearance.front();
  int nearest = 0;
  const int loads = trials(12, 50);
  for (int i = 0; i < loads; ++i) {
    Load load = rod("hand", 0.2);
    load.link_from_load = Eigen::Translation3d(0.0, 0.0, 0.2) * random.pose(0.05);
    for (const Link& link : robot.links) load.touches.push_back(link.name);
    const PathVerdict verdict = check_path(with_load(robot, load), builder.snapshot(), {}, 0.0, {q}, 2.0);
    ASSERT_TRUE(verdict.valid) << verdict.first_contact;
    const double truth = distance_to_cube(load.shape, hand * load.link_from_load, voxel, 0.01).lower;
    ASSERT_NEAR(verdict.clearance.front(), std::min(truth, without), 1e-6);
    nearest += truth < without;
  }
  EXPECT_GT(nearest, 8 * loads / 10);
}

/// A gap between legs is one edge more, wherever it is.
TEST(CheckLegs, NumbersEdgesAndClearancesOverGapsBetweenLegs) {
  const Robot disc = load_robot("point");
  const auto at = [](double x) { return Configuration(Eigen::Vector2d(x, 0.0)); };
  const auto verdict = [&](double voxel, const std::vector<std::vector<Configuration>>& paths) {
    const Snapshot map =
        VoxelScene{0.05, {box_of(voxel + 0.01, 0.01, -0.04, voxel + 0.04, 0.04, 0.04)}, {}, {}}.snapshot();
    std::vector<LegsToCheck> legs;
    for (const std::vector<Configuration>& path : paths) legs.push_back({disc, map, path});
    return check_legs(legs, {{"base", Policy::not_occupied}}, 0.0);
  };
  const std::vector<std::vector<Configuration>> joined{{at(0), at(1)}, {at(1), at(2)}, {at(2), at(3)}},
      gaps{{at(0)}, {at(1), at(2)}, {at(3)}}, more{{at(0), at(1)}, {at(2)}, {at(3), at(4)}};
  for (const auto& paths : {joined, gaps, more}) {
    for (const int edge : {0, 1, 2}) {
      const PathVerdict met = verdict(edge + 0.5, paths);
      EXPECT_FALSE(met.valid);
      EXPECT_EQ(met.edge, edge) << met.first_contact;
      EXPECT_TRUE(met.first_contact.starts_with("edge " + std::to_string(edge) + " at 0."))
          << met.first_contact;
    }
    const PathVerdict free = verdict(9.0, paths);
    EXPECT_TRUE(free.valid) << free.first_contact;
    EXPECT_EQ(free.clearance.size(), paths[2].back() == at(4) ? 5U : 4U);
  }
}

/// A disc that slides along a voxel's face at a distance that no step resolves: neither free nor blocked, on
/// whichever leg it is.
TEST(CheckLegs, SaysWhichLegsAreUndecided) {
  const Robot disc = load_robot("point");
  const Snapshot map = VoxelScene{0.05, {box_of(1.01, 1.01, -0.04, 1.04, 1.04, 0.04)}, {}, {}}.snapshot();
  const auto at = [](double x, double y) { return Configuration(Eigen::Vector2d(x, y)); };
  const double grazing = 1.0 - 0.2 - 1e-9;
  const std::vector<Configuration> clear{at(0.0, 1.0), at(0.5, 1.0)},
      along{at(0.5, 1.0), at(grazing, 1.0), at(grazing, 1.04)}, into{at(0.5, 1.0), at(0.9, 1.0)};
  const auto verdict = [&](const std::vector<Configuration>& first,
                           const std::vector<Configuration>& second) {
    return check_legs({{disc, map, first}, {disc, map, second}}, {{"base", Policy::not_occupied}}, 0.0);
  };
  EXPECT_TRUE(verdict(clear, clear).valid);
  EXPECT_FALSE(verdict(clear, clear).undecided);
  for (const PathVerdict& grazed : {verdict(clear, along), verdict(along, clear)}) {
    EXPECT_FALSE(grazed.valid);
    EXPECT_TRUE(grazed.undecided) << grazed.first_contact;
  }
  EXPECT_FALSE(verdict(clear, into).valid);
  EXPECT_FALSE(verdict(clear, into).undecided);
}

}  // namespace check_legs_test
}  // namespace clearway

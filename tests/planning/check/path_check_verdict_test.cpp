// What verdicts say, of a disc whose contacts are known by arithmetic.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "planning/check/path_check.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/planning/check/comma_locale.hpp"
#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace path_check_verdict_test {

constexpr double edge = 0.05;

/// Of a disc among voxels that were seen free, at times or at none, and asked for what was seen lately.
TEST(PathCheckVerdict, WhatWasSeenTooLongAgoIsRefusedAndSaidSo) {
  const Robot disc = load_robot("point");
  const Eigen::Vector3d middle(0.025, 0.025, 0.025), far(9.0, 9.0, 9.0);
  const auto map_of_looks = [&](double first, double second) {
    FreeSpaceMap builder({.resolution = edge, .integration = Integration::compatible});
    Scan all_round;
    all_round.map_from_sensor.translation() = middle;
    all_round.time = first;
    Random random(11);
    for (int k = 0; k < 20'000; ++k)
      all_round.points.push_back((0.6 * random.point(1.0).normalized()).cast<float>());
    Scan elsewhere;
    elsewhere.map_from_sensor.translation() = far;
    elsewhere.time = second;
    elsewhere.points = {{0.5F, 0.0F, 0.0F}};
    builder.insert(all_round);
    builder.insert(elsewhere);
    return builder.snapshot();
  };
  const Configuration at = middle.head<2>(), on = at + Configuration(Eigen::Vector2d(0.05, 0.0));
  const auto verdict = [&](const Snapshot& map, Policy policy, double seen_within) {
    return check_path(disc, map, {{"base", policy}}, 0.0, {at, on}, 0.0, seen_within);
  };
  const Snapshot known = map_of_looks(2.5, 15.0), unknown = map_of_looks(std::nan(""), 15.0);
  EXPECT_TRUE(verdict(known, Policy::known_free, 0.0).valid);
  EXPECT_TRUE(verdict(unknown, Policy::known_free, 0.0).valid);
  EXPECT_TRUE(verdict(known, Policy::known_free, 13.0).valid);
  EXPECT_FALSE(verdict(known, Policy::known_free, 12.0).valid);
  EXPECT_FALSE(verdict(unknown, Policy::known_free, 1e6).valid);
  expect_same_in_every_locale([&] { return verdict(known, Policy::known_free, 4.5).first_contact; },
                              "its policy is known_free, seen within 4.5 s: it was last seen 12.5 s before");
  expect_same_in_every_locale([&] { return verdict(unknown, Policy::known_free, 4.5).first_contact; },
                              "seen within 4.5 s: it was last seen nobody knows when");
  // What is unknown is not said to be old, and nothing is when nobody asks.
  const Configuration aside = Eigen::Vector2d(3.025, 0.025);
  for (const double seen_within : {0.0, 4.5}) {
    const PathVerdict refused =
        check_path(disc, known, {{"base", Policy::known_free}}, 0.0, {aside}, 0.0, seen_within);
    EXPECT_FALSE(refused.valid);
    EXPECT_EQ(refused.first_contact.find("seen"), std::string::npos) << refused.first_contact;
  }
}

TEST(PathCheckVerdict, ItsSentencesAreTheSameInEveryLocale) {
  const Robot disc = load_robot("point");
  FreeSpaceMap builder({.resolution = edge});
  occupy(builder, {1.025, 0.025, 0.025});
  const Snapshot map = builder.snapshot();
  const auto sentence = [&](const Configuration& from, const Configuration& to) {
    return check_path(disc, map, {{"base", Policy::not_occupied}}, 0.0, {from, to}).first_contact;
  };
  const Configuration at = Eigen::Vector2d(0.0, 0.0), through = Eigen::Vector2d(2.0, 0.0),
                      beyond = Eigen::Vector2d(0.0, 123456.5);
  expect_same_in_every_locale([&] { return sentence(at, through); },
                              "is occupied, at (1.025, 0.025, 0.025); its policy is not_occupied");
  expect_same_in_every_locale([&] { return sentence(at, beyond); }, "is 123456, outside its limits ");
}

TEST(PathCheckVerdict, LengthsThatAreNoneAreRefusedAndAValueOfAMillionIsThere) {
  Robot disc = load_robot("point");
  disc.source.clear();
  const Configuration origin = Configuration::Zero(2);
  const auto refusal = [&](double padding, double cap) -> std::string {
    try {
      check_path(disc, Snapshot(), {}, padding, {origin}, cap);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  for (const double bad : {-1e-12, HUGE_VAL, std::nan("")}) {
    EXPECT_TRUE(refusal(bad, 0.0).starts_with("padding must be")) << refusal(bad, 0.0);
    EXPECT_TRUE(refusal(0.0, bad).starts_with("distance_cap must be")) << refusal(0.0, bad);
  }
  for (Joint& joint : disc.joints) joint.lower = -HUGE_VAL, joint.upper = HUGE_VAL;
  for (const double sign : {1.0, -1.0}) {
    const Configuration far = Eigen::Vector2d(0.0, sign * largest_joint_value),
                        beyond = Eigen::Vector2d(0.0, sign * std::nextafter(largest_joint_value, 1e9));
    EXPECT_TRUE(check_path(disc, Snapshot(), {}, 0.0, {far}).valid);
    EXPECT_NE(check_path(disc, Snapshot(), {}, 0.0, {beyond}).first_contact.find("have lost their digits"),
              std::string::npos);
  }
}

/// Where nothing is near, clearances are what is looked at: a fifth of a metre of the robot at full size.
TEST(PathCheckVerdict, ClearancesEndAtTheCapWhichGrowsWithTheRobot) {
  const Robot disc = load_robot("point");
  const std::vector<Configuration> path{Eigen::Vector2d(0.0, 0.0), Eigen::Vector2d(0.5, 0.0)};
  for (const double scale : {0.5, 1.0, 3.0}) {
    const Robot robot = scaled(disc, scale);
    for (const double cap : {0.0, 0.125}) {
      const double expected = cap == 0.0 ? 0.2 * scale : cap;
      const PathVerdict verdict = check_path(robot, Snapshot(), {}, 0.0, path, cap);
      EXPECT_EQ(verdict.clearance, std::vector<double>(2, expected)) << scale;
      EXPECT_LE(verdict.min_clearance, expected);
    }
  }
}

/// Whatever it is asked for: the padding is a part of no clearance, and the least one is that of the path.
TEST(PathCheckVerdict, PaddingAndCapChangeNoClearance) {
  const Robot disc = load_robot("point");  // of radius 0.2
  FreeSpaceMap builder({.resolution = edge});
  occupy(builder, {0.275, 0.375, 0.025});
  const Snapshot map = builder.snapshot();
  const std::vector<Configuration> path{Eigen::Vector2d(-0.5, 0.0), Eigen::Vector2d(0.275, 0.0),
                                        Eigen::Vector2d(1.0, 0.0)};
  for (const double padding : {0.0, 0.1, 0.1499}) {
    const PathVerdict verdict = check_path(disc, map, {}, padding, path, 0.4);
    ASSERT_TRUE(verdict.valid) << padding << verdict.first_contact;
    ASSERT_EQ(verdict.clearance.size(), 3U);
    EXPECT_EQ(verdict.clearance.front(), 0.4);
    EXPECT_NEAR(verdict.clearance[1], 0.15, 1e-6);
    EXPECT_EQ(verdict.clearance.back(), 0.4);
    EXPECT_LE(verdict.min_clearance, 0.15 + 1e-9);
    EXPECT_GE(verdict.min_clearance, padding);
  }
  const PathVerdict refused = check_path(disc, map, {}, 0.1501, path, 0.4);
  EXPECT_FALSE(refused.valid);
  EXPECT_NE(refused.first_contact.find("base comes too near to a voxel"), std::string::npos);
}

/// Also where it asks for more than clearances are measured, on whichever side.
TEST(PathCheckVerdict, PaddingLargerThanTheCapIsKept) {
  const Robot disc = load_robot("point");  // of radius 0.2
  for (const double padding : {0.25, 0.5, 1.0}) {
    for (const Eigen::Vector2d& way :
         {Eigen::Vector2d(1, 0), Eigen::Vector2d(-1, 0), Eigen::Vector2d(0, 1), Eigen::Vector2d(0, -1)}) {
      FreeSpaceMap builder({.resolution = edge});
      occupy(builder, {0.025, 0.025, 0.025});
      const Snapshot map = builder.snapshot();
      const auto is_valid = [&](double away) {  // from the voxel's side to the disc
        const Eigen::Vector2d at = Eigen::Vector2d::Constant(0.025) + (0.025 + away + 0.2) * way;
        return check_path(disc, map, {{"base", Policy::not_occupied}}, padding, {at}, 0.1).valid;
      };
      EXPECT_TRUE(is_valid(padding + 0.001)) << padding << ' ' << way.transpose();
      EXPECT_FALSE(is_valid(padding - 0.001)) << padding << ' ' << way.transpose();
    }
  }
}

/// In painted space, of which a path that is cut in two reads another part for each half.
TEST(PathCheckVerdict, TheLastClearanceIsThatOfTheWholePathHoweverItIsCut) {
  const Robot disc = load_robot("point");
  constexpr double leg = 11.0;
  FreeSpaceMap builder({.resolution = edge});
  const int volume = builder.add_volume("lane", {"base"});
  for (double way = 0.0; way <= leg; way += 0.1) {
    builder.paint(volume, {{way, 0.0, 0.0}, 0.4});
    builder.paint(volume, {{leg, way, 0.0}, 0.4});
  }
  const Snapshot map = builder.snapshot();
  const Configuration begin = Eigen::Vector2d(0.0, 0.0), corner = Eigen::Vector2d(leg, 0.0),
                      end = Eigen::Vector2d(leg, leg);
  const auto check = [&](const std::vector<Configuration>& path, double cap) {
    return check_path(disc, map, {{"base", Policy::painted}}, 0.0, path, cap);
  };
  const PathVerdict whole = check({begin, corner, end}, 4.2), alone = check({end}, 0.3);
  ASSERT_TRUE(whole.valid) << whole.first_contact;
  ASSERT_EQ(whole.clearance.size(), 3U);
  EXPECT_GT(alone.clearance[0], 0.05);
  EXPECT_NEAR(whole.clearance[2], alone.clearance[0], 1e-6);
  EXPECT_NEAR(whole.clearance[0], check({begin}, 0.3).clearance[0], 1e-6);
}

/// A disc that slides towards a wall at a small angle stands still where less is proved than a step. What
/// touches within a tenth of a millimetre of the way from there is a contact; a path that ends 1 nm before
/// the wall is undecided, and one that goes on into it is not, however far from the stall it touches.
TEST(PathCheckVerdict, AStallIsUndecidedWhereNothingTouchesBeyondIt) {
  const Robot disc = load_robot("point");  // of radius 0.2
  FreeSpaceMap builder({.resolution = 0.25});
  for (int k = -3; k < 3; ++k) occupy(builder, Eigen::Vector3d(1.125, 0.25 * k + 0.125, 0.125));
  const Snapshot map = builder.snapshot();
  const auto verdict_of = [&](double begin, double slope, double length) {
    const Configuration from = Eigen::Vector2d(begin, 0.0),
                        to = from + length * Eigen::Vector2d(slope, std::sqrt(1.0 - slope * slope));
    return check_path(disc, map, {{"base", Policy::not_occupied}}, 0.0, {from, to});
  };
  for (int i = 0; i < 400; ++i) {
    const double slope = 0.03 + 0.0002 * i, before = 1e-5, begin = 0.8 - before;  // the disc meets x = 1
    const PathVerdict into = verdict_of(begin, slope, 0.2),
                      grazing = verdict_of(begin, slope, 0.99999 * before / slope);
    const double way = before / slope - into.parameter * 0.2;
    EXPECT_FALSE(into.valid || into.undecided) << slope << into.first_contact;
    EXPECT_LT(way, 1.01e-4) << slope;        // a contact near the stall is told at the stall,
    EXPECT_GT(way, -0.2 / 1999.0) << slope;  // one beyond it at the first of 2,000 places
    EXPECT_EQ(into.edge, 0);
    EXPECT_FALSE(grazing.valid) << slope;
    EXPECT_TRUE(grazing.undecided) << slope << grazing.first_contact;
  }
}

/// Past an undecided place the path goes on, over another edge or in another piece, into a wall.
TEST(PathCheckVerdict, AContactFarBeyondAnUndecidedPlaceRefuses) {
  const Robot disc = load_robot("point");  // of radius 0.2
  FreeSpaceMap builder({.resolution = 0.25});
  for (int k = -3; k < 3; ++k) occupy(builder, Eigen::Vector3d(1.125, 0.25 * k + 0.125, 0.125));
  const Snapshot map = builder.snapshot();
  const auto at = [](double x, double y) { return Configuration(Eigen::Vector2d(x, y)); };
  const double grazing = 0.8 - 1e-9;
  const auto verdict_of = [&](const std::vector<Configuration>& path) {
    return check_path(disc, map, {{"base", Policy::not_occupied}}, 0.0, path);
  };
  const std::vector<Configuration> along{at(0.0, -0.2), at(grazing, -0.2), at(grazing, 0.2), at(0.0, 0.2)};
  EXPECT_TRUE(verdict_of(along).undecided);
  std::vector<Configuration> into = along;
  into.push_back(at(0.85, 0.2));
  const PathVerdict verdict = verdict_of(into);
  EXPECT_FALSE(verdict.valid || verdict.undecided) << verdict.first_contact;
  EXPECT_EQ(verdict.edge, 3);
  EXPECT_NEAR(verdict.parameter, 0.8 / 0.85, 2e-3);
  EXPECT_EQ(verdict.first_contact.rfind("edge 3 at ", 0), 0U) << verdict.first_contact;
  EXPECT_EQ(verdict.first_contact.find("too near to prove"), std::string::npos) << verdict.first_contact;
}

}  // namespace path_check_verdict_test
}  // namespace clearway

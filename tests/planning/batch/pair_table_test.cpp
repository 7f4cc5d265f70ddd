#include "planning/batch/pair_table.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <set>

#include "tests/worlds/batch_worlds.hpp"

namespace clearway {
namespace pair_table_test {

/// The pairs of the robot's bodies by the two links that they are on.
std::map<std::pair<int, int>, std::vector<BodyPair>> by_links(const Robot& robot) {
  std::map<std::pair<int, int>, std::vector<BodyPair>> pairs;
  for (const BodyPair& pair : self_collision_pairs(robot)) {
    const auto link = [&](int body) { return robot.bodies[static_cast<std::size_t>(body)].link; };
    pairs[{link(pair.first), link(pair.second)}].push_back(pair);
  }
  return pairs;
}

/// What the table proves of the cell that holds the values.
bool says_apart(const PairTable& table, const std::array<double, 2>& values) {
  return table.proof(values) == PairTable::Proof::apart;
}

/// Those whose motion changes how far bodies of some pair are apart.
std::set<int> joints_that_matter(const Robot& robot, const std::vector<BodyPair>& pairs) {
  std::set<int> joints;
  for (const BodyPair& pair : pairs) {
    for (Eigen::Index j = 0; j < pair.approach.size(); ++j)
      if (pair.approach[j] > 0.0) joints.insert(static_cast<int>(j));
  }
  EXPECT_LE(joints.size(), 2U) << robot.name;
  return joints;
}

TEST(PairTable, WhereItSaysApartTheBodiesAreWhateverTheOtherJointsDo) {
  int said = 0, missed = 0, tables = 0;
  for (const Robot& robot : worlds::robots_of_all_kinds()) {
    Random random(1);
    for (const auto& [links, pairs] : by_links(robot)) {
      const auto table = PairTable::of(robot, pairs);
      if (!table) continue;
      ++tables;
      const std::set<int> movers = joints_that_matter(robot, pairs);
      EXPECT_EQ(std::set<int>(table->joints().begin(), table->joints().end()),
                movers.size() == 2 ? movers : (std::set<int>{*movers.begin(), -1}));
      for (int i = 0; i < 300; ++i) {
        const Configuration q = random.configuration(robot);
        const LinkPoses poses = forward_kinematics(robot, q);
        const auto [first, second] = table->joints();
        const bool is_proved = says_apart(*table, {q[first], second < 0 ? 0.0 : q[second]});
        const bool are_apart = std::all_of(pairs.begin(), pairs.end(), [&](const BodyPair& pair) {
          return is_apart(robot, pair, poses, 0.0);
        });
        EXPECT_TRUE(are_apart || !is_proved)
            << robot.name << " links " << links.first << ", " << links.second;
        said += is_proved;
        missed += are_apart && !is_proved;
      }
    }
  }
  EXPECT_GT(tables, 10);
  EXPECT_GT(said, 20 * missed);
}

TEST(PairTable, CellsHoldWhatWasProvedOfTheValuesInThem) {
  const Robot robot = load_robot("puma560");
  Random random(2);
  int tables = 0;
  for (const auto& [links, pairs] : by_links(robot)) {
    const auto table = PairTable::of(robot, pairs);
    if (!table) continue;
    ++tables;
    const PairTable::Cells cells = table->cells();
    for (int i = 0; i < 100; ++i) {
      const Configuration q = random.configuration(robot);
      std::array<double, 2> values{};
      std::array<int, 2> cell{};
      for (std::size_t k = 0; k < 2 && table->joints()[k] >= 0; ++k) {
        values[k] = q[table->joints()[k]];
        cell[k] = static_cast<int>((values[k] - cells.lower[k]) * cells.per_unit[k]);
      }
      const PairTable::Proof proof = table->proof(values);
      EXPECT_NE(proof, PairTable::Proof::unknown);
      EXPECT_EQ(cells.proofs[cell[0] * cells.counts[1] + cell[1]].load(), proof);
    }
  }
  EXPECT_GT(tables, 1);
}

TEST(PairTable, WhereItSaysOverlapSomePairOverlapsAndItDoesSoOfMostThatDo) {
  int said = 0, met = 0;
  for (const Robot& robot : worlds::robots_of_all_kinds()) {
    Random random(3);
    for (const auto& [links, pairs] : by_links(robot)) {
      const auto table = PairTable::of(robot, pairs);
      if (!table) continue;
      for (int i = 0; i < 1000; ++i) {
        const Configuration q = random.configuration(robot);
        const auto [first, second] = table->joints();
        const bool is_proved =
            table->proof({q[first], second < 0 ? 0.0 : q[second]}) == PairTable::Proof::overlap;
        const LinkPoses poses = forward_kinematics(robot, q);
        const bool overlap = std::any_of(pairs.begin(), pairs.end(), [&](const BodyPair& pair) {
          return pair_distance(robot, pair, poses).upper <= 0.0;
        });
        EXPECT_TRUE(overlap || !is_proved) << robot.name << " links " << links.first << ", " << links.second;
        said += is_proved;
        met += overlap;
      }
    }
  }
  EXPECT_GT(met, 200);
  EXPECT_GT(said, met / 2);
}

TEST(PairTable, WhereItSaysApartBetweenValuesItSaysSoOfAllOfThem) {
  const Robot robot = load_robot("panda");
  Random random(4);
  int said = 0;
  for (const auto& [links, pairs] : by_links(robot)) {
    const auto table = PairTable::of(robot, pairs);
    if (!table) continue;
    for (int i = 0; i < 300; ++i) {
      std::array<double, 2> lower{}, upper{};
      for (std::size_t k = 0; k < 2 && table->joints()[k] >= 0; ++k) {
        const Joint& joint = robot.joints[static_cast<std::size_t>(table->joints()[k])];
        lower[k] = random.between(joint.lower, joint.upper);
        upper[k] = lower[k] + random.between(0.0, 0.1);
      }
      if (!table->is_apart(lower, upper)) continue;
      ++said;
      for (int sample = 0; sample < 20; ++sample)
        EXPECT_TRUE(
            says_apart(*table, {random.between(lower[0], upper[0]), random.between(lower[1], upper[1])}));
    }
    EXPECT_FALSE(table->is_apart({std::nan(""), 0.0}, {1.0, 1.0}));
    EXPECT_FALSE(table->is_apart({0.0, 0.0}, {std::nan(""), 1.0}));
    EXPECT_FALSE(table->is_apart({-100.0, -100.0}, {100.0, 100.0}));
  }
  EXPECT_GT(said, 300);
}

TEST(PairTable, WhatItSaysDoesNotDependOnWhoAskedBefore) {
  const Robot robot = load_robot("panda");
  const auto pairs = by_links(robot);
  for (const auto& [links, of_links] : pairs) {
    const auto used = PairTable::of(robot, of_links);
    if (!used) continue;
    Random random(2);
    std::vector<std::array<double, 2>> values;
    for (int i = 0; i < 200; ++i) {
      const Configuration q = random.configuration(robot);
      values.push_back({q[used->joints()[0]], used->joints()[1] < 0 ? 0.0 : q[used->joints()[1]]});
    }
    std::vector<PairTable::Proof> first;
    for (const auto& value : values) first.push_back(used->proof(value));
    const auto fresh = PairTable::of(robot, of_links);
    for (std::size_t i = values.size(); i-- > 0;) EXPECT_EQ(fresh->proof(values[i]), first[i]);
  }
}

TEST(PairTable, NothingIsProvedOfValuesOutsideTheLimits) {
  const Robot robot = load_robot("panda");
  int tables = 0;
  for (const auto& [links, pairs] : by_links(robot)) {
    const auto table = PairTable::of(robot, pairs);
    if (!table) continue;
    ++tables;
    for (const double value : {10.0, -10.0, 1e300, -1e300, std::numeric_limits<double>::infinity(),
                               std::numeric_limits<double>::quiet_NaN()})
      EXPECT_EQ(table->proof({value, 0.0}), PairTable::Proof::none);
  }
  EXPECT_GT(tables, 3);
}

TEST(PairTable, ThereIsNoneForMoreJointsOrJointsWithoutLimits) {
  Robot robot = load_robot("planar2");
  const auto pairs = by_links(load_robot("panda"));
  const Robot panda = load_robot("panda");
  EXPECT_EQ(PairTable::of(panda, pairs.at({0, 7})), nullptr);
  EXPECT_EQ(PairTable::of(panda, {}), nullptr);
  Robot endless = panda;
  constexpr double none = std::numeric_limits<double>::infinity(), most = std::numeric_limits<double>::max();
  for (const auto& [lower, upper] : {std::pair(-2.0, none), std::pair(-none, 2.0), std::pair(-none, none),
                                     std::pair(-most, most)}) {  // farther apart than a number says
    for (Joint& joint : endless.joints) joint.lower = lower, joint.upper = upper;
    for (const auto& [links, of_links] : pairs)
      EXPECT_EQ(PairTable::of(endless, of_links), nullptr) << lower << " to " << upper;
  }
}

TEST(PairTable, OfOneJointSaysApartUpToAFewThousandthsBeforeBodiesMeet) {
  int near = 0;
  for (const Robot& robot : worlds::robots_of_all_kinds()) {
    Random random(5);
    for (const auto& [links, pairs] : by_links(robot)) {
      const auto table = PairTable::of(robot, pairs);
      if (!table || table->joints()[1] >= 0) continue;
      const int joint = table->joints()[0];
      for (int i = 0; i < 2000; ++i) {
        const Configuration q = random.configuration(robot);
        const LinkPoses poses = forward_kinematics(robot, q);
        const auto are_apart_for = [&](double turn) {  // rad or metres of the joint
          return std::all_of(pairs.begin(), pairs.end(), [&](const BodyPair& pair) {
            return is_apart(robot, pair, poses, 2e-4 + turn * pair.approach[joint]);
          });
        };
        if (!are_apart_for(0.005)) continue;
        EXPECT_TRUE(says_apart(*table, {q[joint], 0.0})) << robot.name << " " << q[joint];
        near += !are_apart_for(0.0125);
      }
    }
  }
  EXPECT_GT(near, 0);
}

}  // namespace pair_table_test
}  // namespace clearway

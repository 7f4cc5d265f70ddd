// What bodies may meet, against lists made body by body from the robot's links.

#include "planning/batch/sphere_robot_pairs.hpp"

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <map>
#include <set>

#include "tests/worlds/batch_worlds.hpp"

namespace clearway {
namespace sphere_robot_pairs_test {

/// The links from this one up to the root that a joint moves, as frames: the last one first, then 0.
std::vector<int> frames_above(const Robot& robot, int link) {
  std::vector<int> number(robot.links.size(), 0), frames;  // of each moved link, in their order, from 1
  int count = 0;
  for (std::size_t i = 0; i < robot.links.size(); ++i)
    if (robot.links[i].joint >= 0) number[i] = ++count;
  for (int i = link; i >= 0; i = robot.links[static_cast<std::size_t>(i)].parent)
    if (number[static_cast<std::size_t>(i)] > 0) frames.push_back(number[static_cast<std::size_t>(i)]);
  frames.push_back(0);
  return frames;
}

/// A space, and the frame and field of each body.
struct Ground {
  explicit Ground(const Robot& robot, bool two_fields)
      : space(robot, worlds::voxels_about(robot, 1), policies(robot, two_fields)),
        model(space.collision_model()),
        spheres(*model.spheres) {
    for (std::size_t body = 0; body < model.robot.bodies.size(); ++body) {
      above.push_back(frames_above(model.robot, model.robot.bodies[body].link));
      member.push_back(-1);
      field.push_back(-1);
      for (std::size_t i = 0; i < model.bodies.size(); ++i) {
        if (model.indices[i] != static_cast<int>(body)) continue;
        member[body] = static_cast<int>(i);
        for (std::size_t k = 0; k < spheres.fields.size(); ++k) {
          if (spheres.fields[k].bytes == &model.bodies[i].space().byte_field())
            field[body] = static_cast<int>(k);
        }
      }
    }
  }

  static Policies policies(const Robot& robot, bool two_fields) {
    Policies result{.critical_by_default = false};
    for (std::size_t i = 0; two_fields && i < robot.bodies.size(); i += 2)
      result.parts[robot.bodies[i].part] = Policy::known_free;
    return result;
  }

  int frame(int body) const { return above[static_cast<std::size_t>(body)].front(); }
  std::pair<int, int> branch(int body) const { return {frame(body), field[static_cast<std::size_t>(body)]}; }

  ConfigurationSpace space;
  const CollisionModel& model;
  const SphereRobot& spheres;
  std::vector<std::vector<int>> above;  ///< frames of each body
  std::vector<int> member, field;       ///< of each body
};

void for_each_ground(const std::function<void(const Ground&)>& look) {
  std::size_t most_fields = 0, pairs = 0;
  for (const Robot& robot : worlds::robots_of_all_kinds()) {
    for (const bool two_fields : {false, true}) {
      SCOPED_TRACE(robot.name);
      const Ground ground(robot, two_fields);
      look(ground);
      most_fields = std::max(most_fields, ground.spheres.fields.size());
      pairs += ground.model.pairs.size();
    }
  }
  EXPECT_EQ(most_fields, 2U);
  EXPECT_GT(pairs, 20U);
}

TEST(SphereRobotPairs, EachPairIsListedOnceUnderItsFramesAndWhereTheirWaysMeet) {
  for_each_ground([](const Ground& ground) {
    std::vector<int> seen(ground.model.pairs.size(), 0);
    std::pair<int, int> before{-1, -1};
    int end = 0;
    for (const SphereRobot::FramePair& frames : ground.spheres.frame_pairs) {
      EXPECT_LT(before, (std::pair{frames.a, frames.b}));
      EXPECT_EQ(frames.first, end);
      EXPECT_LT(frames.first, frames.last);
      for (int i = frames.first; i < frames.last; ++i) {
        const SphereRobot::Pair& pair = ground.spheres.body_pairs[static_cast<std::size_t>(i)];
        EXPECT_EQ(ground.frame(pair.a), frames.a);
        EXPECT_EQ(ground.frame(pair.b), frames.b);
        const std::size_t index = static_cast<std::size_t>(pair.member) - ground.model.bodies.size();
        ASSERT_LT(index, seen.size());
        ++seen[index];
        EXPECT_EQ(std::minmax({pair.a, pair.b}),
                  std::pair(ground.model.pairs[index].first, ground.model.pairs[index].second));
        const std::vector<int>& above = ground.above[static_cast<std::size_t>(pair.b)];
        const auto meet = std::find_first_of(ground.above[static_cast<std::size_t>(pair.a)].begin(),
                                             ground.above[static_cast<std::size_t>(pair.a)].end(),
                                             above.begin(), above.end());
        EXPECT_EQ(frames.meet, *meet);
      }
      before = {frames.a, frames.b};
      end = frames.last;
    }
    EXPECT_EQ(seen, std::vector<int>(seen.size(), 1));
    EXPECT_EQ(end, static_cast<int>(ground.spheres.body_pairs.size()));
  });
}

TEST(SphereRobotPairs, AnyTwoBodiesAreThePairThatTheyAreOrNone) {
  for_each_ground([](const Ground& ground) {
    const int count = static_cast<int>(ground.model.robot.bodies.size());
    for (int a = 0; a < count; ++a) {
      for (int b = 0; b < count; ++b) {
        int expected = -1;
        for (std::size_t i = 0; i < ground.model.pairs.size(); ++i) {
          if (std::minmax({a, b}) == std::pair(ground.model.pairs[i].first, ground.model.pairs[i].second))
            expected = static_cast<int>(ground.model.bodies.size() + i);
        }
        EXPECT_EQ(ground.spheres.member_of_pair(a, b), expected) << a << " " << b;
      }
    }
  });
}

using LeafText = std::array<float, 7>;
LeafText text_of(const SphereTree::FloatSphere& sphere, float inner, int body, int member) {
  return {sphere.x,
          sphere.y,
          sphere.z,
          sphere.radius,
          inner,
          static_cast<float>(body),
          static_cast<float>(member)};
}

void collect(const SphereTree& tree, int index, std::multiset<LeafText>& found) {
  const SphereTree::Node& node = tree.nodes[static_cast<std::size_t>(index)];
  for (int i = node.first; i < node.last; ++i) {
    if (!node.holds_leaves) {
      collect(tree, i, found);
      continue;
    }
    const SphereTree::Leaf& leaf = tree.leaves[static_cast<std::size_t>(i)];
    found.insert(text_of(leaf.sphere, leaf.inner, leaf.body, leaf.member));
  }
}

TEST(SphereRobotPairs, ATreeOfEachFrameAndFieldHoldsAllSpheresOfTheirBodiesOnce) {
  for_each_ground([](const Ground& ground) {
    const SphereRobot& spheres = ground.spheres;
    std::map<std::pair<int, int>, std::multiset<LeafText>> expected;
    for (std::size_t body = 0; body < spheres.bodies.size(); ++body) {
      const int first = spheres.clusters[static_cast<std::size_t>(spheres.bodies[body].first)].first;
      const int last = spheres.clusters[static_cast<std::size_t>(spheres.bodies[body].last - 1)].last;
      for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(last); ++i)
        expected[ground.branch(static_cast<int>(body))].insert(
            text_of(spheres.spheres[i], spheres.inner[i], static_cast<int>(body), ground.member[body]));
    }
    int before = static_cast<int>(spheres.frames.size());
    EXPECT_EQ(spheres.branches.size(), expected.size());
    for (const SphereRobot::Branch& branch : spheres.branches) {
      EXPECT_LE(branch.frame, before);
      before = branch.frame;
      std::multiset<LeafText> found;
      collect(spheres.tree, branch.root, found);
      EXPECT_EQ(found, (expected[{branch.frame, branch.field}])) << branch.frame << " " << branch.field;
    }
    EXPECT_EQ(spheres.branches.size(), expected.size());
    EXPECT_EQ(spheres.tree.leaves.size(), spheres.spheres.size());
  });
}

/// Whether two tables say the same of many values, or neither is there.
void expect_same_table(const PairTable* a, const PairTable* b, const Robot& robot) {
  ASSERT_EQ(a == nullptr, b == nullptr);
  if (a == nullptr) return;
  EXPECT_EQ(a->joints(), b->joints());
  Random random(5);
  for (int i = 0; i < 20; ++i) {
    const Configuration q = random.configuration(robot);
    std::array<double, 2> values{};
    for (std::size_t k = 0; k < 2; ++k) {
      if (a->joints()[k] >= 0) values[k] = q[a->joints()[k]];
    }
    EXPECT_EQ(a->proof(values), b->proof(values));
  }
}

TEST(SphereRobotPairs, BranchesWithBodiesOfAPairAreListedOnceWithTheTableOfTheseBodies) {
  for_each_ground([](const Ground& ground) {
    const SphereRobot& spheres = ground.spheres;
    const auto number_of = [&](int body) {
      const auto is_of = [&](const SphereRobot::Branch& branch) {
        return std::pair(branch.frame, branch.field) == ground.branch(body);
      };
      return static_cast<int>(std::find_if(spheres.branches.begin(), spheres.branches.end(), is_of) -
                              spheres.branches.begin());
    };
    std::map<std::pair<int, int>, std::vector<BodyPair>> expected;
    for (const BodyPair& pair : ground.model.pairs) {
      const auto [second, first] = std::minmax({number_of(pair.first), number_of(pair.second)});
      expected[{first, second}].push_back(pair);
    }
    EXPECT_EQ(spheres.branch_pairs.size(), expected.size());
    for (const SphereRobot::BranchPair& pair : spheres.branch_pairs) {
      ASSERT_TRUE(expected.contains({pair.a, pair.b})) << pair.a << " " << pair.b;
      expect_same_table(pair.table.get(), PairTable::of(ground.model.robot, expected[{pair.a, pair.b}]).get(),
                        ground.model.robot);
    }
  });
}

TEST(SphereRobotPairs, FramesHaveATableWhereTheyAreOneBranchEach) {
  int with = 0, without = 0;
  for_each_ground([&](const Ground& ground) {
    const SphereRobot& spheres = ground.spheres;
    for (const SphereRobot::FramePair& frames : spheres.frame_pairs) {
      std::vector<const PairTable*> tables;  // of branches of these frames
      for (const SphereRobot::BranchPair& pair : spheres.branch_pairs) {
        const int a = spheres.branches[static_cast<std::size_t>(pair.a)].frame;
        const int b = spheres.branches[static_cast<std::size_t>(pair.b)].frame;
        if (std::minmax({a, b}) == std::minmax({frames.a, frames.b})) tables.push_back(pair.table.get());
      }
      const auto branches_of = [&](int frame) {
        return std::count_if(spheres.branches.begin(), spheres.branches.end(),
                             [&](const SphereRobot::Branch& branch) { return branch.frame == frame; });
      };
      const bool is_one = branches_of(frames.a) == 1 && branches_of(frames.b) == 1;
      ASSERT_FALSE(tables.empty());
      EXPECT_EQ(frames.table.get(), is_one ? tables.front() : nullptr);
      ++(frames.table != nullptr ? with : without);
    }
  });
  EXPECT_GT(with, 5);
  EXPECT_GT(without, 5);
}

}  // namespace sphere_robot_pairs_test
}  // namespace clearway

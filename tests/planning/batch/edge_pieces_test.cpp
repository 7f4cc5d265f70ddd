// Edges in pieces: against dense samples by shapes at double precision, and against the exact proof.

#include "planning/batch/edge_pieces.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <numeric>
#include <set>

#include "tests/worlds/batch_worlds.hpp"

namespace clearway {
namespace edge_pieces_test {

using worlds::urdf_joint;
using worlds::urdf_limit;
using worlds::urdf_link;

/// The same answer without the batch.
bool is_proved_exactly(const CollisionModel& model, const Configuration& from, const Configuration& to) {
  std::vector<int> all(model.members());
  std::iota(all.begin(), all.end(), 0);
  std::vector<RecentCubes> recent(model.bodies.size());
  return model.is_edge_free(from, to, all, recent);
}

bool is_free_at(const ConfigurationSpace& space, const Configuration& from, const Configuration& to,
                double begin, double end, int samples) {
  for (int i = 0; i <= samples; ++i) {
    if (!space.is_free(from + (begin + (end - begin) * i / samples) * (to - from))) return false;
  }
  return true;
}

struct Counts {
  int free = 0, blocked = 0, open = 0, parts = 0;
};

Counts judge(const ConfigurationSpace& space, std::uint64_t seed, int edges) {
  const CollisionModel& model = space.collision_model();
  EdgePieces pieces(*model.spheres);
  Random random(seed);
  Counts counts;
  for (int i = 0; i < edges; ++i) {
    const Configuration from = random.configuration(model.robot);
    const Configuration to = from + std::pow(random.unit(), 2.0) * (random.configuration(model.robot) - from);
    const EdgePieces::Finding finding = pieces.examine(from, to);
    const std::string where = model.robot.name + " edge " + std::to_string(i);
    const bool is_proved = is_proved_exactly(model, from, to);
    EXPECT_FALSE(is_proved && !space.is_edge_free(from, to)) << where << ": refused although it was proved";
    if (finding == EdgePieces::Finding::free) {
      ++counts.free;
      EXPECT_TRUE(is_free_at(space, from, to, 0.0, 1.0, 100)) << where;
    }
    if (finding == EdgePieces::Finding::blocked) {
      ++counts.blocked;
      EXPECT_FALSE(is_proved) << where;
      EXPECT_FALSE(space.is_edge_free(from, to)) << where;
    }
    counts.open += finding == EdgePieces::Finding::open;
    const double share = space.free_share(from, to);
    EXPECT_EQ(share == 1.0, space.is_edge_free(from, to));
    if (share == 0.0 || share == 1.0) continue;
    ++counts.parts;
    EXPECT_TRUE(is_free_at(space, from, to, 0.0, share, 100)) << where << " to " << share;
  }
  return counts;
}

TEST(EdgePieces, WhatTheyProveIsFreeAndWhatTheyRefuseCannotBeProved) {
  Counts all;
  for (Robot robot : worlds::robots_of_all_kinds()) {
    Random random(11);
    robot.map_from_base.translation() = random.point(1.0);
    const Snapshot map = worlds::voxels_about(robot, 4);
    for (const Policies& policies : {Policies{.critical_by_default = false}, Policies{}}) {
      const ConfigurationSpace space(robot, map, policies, {.padding = 0.005});
      const Counts counts = judge(space, 12, 150);
      all.free += counts.free, all.blocked += counts.blocked, all.parts += counts.parts;
    }
  }
  EXPECT_GT(all.free, 100);
  EXPECT_GT(all.blocked, 100);
  EXPECT_GT(all.parts, 100);
}

/// Bounds on motion that are too small by little are seen here: the last touch is all that blocks the edge.
TEST(EdgePieces, AnEdgeThatEndsJustInsideOfWhatBlocksIsNotFreeFromEitherEnd) {
  int edges = 0;
  for (const Robot& robot : worlds::robots_of_all_kinds()) {
    const ConfigurationSpace space(robot, worlds::voxels_about(robot, 4), {.critical_by_default = false});
    const CollisionModel& model = space.collision_model();
    EdgePieces pieces(*model.spheres);
    Random random(31);
    for (int i = 0; i < 150; ++i) {
      const Configuration from = random.configuration(model.robot);
      const std::optional<Configuration> end =
          worlds::just_inside(model, from, random.configuration(model.robot));
      if (!end) continue;
      ++edges;
      for (const double part : {0.0, 0.7, 0.97}) {
        const Configuration start = from + part * (*end - from);
        const std::string where = robot.name + " edge " + std::to_string(i) + " from " + std::to_string(part);
        EXPECT_NE(pieces.examine(start, *end), EdgePieces::Finding::free) << where;
        EXPECT_NE(pieces.examine(*end, start), EdgePieces::Finding::free) << where;
        EXPECT_FALSE(pieces.is_free(start, *end)) << where;
        EXPECT_FALSE(pieces.is_free(*end, start)) << where;
      }
    }
  }
  EXPECT_GT(edges, 300);
}

/// Two links of this length, a post on the way of the ball at their end: it moves straight toward the base,
/// ever faster, while the links fold.
worlds::UrdfRobot folding_arm(double length, double post) {
  const std::string ball = "<sphere radius='0.05'/>", along = std::to_string(length) + " 0 0";
  return {"folding",
          urdf_link("base", std::to_string(post) + " 0 0", ball) + "<link name='upper'/>" +
              urdf_link("tip", along, ball) +
              urdf_joint("fold", "revolute", "base", "upper", "0 0 0", "0 0 1", urdf_limit(-3, 3)) +
              urdf_joint("back", "revolute", "upper", "tip", along, "0 0 1", urdf_limit(-3, 3))};
}

/// How the answers to the edge along which the ball gets from 2 length to this distance from the base are:
/// from either end, of examine() and is_free().
std::set<bool> free_folding_to(const ConfigurationSpace& space, double length, double distance) {
  const double angle = std::acos(distance / (2.0 * length));
  const Configuration straight = Eigen::Vector2d::Zero(), folded = Eigen::Vector2d(angle, -2.0 * angle);
  EdgePieces pieces(*space.collision_model().spheres);
  return {pieces.examine(straight, folded) == EdgePieces::Finding::free,
          pieces.examine(folded, straight) == EdgePieces::Finding::free, pieces.is_free(straight, folded),
          pieces.is_free(folded, straight)};
}

/// The speed in the middle of a piece is less than at its end.
TEST(EdgePieces, WhatMovesEverFasterIsNotTakenForWhatMovesAsInTheMiddleOfAPiece) {
  constexpr double most_rounded = 1e-6;  // metres, of the file's numbers
  for (const double post : {1.8, 1.4, 1.0, 0.6}) {
    const worlds::UrdfRobot arm = folding_arm(1.0, post);
    const ConfigurationSpace space(arm.robot(), Snapshot(), {.critical_by_default = false});
    EXPECT_EQ(free_folding_to(space, 1.0, post + 0.1 - 2 * most_rounded), std::set{false}) << post;
    EXPECT_TRUE(free_folding_to(space, 1.0, post + 0.11).contains(true)) << post;
  }
  const worlds::UrdfRobot arm = folding_arm(40.0, -1.0);
  for (const double post : {72.01, 56.01, 40.01, 24.01}) {
    FreeSpaceMap map({.resolution = 0.02});
    occupy(map, {post, 0.01, 0.01});
    const ConfigurationSpace space(arm.robot(), map.snapshot(), {.critical_by_default = false});
    ASSERT_NE(space.collision_model().spheres, nullptr);
    EXPECT_EQ(free_folding_to(space, 40.0, post + 0.01 + 0.05 - 1e-5), std::set{false}) << post;
    EXPECT_TRUE(free_folding_to(space, 40.0, post + 0.16).contains(true)) << post;
  }
}

/// Two arms on a table that slides and turns; three joints move their ends against each other.
worlds::UrdfRobot arms_on_a_table() {
  const std::string ball = "<sphere radius='0.05'/>";
  return {"arms",
          "<link name='base'/><link name='slide'/><link name='table'/><link name='upper'/>" +
              urdf_link("left", "0.3 0 0", ball) + urdf_link("right", "-0.4 0 0", ball) +
              urdf_joint("along", "prismatic", "base", "slide", "0 0 0", "0.6 0 0.8", urdf_limit(-2, 2)) +
              urdf_joint("about", "revolute", "slide", "table", "0 0 0", "0 0.6 0.8", urdf_limit(-3, 3)) +
              urdf_joint("shoulder", "revolute", "table", "upper", "-0.4 0 0", "0 0 1", urdf_limit(-1, 1)) +
              urdf_joint("elbow", "revolute", "upper", "left", "0.3 0 0", "0 0 1", urdf_limit(-2, 2)) +
              urdf_joint("other", "revolute", "table", "right", "0.5 0 0", "0 0 1", urdf_limit(-1, 1))};
}

/// What carries both bodies of a pair moves neither against the other.
TEST(EdgePieces, WhatCarriesAPairChangesNothingBetweenTheTwo) {
  const worlds::UrdfRobot arms = arms_on_a_table();
  const ConfigurationSpace space(arms.robot(), Snapshot(), {.critical_by_default = false});
  EdgePieces pieces(*space.collision_model().spheres);
  Random random(37);
  std::map<EdgePieces::Finding, int> found;
  int others = 0;
  for (int i = 0; i < 400; ++i) {
    const Configuration from = random.configuration(arms.robot());
    const Configuration to = from + 0.4 * random.unit() * (random.configuration(arms.robot()) - from);
    Configuration standing = to;
    standing.head<2>() = from.head<2>();
    const EdgePieces::Finding moving = pieces.examine(from, to);
    const double share = pieces.proved_share();
    ++found[moving];
    others += moving != pieces.examine(from, standing) || share != pieces.proved_share();
  }
  EXPECT_LE(others, 4);  // where rounding decides
  EXPECT_GT(found[EdgePieces::Finding::free], 50);
  EXPECT_GT(found[EdgePieces::Finding::blocked], 50);
}

/// Asked between looks at other edges, whose poses and findings must not be taken for its own.
TEST(EdgePieces, TheQuickAnswerIsSoundAndSeldomAnother) {
  int free = 0, others = 0, asked = 0;
  for (const Robot& robot : worlds::robots_of_all_kinds()) {
    const ConfigurationSpace space(robot, worlds::voxels_about(robot, 4), {.critical_by_default = false});
    const CollisionModel& model = space.collision_model();
    EdgePieces pieces(*model.spheres), fresh(*model.spheres);
    Random random(29);
    for (int i = 0; i < 200; ++i, ++asked) {
      const Configuration from = random.configuration(model.robot);
      const Configuration to = from + 0.5 * random.unit() * (random.configuration(model.robot) - from);
      pieces.examine(random.configuration(model.robot), random.configuration(model.robot));
      const bool is_free = pieces.is_free(from, to);
      EXPECT_EQ(is_free, fresh.is_free(from, to)) << robot.name << " edge " << i;
      others += is_free != (pieces.examine(from, to) == EdgePieces::Finding::free);
      if (!is_free) continue;
      ++free;
      EXPECT_TRUE(is_free_at(space, from, to, 0.0, 1.0, 100)) << robot.name << " edge " << i;
    }
  }
  RecordProperty("free", free);
  RecordProperty("others", others);
  EXPECT_GT(free, asked / 10);
  EXPECT_LE(others, asked / 100);
}

TEST(EdgePieces, WhoNeedsLessOfAnEdgeHearsTheSameOfTheRest) {
  int kept = 0, left_out = 0;
  for (const Robot& robot : worlds::robots_of_all_kinds()) {
    const ConfigurationSpace space(robot, worlds::voxels_about(robot, 4), {.critical_by_default = false});
    const CollisionModel& model = space.collision_model();
    EdgePieces pieces(*model.spheres);
    Random random(17);
    for (int i = 0; i < 200; ++i) {
      const Configuration from = random.configuration(model.robot);
      const Configuration to = from + random.unit() * (random.configuration(model.robot) - from);
      const EdgePieces::Finding finding = pieces.examine(from, to);
      const double share = pieces.proved_share();
      for (const double least : {0.1, 0.25, 0.6, 1.0}) {
        EXPECT_EQ(pieces.examine(from, to, least), finding) << robot.name << " edge " << i;
        const double of_use = pieces.proved_share();
        EXPECT_TRUE(of_use == share || (share < least && of_use == 0.0)) << robot.name << " edge " << i;
        kept += finding == EdgePieces::Finding::blocked && of_use > 0.0;
        left_out += of_use < share;
      }
    }
  }
  EXPECT_GT(kept, 50);
  EXPECT_GT(left_out, 50);
}

TEST(EdgePieces, OpenPiecesHoldAllThatIsNotDecided) {
  const Robot robot = load_robot("puma560");
  const ConfigurationSpace space(robot, worlds::voxels_about(robot, 5), {.critical_by_default = false});
  const CollisionModel& model = space.collision_model();
  EdgePieces pieces(*model.spheres);
  Random random(13);
  int open = 0;
  for (int i = 0; i < 300; ++i) {
    const Configuration from = random.configuration(robot);
    const Configuration to = from + 0.2 * (random.configuration(robot) - from);
    if (pieces.examine(from, to) != EdgePieces::Finding::open) continue;
    ++open;
    for (int k = 0; k <= 200; ++k) {  // what is not free at a sample is open there
      const double part = k / 200.0;
      const LinkPoses poses = forward_kinematics(model.robot, from + part * (to - from));
      for (std::size_t body = 0; body < model.bodies.size(); ++body) {
        if (model.bodies[body].is_clear(model.pose(poses, body), 0.0)) continue;
        const auto& all = pieces.open_pieces();
        EXPECT_TRUE(std::any_of(all.begin(), all.end(),
                                [&](const EdgePieces::Piece& piece) {
                                  if (part < piece.begin || part > piece.end) return false;
                                  const auto first = pieces.open_members().begin() + piece.first;
                                  const auto last = pieces.open_members().begin() + piece.last;
                                  return std::find(first, last, static_cast<int>(body)) != last;
                                }))
            << "edge " << i << " at " << part;
      }
    }
  }
  EXPECT_GT(open, 20);
}

TEST(EdgePieces, AnEdgeKeepsNothingOfTheEdgesBeforeIt) {
  const Robot robot = load_robot("puma560");
  const ConfigurationSpace space(robot, worlds::voxels_about(robot, 5), {.critical_by_default = false});
  EdgePieces used(*space.collision_model().spheres);
  Random random(13);
  int open = 0;
  for (int i = 0; i < 100; ++i) {
    const Configuration from = random.configuration(robot);
    const Configuration to = from + 0.2 * (random.configuration(robot) - from);
    EdgePieces fresh(*space.collision_model().spheres);
    EXPECT_EQ(used.examine(from, to), fresh.examine(from, to));
    EXPECT_EQ(used.open_members(), fresh.open_members()) << i;
    open += !fresh.open_members().empty();
  }
  EXPECT_GT(open, 10);
}

TEST(EdgePieces, AnglesWithoutEndAreLeftToExactShapes) {
  Robot robot = load_robot("planar2");
  for (Joint& joint : robot.joints) {
    joint.lower = -std::numeric_limits<double>::infinity();
    joint.upper = std::numeric_limits<double>::infinity();
  }
  const ConfigurationSpace space(robot, worlds::voxels_about(robot, 6), {.critical_by_default = false});
  ASSERT_NE(space.collision_model().spheres, nullptr);
  Random random(14);
  int blocked = 0;
  for (const double size : {1e2, 1e5, 1e9, 1e13, 1e16, 1e20, 1e41}) {
    std::vector<Configuration> qs;
    for (int i = 0; i < 100; ++i)
      qs.emplace_back(Eigen::Vector2d(random.between(-size, size), random.between(-3.0, 3.0)));
    const std::vector<bool> together = space.is_free(qs);
    for (std::size_t i = 0; i < qs.size(); ++i) {
      const bool is_free = space.is_free(qs[i]);
      EXPECT_EQ(together[i], is_free) << qs[i].transpose();
      EXPECT_FALSE(space.is_edge_free(qs[i], qs[i]) && !is_free) << qs[i].transpose();
      blocked += !is_free;
    }
  }
  EXPECT_GT(blocked, 50);
}

TEST(EdgePieces, ARobotTooFarAwayForSinglePrecisionIsLeftToTheExactProof) {
  Robot robot = load_robot("planar2");
  const Snapshot map = worlds::voxels_about(robot, 6);
  robot.map_from_base.translation().x() = 1e6;
  const ConfigurationSpace space(robot, map, {.critical_by_default = false});
  EXPECT_EQ(space.collision_model().spheres, nullptr);
  EXPECT_TRUE(space.is_edge_free(Eigen::Vector2d(0.0, 0.5), Eigen::Vector2d(0.5, 0.5)));
  EXPECT_EQ(space.free_share(Eigen::Vector2d(0.0, 0.5), Eigen::Vector2d(0.5, 0.5)), 1.0);
}

}  // namespace edge_pieces_test
}  // namespace clearway

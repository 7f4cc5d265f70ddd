#pragma once

// Not part of the installed library.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "mapping/field/blocked_space.hpp"
#include "planning/batch/pair_table.hpp"
#include "planning/batch/sphere_tree.hpp"
#include "planning/robot/robot.hpp"
#include "planning/robot/self_collision.hpp"

namespace clearway {

struct ByteField;

/// A body that some joint moves, and what blocks it.
struct BlockedBody {
  const Body* body = nullptr;
  const BlockedSpace* space = nullptr;
};

/// A robot as spheres in frames, at single precision, for PieceBatch: links that joints move, with all that
/// is fixed to them, and each body by the spheres that cover it. Lengths are in metres, in map axes about the
/// robot's base, so that it does not matter how far that is from the map's origin. Plain data.
struct SphereRobot {
  /// A link that a joint moves (frame 0: what none moves). Its frame is turned so that the joint's axis is z:
  /// its pose is that of the parent, times this rotation and translation, times the joint's motion.
  struct Frame {
    int parent = -1;
    int joint = -1;
    bool turns = false;
    double multiplier = 1.0, offset = 0.0;            ///< value of the motion = multiplier * q + offset
    float rotation[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< row by row
    float translation[3] = {};
  };
  using FloatSphere = SphereTree::FloatSphere;
  /// A field of blocked voxels and where its first cell's corner is, seen from the robot's base.
  struct Field {
    const ByteField* bytes = nullptr;
    float low[3] = {};
  };
  /// Some spheres of one body, first to last - 1, and a sphere around them.
  struct Cluster {
    int first = 0, last = 0;
    FloatSphere bound;
  };
  /// Clusters first to last - 1 of one frame that are looked up in one field, and a sphere around them.
  struct Group {
    int frame = 0, field = 0, first = 0, last = 0;
    FloatSphere bound;
    int first_core = 0, last_core = 0;  ///< of `cores`: inside of these bodies
  };
  /// The tree of all spheres of one frame that are looked up in one field, -1: in none.
  struct Branch {
    int frame = 0, field = 0, root = 0;
  };
  /// Branches that hold bodies which must not touch.
  struct BranchPair {
    int a = 0, b = 0;
    std::shared_ptr<const PairTable> table;  ///< of all these bodies; may be null
  };
  /// Pairs of bodies, first to last - 1 of `body_pairs`, of two frames. `meet` is the last frame that moves
  /// both: what happens between them is seen from there.
  struct FramePair {
    int a = 0, b = 0, meet = 0, first = 0, last = 0;
    std::shared_ptr<const PairTable> table;  ///< of all these bodies; may be null
  };
  struct Pair {
    int a = 0, b = 0, member = 0;  ///< bodies of the robot, and what CollisionModel calls the pair
  };
  struct Range {
    int first = 0, last = 0;
  };

  std::uint64_t id = 0;                ///< no other's of this process
  std::shared_ptr<const Robot> robot;  ///< what the tables are of
  std::vector<Frame> frames;
  std::vector<FloatSphere> spheres;  ///< by frame, then field, then body; all in their frames
  std::vector<int> member;    ///< of each: which of the bodies that were given; -1: one that no joint moves
  std::vector<float> inner;   ///< of each: radius about its middle that lies in the body, <= 0: unknown
  std::vector<int> frame_of;  ///< of each
  std::vector<Field> fields;
  std::vector<Group> groups;        ///< those of the last frames first: they meet things more often
  std::vector<FloatSphere> cores;   ///< spheres that lie inside of bodies, a few of each; in their frames
  std::vector<FloatSphere> bounds;  ///< around all spheres of each frame; radius < 0: none
  std::vector<Cluster> clusters;
  std::vector<Range> bodies;  ///< clusters of each body of the robot
  std::vector<FloatSphere> body_bounds;
  std::vector<FramePair> frame_pairs;
  std::vector<Pair> body_pairs;
  SphereTree tree;               ///< the spheres once more
  std::vector<Branch> branches;  ///< those of the last frames first
  std::vector<BranchPair> branch_pairs;
  std::vector<int> pair_member;  ///< [a * bodies + b] of two bodies of the robot; -1: they may touch
  float base[9] = {};            ///< rotation of the robot's base in the map, row by row
  float padding = 0;             ///< metres
  float slack = 0;               ///< no rounding at single precision puts a sphere farther off, metres
  std::vector<float> lever;  ///< [frame * frames + mover]: no sphere's middle gets farther from the mover's
                             ///< axis, metres; of one that slides 1
  double steepest = 0, farthest_offset = 0;  ///< largest |multiplier| and |offset| of the frames
  std::size_t joints = 0;
  std::size_t members = 0;  ///< bodies and pairs

  /// Whether the values of all motions are so small that single precision resolves angles.
  bool suits(const Eigen::VectorXd& q) const {
    return q.size() == 0 || steepest * q.cwiseAbs().maxCoeff() + farthest_offset < 1e6;
  }

  int member_of_pair(int a, int b) const {
    return pair_member[static_cast<std::size_t>(a) * bodies.size() + static_cast<std::size_t>(b)];
  }

  float lever_of(std::size_t frame, std::size_t mover) const { return lever[frame * frames.size() + mover]; }
};

/// What this thread keeps for the robot: an object made of it. It keeps those of the last few robots that it
/// asked for; what it gave for another one may go.
template <class Kept>
Kept& of_this_thread(const SphereRobot& robot) {
  struct Place {
    std::uint64_t id = 0;
    std::unique_ptr<Kept> kept;
  };
  thread_local std::array<Place, 6> places;
  const auto known =
      std::find_if(places.begin(), places.end(), [&](const Place& place) { return place.id == robot.id; });
  if (known == places.begin()) return *known->kept;
  const bool is_new = known == places.end();
  const auto last = is_new ? places.end() - 1 : known;
  if (is_new) *last = {robot.id, std::make_unique<Kept>(robot)};
  std::rotate(places.begin(), last, last + 1);
  return *places.front().kept;
}

/// Spheres in the link's frame that cover the body: its own, or fewer for a box that is small beside a voxel
/// of that edge (metres), of which these would say more than a look at voxels can.
std::vector<Sphere> lane_cover(const Body& body, double resolution);

/// Null when the robot or the map is too large or too far away for single precision to be of use. What the
/// robot alone decides is made once for the last few robots of the process.
/// @param bodies those that some joint moves. @param pairs of bodies of the robot, members after the bodies
std::unique_ptr<const SphereRobot> sphere_robot(const Robot& robot, std::span<const BlockedBody> bodies,
                                                std::span<const BodyPair> pairs, double padding);

}  // namespace clearway

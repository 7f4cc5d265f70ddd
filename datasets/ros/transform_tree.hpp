#pragma once

#include <Eigen/Geometry>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "datasets/ros/ros_messages.hpp"

namespace clearway {

/// A frame of a bag's transforms.
struct BagFrame {
  std::string name, parent;
  bool is_fixed = false;  ///< by /tf_static
};

/// A parent that transforms give a frame.
struct FrameParent {
  std::string name;
  std::size_t transforms = 0;  ///< that say so
  bool leads_to_root = false;  ///< by it, and not by the frame itself, the frame leads to the root asked for
};

/// Poses of one frame that cannot all be true, as of two publishers.
struct PoseConflicts {
  std::size_t poses = 0;        ///< of the frame
  std::size_t same_time = 0;    ///< a pose of the same time differed by more than 1 mm or 1 mrad
  std::size_t alternating = 0;  ///< over 5 cm off the way between their neighbours, which are much closer
  double farthest = 0.0;        ///< m, of these

  std::size_t count() const { return same_time + alternating; }
  /// More than single errors: at least 5, a fifth of all, and 5 cm.
  bool are_many() const { return count() >= 5 && count() * 5 >= poses && farthest > 0.05; }
};

/// Two poses of a frame, one after the other, between which nothing drives.
struct PoseJump {
  std::string frame, parent;
  double before = 0.0, after = 0.0;   ///< s, their times
  double distance = 0.0, turn = 0.0;  ///< m, rad
};

/// Where the frames of a recording are in one another, by its transforms, as tf2 has it: each frame has one
/// parent, fixed to it or with poses at times. Of a frame that is given several, the first one counts, or the
/// first that leads to where it is wanted; parents_of tells.
class TransformTree {
 public:
  /// Poses of one frame; the last of one time counts. A transform that is no rotation (its quaternion is off
  /// unit length by more than 1 %), not finite, or of a frame in itself is left out.
  /// @param is_fixed it holds from when it was recorded on, until another one is (/tf_static); the first one
  /// before, too
  /// @param recorded s since 1970
  void add(const RosTransform& transform, bool is_fixed, double recorded);

  /// From now on parents that lead to this frame come first.
  void prefer_ways_to(const std::string& root);

  /// Maps from `frame` to `root` at that time: between two poses the translation in a straight line and the
  /// shortest turn. Nothing: no chain joins the two, or a pose of it is not known within max_gap on both
  /// sides (at one of exactly that time a side is enough), or it jumps there (jump_between).
  /// @param recorded s since 1970, of what is placed: which of several fixed poses holds
  std::optional<Eigen::Isometry3d> root_from_frame(const std::string& root, const std::string& frame,
                                                   double time, double recorded) const;

  /// Where a frame between the two jumps at that time, as a map's odometry does when the robot finds out
  /// where it is: by more than 10 cm (0.1 rad) away from where its speeds before and after lead, which would
  /// take more than 10 m/s^2 (40 rad/s^2). Nothing: none does.
  std::optional<PoseJump> jump_between(const std::string& root, const std::string& frame, double time) const;

  /// The frame, its parent, and so on.
  std::vector<std::string> chain_of(const std::string& frame) const;
  /// The frames of a loop above this one, as of two publishers of which each is the other's parent; the first
  /// one again at the end. Empty: there is none.
  std::vector<std::string> loop_above(const std::string& frame) const;
  /// All parents of a frame; first the one that counts.
  std::vector<FrameParent> parents_of(const std::string& frame, const std::string& root) const;
  /// Whether the two have a frame in common: one of them, or one above both.
  bool are_joined(const std::string& root, const std::string& frame) const;
  /// The frames whose poses join the two: up to their common one, or all above both where there is none.
  std::set<std::string> way_between(const std::string& root, const std::string& frame) const;
  /// s, the first and the last time at which all frames that move on this way have poses, the last before the
  /// first where there is no such time; nothing: none moves, or the two are not joined.
  std::optional<std::pair<double, double>> times_between(const std::string& root,
                                                         const std::string& frame) const;
  /// Of a frame that moves; elsewhere 0.
  PoseConflicts conflicts_of(const std::string& frame) const;
  /// m, the diagonal of the box of its places in its parent; 0 where it is fixed.
  double way_of(const std::string& frame) const;
  /// rad, the largest turn away from its first pose; 0 where it is fixed.
  double turn_of(const std::string& frame) const;
  /// m, the longest way from one of its places to the next; 0 where it is fixed.
  double longest_step_of(const std::string& frame) const;
  /// How often the pose of a fixed frame was replaced by another one.
  std::size_t changes_of(const std::string& frame) const;

  std::vector<std::string> frames() const;  ///< sorted
  std::vector<BagFrame> edges() const;      ///< in the order of the children's names
  std::size_t left_out() const { return left_out_; }

  static constexpr double max_gap = 1.0;  ///< s between two poses that are interpolated

 private:
  struct Pose {
    Eigen::Vector3d translation;
    Eigen::Quaterniond rotation;
  };
  struct Edge {
    std::string parent;
    bool is_fixed = false;
    std::map<double, Pose> poses;  ///< by time; where it is fixed by when it was recorded
    std::size_t contradicted = 0;  ///< by another pose of their time
    double farthest = 0.0;         ///< m, of these
    std::size_t transforms = 0;    ///< that were added
  };
  /// The one that counts; null: the frame has no parent.
  const Edge* edge_of(const std::string& frame) const;
  /// Whether the parent of a frame, or one above it, is this root, without the frame itself.
  bool leads_to(const Edge& edge, const std::string& frame, const std::string& root) const;
  using Poses = std::map<double, Pose>;
  /// @param after the second pose of the two, not the first of all
  static bool is_jump(const Poses& poses, Poses::const_iterator after);
  static std::optional<Eigen::Isometry3d> pose_at(const Edge& edge, double time, double recorded);

  std::map<std::string, std::vector<Edge>> edges_;  ///< of the child, one for each parent
  std::size_t left_out_ = 0;
};

}  // namespace clearway

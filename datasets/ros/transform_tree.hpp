#pragma once

#include <Eigen/Geometry>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "datasets/ros/ros_messages.hpp"

namespace clearway {

/// A frame of a bag's transforms.
struct BagFrame {
  std::string name, parent;
  bool is_fixed = false;  ///< by /tf_static
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

/// Where the frames of a recording are in one another, by its transforms, as tf2 has it: each frame has one
/// parent, fixed to it or with poses at times.
class TransformTree {
 public:
  /// Poses of one frame; the last of one time counts. A transform that is no rotation (its quaternion is off
  /// unit length by more than 1 %) or not finite is left out, and so is one that gives a frame another
  /// parent.
  /// @param is_fixed it holds from when it was recorded on, until another one is (/tf_static); the first one
  /// before, too
  /// @param recorded s since 1970
  void add(const RosTransform& transform, bool is_fixed, double recorded);

  /// Maps from `frame` to `root` at that time: between two poses the translation in a straight line and the
  /// shortest turn. Nothing: no chain joins the two, or a pose of it is not known within max_gap on both
  /// sides (at one of exactly that time a side is enough).
  /// @param recorded s since 1970, of what is placed: which of several fixed poses holds
  std::optional<Eigen::Isometry3d> root_from_frame(const std::string& root, const std::string& frame,
                                                   double time, double recorded) const;

  /// The frame, its parent, and so on.
  std::vector<std::string> chain_of(const std::string& frame) const;
  /// The frames of a loop above this one, as of two publishers of which each is the other's parent; the first
  /// one again at the end. Empty: there is none.
  std::vector<std::string> loop_above(const std::string& frame) const;
  /// Of a frame that moves; elsewhere 0.
  PoseConflicts conflicts_of(const std::string& frame) const;
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
  };
  static std::optional<Eigen::Isometry3d> pose_at(const Edge& edge, double time, double recorded);

  std::map<std::string, Edge> edges_;  ///< of the child
  std::size_t left_out_ = 0;
};

}  // namespace clearway

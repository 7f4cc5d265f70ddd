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

/// Where the frames of a recording are in one another, by its transforms, as tf2 has it: each frame has one
/// parent, fixed to it or with poses at times.
class TransformTree {
 public:
  /// Poses of one frame; the last of one time counts. A transform that is no rotation (its quaternion is off
  /// unit length by more than 1 %) or not finite is left out, and so is one that gives a frame another
  /// parent.
  /// @param is_fixed it holds at all times (/tf_static)
  void add(const RosTransform& transform, bool is_fixed);

  /// Maps from `frame` to `root` at that time: between two poses the translation in a straight line and the
  /// shortest turn. Nothing: no chain joins the two, or a pose of it is not known within max_gap on both
  /// sides (at one of exactly that time a side is enough).
  std::optional<Eigen::Isometry3d> root_from_frame(const std::string& root, const std::string& frame,
                                                   double time) const;

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
    std::map<double, Pose> poses;
  };
  static std::optional<Eigen::Isometry3d> pose_at(const Edge& edge, double time);
  std::vector<std::string> chain_of(const std::string& frame) const;

  std::map<std::string, Edge> edges_;  ///< of the child
  std::size_t left_out_ = 0;
};

}  // namespace clearway

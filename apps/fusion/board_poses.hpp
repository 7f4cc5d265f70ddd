#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "datasets/descriptions/setup.hpp"
#include "datasets/poses/pose_stream.hpp"
#include "datasets/sources/recording.hpp"
#include "tracking/tracking_session.hpp"

namespace clearway {

/// Where the boards that carry sensors, the probe or the gripper were, image by image: map_from_board over
/// time. A pose counts when it passes the setup's acceptance of reprojection error and ambiguity.
class BoardPoses {
 public:
  /// @throws std::invalid_argument when a sensor is on a board and no board is fixed in the map.
  explicit BoardPoses(const Setup& setup);

  /// Whether any board is followed: whether images have to be searched for tags.
  bool are_needed() const { return !boards_.empty(); }

  /// @param tags in the image
  /// @param painted what the painter made of them; null without a painter
  void take(const Frame& frame, const ImageFrame& image, const std::vector<TagDetection>& tags,
            const TrackedImage* painted);
  /// No more images will come.
  void finish() { finished_ = true; }

  /// map_from_board at `time`, interpolated between two images; empty when they do not show it.
  std::optional<Eigen::Isometry3d> at(const std::string& board, double time) const;
  /// The one nearest in time.
  std::optional<Eigen::Isometry3d> nearest(const std::string& board, double time) const;

  /// The board of the setup's gripper in an image of that very time; empty without one.
  std::optional<Eigen::Isometry3d> gripper_at(double time) const;

  /// When images before and after `time` saw it.
  PoseStream::Around around(const std::string& board, double time) const;

  /// False while an image to come may still show more of the board at `time`: one that sees it at most
  /// `wait` seconds later, or its longest gap where that is more.
  bool is_settled(const std::string& board, double time, double wait = 0.0) const;

 private:
  struct Tracked {
    TagBody body;
    double max_gap = 0.0;
    PoseStream poses;
  };

  std::string probe_board_;  ///< empty without a probe
  TagBody base_;
  Eigen::Isometry3d map_from_base_ = Eigen::Isometry3d::Identity();
  const Setup& setup_;
  TrackingOptions options_;
  std::map<std::string, Tracked> boards_;
  std::optional<double> last_image_;
  bool finished_ = false;
};

}  // namespace clearway

#pragma once

#include <chrono>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apps/overlay/overlay_scene.hpp"
#include "apps/teach/teach_keys.hpp"
#include "apps/teach/teach_session.hpp"
#include "mapping/free_space_map.hpp"
#include "tracking/camera.hpp"

namespace clearway {

/// What is shown of a session at one image: a copy, to be drawn beside the session.
struct TeachView {
  cv::Mat image;  ///< CV_8UC1
  Camera camera;
  std::optional<Eigen::Isometry3d> camera_from_map;  ///< empty: not known, nothing is drawn
  double since_start = 0.0;                          ///< s
  std::chrono::steady_clock::time_point taken;       ///< when the source gave the image
  TeachState state = TeachState::ready;
  std::string volume;  ///< label of the active one; empty without a probe
  std::size_t balls = 0;
  std::shared_ptr<const std::vector<PaintedVolume>> volumes;  ///< null: as in the view before
  std::optional<Snapshot> sensed;  ///< for conflicts and what sensors saw; empty: as in the view before
  double resolution = 0.02;        ///< of the map, m
  std::optional<OverlayBall> ball;
  bool is_led = false;        ///< the hand leads the virtual robot in this image
  KeyOffer offer;             ///< for the keys of the strip
  std::string more_keys;      ///< beside those of the state
  std::string warning;        ///< of the virtual robot
  std::string refusal, cure;  ///< the last event's, or the image's
  std::shared_ptr<const Robot> robot;
  LinkPoses robot_pose, start_pose, goal_pose;  ///< map_from_link; empty: not drawn
  std::vector<OverlayLoad> loads;
  std::string held;  ///< names of what is in the hand; empty: nothing
  std::optional<Eigen::Vector3d> start_tip, goal_tip;
  std::vector<Sphere> to_paint;
  std::shared_ptr<const OverlayPath> path;
};

/// Copies of a session at its images.
class TeachViewer {
 public:
  TeachViewer(const TeachSession& session, const Setup& setup, const FreeSpaceMap& map,
              const FusionCounts& counts)
      : session_(session), setup_(setup), map_(map), counts_(counts) {}

  /// After the session has seen the image.
  TeachView view(const SeenImage& image, const ImageFrame& frame);

 private:
  void add_camera(const SeenImage& image, TeachView& view);
  void add_map(TeachView& view);
  void add_sensed(TeachView& view);
  void add_robot(TeachView& view);
  void add_loads(TeachView& view);
  void add_sentences(const SeenImage& image, TeachView& view);

  const TeachSession& session_;
  const Setup& setup_;
  const FreeSpaceMap& map_;
  const FusionCounts& counts_;
  std::optional<Eigen::Isometry3d> camera_from_map_;
  std::size_t painted_version_ = 0;
  std::size_t sensed_version_ = 0, sensed_by_hand_ = 0;  ///< of these, what no scan did
  double sensed_at_ = -1e300;
  const VirtualRobot* drawn_ = nullptr;
  std::shared_ptr<const Robot> robot_;
  const Plan* planned_ = nullptr;
  std::shared_ptr<const OverlayPath> path_;
};

/// Draws views of one session, in their order.
class TeachPainter {
 public:
  /// @param threads for one picture, at least 1; the picture does not depend on it
  explicit TeachPainter(std::size_t threads) : threads_(threads) {}

  /// The picture of a view, CV_8UC3 (BGR), as large as its image.
  cv::Mat draw(const TeachView& view);

 private:
  void take_paint(const TeachView& view);

  std::size_t threads_;
  OverlayMap shown_;
  std::optional<FreeSpaceMap> paint_;
  std::vector<PaintedVolume> painted_;  ///< what paint_ holds
  std::shared_ptr<const Robot> robot_;
  std::optional<RobotSurface> surface_;
};

/// The state in one line: "12.3 s, painting 'tool', 56 balls".
std::string state_line(const TeachView& view);

}  // namespace clearway

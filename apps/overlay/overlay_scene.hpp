#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/overlay/canvas.hpp"
#include "apps/overlay/strip.hpp"
#include "mapping/snapshot.hpp"
#include "mapping/voxels/sphere.hpp"
#include "planning/robot/kinematics.hpp"

namespace clearway {

/// What of a map is drawn: faces of voxels in the map frame. Made once for a map.
struct OverlayMap {
  struct Volume {
    std::string label;
    Mesh faces;  ///< of its painted voxels
  };
  std::vector<Volume> volumes;  ///< in the map's order
  Mesh conflicts;               ///< painted and occupied
  Mesh occupied;                ///< hides what is behind
};
OverlayMap overlay_map(const Snapshot& map);

/// The bodies of a robot as surfaces, for drawing it in many configurations.
struct RobotSurface {
  explicit RobotSurface(const Robot& robot);

  struct Part {
    int link = 0;
    bool is_critical = false;  ///< drawn in a colour of its own
    Mesh mesh;                 ///< link frame
  };
  std::vector<Part> parts;
};

/// The tip's way, map frame, with the clearance of the robot at each point, metres.
struct OverlayPath {
  std::vector<Eigen::Vector3d> points;
  std::vector<double> clearance;  ///< as many; not finite: not known
};

/// The probe's ball, map frame, metres.
struct OverlayBall {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double radius = 0.0;
  double bound = 0.0;  ///< how far the centre may be off (CenterBound::total): the halo's width
  bool is_accepted = true;
};

/// A load in the hand, in that of a ghost, or where it stands.
struct OverlayLoad {
  enum class Holder { hand, start, goal, none };
  Mesh mesh;  ///< load's frame
  Eigen::Isometry3d map_from_load = Eigen::Isometry3d::Identity();
  Holder holder = Holder::hand;
  bool is_refused = false;  ///< red: hand and load may not be there
};

/// What is drawn over a camera's image. Everything may be left out.
struct OverlayScene {
  const OverlayMap* map = nullptr;
  const RobotSurface* robot = nullptr;
  LinkPoses robot_pose;                                ///< map_from_link; empty: not drawn
  LinkPoses start_pose, goal_pose;                     ///< of the ghosts
  std::vector<OverlayLoad> loads;                      ///< solid in the hand, clear elsewhere
  std::optional<Eigen::Vector3d> start_tip, goal_tip;  ///< where "start" and "goal" are written
  OverlayPath path;
  std::vector<Sphere> to_paint;  ///< where painting would help
  /// Centres of painted spheres, drawn as dots instead of the volumes: while a hand chooses places inside of
  /// them.
  std::vector<Eigen::Vector3d> dots;
  bool is_outside = false;  ///< the dots are red: the hand has left the paint, or is where it may not be
  std::optional<OverlayBall> ball;
  std::optional<Strip> strip;
};

/// The colour of a clearance between 0 and `most`: orange where it is tight, over white, to blue;
/// colour-blind people see it as dark, bright, dark of another hue.
Colour clearance_colour(double clearance, double most);

/// The image with the scene: volumes, conflicts, robot, ghosts, path, advice and ball, each hidden by what is
/// nearer; occupied voxels hide, too. The strip covers the lower edge.
/// @param image CV_8UC1 or CV_8UC3 of the camera's size
/// @throws std::invalid_argument as Canvas does
cv::Mat draw_overlay(const cv::Mat& image, const Camera& camera, const Eigen::Isometry3d& camera_from_map,
                     const OverlayScene& scene, std::size_t threads = 1);

}  // namespace clearway

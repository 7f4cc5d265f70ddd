#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "datasets/descriptions/load_setup.hpp"
#include "datasets/descriptions/query_fields.hpp"
#include "datasets/sources/frame_source.hpp"
#include "datasets/sources/recording.hpp"

namespace clearway {

/// Statistical outlier removal: points whose mean distance to their neighbours is that many standard
/// deviations above the scan's mean.
struct OutlierSetup {
  int neighbours = 20;
  double deviations = 2.0;
};

/// How sensors and painting become voxels. What is left out is the mapping's own default.
struct MapSetup {
  std::optional<double> resolution;            ///< m, edge of a voxel
  std::optional<double> min_range, max_range;  ///< m, returns outside are dropped
  std::optional<Eigen::AlignedBox3d> crop;     ///< in the map frame; nothing outside is mapped
  double thin_to = 0;                          ///< m, one point per cube of this side; 0 = keep all
  std::optional<OutlierSetup> outliers;        ///< left out: all points count
  std::optional<bool> discretize;              ///< one ray per end voxel: faster, same end voxels
  std::optional<std::string> integration;      ///< "safe" or "compatible": what a scan frees
  std::optional<double>
      safe_band;  ///< m, around a scan's hits, which safe integration does not free; 0: none
};

/// Families of tags that are read, and how many ids each has.
const std::map<std::string, int>& tag_family_ids();

/// A tag of the detector's family. Its frame: origin in the middle of the tag, x right and y up as one faces
/// it, z out of the tag towards the viewer.
struct TagSetup {
  int id = 0;
  double size = 0;  ///< m, the square that is found: of tag36h11 the outer edge of the black border (8 cells)
  Eigen::Isometry3d board_from_tag = Eigen::Isometry3d::Identity();
};

/// How far the tags of a board may be from what the setup says: one standard deviation each. What is left out
/// is what `errors` says of all boards, else the tracking's own default.
struct BoardErrorsSetup {
  std::optional<double> scale;  ///< relative, of all sizes and places of the board together
  std::optional<double> size;   ///< relative, of each tag
  std::optional<double> place;  ///< m along each axis, of each tag
  std::optional<double> turn;   ///< rad about each axis, of each tag
};

/// The same for what a camera's calibration says.
struct CameraErrorsSetup {
  std::optional<double> focal;       ///< relative, fx and fy together
  std::optional<double> aspect;      ///< relative, fx / fy
  std::optional<double> center;      ///< px, cx and cy
  std::optional<double> distortion;  ///< px in the image's corner
};

/// What the setup does not know exactly.
struct ErrorsSetup {
  CameraErrorsSetup camera;
  BoardErrorsSetup boards;
  std::optional<double> edge;  ///< px, by which the detector may shift an edge of a tag
};

/// Tags that move as one rigid body. A board with `map_from_board` is fixed and anchors the map frame.
struct BoardSetup {
  std::string name;
  std::vector<TagSetup> tags;
  std::optional<Eigen::Isometry3d> map_from_board;
  BoardErrorsSetup errors{};
};

/// A capsule on a board: radius around the segment from `from` to `to`, metres, in the board's frame.
struct CapsuleSetup {
  Eigen::Vector3d from = Eigen::Vector3d::Zero(), to = Eigen::Vector3d::Zero();
  double radius = 0;
};

/// Where the scans of one sensor come from, when it is not where the recording says. One of four: fixed in
/// the map (`mount` = map_from_sensor); on a body whose poses a file gives (`mount` = body_from_sensor); on a
/// board that the camera tracks (`mount` = board_from_sensor); or on a link of the robot whose joints the
/// setup gives (`mount` = link_from_sensor).
struct SensorSetup {
  std::string name;             ///< label of the sensor in the recording, or a kind of cloud
  std::filesystem::path poses;  ///< TUM format, map_from_body; empty: no file
  std::string board;            ///< empty: no board
  std::string link;             ///< of the robot, "tip": its tip's frame; empty: no link
  Eigen::Isometry3d mount = Eigen::Isometry3d::Identity();
  double max_gap = 0.5;  ///< s between the two poses around a scan, at most
};

/// The probe: a ball on a stick on a board.
struct ProbeSetup {
  std::string board;
  Eigen::Vector3d ball_center = Eigen::Vector3d::Zero();            ///< m, in the board's frame
  double ball_radius = 0;                                           ///< m
  double robot_error = 0, tracking_error = 0, modelling_error = 0;  ///< m
  bool constant_tracking = false;  ///< each sample pays tracking_error; else how far it may itself be off
  std::vector<CapsuleSetup> hand;  ///< what holds it; scans must not see it, nor the ball and its stick

  /// Radius that is painted when the tracking error is constant, Chong 2008, eq. 3: r0 = r - (robot +
  /// tracking
  /// + modelling error).
  double painted_radius() const { return ball_radius - robot_error - tracking_error - modelling_error; }
};

/// A second probe, shaped like the robot's hand: it leads the virtual robot and picks start and goals.
struct GripperSetup {
  std::string board;
  /// W_T_W' of Chong 2008, eq. 1: where the board has the robot's tip.
  Eigen::Isometry3d board_from_tip = Eigen::Isometry3d::Identity();
  std::vector<CapsuleSetup> hand;  ///< what holds it, as of the probe
};

/// What scans must not see of probe, gripper and the hands that hold them: how far these may be from where
/// the images around a scan put them.
struct HandsSetup {
  std::optional<double> margin;  ///< m, in all directions; none: two voxels
  double latency = 0.02;         ///< s, by which times of images and of scans may differ
  double acceleration = 3;       ///< m/s^2, of any point of them between two images
  double hidden = 2;  ///< s: a scan in which they are not seen is left out, when images so near before and
                      ///< after it see them
};

/// A painted volume (CFV) and when in the recording it was painted.
struct VolumeSetup {
  std::string label;
  std::vector<std::string> critical_parts;  ///< empty: the robot's own choice
  double from = 0;                          ///< s after the first frame
  double to = std::numeric_limits<double>::infinity();
};

/// When a tracked sample is good enough to paint with. What is left out is the tracking's own default.
struct AcceptanceSetup {
  std::optional<double> max_reprojection_px;
  std::optional<double> min_ambiguity;  ///< error of the second pose over that of the first
  std::optional<int> min_tags;
  std::optional<double> max_noise;       ///< how many times the stated noise the residuals may show
  std::optional<double> max_speed;       ///< m/s of the ball
  std::optional<double> max_turn_speed;  ///< rad/s of the probe
  std::optional<double> max_pause;       ///< s to the previous image, if only one tag is visible
  std::optional<double> pixel_noise;     ///< standard deviation of a tag corner, px
  bool fixed_camera = false;             ///< camera and base board stand still: the board's pose is averaged
};

/// How images are searched for tags. What is left out is the detector's own default.
struct DetectorSetup {
  std::string family = "tag36h11";   ///< one of tag_family_ids()
  std::optional<int> decimate;       ///< 1, or 2: squares are looked for at half size, corners found at full
  std::optional<int> threads;        ///< images searched at the same time; none: all cores, at most 8
  std::optional<double> sigma;       ///< px, Gaussian blur of the image
  std::optional<double> sharpening;  ///< of the bits
  std::optional<int> max_hamming;    ///< bits that may be corrected
  std::optional<double> min_margin;  ///< grey levels between bits and threshold
};

/// The robot of a recording: where it stands, what it carries, how its joints are known.
struct RobotSetup {
  std::string name;  ///< in datasets/robots, or a URDF path
  Eigen::Isometry3d map_from_base = Eigen::Isometry3d::Identity();
  std::optional<double> scale;
  RobotTermsSetup terms;       ///< of what is planned; joint_file and joint_topic speak of all joints
  std::vector<double> joints;  ///< where it stands while scans are taken; empty: it is not in their way
  double payload = 0;          ///< kg at the tip, full size, for the path cost
  Eigen::Vector3d gravity{0.0, 0.0, -9.81};  ///< m/s^2, map frame, for the path cost
  double self_margin = 0.02;                 ///< m, points this near to its bodies are its own
  std::filesystem::path joint_file;  ///< where it was while it moved: a table (joint_stream.hpp); empty: none
  std::string joint_topic;           ///< the same, JointState of the recording, a bag; empty: none
  std::map<std::string, std::string> joint_names;  ///< what these recordings call a joint of the robot
  std::string joint_prefix;                        ///< that their names have before the robot's
  double latency = 0.02;                           ///< s, by which times of joints and of scans may differ
  double joint_error = 0.01;                       ///< rad or m, of each joint's position
  double place_error = 0.005;                      ///< m, of the sensor's place against the robot's
  std::vector<std::string> paints;  ///< parts that paint where they are led, as far as the joints are known
};

/// A goal of a query that is a pose of the tip, and what of it may differ.
struct GoalPoseSetup {
  Eigen::Isometry3d map_from_tip = Eigen::Isometry3d::Identity();
  double position_tolerance = 0;  ///< m
  double turn_tolerance = 0;      ///< rad
  std::optional<int> free_axis;   ///< 0, 1, 2: the tip's x, y or z, about which it may turn
};

/// A planning query: legs from the start through each goal in turn. Radians and metres, as the joints are.
struct QuerySetup : WaySetup {
  std::string name;
  std::vector<GoalPoseSetup> goal_poses;        ///< instead of goals
  std::string tip;                              ///< link that they place; empty: the robot's own tip
  std::vector<std::string> planners;            ///< empty: the command's default
  std::map<std::string, std::string> policies;  ///< part or "default" -> painted | known_free | not_occupied
  std::map<std::string, std::string> options;   ///< "key" for each planner, "planner.key" for one
  std::optional<double> padding;                ///< m, distance that every body keeps; none: `auto`
  std::vector<std::string> allow_outside;       ///< parts that may leave the map's bounds, or "all"
  double seen_within = 0;                       ///< s, how long a look counts under known_free; 0: ever
  std::vector<LoadSetup> loads;                 ///< that ride on the robot
  std::optional<PickSetup> pick;  ///< taken and put down, with a place; then at most one goal, and no loads
};

/// Everything about a teaching session that is not in the sensors' data. See datasets/FORMATS.md for the
/// file.
struct Setup {
  std::string title;  ///< shown on the report page
  MapSetup map;
  std::optional<CameraIntrinsics> camera;  ///< overrides the recording's
  ErrorsSetup errors;
  std::vector<BoardSetup> boards;
  std::vector<SensorSetup> sensors;  ///< those that are not where the recording says
  std::optional<ProbeSetup> probe;
  std::optional<GripperSetup> gripper;
  HandsSetup hands;
  std::vector<VolumeSetup> volumes;  ///< never empty: by default one, "free", over everything
  AcceptanceSetup acceptance;
  DetectorSetup detector;
  SourceOptions source;  ///< with the camera
  std::optional<RobotSetup> robot;
  std::vector<LoadSetup> loads;  ///< that a teaching session may attach, each with a name of its own
  std::vector<QuerySetup> queries;

  /// The load of that name, of `loads`, else of the first query that has one; null when there is none.
  const LoadSetup* load(const std::string& name) const;
  /// The board of that name; null when there is none.
  const BoardSetup* board(const std::string& name) const;
  /// The sensor of that label, else of that kind; null: where the recording says.
  const SensorSetup* sensor(const std::string& label, const std::string& kind) const;
};

/// Reads a setup from YAML text; `name` is what errors call it. @throws std::invalid_argument, one sentence
/// naming the file, the line, the key and what was expected: unknown keys (with the nearest known one),
/// numbers that are not finite or out of range, tag ids used twice, a probe or sensor without its board.
/// Files that it names are relative to the folder of `name`.
Setup parse_setup(const std::string& text, const std::string& name);

/// The same from a file. @throws std::invalid_argument also when it cannot be read.
Setup load_setup(const std::filesystem::path& file);

}  // namespace clearway

#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "datasets/recording.hpp"

namespace clearway {

/// How sensors and painting become voxels. What is left out is the mapping's own default.
struct MapSetup {
  std::optional<double> resolution;            ///< m, edge of a voxel
  std::optional<double> min_range, max_range;  ///< m, returns outside are dropped
  std::optional<Eigen::AlignedBox3d> crop;     ///< in the map frame; nothing outside is mapped
  double thin_to = 0;                          ///< m, one point per cube of this side; 0 = keep all
  std::optional<bool> discretize;              ///< one ray per end voxel: faster, same end voxels
};

/// A tag36h11 tag. Its frame: origin in the middle of the tag, x right and y up as one faces it, z out of the
/// tag towards the viewer.
struct TagSetup {
  int id = 0;
  double size = 0;  ///< m, outer edge of the black border (8 cells)
  Eigen::Isometry3d board_from_tag = Eigen::Isometry3d::Identity();
};

/// Tags that move as one rigid body. A board with `map_from_board` is fixed and anchors the map frame.
struct BoardSetup {
  std::string name;
  std::vector<TagSetup> tags;
  std::optional<Eigen::Isometry3d> map_from_board;
};

/// The probe: a ball on a stick on a board.
struct ProbeSetup {
  std::string board;
  Eigen::Vector3d ball_center = Eigen::Vector3d::Zero();            ///< m, in the board's frame
  double ball_radius = 0;                                           ///< m
  double robot_error = 0, tracking_error = 0, modelling_error = 0;  ///< m

  /// Radius that is painted, eq. 3: r0 = r - (robot + tracking + modelling error).
  double painted_radius() const { return ball_radius - robot_error - tracking_error - modelling_error; }
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
  std::optional<double> max_speed;    ///< m/s of the ball
  std::optional<double> pixel_noise;  ///< standard deviation of a tag corner, px
  bool fixed_camera = false;          ///< camera and base board stand still: the board's pose is averaged
};

struct RobotSetup {
  std::string name;  ///< in datasets/robots, or a URDF path
  Eigen::Isometry3d map_from_base = Eigen::Isometry3d::Identity();
  std::optional<double> scale;
};

/// A planning query: legs from the start through each goal in turn. Radians and metres, as the joints are.
struct QuerySetup {
  std::string name;
  std::vector<double> start;
  std::vector<std::vector<double>> goals;
  std::vector<std::string> planners;            ///< empty: the command's default
  std::map<std::string, std::string> policies;  ///< part or "default" -> painted | known_free | not_occupied
  std::map<std::string, std::string> options;   ///< "key" for each planner, "planner.key" for one
  double padding = 0;                           ///< m, distance that every body keeps
};

/// Everything about a teaching session that is not in the sensors' data. See datasets/README.md for the file.
struct Setup {
  std::string title;  ///< shown on the report page
  MapSetup map;
  std::optional<CameraIntrinsics> camera;  ///< overrides the recording's
  std::vector<BoardSetup> boards;
  std::optional<ProbeSetup> probe;
  std::vector<VolumeSetup> volumes;  ///< never empty: by default one, "free", over everything
  AcceptanceSetup acceptance;
  std::optional<RobotSetup> robot;
  std::vector<QuerySetup> queries;

  /// The board of that name; null when there is none.
  const BoardSetup* board(const std::string& name) const;
};

/// Reads a setup from YAML text; `name` is what errors call it. @throws std::invalid_argument, one sentence
/// naming the file, the line, the key and what was expected: unknown keys (with the nearest known one),
/// numbers that are not finite or out of range, tag ids used twice, a probe without its board.
Setup parse_setup(const std::string& text, const std::string& name);

/// The same from a file. @throws std::invalid_argument also when it cannot be read.
Setup load_setup(const std::filesystem::path& file);

/// A whole text file. @throws std::invalid_argument, saying `what` it should have been, when it cannot be
/// read or is larger than 4 MB.
std::string read_text(const std::filesystem::path& file, const std::string& what);

}  // namespace clearway

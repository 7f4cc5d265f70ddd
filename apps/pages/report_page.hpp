#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/fusion/recording_timeline.hpp"
#include "apps/pages/page_evidence.hpp"
#include "apps/pages/voxel_faces.hpp"
#include "mapping/history/provenance.hpp"
#include "mapping/voxels/sphere.hpp"

namespace clearway {

/// A named value of a table of figures, as it is shown.
using PageFigure = std::pair<std::string, std::string>;

/// One rigid piece of the robot.
struct PageShape {
  static constexpr std::string_view mesh = "mesh";
  std::string_view kind = "sphere";  ///< or capsule, cylinder, box: the name of a Shape of sizes; or mesh
  /// Metres. sphere: radius; capsule and cylinder: radius, length along z (a capsule's between the centres of
  /// its caps); box: the three full edges; mesh: unused.
  Eigen::Vector3d size = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d> vertices;      ///< of a mesh, in the shape's frame
  std::vector<std::array<int, 3>> triangles;  ///< of a mesh
  Eigen::Isometry3d link_from_shape = Eigen::Isometry3d::Identity();
  int link = 0;           ///< index into the poses of each waypoint
  std::string part;       ///< the robot part it belongs to, as policies name it
  bool critical = false;  ///< drawn in the colour of critical parts
  int group = 0;  ///< of several robots: which one, by its colour; -1: an obstacle that moves; -2: one
                  ///< that robots know from the map alone
};

/// Voxels that a map has from some time on, and did not have when the page's map was made.
struct PageSeen {
  double time = 0.0;  ///< s
  std::vector<Eigen::Vector3d> centers;
};

/// One plan, found or not. All per-waypoint arrays have as many entries as `waypoints`, or none.
/// The page draws the robot between two waypoints by interpolating each link's pose, so waypoints more than
/// about 5 degrees apart should be subdivided before.
struct PagePlan {
  std::string name, planner;
  std::string status;       ///< a PlanStatus word; anything but "solved" is shown as a failure
  std::string explanation;  ///< one or more sentences
  std::vector<std::string> joints;
  std::vector<bool> is_prismatic;          ///< per joint: metres, else radians
  std::vector<Eigen::VectorXd> waypoints;  ///< joint values; may be empty when no path was found
  std::vector<std::vector<Eigen::Isometry3d>> link_poses;  ///< map_from_link, per waypoint and link
  std::vector<double>
      clearance;  ///< metres, below zero in contact; not finite = not known, left out of the plot
  std::vector<double> between_bodies{};  ///< metres, of the robot's own; not finite = not known
  double period = 0.0;    ///< s between two waypoints, less before the last one; 0: the plan has no time
  double duration = 0.0;  ///< s, of the whole motion
  /// With time: of each joint at each waypoint, rad/s (m/s), and the change of speed since the waypoint
  /// before, of several in between the greatest, rad/s^2 (m/s^2). Else empty.
  std::vector<Eigen::VectorXd> speeds, accelerations;
  std::vector<double> max_speed, max_acceleration;  ///< limits of each joint, of a plan with time
  /// With time, where it is known: jerk, the greatest since the waypoint before, rad/s^3 (m/s^3), and the
  /// limit of each joint. Else empty.
  std::vector<Eigen::VectorXd> jerks{};
  std::vector<double> max_jerk{};
  /// The same of torques, N m (N of a sliding joint); the limit of a joint that has none is infinite.
  std::vector<Eigen::VectorXd> torques{};
  std::vector<double> max_torque{};
  double security_distance = 0.0;  ///< m: what was to be kept; 0: nothing was said
  /// While a map changes: what is blocked anew from time to time, the edge of these voxels, and at each
  /// waypoint how old the map was, s, and the true distance from what `clearance` has from the map alone, m.
  /// Else empty.
  std::vector<PageSeen> seen;
  double seen_voxel = 0.0;
  std::vector<double> map_age, true_separation;
  /// How the planner got to each waypoint: an index into these words, and when the search made the edge
  /// (WaypointOrigin::search_step, 0: not known). All empty where it does not say.
  std::vector<std::string> phase_names{};
  std::vector<int> phases{}, search_steps{};
  std::vector<PageFigure> figures;
  std::vector<Eigen::Vector3d> tip_path;  ///< map frame
  std::vector<Sphere> to_paint;           ///< where more paint would connect the ends; map frame
  /// map_from_link at the start and at the goal asked for: the ghosts. Empty: those of the first and last
  /// waypoint; give both for a plan that found no path.
  std::vector<Eigen::Isometry3d> start_poses, goal_poses;
};

/// An exact painted sphere.
struct PageSphere {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double radius = 0.0;
  int volume = 0;  ///< index into volume_labels
};

struct PageTable {
  std::string name;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
};

/// A picture with the sentence below it.
struct PagePicture {
  std::string caption;
  std::string jpeg;  ///< the file's bytes
};

/// What a report page shows. Everything may be empty but the title.
struct ReportPage {
  std::string title, subtitle;
  std::vector<PageFigure> figures;
  std::string opens{};               ///< what it shows where its address asks nothing: "cut=z:0.5"
  double iso_azimuth_deg = 35.0;     ///< where the eye of the first view stands: 0 at -y, 90 at +x
  Eigen::AlignedBox3d first_look{};  ///< what it shows of a map alone, metres; empty: all that is occupied
  std::size_t occupied_beyond = 0;   ///< voxels outside of that
  double resolution = 0.0;           ///< of the map, metres; > 0 when there are voxels
  std::vector<std::pair<std::string, std::string>> state_labels{};  ///< (state, what it is called) if not so
  std::vector<PageVoxels> voxels;  ///< at most one per state, all with `size` equal to the resolution
  std::vector<PageSphere> spheres;
  std::vector<std::string> volume_labels;
  PageEvidence evidence{};  ///< of the voxels; may be none
  /// MAP of `clearway inspect`; empty: the folder in which the page lies. None: the map lies in no file.
  std::optional<std::string> map_place{};
  RecordingTimeline recording{};         ///< what happened when; may be none
  Provenance provenance = Provenance();  ///< spheres and conflicts by their times; may be none
  std::vector<PageShape> robot;
  std::vector<Eigen::Isometry3d> robot_home;  ///< map_from_link, drawn when no plan gives a pose
  std::vector<PagePlan> plans;
  std::vector<PageTable> tables;
  std::vector<PagePicture> pictures;
  std::vector<std::string> warnings;
  std::string json;  ///< report.json, offered for download byte for byte
};

/// One HTML file that shows `page` with no network and no other file. Equal pages give equal bytes; strings
/// that are not UTF-8 get U+FFFD in place of the bytes that are wrong.
/// @throws std::invalid_argument naming the field whose sizes or indices do not agree.
std::string render_report_page(const ReportPage& page);

}  // namespace clearway

#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "apps/console/console.hpp"
#include "planning/path/motion.hpp"
#include "planning/path/trajectory.hpp"
#include "planning/survey/path_survey.hpp"

namespace clearway {

// One struct of options and one function per command; `command_line.cpp` fills the structs from flags.
// Every function returns an ExitStatus. User's mistakes and damaged files are thrown (std::invalid_argument,
// std::runtime_error, DamagedFile) and turned into one sentence and a status by run_command_line().

/// Flags that `plan` and `check` share about the robot and what it must keep.
struct RobotChoice {
  std::string robot;                       ///< name in datasets/robots, .yaml or .urdf
  std::optional<double> scale;             ///< replaces the robot's own
  std::vector<double> base;                ///< x,y,z[,roll,pitch,yaw] of the base in the map; empty: its own
  std::vector<std::string> policies;       ///< "P" (all parts) or "PART=P"
  std::optional<double> padding = {};      ///< metres; none: `auto`, the robot's position accuracy
  std::optional<double> seen_within = {};  ///< seconds, of parts under known_free; none: ever
  std::filesystem::path srdf = {};         ///< empty: the robot's own
  std::string group = {};                  ///< empty: the robot's own, else all joints
  std::vector<std::string> fixed = {};     ///< "JOINT=VALUE"
  std::vector<std::string> standing = {};  ///< links
  std::vector<std::string> packages = {};  ///< "NAME=DIR"
  std::vector<std::string> xacro = {};     ///< "NAME:=VALUE"
};

/// Flags that `plan` and `check` share about loads on the joints: path costs and torques follow from them.
struct DynamicsChoice {
  std::optional<double> payload = {};  ///< kg at the tip, full size
  std::vector<double> gravity = {};    ///< x,y,z in the map frame, m/s^2; empty: none is chosen
};

struct ReplayOptions {
  std::filesystem::path recording;
  double camera_seconds = 10.0;       ///< of a live camera
  std::filesystem::path setup;        ///< empty: the one embedded in the recording, if any
  std::filesystem::path out;          ///< folder, created
  double resolution = 0.0;            ///< metres; 0: the setup's, else 0.02
  std::string integration;            ///< "safe" or "compatible"; empty: the setup's, else safe
  int threads = 0;                    ///< for images and scans; 0: as many as the machine has, at most 8
  std::vector<std::string> planners;  ///< replaces the queries' own lists
  std::optional<double> seen_within;  ///< seconds; replaces the queries' own
  bool plan = true;
  std::uint64_t seed = 1;
  double time_limit = 60.0;       ///< seconds for each leg
  std::filesystem::path record;   ///< .mcap file of what was seen and made; empty: none
  std::filesystem::path overlay;  ///< folder of stills: plans in the camera's image; empty: none
  std::filesystem::path video;  ///< .mp4 file of the recording with what was painted and planned; empty: none
};
int run_replay(const ReplayOptions& options, Console& console);

struct TeachCommand {
  std::filesystem::path source;   ///< a recording, or the folder of a recorded session
  double camera_seconds = 600.0;  ///< of a live camera
  std::filesystem::path setup;    ///< empty: the one embedded in the recording
  std::filesystem::path events;   ///< what the person does, one action a line; empty: keys in the window
  std::filesystem::path keys;     ///< more keys of the window, one a line; empty: none
  bool headless = false;          ///< no window
  std::filesystem::path overlay;  ///< folder of stills of the plans in the camera's image; empty: none
  std::filesystem::path video;    ///< .mp4 file of the session's pictures; empty: none
  std::filesystem::path out;      ///< folder, created
  double resolution = 0.0;        ///< metres; 0: the setup's, else 0.02
  std::string integration{};      ///< "safe" or "compatible"; empty: the setup's, else safe
  int threads = 0;                ///< for images and scans; 0: as many as the machine has, at most 8
  std::uint64_t seed = 1;
  double time_limit = 60.0;  ///< seconds for each leg
};
int run_teach(const TeachCommand& command, Console& console);

struct TrackOptions {
  std::filesystem::path source;
  double camera_seconds = 10.0;  ///< of a live camera
  std::filesystem::path setup;   ///< empty: the one embedded in the recording, if any
  std::filesystem::path csv;     ///< empty: none, as the others
  std::filesystem::path json;
  std::filesystem::path tum_probe, tum_camera;
  std::filesystem::path draw;  ///< folder, created
  int threads = 0;             ///< for searching images; 0: the setup's, else as many as the machine has
};
int run_track(const TrackOptions& options, Console& console);

/// A calibration from images of tags; `setup` names the boards.
struct CalibrateOptions {
  std::string what;  ///< camera, board, probe, base or hand-eye
  std::filesystem::path source;
  double camera_seconds = 10.0;  ///< of a live camera
  std::filesystem::path setup;
  std::string body;           ///< the board's name; empty: the one that is seen most
  std::string lens;           ///< of camera: plumb_bob, rational or fisheye; empty: plumb_bob
  std::string sensor;         ///< hand-eye: a sensor on the tip that the camera is; empty: none
  std::filesystem::path out;  ///< copy of the setup with what was measured; empty: none
  int threads = 0;            ///< for searching images; 0: as many as the machine has, at most 8
};
int run_calibrate(const CalibrateOptions& options, Console& console);

/// Goals that are poses of a link, and what of them may differ.
struct GoalPoseChoice {
  std::vector<std::string> poses;   ///< "x,y,z[,roll,pitch,yaw]", map frame, one a leg; empty: none
  std::string tip;                  ///< link that they place; empty: the robot's own tip
  double position_tolerance = 0.0;  ///< m
  double turn_tolerance = 0.0;      ///< rad
  std::string free_axis;            ///< x, y or z of the tip, about which it may turn; empty: none
};

/// Flags that `plan`, `check` and `gate` share: a robot, with what rides on it, in a map.
struct PlacedRobotChoice {
  std::filesystem::path map;
  std::optional<double> cloud_resolution = {};  ///< metres, of a map that is a cloud; none: its own
  RobotChoice robot;
  std::vector<std::filesystem::path> attach = {};  ///< files of loads
  std::string start;                               ///< of `gate` may be empty: where the first chunk starts
};

/// Flags that `plan` and `check` share; what is left out of it `check` takes from the map's record or the
/// plan.
struct QueryChoice : PlacedRobotChoice {
  std::vector<std::string> goals;
  GoalPoseChoice goal_poses;        ///< instead of goals
  std::filesystem::path pick = {};  ///< file of an object that is taken; empty: none
  std::string place = {};           ///< "x,y,z[,roll,pitch,yaw]" of it; empty: the file's
  bool degrees = false;             ///< start and goals
  DynamicsChoice dynamics;
  SurveyDemands survey;
};

struct PlanOptions : QueryChoice {
  std::string planner = "auto";
  std::vector<std::string> settings;  ///< "key=value", planner options
  std::uint64_t seed = 1;
  double time_limit = 60.0;
  std::filesystem::path out;  ///< plan.json; empty: none
  std::filesystem::path csv;
  std::filesystem::path view;                                     ///< HTML; empty: none
  std::vector<std::pair<std::string, std::string>> trajectories;  ///< ("ros", FILE), ("urscript", FILE), …
  MotionScales scales{};                                          ///< of the motion
  double period = 0.008;                                          ///< of its points, seconds
  double grip_time = usual_grip_time;                             ///< seconds
  bool motion = false;                                            ///< in plan.json
  bool print_options = false;
};
int run_plan(const PlanOptions& options, Console& console);

/// What a plan may loosen when the user names it (--accept-…).
enum class AcceptedTerm {
  robot,
  held,
  scale,
  base,
  policy,
  padding,
  load,
  payload,
  map,
  goals,
  moving_start,
  moving_end
};

struct CheckOptions : QueryChoice {
  std::optional<double> grip_time = {};  ///< seconds at rest where loads are taken or left; none: the plan's
  std::set<AcceptedTerm> accepted;
  std::filesystem::path plan;
};
int run_check(const CheckOptions& options, Console& console);

struct GateCommandOptions : PlacedRobotChoice {
  std::vector<double> max_velocity;             ///< of all joints or each; empty: the robot's own
  std::vector<double> deceleration;             ///< of all joints or each; empty: 5 rad/s^2 or m/s^2
  double reaction = 0.0;                        ///< seconds
  double tolerance = 1e-3;                      ///< of where a chunk starts, rad or m
  std::optional<double> max_age;                ///< seconds; none: unlimited
  std::optional<double> max_duration;           ///< of a chunk, seconds; none: 60
  std::vector<std::string> allow_outside = {};  ///< parts that may leave the map's bounds, or "all"
  std::size_t max_line = 262144;                ///< bytes
};
int run_gate(const GateCommandOptions& options, Console& console);

struct InspectOptions {
  std::filesystem::path map;
  std::optional<double> cloud_resolution = {};  ///< metres, of a map that is a cloud; none: its own
  std::vector<std::string> at;                  ///< "X,Y,Z"
  std::vector<std::pair<std::string, std::string>> slices;  ///< ("z=0.3", "FILE.png")
  std::vector<std::string> terms;                           ///< "z=0.3": slices as text
  std::string clearance;  ///< policy whose clearance the slices show; or empty
  bool age = false;       ///< slices colour what was seen free by when
  bool whole = false;     ///< slices reach as far as the map, not as far as most of it
  std::vector<std::filesystem::path> exports;
  std::filesystem::path view;     ///< HTML
  bool holes = false;             ///< quality of the painted volumes
  std::vector<std::string> rays;  ///< "ox,oy,oz,dx,dy,dz"
  bool conflicts = false;         ///< list them
  std::filesystem::path diff;     ///< map to compare with; empty: none
  // A new map made of this one, in this order; all else is then asked of it.
  std::filesystem::path merge;             ///< map to add; empty: none
  std::filesystem::path paint{};           ///< painted.csv whose volumes are painted; empty: none
  std::vector<std::string> clear, occupy;  ///< shapes, see apps/inspect/hand_shapes.hpp
  std::string crop;                        ///< "x0,y0,z0,x1,y1,z1"; empty: all of it
  std::optional<double> coarsen;           ///< edge of a voxel, metres
  std::filesystem::path save;              ///< folder for the new map; empty: none
};
int run_inspect(const InspectOptions& options, Console& console);

struct SimulateOptions {
  std::filesystem::path scene;
  std::filesystem::path out;  ///< recording to write
};
int run_simulate(const SimulateOptions& options, Console& console);

/// Tag boards to print and the setup that matches them; millimetres, see apps/print/tag_boards.hpp.
struct TagsPrintOptions {
  std::filesystem::path out;  ///< folder, created
  double base_tag = 60.0, probe_tag = 28.0, ball_radius = 20.0, stem = 80.0, gripper_tag = 28.0,
         square = 34.0;
};
int run_tags_print(const TagsPrintOptions& options, Console& console);

struct CompareOptions {
  std::vector<std::filesystem::path> what;  ///< a suite; or `merge` and folders; or `diff` and two of them
  std::filesystem::path out;                ///< folder, created
  std::vector<std::string> planners;        ///< only those labels or names; empty: all
  std::vector<std::string> externals;       ///< "NAME=COMMAND"
  std::vector<std::string> experiments;     ///< only those; empty: all
  int jobs = 1;                             ///< problems at the same time
  std::optional<std::uint64_t> seed;        ///< replaces the suite's
  std::optional<double> time_limit;         ///< replaces all of the suite's, seconds a leg
  bool keep_maps = false;                   ///< also those that generators made
  int worst_pages = 3;                      ///< pages in 3D of worst runs, each experiment, at most
  bool resume = false;                      ///< goes on with OUT.partial
  std::string rerun;                        ///< the one run of that id; empty: all
  int shard = 1, shards = 1;                ///< one part of several
  bool isolate = true;                      ///< a process for each run
  double grace = 60.0;                      ///< s beyond the time limit until a run counts as hung
  double memory = 8.0;                      ///< GB that a run may take
};
int run_compare(const CompareOptions& options, Console& console);

struct ImportOptions {
  std::string kind;                          ///< "mbm", "scene", "json" or "robometrics"
  std::vector<std::filesystem::path> files;  ///< of problems
  RobotChoice robot;
  double resolution = 0.02;   ///< metres
  std::filesystem::path out;  ///< folder, created
  bool leave_out_unknown_frames = false;
};
int run_import(const ImportOptions& options, Console& console);

struct RobotsOptions {
  RobotChoice robot;  ///< whose `robot` is empty: those that come with the program are listed
  std::vector<std::filesystem::path> attach = {};  ///< .yaml
  std::string at = {};                             ///< configuration; empty: resting_configuration
  bool degrees = false;                            ///< `at`
  std::filesystem::path view = {};                 ///< HTML file; empty: none
};
int run_robots(const RobotsOptions& options, Console& console);
int run_planners(Console& console);

}  // namespace clearway

#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "datasets/descriptions/sensing_errors.hpp"
#include "datasets/descriptions/setup.hpp"

namespace clearway {

class YamlFields;

/// A box of a scene.
struct BoxShape {
  Eigen::Vector3d size;  ///< m, centred on the shape's origin
};
/// A cylinder of a scene.
struct CylinderShape {
  double radius, length;  ///< m, along z, centred on the shape's origin
};
/// A sphere of a scene, about the shape's origin.
struct SphereShape {
  double radius;  ///< m
};

/// A solid thing of the scene.
struct SceneShape {
  std::string name;
  std::variant<BoxShape, CylinderShape, SphereShape> geometry;
  Eigen::Isometry3d map_from_shape = Eigen::Isometry3d::Identity();
  double grey = 160;  ///< 0 black to 255 white, before shading
};

/// The pose that goes a share of the way from one to the other: straight, turning evenly.
Eigen::Isometry3d pose_between(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to, double share);

/// The camera that watches the boards; its intrinsics are the setup's, and less true than they say by
/// `errors`.
struct SceneCamera {
  struct Waypoint {
    double time;  ///< s after the first picture
    Eigen::Isometry3d map_from_camera;
  };
  Eigen::Isometry3d map_from_camera = Eigen::Isometry3d::Identity();  ///< optical frame: z forward
  std::vector<Waypoint> path;  ///< who carries it walks along these, times rising; empty: it stands still
  Shake sway{0, 0, 0.5, 3};    ///< of who carries it
  std::string family;          ///< that `errors` were drawn for; empty: none
  PictureErrors errors;
  double rate_hz = 15;
  double noise_sigma = 2;  ///< grey levels
  double blur_px = 0.6;    ///< sigma of the lens blur
  double exposure = 0;     ///< s, the probe is smeared over that time
};

/// The depth camera: one image from each pose, pass after pass, of the shapes alone (not of boards, probe and
/// hands); or, beside the pictures, of everything.
struct SceneDepth {
  CameraIntrinsics intrinsics;
  std::vector<Eigen::Isometry3d> map_from_sensor;  ///< x forward, y left, z up
  double noise_constant = 0, noise_quadratic = 0;  ///< sigma = constant + quadratic * range^2, m and 1/m
  double dropout = 0;                              ///< share of pixels without a return
  double max_range = 5;                            ///< m
  double unit = 1e-3;                              ///< m per stored step
  size_t passes = 1;                               ///< over all poses, one after the other
  double interval = 0.1;                           ///< s from pose to pose
  bool beside_pictures = false;  ///< from the first picture to the last one, as many passes as there is time
  size_t images_beside = 0;      ///< how many images that makes
  std::string family;            ///< that noise and errors were drawn for; empty: none
  std::optional<DepthNoise> noise;  ///< instead of the two numbers above and the dropout
  SequenceErrors errors;

  /// How many images there are.
  size_t images() const { return beside_pictures ? images_beside : map_from_sensor.size() * passes; }
};

/// How the probe is moved: its ball runs through the waypoints (centripetal Catmull-Rom curve) at constant
/// speed, or is at each at its time; its board turns between theirs and wobbles about the ball like a hand;
/// and all of it trembles.
struct SceneStroke {
  struct Waypoint {
    Eigen::Vector3d ball;               ///< m, in the map frame
    Eigen::Quaterniond map_from_probe;  ///< of the probe's board
    double time = 0;                    ///< s after the first picture, where the stroke is timed
  };
  std::vector<Waypoint> waypoints;
  std::optional<double> speed, duration;  ///< m/s or s, exactly one of them; neither: the waypoints' times
  double wobble = 0;                      ///< rad, amplitude
  double wobble_hz = 0.5;
  std::string person;  ///< that tremor and wobble were drawn for; empty: none
  Shake tremor;
  uint64_t seed = 1;  ///< of the tremor
};

/// What holds the probes, in pictures and in depth images taken beside them: capsules on their boards, and
/// now and then a finger on a tag of the probe, which hides it.
struct SceneHands {
  struct Cover {
    double from, to;  ///< s after the first picture
    int tag;
  };
  std::vector<CapsuleSetup> probe, gripper;
  double grey = 150;
  std::vector<Cover> covers;
  double cover_share = 0;  ///< of the time, in which a finger lies on a tag that is drawn
};

/// How the gripper probe is moved: its tip goes from pose to pose, in a straight line and turning evenly. It
/// is out of sight before the first time and after the last one.
struct SceneGripper {
  struct Waypoint {
    double time;  ///< s after the first picture
    Eigen::Isometry3d map_from_tip;
  };
  std::vector<Waypoint> waypoints;  ///< one at least, times rising

  /// map_from_tip at a time; empty when it is out of sight.
  std::optional<Eigen::Isometry3d> at(double time) const;
};

/// Frames copied from another recording.
struct SceneInclude {
  std::filesystem::path recording;
  Eigen::Isometry3d world_from_map = Eigen::Isometry3d::Identity();  ///< our map frame in its world
  std::vector<std::string> sensors;  ///< labels or cloud kinds to copy; empty: every cloud
};

/// A world with exact truth, from which `simulate` makes a recording.
struct Scene {
  std::string name;
  Setup setup;
  std::string setup_text;  ///< stored in the recording, so that it explains itself
  std::vector<SceneShape> shapes;
  std::optional<SceneCamera> camera;
  std::optional<SceneDepth> depth;
  std::optional<SceneStroke> stroke;
  std::optional<SceneHands> hands;
  std::optional<SceneGripper> gripper;  ///< with it, the ball is out of sight once its stroke has ended
  std::vector<SceneInclude> includes;
  uint64_t seed = 1;
  double start_time = 0;   ///< s since 1970 of the first frame
  double background = 40;  ///< grey where no ray meets anything
};

/// {name, box | cylinder | sphere, pose, grey} of a scene or suite; the map must hold nothing else.
/// @throws std::invalid_argument
SceneShape read_scene_shape(const YamlFields& fields);

/// How long its pictures go on, s: until stroke and gripper have ended.
double duration_of_pictures(const Scene& scene);

/// Reads a scene and the setup it names. See datasets/FORMATS.md for the file. `${MRPT_DATASETS}` in the path
/// of an included recording is the environment's CLEARWAY_MRPT_DATASETS, or /usr/share/mrpt/datasets.
/// @throws std::invalid_argument, one sentence naming file, line, key and what was expected.
Scene load_scene(const std::filesystem::path& file);

/// The same from text; `folder` is what relative paths start from.
Scene parse_scene(const std::string& text, const std::string& name, const std::filesystem::path& folder);

}  // namespace clearway

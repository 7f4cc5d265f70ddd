#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "apps/fusion/recording_timeline.hpp"
#include "apps/fusion/taken_cameras.hpp"
#include "datasets/descriptions/setup.hpp"
#include "datasets/sources/recording.hpp"
#include "mapping/free_space_map.hpp"
#include "tracking/probe.hpp"

namespace clearway {

/// What one pass over a recording met and made of it.
struct FusionCounts {
  std::size_t frames = 0, images = 0, scans = 0, odometry = 0;
  std::size_t detections = 0;  ///< tags seen, over all images
  std::size_t images_with_tags = 0;
  std::set<int> ids_seen;                             ///< of tags
  std::map<std::string, std::int64_t> samples;        ///< by "accepted" or the reason of refusal
  std::map<std::string, std::string> first_refusals;  ///< by reason, the first sentence
  std::size_t accepted_outside_volumes = 0;           ///< accepted, but outside every volume's time span
  std::size_t spheres = 0;
  std::size_t body_spheres = 0;  ///< painted by the robot's own bodies
  double body_radius = 0.0;      ///< of these, the largest, metres
  std::size_t erasers = 0;       ///< accepted samples that erased
  std::size_t scans_inserted =
      0;              ///< of the scans: in the map by now; others wait for a pose, or were left out
  ScanCounts points;  ///< summed over the scans
  std::size_t infinite_beams = 0;  ///< of 2D lasers: they said +inf, range_max or `no_return` of the setup
  std::size_t beams_at_range = 0;  ///< of these, those that did not say +inf
  Eigen::Vector3d scan_origin_sum =
      Eigen::Vector3d::Zero();  ///< of the scans, metres: from where they looked
  std::vector<std::string>
      lost_poses;  ///< sentences about files of poses: of lines without one, of metres that are none
  std::set<std::string> placed_sensors;  ///< of the setup: those that scans were of
  /// Of the scans that none of the setup's sensors placed: label and kind, the first of them.
  std::set<std::pair<std::string, std::string>> unplaced_scans;
  bool has_poses_of_scans = false;  ///< the recording places one of them elsewhere than at its origin
  /// A clause for each laser that may call its largest range what it did not see.
  std::vector<std::string> range_spikes;
  std::size_t scans_without_pose = 0;    ///< at their time nothing shows where their sensor was: left out
  std::size_t scans_without_probe = 0;   ///< no image near in time shows the probe: taken as not in the way
  std::size_t scans_probe_hidden = 0;    ///< probe or gripper is not seen for a moment: left out
  std::size_t scans_without_joints = 0;  ///< at their time nothing shows where the robot was: left out
  std::string joint_gap;                 ///< of the first of these: why its joints are not known
  std::size_t scans_refused = 0;         ///< whose origin was outside the map's key range
  StaticBoard::Moves base_moves;         ///< of the base board before a fixed camera
  Probe::Doubts doubts;                  ///< samples that rest on a tag that may have come loose
  double painted_radius = 0.0;           ///< r0 of Chong 2008, eq. 3, metres; mean over the accepted samples
  double smallest_radius = 0.0;          ///< of these, metres
  double largest_bound = 0.0;            ///< how far an accepted centre may be off, metres
  double mean_bound = 0.0;
  double largest_center_sigma = 0.0;  ///< of the accepted samples, worst direction, metres
  double mean_center_sigma = 0.0;
  double mean_reprojection_px = 0.0;  ///< of the probe, accepted samples
  double duration = 0.0;              ///< seconds between first and last frame
  double read_s = 0.0, track_s = 0.0, paint_s = 0.0, insert_s = 0.0;  ///< time spent
};

/// What an image says about the probe, and by what.
struct Sighting {
  const PaintingSample& sample;
  const Setup& setup;       ///< its boards and its probe
  const BoardSetup& base;   ///< that anchors the map frame
  CameraIntrinsics camera;  ///< the setup's, else the recording's
};

/// Hears what a fusion sees, in the order of its work.
class FusionObserver {
 public:
  virtual ~FusionObserver() = default;
  virtual void see(const Sighting& sighting) = 0;
  /// A scan in its place, before anything is taken out of it.
  virtual void see(const Scan& scan) = 0;
};

/// What the ball does at the moment.
struct Brush {
  enum class Use { none, paints, erases };
  Use use = Use::none;
  int volume = 0;  ///< number in the map
};

/// What an image said.
struct SeenImage {
  const Frame& frame;
  const std::vector<TagDetection>& tags;
  const PaintingSample* sample;                       ///< of the ball; null without a probe
  std::optional<Eigen::Isometry3d> map_from_gripper;  ///< the board of the gripper, when it passes acceptance
  double since_start;                                 ///< s
  std::chrono::steady_clock::time_point read;         ///< when the source gave it
};

/// Leads a fusion: instead of the times of the setup's volumes it says when the ball paints, and into which
/// volume. A teaching session is one.
class FusionGuide {
 public:
  virtual ~FusionGuide() = default;
  /// Before the first frame; all three are there until `end`.
  virtual void begin(const Setup& setup, FreeSpaceMap& map, const FusionCounts& counts) = 0;
  /// Before a frame is used, `since_start` seconds after the first one. False ends the fusion there.
  virtual bool before(double since_start) = 0;
  virtual Brush brush() const = 0;
  /// After the ball of an image has painted.
  virtual void see(const SeenImage& image) = 0;
  /// After the last frame. Map and counts are not used afterwards.
  virtual void end() = 0;
};

/// What the caller decides about a fusion; what is left out is the setup's, else the default that is named.
struct FusionOptions {
  std::filesystem::path
      setup_file{};           ///< empty: the setup embedded in the recording (its first comment), if any
  double resolution = 0.0;    ///< metres; 0: the setup's, else 0.02
  std::string integration{};  ///< "safe" or "compatible"; empty: the setup's, else safe
  int threads = 0;  ///< for images and scans, in [1, 64]; 0: the setup's, else the machine's, at most 8
  FusionObserver* observer = nullptr;  ///< may be null
  double camera_seconds = 10.0;        ///< how long a live camera is watched
  FusionGuide* guide = nullptr;        ///< may be null
  std::optional<Setup> setup{};        ///< as read from setup_file, which is then not read again
  bool is_paced =
      false;  ///< frames come at the recording's own pace, and images that come too late are left out
  std::filesystem::path
      frames_file{};  ///< new rawlog that takes every frame before it is used, and keeps them; empty: none
};

/// A recording turned into a map.
struct Fusion {
  Setup setup;
  std::string setup_source;  ///< file, "embedded in the recording" or "none"
  FreeSpaceMap map;
  FusionCounts counts;
  std::optional<std::string>
      damage;  ///< one sentence when the recording is damaged; what came before it is kept
  std::vector<std::string> warnings;
  std::vector<TakenCamera> cameras;  ///< whether pictures were taken as raw or rectified
  RecordingTimeline timeline;        ///< of the images and scans that were used
};

/// Recording -> tag poses -> painted spheres and integrated scans -> one fused map.
/// `recording`: see open_frames.hpp.
/// @throws std::invalid_argument: the recording or setup cannot be used (missing, a probe without boards, no
///         tag seen although a probe is set up, nothing that gets into the map, ...), in one sentence.
Fusion fuse(const std::filesystem::path& recording, const FusionOptions& options,
            const std::function<void(double)>& progress);

}  // namespace clearway

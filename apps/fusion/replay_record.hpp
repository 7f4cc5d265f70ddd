#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "apps/fusion/fusion.hpp"
#include "datasets/bags/mcap_writer.hpp"
#include "planning/path/trajectory.hpp"

namespace clearway {

/// What a replay saw and made, as an MCAP file of ROS 2 messages, in the frame "map":
/// - /tf: "camera" (optical) and "probe", where the base board was seen with them, and each tag by which they
///   were, as FAMILY:ID, as apriltag_ros calls them: where its board's pose puts it;
/// - /poses/camera, /poses/probe: PoseWithCovarianceStamped of accepted images, the noise of their corners;
/// - /camera/camera_info: CameraInfo of each image with the base board, by which viewers draw what it sees;
/// - /scans: each scan in its sensor's axes, PointCloud2, with the sensor's pose in /tf as "scan/LABEL"
/// ("…/2"
///   for another sensor of that label); in "map" where nobody knows where the sensor was; /spheres: what was
///   painted, with the field "radius";
/// - /voxels/STATE: the middles of voxels, with the field "size";
/// - /plans/NAME: JointTrajectory; then all plans one after the other, after the recording: /joint_states,
///   and in /tf the robot's links, as large as the robot is.
class ReplayRecord final : public FusionObserver {
 public:
  /// @throws std::runtime_error naming the file and why it cannot be written, as do the others.
  explicit ReplayRecord(const std::filesystem::path& file);

  void see(const Sighting& sighting) override;
  void see(const Scan& scan) override;

  void add_map(const Snapshot& map);
  void add_plan(const std::string& name, const Robot& robot, const Trajectory& trajectory);
  void finish() { mcap_.finish(); }

 private:
  /// A frame that scans were in, and where it was last.
  struct ScanFrame {
    std::string name;
    double time;
    Eigen::Isometry3d map_from_sensor;
  };
  std::string frame_of(const Scan& scan);

  McapWriter mcap_;
  std::uint16_t transforms_, camera_pose_, probe_pose_, camera_info_, scans_, spheres_, joints_;
  double time_ = 0;                                            ///< s, the last that was seen
  std::map<std::string, std::vector<ScanFrame>> scan_frames_;  ///< by label
};

}  // namespace clearway

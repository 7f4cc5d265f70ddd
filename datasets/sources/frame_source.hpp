#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "datasets/sources/recording.hpp"

namespace clearway {

/// How the pictures of a camera are taken: as its lens bent them, or rectified.
struct TakenCamera {
  std::string sensor;  ///< the label of its frames
  bool is_rectified = false;
  std::string known_by;  ///< what says so, as "its topic's name"; "default": nothing
};

/// Frames in the order they were taken, from whatever holds them.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  /// The next frame, or nothing at the end. Never throws for what a file holds: see `damage`.
  virtual std::optional<Frame> next() = 0;
  /// One sentence about what is damaged and not used, once `next` has met it.
  virtual std::optional<std::string> damage() const = 0;
  /// One sentence for each kind of thing that was left out.
  virtual std::vector<std::string> warnings() const = 0;
  /// One sentence when nothing says the frames' times and they are made up; else "".
  virtual std::string time_caveat() const { return ""; }
  /// The cameras of which the source says how their pictures are taken; others by their frames alone.
  virtual std::vector<TakenCamera> cameras() const { return {}; }
  virtual double progress() const = 0;  ///< how much has been read, 0 to 1
  /// Whether frames come as they are taken: who reads ahead waits for what has not happened yet.
  virtual bool is_live() const { return false; }
};

/// Where a frame of a bag is in another one that does not move against it.
struct StatedFrame {
  std::string parent, child;
  Eigen::Isometry3d parent_from_child = Eigen::Isometry3d::Identity();
};

/// A topic of depth images.
struct DepthTopic {
  std::string name, camera_info;  ///< Image with depths; its CameraInfo, else the setup's camera
};

/// When what a bag's messages say holds: by their stamps, if clocks agree; by their stamps, whatever clocks
/// seem to say; or when they were recorded.
enum class BagTimes { agreeing_stamps, stamps, recording };

/// Which topics of a bag of ROS messages become frames. All may be empty, but not at once.
struct BagTopics {
  std::string images, camera_info;  ///< Image or CompressedImage; its CameraInfo, else the setup's camera
  std::vector<DepthTopic> depth;
  std::optional<bool> rectified, depth_rectified;  ///< whether they are; empty: as the topics' names say
  std::vector<std::string> clouds, scans;          ///< PointCloud2, LaserScan
  std::vector<std::string> parts;  ///< files that the bag's folder should hold; none: not known
  double from = 0.0;               ///< s after its first message was recorded: what was before is not read
  std::optional<double> to = {};   ///< the same: what was recorded then and later; empty: to the end
  BagTimes times = BagTimes::agreeing_stamps;
  std::map<std::string, double> clock_offsets = {};  ///< s, of topics: added to the stamps of their messages
  std::string joint_topic = {};  ///< of the robot's joints, which others read: its clock is to agree, too
  std::string sensor_frame;  ///< where rays of clouds in other frames begin; empty: at the origin of theirs
  bool point_times = true;   ///< points of clouds are where they were seen at their own times
  std::string fixed_frame;   ///< poses of sensors are in it, by tf; empty: sensors do not move
  /// Frame of the moving robot's base, which is taken to stand in the fixed frame; clouds then keep the times
  /// of their points. Empty: no robot.
  std::string robot_base;
  std::vector<std::string> poses;   ///< Odometry, TransformStamped, PoseStamped, …: count as tf does
  std::string pose_frame;           ///< of which these are that name no frame of their own
  std::vector<StatedFrame> frames;  ///< that the bag lacks; its own poses of these children do not count

  /// A stamp as it counts. @param recorded when the message was, s since 1970
  double time_of(const std::string& topic, double stamp, double recorded) const {
    if (times == BagTimes::recording) return recorded;
    const auto offset = clock_offsets.find(topic);
    return offset == clock_offsets.end() ? stamp : stamp + offset->second;
  }
  bool empty() const { return images.empty() && depth.empty() && clouds.empty() && scans.empty(); }
};

/// Whether a topic's name says that its images are rectified: its last part begins with "image_rect"
/// (image_rect, image_rect_color, image_rect_raw, …), possibly before that of a transport
/// ("image_rect/compressed").
inline bool is_named_rectified(const std::string& topic) {
  std::string name = topic;
  for (const char* transport : {"/compressed", "/compressedDepth", "/zstd", "/theora"})
    if (topic.ends_with(transport)) name.resize(topic.size() - std::string(transport).size());
  return name.substr(name.rfind('/') + 1).starts_with("image_rect");
}

/// Whether the images of the bag, or its depth images, are rectified: as the options say, else as the topic's
/// name does. Here, so that setups are read without what reads bags.
inline bool are_images_rectified(const BagTopics& bag) {
  return bag.rectified.value_or(is_named_rectified(bag.images));
}
inline bool is_depth_rectified(const BagTopics& bag, const DepthTopic& depth) {
  return bag.depth_rectified.value_or(is_named_rectified(depth.name));
}

/// How depth pictures become points, and where they were taken from.
struct DepthOptions {
  std::optional<double> scale = {};  ///< m per step of the stored number; empty: 0.001, or TUM's of its files
  double max_range = 0;              ///< m, of the sensor; 0: not known
  std::optional<CameraIntrinsics> camera;  ///< of the depth pictures; empty: the setup's camera
  std::filesystem::path camera_file;       ///< where `camera` is from, if it was found in the folder
  std::filesystem::path mount_file;     ///< the setup's file of `camera`, which may say where it is on a body
  std::filesystem::path scale_file;     ///< the setup's camera file, which may say `scale` of a folder's
  std::string scale_camera;             ///< the one of several cameras in it
  std::optional<double> scale_of_file;  ///< what a camera's file says of `scale`; others come before
  std::string scale_note;  ///< what is to be told where that counts; without it, why the file's cannot be
  bool rectified = false;  ///< pictures of a folder were freed of the lens's distortion
  std::filesystem::path poses;            ///< TUM text, world_from_camera; empty: what lies in the folder
  double tolerance = 0.02;                ///< s between a picture and a pose
  std::optional<double> pose_scale = {};  ///< m per unit of COLMAP's poses, which have none of their own
};

/// In whose frame the points of .pcd and .ply files are; their viewpoints say where the sensor was.
enum class CloudFrameOf { map, sensor };

/// What a setup says of the source it belongs to.
struct SourceOptions {
  std::optional<double> rate;  ///< pictures a second, in the order of their names: there are no other times
  std::optional<CameraIntrinsics> camera;  ///< of the setup; what pictures were taken with
  BagTopics bag = {};
  DepthOptions depth;
  std::optional<CloudFrameOf> clouds = {};  ///< empty: the map's, with a warning where viewpoints are turned
  bool clear_infinite = false;              ///< beams of 2D lasers that say +inf free space up to their range
  double no_return =
      0.0;  ///< m, 2D lasers: readings of so much or more say that nothing came back; 0: none does
  double resolution = 0.02;                   ///< m, of the map: what a sensor may move while it sweeps once
  double camera_seconds = 10.0;               ///< how long a live camera is watched
  std::vector<std::string> placed;            ///< sensors, or kinds of clouds, whose place the setup says
  bool places_depth = false;                  ///< the setup's sensors say where the sensor "depth" is
  std::filesystem::path numbered_poses = {};  ///< of `sensors`, without times: for a folder of KITTI's scans
  std::vector<std::string> notes = {};        ///< sentences about these options that are to be told
};

}  // namespace clearway

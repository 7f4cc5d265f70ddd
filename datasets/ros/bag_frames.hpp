#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "datasets/ros/bag_clocks.hpp"
#include "datasets/ros/left_out.hpp"
#include "datasets/ros/message_bag.hpp"
#include "datasets/ros/ros_camera.hpp"
#include "datasets/ros/sensor_frames.hpp"
#include "datasets/ros/transform_faults.hpp"
#include "datasets/ros/transform_tree.hpp"
#include "datasets/sources/frame_source.hpp"

namespace clearway {

/// Makes frames of a bag's messages: reads it once for transforms, cameras and the stamps of what sensors
/// saw, and once more, in the order of these stamps, for what they saw.
class BagFrames {
 public:
  /// @throws std::runtime_error a clause: a camera_info topic has no message that can be used.
  /// @throws ContradictoryBag a clause: its clock starts again, or where a sensor is cannot be told
  /// (refuse_contradictions).
  BagFrames(MessageBag& bag, const SourceOptions& options);

  void visit(const std::function<void(const Frame&)>& take);

  /// After visit: one clause for each kind of thing that was left out.
  std::vector<std::string> left_out() const;
  /// After visit: one clause about messages that end early; empty: there is none.
  std::string damage() const { return account_.damage(); }

 private:
  struct DepthSensor {
    std::optional<RosCamera> camera;
    std::vector<Eigen::Vector2d> rays;  ///< of the camera
    std::optional<double> step;         ///< m, where the setup or the bag states it
    std::string units;                  ///< the topic that does
  };
  /// Of the transforms beyond the part that is wanted, those within a gap's reach of what sensors saw, if
  /// they came as late as that did: others are of another run of the clock.
  void add_beyond();
  bool is_sensor(const BagTopic& topic) const;
  bool is_pose(const BagTopic& topic) const;
  /// Those of tf, or a pose as one, but of frames that the setup states.
  std::vector<RosTransform> transforms_in(const BagMessage& message) const;
  /// A path's poses. @throws std::runtime_error a clause, where they do not say when they are
  std::vector<RosTransform> path_in(const BagMessage& message) const;
  void learn();
  /// @throws ContradictoryBag where clocks of what is read differ. @param poses of the streams of `clocks`,
  /// those of poses and the frames that they are of
  void refuse_clocks(const BagClocks& clocks, const std::map<std::string, std::string>& poses);
  void learn_camera(const std::string& topic, const RosCameraInfo& info);
  void learn_step(const BagTopic& topic, double step);
  bool is_camera(const BagTopic& topic) const;
  /// Whether a topic states the steps of a depth topic of which nothing did.
  bool tells_step(const BagTopic& topic) const;
  /// When a message of this topic counts, s.
  double time_in(const std::string& topic, const RosHeader& header, double recorded) const;
  RosLaserScan laser_scan_in(WireReader& in) const;
  /// What a sensor saw: one frame, or the parts of a sweep.
  std::vector<Frame> frames_in(const BagMessage& message);
  Frame frame_of(const BagMessage& message);
  Eigen::Isometry3d pose_of(const std::string& frame, double time, double recorded) const;
  std::vector<Frame> frames_of_cloud(const BagMessage& message);
  /// A cloud's points at their own times while the sensor moves, which is noted; empty: it is one frame.
  /// @param tf_frame of the cloud's header
  std::vector<Frame> parts_in_time(PointTimes seen, const std::string& tf_frame, const Frame& frame,
                                   double recorded);
  /// Places a cloud: rays begin at its frame's origin, or at that of the setup's `sensor_frame`.
  /// @param world_from_cloud by the frame of its header
  void place(CloudFrame& cloud, const std::string& topic, const RosHeader& header,
             Eigen::Isometry3d world_from_cloud, double recorded);
  /// Says of a cloud that nobody knows where its rays began, where that is so.
  void note_origin(CloudFrame& cloud, const std::string& topic, const RosHeader& header, double recorded);
  /// What hangs on the frame of a cloud or scan.
  const MountedFrames& mounted_at(const RosHeader& header, double recorded);
  /// Whether a scan goes round in the frame of a body on which lasers are mounted elsewhere: programs merge
  /// several lasers' scans so (ira_laser_tools).
  bool is_merged(const RosLaserScan& scan, const std::string& topic, double recorded);
  /// As `place`. What met nothing in a merged scan counts only where `sensor_frame` is its own.
  void place_merged(CloudFrame& cloud, const std::string& topic, const RosHeader& header, double recorded);
  /// Whether a cloud is in the frame of a body, on which sensors are mounted elsewhere; a note tells that,
  /// and where another frame has such sensors.
  bool is_bodys(const std::string& topic, const RosHeader& header, double recorded);
  /// Whether a frame of clouds is none of a sensor, so that their rays began elsewhere.
  bool is_no_sensors(const std::string& frame) const;
  /// Whether the setup says where a sensor is. @param kind of its clouds
  bool is_placed(const std::string& topic, const char* kind) const;
  /// Whether neither the setup nor transforms say where some sensor of points is.
  bool takes_sensors_to_stand() const;
  /// The end of the clause that says that a frame has no pose.
  std::string why_unknown(const std::string& frame, double time) const;

  MessageBag& bag_;
  const SourceOptions& options_;
  std::vector<bool> read_, sensors_;  ///< whether a topic is read; whether it is a sensor's
  std::vector<double> stamps_;        ///< s, of the sensors' messages in the bag's order
  std::vector<double> delays_;        ///< s, from these to when they were recorded
  std::vector<std::pair<RosTransform, double>> beyond_;  ///< transforms and when they were recorded
  /// The last path of each topic: it is the whole way, as it is known then; and when it was recorded.
  std::map<std::string, std::pair<std::vector<RosTransform>, double>> paths_;
  std::set<std::string> sensor_frames_;  ///< that headers of sensors' messages name
  TransformTree transforms_;
  std::optional<RosCamera> camera_;               ///< where images have one
  std::map<std::string, DepthSensor> depth_;      ///< of each topic of depth
  std::map<std::string, bool> no_sensors_;        ///< of a cloud's frame: is_no_sensors
  std::map<std::string, MountedFrames> mounted_;  ///< of a cloud's frame: mounted_on
  std::set<std::string> odometry_frames_;         ///< in which odometry says where something is
  std::vector<std::string> clock_notes_;          ///< clauses about clocks that may differ
  LeftOut account_;
};

}  // namespace clearway

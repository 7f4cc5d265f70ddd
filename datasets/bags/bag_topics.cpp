#include "datasets/bags/bag_topics.hpp"

#include <algorithm>
#include <stdexcept>

#include "datasets/bags/bag_files.hpp"
#include "datasets/sources/lens.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

std::string list_of(const std::vector<BagTopic>& topics) {
  std::string list;
  constexpr std::size_t enough = 12;
  for (std::size_t i = 0; i < std::min(topics.size(), enough); ++i)
    list += (i > 0 ? ", " : "") + quote(topics[i].name) + " (" + quote(topics[i].type) + ")";
  if (topics.size() > enough) list += " and " + std::to_string(topics.size() - enough) + " more";
  return list.empty() ? "no topic" : list;
}

/// Refuses a camera of the setup that would undo the distortion of rectified images once more.
/// @param kind of the keys in 'source: bag:'
void refuse_distortion(const std::filesystem::path& file, const std::string& topic,
                       const std::optional<CameraIntrinsics>& camera, const std::string& kind) {
  if (!camera || !has_distortion(*camera)) return;
  throw std::invalid_argument(bag_sentence(
      file, "has rectified images in topic " + quote(topic) + ", by its name or '" + kind +
                "rectified', and the setup's camera has a distortion; expected the rectified camera "
                "without it, '" +
                kind + "camera_info' in place of it, or '" + kind + "rectified: false' in 'source: bag:'"));
}

}  // namespace

std::vector<TakenCamera> taken_cameras(const BagTopics& bag) {
  std::vector<TakenCamera> cameras;
  const auto add = [&](const std::string& topic, bool is_rectified, bool is_stated, const char* key) {
    if (topic.empty()) return;
    cameras.push_back(
        {topic, is_rectified, is_stated ? "'" + std::string(key) + "' of the setup" : "its topic's name"});
  };
  add(bag.images, are_images_rectified(bag), bag.rectified.has_value(), "rectified");
  for (const DepthTopic& depth : bag.depth)
    add(depth.name, is_depth_rectified(bag, depth), bag.depth_rectified.has_value(), "depth_rectified");
  return cameras;
}

void require_topic(const std::filesystem::path& file, const std::vector<BagTopic>& topics,
                   const std::string& name, const std::string& by, const std::vector<std::string>& types) {
  const auto found =
      std::find_if(topics.begin(), topics.end(), [&](const BagTopic& topic) { return topic.name == name; });
  const std::string named = " topic " + quote(name) + ", which '" + by + "' of the setup names";
  if (found == topics.end())
    throw std::invalid_argument(bag_sentence(file, "has no" + named + "; it has " + list_of(topics)));
  if (std::find(types.begin(), types.end(), found->type) == types.end())
    throw std::invalid_argument(
        bag_sentence(file, "has " + quote(found->type) + " in" + named + "; expected " + types.front()));
  if (!found->wire)
    throw std::invalid_argument(
        bag_sentence(file, "encodes" + named + ", in another way than CDR and ROS 1, which are known here"));
}

void require_topics(const std::filesystem::path& file, const std::vector<BagTopic>& topics,
                    const SourceOptions& options) {
  const auto require = [&](const std::string& name, const char* key, const std::vector<std::string>& types) {
    if (!name.empty()) require_topic(file, topics, name, std::string("source: bag: ") + key, types);
  };
  const BagTopics& bag = options.bag;
  if (bag.empty())
    throw std::invalid_argument(
        bag_sentence(file,
                     "has several topics and the setup names none: expected 'source: bag:' with 'images', "
                     "'depth', 'clouds' or 'scans'; it has " +
                         list_of(topics)));
  require(bag.images, "images", {"sensor_msgs/Image", "sensor_msgs/CompressedImage"});
  require(bag.camera_info, "camera_info", {"sensor_msgs/CameraInfo"});
  for (const DepthTopic& depth : bag.depth) {
    require(depth.name, "depth", {"sensor_msgs/Image", "sensor_msgs/CompressedImage"});
    require(depth.camera_info, "depth_camera_info", {"sensor_msgs/CameraInfo"});
  }
  for (const std::string& name : bag.clouds)
    require(name, "clouds",
            {"sensor_msgs/PointCloud2", "livox_ros_driver/CustomMsg", "livox_ros_driver2/CustomMsg",
             "livox_interfaces/CustomMsg"});
  for (const std::string& name : bag.scans) require(name, "scans", {"sensor_msgs/LaserScan"});
  for (const std::string& name : bag.poses) {
    require(name, "poses",
            {"nav_msgs/Odometry", "geometry_msgs/TransformStamped", "geometry_msgs/PoseStamped",
             "geometry_msgs/PoseWithCovarianceStamped", "nav_msgs/Path"});
    const bool is_nameless = std::any_of(topics.begin(), topics.end(), [&](const BagTopic& topic) {
      return topic.name == name &&
             (topic.type.starts_with("geometry_msgs/Pose") || topic.type == "nav_msgs/Path");
    });
    if (is_nameless && bag.pose_frame.empty())
      throw std::invalid_argument(bag_sentence(
          file, "does not say of which frame the poses in topic " + quote(name) +
                    " are: expected 'pose_frame' beside 'poses' in 'source: bag:' of the setup"));
  }
  if (!bag.images.empty() && bag.camera_info.empty() && !options.camera)
    throw std::invalid_argument(
        bag_sentence(file, "needs the camera of topic " + quote(bag.images) +
                               ": expected 'camera_info' in 'source: bag:' or 'camera:' in the setup"));
  const auto& camera = options.depth.camera ? options.depth.camera : options.camera;
  for (const DepthTopic& depth : bag.depth) {
    if (!depth.camera_info.empty()) continue;
    if (camera && is_depth_rectified(bag, depth)) refuse_distortion(file, depth.name, camera, "depth_");
    if (camera) continue;
    throw std::invalid_argument(
        bag_sentence(file, "needs the camera of topic " + quote(depth.name) +
                               ": expected 'depth_camera_info' in 'source: bag:', or 'camera' of 'depth' "
                               "in 'source:', in the setup"));
  }
  if (!bag.images.empty() && are_images_rectified(bag))
    refuse_distortion(file, bag.images, options.camera, "");
}

}  // namespace clearway

#include "apps/fusion/board_poses.hpp"

#include <gtest/gtest.h>

#include "tests/worlds/tag_scene.hpp"

namespace clearway {
namespace board_poses_test {

/// A base of six tags that stands in the map, a cart of six that carries a lidar, a camera that stands still.
struct Room {
  Setup setup = parse_setup(text(), "setup.yaml");
  Camera camera = scene::plain_camera();
  TagBody base = scene::board("base", 0, 3, 2, 0.06, 0.09), cart = scene::board("cart", 20, 3, 2, 0.06, 0.09);
  Eigen::Isometry3d camera_from_base = scene::tag_before_camera(0.7, 0.6, 0.2, 0.0, -0.15, 0.06);
  std::mt19937 random{5};

  static std::string tags(int first) {
    std::string text;
    for (const auto& [id, tag] : scene::board("any", first, 3, 2, 0.06, 0.09).tags) {
      const Eigen::Vector3d at = tag.body_from_tag.translation();
      text += "      - {id: " + std::to_string(id) + ", size: 0.06, pose: [" + std::to_string(at.x()) + ", " +
              std::to_string(at.y()) + ", 0, 0, 0, 0]}\n";
    }
    return text;
  }

  static std::string text() {
    return "map: {resolution: 0.01}\nboards:\n  - name: base\n    map_from_board: [1, 0.5, 0.1, 0, 0, 0.4]\n "
           "   "
           "tags:\n" +
           tags(0) + "  - name: cart\n    tags:\n" + tags(20) +
           "sensors:\n  - {name: lidar, board: cart, pose: [0, 0, 0.2, 0, 0, 0], max_gap: 0.3}\n";
  }

  /// The cart rolls sideways with its time.
  static Eigen::Isometry3d camera_from_cart(double time) {
    return scene::tag_before_camera(0.8, 0.7, 2.5, 0.3, 0.1 + 0.05 * time, -0.04);
  }

  Eigen::Isometry3d map_from_cart(double time) const {
    return *setup.board("base")->map_from_board * camera_from_base.inverse() * camera_from_cart(time);
  }

  /// @param bend pixels by which three tags of the cart are off, each at another corner
  void take(BoardPoses& poses, double time, bool sees_cart, double bend = 0.0) {
    std::vector<scene::PlacedTag> tags = scene::placed(base, camera_from_base);
    const std::size_t of_base = tags.size();
    if (sees_cart)
      for (const scene::PlacedTag& tag : scene::placed(cart, camera_from_cart(time))) tags.push_back(tag);
    std::vector<TagDetection> seen = scene::noisy_detections(camera, tags, 0.05, random);
    for (std::size_t i = 0; sees_cart && i < 3; ++i) seen[of_base + i].corners[i].x() += bend;
    ImageFrame image;
    image.intrinsics = setup.camera.value_or(image.intrinsics);
    image.intrinsics.width = camera.width, image.intrinsics.height = camera.height;
    image.intrinsics.fx = camera.fx, image.intrinsics.fy = camera.fy;
    image.intrinsics.cx = camera.cx, image.intrinsics.cy = camera.cy;
    Frame frame;
    frame.time = time;
    poses.take(frame, image, seen, nullptr);
  }
};

TEST(BoardPoses, a_board_that_carries_a_sensor_is_where_the_images_around_see_it) {
  Room room;
  BoardPoses poses(room.setup);
  ASSERT_TRUE(poses.are_needed());
  for (const double time : {1.0, 1.2, 1.6}) room.take(poses, time, true);
  for (const double time : {1.0, 1.1, 1.2, 1.6}) {
    const auto at = poses.at("cart", time);
    ASSERT_TRUE(at) << time;
    EXPECT_LT((at->translation() - room.map_from_cart(time).translation()).norm(), 0.003) << time;
  }
  EXPECT_FALSE(poses.at("cart", 1.4));  // 0.4 s lie between the images
  EXPECT_FALSE(poses.at("cart", 0.9));
}

TEST(BoardPoses, an_image_that_bends_the_board_says_nothing_of_it) {
  Room room;
  BoardPoses poses(room.setup);
  room.take(poses, 1.0, true);
  room.take(poses, 1.1, true, 12.0);
  room.take(poses, 1.2, true);
  EXPECT_EQ(poses.around("cart", 1.1).before, 1.0);
  EXPECT_EQ(poses.around("cart", 1.1).after, 1.2);
}

TEST(BoardPoses, a_scan_waits_for_images_that_may_still_show_its_board) {
  Room room;
  BoardPoses poses(room.setup);
  room.take(poses, 1.0, true);
  EXPECT_TRUE(poses.is_settled("cart", 1.0));
  EXPECT_FALSE(poses.is_settled("cart", 1.05));
  room.take(poses, 1.3, false);
  EXPECT_FALSE(poses.is_settled("cart", 1.05));  // one at 1.35 might see it, 0.3 s after the last that did
  room.take(poses, 1.4, false);
  EXPECT_TRUE(poses.is_settled("cart", 1.05));
  EXPECT_FALSE(poses.is_settled("cart", 1.05, 0.5));
  poses.finish();
  EXPECT_TRUE(poses.is_settled("cart", 1.05, 0.5));
}

}  // namespace board_poses_test
}  // namespace clearway

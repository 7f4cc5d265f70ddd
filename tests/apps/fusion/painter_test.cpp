// What a setup states of errors reaches the tracking, and a brush that erases takes away all that it may have
// touched.
#include "apps/fusion/painter.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tracking/tag_pose.hpp"

namespace clearway {
namespace painter_test {

CameraIntrinsics pinhole() {
  CameraIntrinsics camera;
  camera.width = 640, camera.height = 480;
  camera.fx = camera.fy = 600.0;
  camera.cx = 320.0, camera.cy = 240.0;
  return camera;
}

TEST(TrackingErrors, EachThatASetupStatesOfItsBoardsReplacesItsOwnDefault) {
  const TagErrors usual;
  const auto errors = [](const BoardErrorsSetup& stated) {
    BoardSetup board;
    board.errors = stated;
    const TagErrors found = tag_body(board).errors;
    return std::array{found.scale, found.size, found.place, found.turn};
  };
  EXPECT_EQ(errors({}), (std::array{usual.scale, usual.size, usual.place, usual.turn}));
  EXPECT_EQ(errors({0.1, {}, {}, {}}), (std::array{0.1, usual.size, usual.place, usual.turn}));
  EXPECT_EQ(errors({{}, 0.2, {}, {}}), (std::array{usual.scale, 0.2, usual.place, usual.turn}));
  EXPECT_EQ(errors({{}, {}, 0.3, {}}), (std::array{usual.scale, usual.size, 0.3, usual.turn}));
  EXPECT_EQ(errors({{}, {}, {}, 0.4}), (std::array{usual.scale, usual.size, usual.place, 0.4}));
}

TEST(TrackingErrors, EachThatASetupStatesOfItsCameraReplacesItsOwnDefault) {
  const CameraErrors usual;
  const auto errors = [](const CameraErrorsSetup& stated) {
    const CameraErrors found = tracking_camera(pinhole(), stated).errors;
    return std::array{found.focal, found.aspect, found.center, found.distortion.value_or(-1.0)};
  };
  EXPECT_EQ(errors({}), (std::array{usual.focal, usual.aspect, usual.center, -1.0}));
  EXPECT_EQ(errors({0.1, {}, {}, {}}), (std::array{0.1, usual.aspect, usual.center, -1.0}));
  EXPECT_EQ(errors({{}, 0.2, {}, {}}), (std::array{usual.focal, 0.2, usual.center, -1.0}));
  EXPECT_EQ(errors({{}, {}, 3.0, {}}), (std::array{usual.focal, usual.aspect, 3.0, -1.0}));
  EXPECT_EQ(errors({{}, {}, {}, 0.4}), (std::array{usual.focal, usual.aspect, usual.center, 0.4}));
}

BoardSetup board(const std::string& name, int first, double size) {
  BoardSetup board;
  board.name = name;
  for (int i = 0; i < 4; ++i) {
    TagSetup& tag = board.tags.emplace_back();
    tag.id = first + i;
    tag.size = size;
    tag.board_from_tag.translation() << 1.3 * size * (i % 2 - 0.5), 1.3 * size * (i / 2 - 0.5), 0.0;
  }
  return board;
}

/// The corners of a board's tags as the camera sees them.
void see(const Camera& camera, const BoardSetup& board, const Eigen::Isometry3d& camera_from_board,
         std::vector<TagDetection>& seen) {
  for (const TagSetup& tag : board.tags) {
    TagDetection& detection = seen.emplace_back();
    detection.id = tag.id;
    const auto corners = tag_corners(tag.size);
    for (std::size_t i = 0; i < 4; ++i)
      detection.corners[i] = *camera.project(camera_from_board * tag.board_from_tag * corners[i]);
  }
}

/// A board and a tool with a ball before a camera at rest.
struct PaintersStage {
  clearway::Setup setup;
  ImageFrame image;
  Eigen::Isometry3d camera_from_base{Eigen::AngleAxisd(M_PI + 0.5, Eigen::Vector3d::UnitX())};
  Eigen::Isometry3d camera_from_tool = camera_from_base;

  PaintersStage() {
    setup.boards = {board("base", 0, 0.1), board("tool", 10, 0.05)};
    setup.boards[0].map_from_board = Eigen::Isometry3d::Identity();
    setup.probe = ProbeSetup{};
    setup.probe->board = "tool";
    setup.probe->ball_radius = 0.04;
    setup.probe->ball_center << 0.0, 0.0, -0.05;
    setup.volumes = {{"all", {"base"}, 0.0}};
    image.image = {640, 480, std::vector<std::uint8_t>(640 * 480, 128)};
    image.intrinsics = pinhole();
    camera_from_base.translation() << -0.15, 0.0, 0.8;
    camera_from_tool.translation() << 0.15, 0.0, 0.6;
  }

  std::vector<TagDetection> seen() const {
    const Camera camera = camera_of(setup, image);
    std::vector<TagDetection> seen;
    see(camera, setup.boards[0], camera_from_base, seen);
    see(camera, setup.boards[1], camera_from_tool, seen);
    return seen;
  }

  Frame frame(double time) const { return {time, "camera", image, {}}; }
};

/// A large painted ball shrinks until it does not touch the eraser: by how much says how large that was.
TEST(Painter, ABrushErasesTheWholeBallAndWhatItMayBeOff) {
  PaintersStage stage;
  FreeSpaceMap map({.resolution = 0.02});
  const int volume = map.add_volume("all", {"base"});
  FusionCounts counts;
  Painter painter(stage.setup, map, counts);
  const Sphere painted{Eigen::Vector3d(0.0, 0.0, -0.3), 0.5};
  map.paint(volume, painted, 0.0);
  const TrackedImage tracked =
      painter.take(stage.frame(1.0), stage.image, stage.seen(), 1.0, Brush{Brush::Use::erases, volume});
  const PaintingSample& sample = tracked.sample;
  ASSERT_TRUE(sample.accepted) << sample.reason;
  EXPECT_GT(sample.bound.total, 1e-4);
  const Eigen::Isometry3d base_from_tool = stage.camera_from_base.inverse() * stage.camera_from_tool;
  EXPECT_LT((sample.sphere.center - base_from_tool * stage.setup.probe->ball_center).norm(), 1e-3);
  ASSERT_EQ(map.volumes()[0].spheres.size(), 1U);
  const Sphere& left = map.volumes()[0].spheres[0];
  const double eraser = (left.center - sample.sphere.center).norm() - left.radius;
  EXPECT_NEAR(eraser, 0.04 + sample.bound.total, 1e-6);
}

TEST(Painter, TellsHowManySamplesRestOnATagThatMayHaveComeLoose) {
  PaintersStage stage;
  FreeSpaceMap map({.resolution = 0.02});
  map.add_volume("all", {"base"});
  FusionCounts counts;
  Painter painter(stage.setup, map, counts);
  double time = 0.0;
  const auto show = [&](const std::set<int>& ids) {
    auto seen = stage.seen();
    std::erase_if(seen, [&](const TagDetection& tag) { return tag.id >= 10 && !ids.contains(tag.id); });
    time += 0.1;
    painter.take(stage.frame(time), stage.image, seen, time, std::nullopt);
  };
  for (int i = 0; i < 4; ++i) show({12});  // the first is unconfirmed
  stage.setup.boards[1].tags[2].board_from_tag.translation().x() +=
      0.015;  // tag 12, not as the painter has it
  for (int i = 0; i < 3; ++i) show({11, 12});
  painter.finish();
  EXPECT_EQ(counts.spheres, 3U);
  EXPECT_EQ(counts.doubts.samples, 3);
  EXPECT_EQ(counts.doubts.tags, std::set<int>{12});
}

}  // namespace painter_test
}  // namespace clearway

#include "apps/teach/teach_picture.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/tag_scene.hpp"
#include "tests/worlds/taught_planar.hpp"

namespace clearway {
namespace teach_picture_test {

/// A camera above the plane of a two-link arm, an arm's length away.
TeachView view_of_arm() {
  TeachView view;
  view.image = cv::Mat(240, 320, CV_8UC1, cv::Scalar(120));
  view.camera = Camera{320, 240, 100.0, 100.0, 159.5, 119.5, {}};
  Eigen::Isometry3d camera_from_map = Eigen::Isometry3d::Identity();
  camera_from_map.linear() << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  camera_from_map.translation() = Eigen::Vector3d(0, 0, 3);
  view.camera_from_map = camera_from_map;
  view.resolution = 0.05;
  auto volumes = std::make_shared<std::vector<PaintedVolume>>(1);
  volumes->front().label = "tool";
  volumes->front().spheres = {{{0.8, 0.5, 0.0}, 0.3}};
  view.volumes = volumes;
  view.volume = "tool";
  return view;
}

cv::Vec3b at(const cv::Mat& picture, const TeachView& view, const Eigen::Vector3d& point) {
  const auto pixel = view.camera.project(*view.camera_from_map * point);
  return picture.at<cv::Vec3b>(static_cast<int>(std::lround(pixel->y())),
                               static_cast<int>(std::lround(pixel->x())));
}

const cv::Vec3b grey(120, 120, 120);

TEST(TeachPicture, ShowsThePaintAndTheRobotWhereTheyAre) {
  TeachView view = view_of_arm();
  const auto robot = std::make_shared<const Robot>(load_robot("planar2"));
  view.robot = robot;
  view.robot_pose = forward_kinematics(*robot, Configuration::Zero(2));
  TeachPainter painter(1);
  const cv::Mat picture = painter.draw(view);
  EXPECT_NE(at(picture, view, {0.8, 0.5, 0.0}), grey);  // paint
  EXPECT_NE(at(picture, view, {0.5, 0.0, 0.0}), grey);  // upper arm
  EXPECT_EQ(at(picture, view, {-0.5, 0.5, 0.0}), grey);
  view.volumes = nullptr;  // as before
  EXPECT_EQ(cv::norm(painter.draw(view), picture, cv::NORM_INF), 0.0);
  auto none = std::make_shared<std::vector<PaintedVolume>>(1);
  none->front().label = "tool";
  view.volumes = none;  // the stroke was undone
  EXPECT_EQ(at(painter.draw(view), view, {0.8, 0.5, 0.0}), grey);
}

TEST(TeachPicture, WhileAHandChoosesThePaintIsDotsThatAreRedOutside) {
  TeachView view = view_of_arm();
  view.is_led = true;
  view.state = TeachState::selecting;
  TeachPainter painter(1);
  const cv::Vec3b inside = at(painter.draw(view), view, {0.8, 0.5, 0.0});
  EXPECT_EQ(at(painter.draw(view), view, {0.8, 0.65, 0.0}), grey);
  view.warning = "tool leaves its painted volume";
  const cv::Vec3b outside = at(painter.draw(view), view, {0.8, 0.5, 0.0});
  EXPECT_GT(outside[2], 180);
  EXPECT_LT(outside[1], 60);
  EXPECT_NE(inside, outside);
  for (const TeachState planned : {TeachState::planned, TeachState::approved}) {
    view.state = planned;
    EXPECT_EQ(at(painter.draw(view), view, {0.8, 0.5, 0.0}), outside);
  }
  view.state = TeachState::painting;
  EXPECT_NE(at(painter.draw(view), view, {0.8, 0.65, 0.0}), grey);  // the volume itself
}

TEST(TeachPicture, WithoutTheCamerasPoseItIsTheImageWithTheStrip) {
  TeachView view = view_of_arm();
  view.camera_from_map.reset();
  const cv::Mat picture = TeachPainter(1).draw(view);
  cv::Mat upper;
  cv::extractChannel(picture.rowRange(0, 150), upper, 0);
  EXPECT_EQ(cv::norm(upper, view.image.rowRange(0, 150), cv::NORM_INF), 0.0);
  cv::Mat lower;
  cv::extractChannel(picture.rowRange(215, 240), lower, 0);
  EXPECT_GT(cv::norm(lower, view.image.rowRange(215, 240), cv::NORM_INF), 50.0);
}

/// A session as a camera sees it that looks down at the base board.
class TeachViewerOf : public worlds::TeachSessionOf {
 protected:
  TeachViewerOf() {
    const Camera camera = scene::plain_camera();
    setup_.camera = CameraIntrinsics{camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy};
    const TagBody tags = scene::board("table", 0, 3, 2, 0.1, 0.14);
    BoardSetup board;
    board.name = "table";
    board.map_from_board = Eigen::Isometry3d::Identity();
    for (const auto& [id, tag] : tags.tags) board.tags.push_back({id, tag.size, tag.body_from_tag});
    setup_.boards = {board};
    session_.begin(setup_, map_, counts_);
    camera_from_map_.linear() << 1, 0, 0, 0, -1, 0, 0, 0, -1;
    camera_from_map_.translation() = Eigen::Vector3d(0, 0, 1.5);
    std::mt19937 random(1);
    tags_ = scene::noisy_detections(camera, scene::placed(tags, camera_from_map_), 0.05, random);
    image_.image = {camera.width, camera.height,
                    std::vector<std::uint8_t>(static_cast<std::size_t>(camera.width * camera.height), 120)};
  }
  TeachView view(const std::vector<TagDetection>& tags) {
    const Frame frame;
    return viewer_.view({frame, tags, nullptr, {}, time_, {}}, image_);
  }

  Eigen::Isometry3d camera_from_map_ = Eigen::Isometry3d::Identity();
  std::vector<TagDetection> tags_;
  ImageFrame image_;
  TeachViewer viewer_{session_, setup_, map_, counts_};
};

TEST_F(TeachViewerOf, ConflictsAreDrawnAsTheStrokeEndsAndGoAsItIsUndone) {
  Scan scan;
  scan.map_from_sensor.translation() = Eigen::Vector3d(0, 0, 2);
  scan.points = {{0.51F, 0.51F, -2.0F}};
  map_.insert(scan);
  ++counts_.scans_inserted;
  ASSERT_TRUE(view(tags_).sensed);
  EXPECT_FALSE(view(tags_).sensed);  // as before
  paint_everything();
  time_ -= 1.9;  // no second has passed
  TeachView painted = view(tags_);
  ASSERT_TRUE(painted.sensed);
  EXPECT_EQ(painted.sensed->counts().conflict, 1U);
  EXPECT_TRUE(painted.refusal.starts_with("paint_off: 1 painted voxel is where")) << painted.refusal;
  time_ -= 0.9;
  ASSERT_EQ(act(TeachAction::undo), "");
  time_ -= 0.05;
  const TeachView undone = view(tags_);
  ASSERT_TRUE(undone.sensed);
  EXPECT_EQ(undone.sensed->counts().conflict, 0U);
}

TEST_F(TeachViewerOf, WithoutAProbeTheBaseBoardPlacesTheCamera) {
  setup_.probe.reset();
  const TeachView seen = view(tags_);
  ASSERT_TRUE(seen.camera_from_map);
  EXPECT_TRUE(seen.camera_from_map->isApprox(camera_from_map_, 1e-2));
  EXPECT_FALSE(seen.offer.probe);
  EXPECT_EQ(seen.refusal, "");
  const TeachView hidden = view({});
  EXPECT_FALSE(hidden.camera_from_map);
  EXPECT_EQ(hidden.refusal, "Nothing is drawn: the base board 'table' is not seen");
  EXPECT_EQ(hidden.cure, "Keep the fixed board in view.");
}

TEST_F(TeachViewerOf, AFixedCameraStaysWhereTheBaseBoardWasSeenLast) {
  setup_.acceptance.fixed_camera = true;
  EXPECT_FALSE(view({}).camera_from_map);
  const TeachView seen = view(tags_), hidden = view({});
  ASSERT_TRUE(hidden.camera_from_map);
  EXPECT_EQ(hidden.camera_from_map->matrix(), seen.camera_from_map->matrix());
  EXPECT_EQ(hidden.refusal, "");
}

TEST_F(TeachViewerOf, APartThatHasToStayInPaintIsDrawnAsACriticalOne) {
  TeachEvent event;
  event.time = ++time_;
  event.action = TeachAction::robot;
  event.robot.robot = "planar2";
  event.robot.policies = {"forearm=known_free", "upper_arm=painted"};
  due_ = {event};
  session_.before(time_);
  EXPECT_EQ(view(tags_).robot->critical_parts, std::vector<std::string>{"upper_arm"});
}

TEST(TeachPicture, TheStateIsOneLine) {
  TeachView view = view_of_arm();
  view.since_start = 12.34;
  view.balls = 56;
  view.state = TeachState::painting;
  EXPECT_EQ(state_line(view), "12.3 s, painting, volume tool, 56 balls");
  view.balls = 1;
  EXPECT_EQ(state_line(view), "12.3 s, painting, volume tool, 1 ball");
}

}  // namespace teach_picture_test
}  // namespace clearway

// Raw and rectified pictures of one scene, drawn from its truth each by its own camera (nothing is rectified
// by code), in ROS 1 bags and MCAP: the tags' poses and the map must be the same, and true.

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/calib3d.hpp>
#include <set>

#include "apps/fusion/painter.hpp"
#include "mapping/files/map_file.hpp"
#include "tests/apps/run_command.hpp"
#include "tests/worlds/bags/camera_bag.hpp"
#include "tests/worlds/tag_scene.hpp"

namespace clearway {
namespace rectified_bags_test {

using Json = nlohmann::json;
using worlds::BagCameraInfo;
using worlds::CameraBag;

/// Of a raw camera, how its images are rectified: turned by R, through the pinhole P.
struct Rig {
  Camera raw, rectified;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();  ///< R
  double tag = 0.06;                                   ///< size of the tags before it
  double tolerance = 0.001;                            ///< m, of a tag half a metre away

  BagCameraInfo info() const {
    BagCameraInfo info;
    info.width = 640;
    info.height = 480;
    info.model = raw.lens == LensDistortion::Model::fisheye    ? "equidistant"
                 : raw.lens == LensDistortion::Model::rational ? "rational_polynomial"
                                                               : "plumb_bob";
    const std::size_t count = info.model == "plumb_bob" ? 5 : info.model == "equidistant" ? 4 : 8;
    info.d.assign(raw.distortion.begin(), raw.distortion.begin() + static_cast<std::ptrdiff_t>(count));
    info.k = {raw.fx, 0, raw.cx, 0, raw.fy, raw.cy, 0, 0, 1};
    info.p = {rectified.fx, 0, rectified.cx, 0, 0, rectified.fy, rectified.cy, 0, 0, 0, 1, 0};
    for (int i = 0; i < 9; ++i) info.r[static_cast<std::size_t>(i)] = turn(i / 3, i % 3);
    return info;
  }
};

Rig rig_of(const Camera& raw, double focal) {
  Rig rig{raw, {640, 480, focal, focal + 2, 325.0, 236.0}};
  rig.turn = Eigen::AngleAxisd(0.06, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  return rig;
}
std::vector<Rig> rigs() {
  std::vector<Rig> rigs{rig_of(scene::distorted_camera(), 560), rig_of(scene::rational_camera(), 590),
                        rig_of(scene::fisheye_camera(), 200)};
  rigs[2].tag = 0.1;  // a third of the focal length, and it bends the edges of tags
  rigs[2].tolerance = 0.003;
  return rigs;
}

std::vector<scene::PlacedTag> tags(double size) {
  return {{3, size, scene::tag_before_camera(0.45, 0.5, 0.3, 0.2, -0.15, 0.1)},
          {5, size, scene::tag_before_camera(0.5, 0.6, 1.3, -0.4, 0.18, -0.12)}};
}
std::string boards(double size) {
  const std::string tag = ", size: " + std::to_string(size) + ", pose: [0, 0, 0, 0, 0, 0]}]}\n";
  return "boards:\n  - {name: base, map_from_board: [0, 0, 0, 0, 0, 0], tags: [{id: 3" + tag +
         "  - {name: b, tags: [{id: 5" + tag;
}

std::vector<std::uint8_t> grey_of(const cv::Mat& picture) {
  return {picture.data, picture.data + picture.total()};
}

/// Of tags, as a rig's raw camera sees them and rectified.
struct Pictures {
  std::vector<std::uint8_t> raw, rectified;
};
Pictures pictures_of(const Rig& rig) {
  const std::vector<scene::PlacedTag> still = tags(rig.tag);
  std::vector<scene::PlacedTag> turned = still;
  for (scene::PlacedTag& tag : turned) tag.camera_from_tag = rig.turn * tag.camera_from_tag;
  const scene::Look look{.blur = 0.6, .noise = 1.0};
  return {grey_of(scene::render(rig.raw, still, look)), grey_of(scene::render(rig.rectified, turned, look))};
}

/// The pictures, each in a topic of its own.
void write_tags(const std::filesystem::path& file, const Rig& rig, const Pictures& pictures,
                const std::string& rectified_topic) {
  CameraBag bag(file);
  bag.info("/camera/camera_info", 9.9, "camera", rig.info());
  bag.image("/camera/image_raw", 10, "camera", "mono8", 640, pictures.raw);
  bag.image(rectified_topic, 10, "camera", "mono8", 640, pictures.rectified);
  bag.write();
}

std::map<std::string, Eigen::Isometry3d> tracked(const Rig& rig, const std::string& bag,
                                                 const std::string& topic, const std::string& more = "") {
  const TemporaryFolder folder;
  folder.write("s.yaml", boards(rig.tag) + "source: {bag: {images: " + topic +
                             ", camera_info: /camera/camera_info" + more + "}}\n");
  const CommandRun run = run_command({"track", bag, "--setup", folder.file("s.yaml"), "--json"});
  EXPECT_EQ(run.status, exit_done) << run.log;
  std::map<std::string, Eigen::Isometry3d> poses;
  if (run.status != exit_done) return poses;
  const Json report = Json::parse(run.out);
  for (const Json& pose : report["images"].at(0)["poses"]) {
    if (pose["kind"] != "tag" || !pose.contains("pose")) continue;
    const Json& v = pose["pose"];
    Eigen::Isometry3d& found = poses[pose["name"]];
    found = Eigen::Quaterniond(v[3].get<double>(), v[4], v[5], v[6]);
    found.translation() = Eigen::Vector3d(v[0], v[1], v[2]);
  }
  EXPECT_EQ(poses.size(), 2U) << report["summary"];
  return poses;
}

/// How far the tags are from the truth, metres. @param camera_from_raw the camera's axes
double farthest(const std::map<std::string, Eigen::Isometry3d>& poses,
                const Eigen::Matrix3d& camera_from_raw) {
  double far = poses.size() == 2 ? 0.0 : HUGE_VAL;
  for (const scene::PlacedTag& tag : tags(0.06))
    if (poses.contains(std::to_string(tag.id)))
      far = std::max(far, (poses.at(std::to_string(tag.id)).translation() -
                           camera_from_raw * tag.camera_from_tag.translation())
                              .norm());
  return far;
}

/// What a report says of its only camera.
std::string said_of(const Json& report) {
  const Json& cameras = report["cameras"];
  if (cameras.size() != 1) return cameras.dump();
  const std::string sensor = cameras[0]["sensor"], as = cameras[0]["taken_as"], by = cameras[0]["known_by"];
  return sensor + " " + as + " by " + by;
}

TEST(RectifiedBags, TagsOfRawAndRectifiedImagesStandWhereTheyAre) {
  const TemporaryFolder folder;
  for (const Rig& rig : rigs()) {
    const Pictures pictures = pictures_of(rig);
    for (const char* name : {"a.mcap", "a.bag"}) {
      SCOPED_TRACE(rig.info().model + " " + name);
      write_tags(folder / name, rig, pictures, "/camera/image_rect_color");
      EXPECT_LT(farthest(tracked(rig, folder.file(name), "/camera/image_raw"), Eigen::Matrix3d::Identity()),
                rig.tolerance);
      EXPECT_LT(farthest(tracked(rig, folder.file(name), "/camera/image_rect_color"), rig.turn),
                rig.tolerance);
      const auto undone_twice =
          tracked(rig, folder.file(name), "/camera/image_rect_color", ", rectified: false");
      EXPECT_GT(farthest(undone_twice, rig.turn), 3 * rig.tolerance) << "the scene would not show it";
    }
  }
}

TEST(RectifiedBags, TheSetupOverrulesTheNameOfATopic) {
  const TemporaryFolder folder;
  const Rig rig = rigs()[0];
  write_tags(folder / "a.mcap", rig, pictures_of(rig), "/camera/undistorted");
  EXPECT_LT(
      farthest(tracked(rig, folder.file("a.mcap"), "/camera/undistorted", ", rectified: true"), rig.turn),
      1e-3);
  EXPECT_GT(farthest(tracked(rig, folder.file("a.mcap"), "/camera/undistorted"), rig.turn), 5e-3);
}

TEST(RectifiedBags, ReportsSayHowEachCameraWasTakenAndByWhat) {
  const TemporaryFolder folder;
  const Rig rig = rigs()[0];
  write_tags(folder / "a.mcap", rig, pictures_of(rig), "/image_rect");
  const auto report = [&](const std::string& topics) {
    folder.write("s.yaml", boards(rig.tag) + "source: {bag: {images: " + topics + "}}\n");
    const CommandRun run = run_command({"track", folder.file("a.mcap"), "--setup", folder.file("s.yaml"),
                                        "--json", folder.file("t.json"), "--csv", folder.file("t.csv")});
    EXPECT_NE(run.out.find("camera /"), std::string::npos) << run.out;
    return Json::parse(read_file(folder.file("t.json")));
  };
  const std::string info = ", camera_info: /camera/camera_info";
  EXPECT_EQ(said_of(report("/image_rect" + info)), "/image_rect rectified by its topic's name");
  EXPECT_EQ(said_of(report("/camera/image_raw" + info)), "/camera/image_raw raw by its topic's name");
  EXPECT_EQ(said_of(report("/image_rect, rectified: false" + info)),
            "/image_rect raw by 'rectified' of the setup");
}

TEST(RectifiedBags, ThatARectifiedImageHasNoDistortionIsKnownUnlessTheSetupStatesAnError) {
  CameraIntrinsics camera{640, 480, 600, 605, 318, 243, {}};
  EXPECT_FALSE(tracking_camera(camera).errors.distortion) << "1 % of half the diagonal";
  camera.is_rectified = true;
  EXPECT_EQ(tracking_camera(camera).errors.distortion, kKnownDistortion);
  CameraErrorsSetup errors;
  errors.distortion = 0.2;
  EXPECT_EQ(tracking_camera(camera, errors).errors.distortion, 0.2);
}

/// A wall and a floor before the camera, as planes n x = d of its raw axes.
const std::array<Eigen::Vector4d, 2> planes{Eigen::Vector4d(0.5, 0.1, 0.86, 1.3),
                                            Eigen::Vector4d(0, 0.8, 0.6, 1.1)};

/// Millimetres along the optical axis. @param rays right and down at 1 m @param raw_from_camera
std::vector<std::uint16_t> depth_of(const std::vector<cv::Point2d>& rays,
                                    const Eigen::Matrix3d& raw_from_camera) {
  std::vector<std::uint16_t> depth;
  for (const cv::Point2d& ray : rays) {
    const Eigen::Vector3d towards = raw_from_camera * Eigen::Vector3d(ray.x, ray.y, 1);
    double z = 6.0;  // beyond it is no return
    for (const Eigen::Vector4d& plane : planes) {
      const double along = plane[3] / plane.head<3>().dot(towards);
      if (along > 0) z = std::min(z, along);
    }
    depth.push_back(z < 6.0 && std::hypot(ray.x, ray.y) < 1.0 ? static_cast<std::uint16_t>(1000 * z + 0.5)
                                                              : 0);
  }
  return depth;
}

/// By OpenCV.
std::vector<cv::Point2d> rays_of(const Camera& camera) {
  std::vector<cv::Point2d> pixels, rays;
  for (int row = 0; row < camera.height; ++row)
    for (int column = 0; column < camera.width; ++column) pixels.emplace_back(column, row);
  const cv::Matx33d k(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  const std::vector<double> d(camera.distortion.begin(), camera.distortion.end());
  if (camera.lens == LensDistortion::Model::fisheye)
    cv::fisheye::undistortPoints(pixels, rays, k, std::vector<double>(d.begin(), d.begin() + 4));
  else
    cv::undistortPoints(pixels, rays, k, d, cv::noArray(), cv::noArray(),
                        {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 100, 1e-10});
  return rays;
}

/// The occupied voxels of a map of a topic, and how far the farthest is from the planes, metres.
struct Mapped {
  std::set<std::array<int, 3>> occupied;
  double off = 0.0;
};

constexpr double resolution = 0.05;

Mapped mapped(const std::string& bag, const std::string& topic, const Eigen::Isometry3d& raw_from_map) {
  const TemporaryFolder folder;
  folder.write("s.yaml", "map: {resolution: 0.05}\nsource: {bag: {depth: " + topic +
                             ", depth_camera_info: /depth/camera_info, fixed_frame: map}}\n");
  const CommandRun run = run_command(
      {"replay", bag, "--setup", folder.file("s.yaml"), "--out", folder.file("out"), "--no-plan"});
  EXPECT_EQ(run.status, exit_done) << run.log;
  Mapped result;
  if (run.status != exit_done) return result;
  const std::string as = topic.ends_with("image_rect") ? " rectified" : " raw";
  EXPECT_EQ(said_of(Json::parse(read_file(folder.file("out/report.json")))),
            topic + as + " by its topic's name");
  load_map(folder / "out/map.ot").visit_leaves([&](const Voxel& leaf) {
    if (leaf.state != VoxelState::occupied) return;
    const Eigen::Vector3d in_raw = raw_from_map * leaf.center;
    double off = HUGE_VAL;
    for (const Eigen::Vector4d& plane : planes)
      off = std::min(off, std::abs(plane.head<3>().dot(in_raw) - plane[3]) / plane.head<3>().norm());
    result.off = std::max(result.off, off);
    const Eigen::Vector3i cell = (leaf.center / resolution).array().floor().cast<int>();
    result.occupied.insert({cell.x(), cell.y(), cell.z()});
  });
  return result;
}

TEST(RectifiedBags, RawAndRectifiedDepthGiveTheSameMap) {
  const TemporaryFolder folder;
  const std::array<double, 3> at{0.3, -0.2, 1.0};
  const std::array<double, 4> turn{-0.5, 0.5, -0.5, 0.5};  // looks along x
  Eigen::Isometry3d map_from_frame(Eigen::Translation3d(at[0], at[1], at[2]));
  map_from_frame.rotate(Eigen::Quaterniond(turn[3], turn[0], turn[1], turn[2]));
  for (const Rig& rig : rigs()) {
    const auto raw_depth = depth_of(rays_of(rig.raw), Eigen::Matrix3d::Identity());
    const auto rectified_depth = depth_of(rays_of(rig.rectified), rig.turn.transpose());
    for (const char* name : {"d.mcap", "d.bag"}) {
      SCOPED_TRACE(rig.info().model + " " + name);
      CameraBag bag(folder / name);
      bag.place("camera", 9.8, at, turn);
      bag.info("/depth/camera_info", 9.9, "camera", rig.info());
      bag.image("/depth/image_raw", 10, "camera", "16UC1", 640, raw_depth);
      bag.image("/depth/image_rect", 10, "camera", "16UC1", 640, rectified_depth);
      bag.write();
      Eigen::Isometry3d raw_from_frame = Eigen::Isometry3d::Identity();
      raw_from_frame.linear() = rig.turn.transpose();
      const Eigen::Isometry3d raw_from_map = raw_from_frame * map_from_frame.inverse();
      const Mapped raw = mapped(folder.file(name), "/depth/image_raw", raw_from_map);
      const Mapped rectified = mapped(folder.file(name), "/depth/image_rect", raw_from_map);
      const double reach = 0.5 * std::sqrt(3.0) * resolution + 0.001;  // a voxel's corner, and rounding
      EXPECT_LT(raw.off, reach);
      EXPECT_LT(rectified.off, reach);
      std::size_t both = 0;
      for (const auto& cell : raw.occupied) both += rectified.occupied.count(cell);
      EXPECT_GT(raw.occupied.size(), 300U);
      EXPECT_GT(static_cast<double>(both),
                0.8 * static_cast<double>(std::min(raw.occupied.size(), rectified.occupied.size())));
    }
  }
}

}  // namespace rectified_bags_test
}  // namespace clearway

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "apps/fusion/painter.hpp"
#include "datasets/descriptions/scene.hpp"
#include "datasets/simulation/simulate.hpp"
#include "datasets/sources/lens.hpp"
#include "tests/apps/run_command.hpp"
#include "tests/worlds/small_scene.hpp"

namespace clearway {
namespace wide_lenses_test {

using Json = nlohmann::json;

/// How far the balls of a rendered stroke are from the truth, metres.
struct Tracked {
  std::size_t images = 0, balls = 0, beyond_bound = 0;
  double mean = 0.0, bound = 0.0;
  double angle = 0.0;  ///< of the balls to the camera's axis, radians, mean
};

std::string replaced(std::string text, const std::string& old, const std::string& by) {
  return text.replace(text.find(old), old.size(), by);
}

/// @param camera its block in the setup; @param target what it looks at
Tracked track(const std::string& camera, const std::string& target) {
  const TemporaryFolder folder;
  const std::string exact =
      "errors: {camera: {focal: 0, aspect: 0, center_px: 0, distortion_px: 0},\n"
      "         boards: {scale: 0, size: 0, place: 0, turn: 0}}\n";
  const auto from = small_setup.find("camera:"), to = small_setup.find("boards:");
  folder.write("setup.yaml",
               replaced(small_setup, small_setup.substr(from, to - from), camera + "\n") + exact);
  std::string text = replaced(small_scene, "target: [0.05, 0, 0.05]", "target: " + target);
  text = replaced(text, "rate_hz: 10", "rate_hz: 40");
  Scene scene = parse_scene(text, "scene", folder / "");
  scene.depth.reset();
  simulate(scene, folder / "r.rawlog");
  const Json truth = Json::parse(read_file(folder / "truth.json"));
  const CommandRun run = run_command({"track", folder.file("r.rawlog"), "--json"});
  EXPECT_EQ(run.status, exit_done) << run.log;
  const Json found = Json::parse(run.out);
  Tracked tracked;
  tracked.images = found["images"].size();
  for (std::size_t i = 0; i < tracked.images; ++i)
    for (const Json& pose : found["images"][i]["poses"]) {
      if (pose["kind"] != "ball" || pose["frame"] != "map" || !pose.contains("pose")) continue;
      const auto vector = [](const Json& v) { return Eigen::Vector3d(v[0], v[1], v[2]); };
      const Json& frame = truth["frames"][i];
      const Json& eye = frame["map_from_camera"];
      const Eigen::Vector3d ball = vector(frame["ball"]);
      const Eigen::Quaterniond turn(eye[3].get<double>(), eye[4], eye[5], eye[6]);
      const double off = (vector(pose["pose"]) - ball).norm(), bound = pose["bound"];
      tracked.balls += 1;
      tracked.beyond_bound += off > bound ? 1 : 0;
      tracked.mean += off;
      tracked.bound += bound;
      const Eigen::Vector3d in_camera = turn.inverse() * (ball - vector(eye));
      tracked.angle += std::atan2(in_camera.head<2>().norm(), in_camera.z());
    }
  for (double* sum : {&tracked.mean, &tracked.bound, &tracked.angle})
    *sum /= static_cast<double>(std::max<std::size_t>(1, tracked.balls));
  return tracked;
}

const std::string size = "camera: {width: 640, height: 480, fx: 330, fy: 331, cx: 318, cy: 241, ";
const std::string pinhole = size + "distortion: [0, 0, 0, 0, 0]}";
const std::string rational =
    size + "lens: rational, distortion: [0.42, -2.1, 0.0005, -0.0003, 1.3, 0.31, -1.9, 1.2]}";
const std::string fisheye = size + "lens: fisheye, distortion: [-0.012, 0.021, -0.017, 0.003]}";
/// Sees 90 degrees all around; what looks backwards is black.
const std::string wide =
    "camera: {width: 900, height: 800, fx: 240, fy: 241, cx: 448, cy: 402, lens: fisheye,\n"
    "         distortion: [-0.0069, 0.0459, -0.0429, 0.0078]}";

TEST(WideLenses, ABallIsWithinItsBoundAndAsNearAsWithAPinhole) {
  const std::string ahead = "[0.05, 0, 0.05]";
  const Tracked plain = track(pinhole, ahead);
  EXPECT_EQ(plain.balls, plain.images);
  EXPECT_EQ(plain.beyond_bound, 0U);
  for (const std::string& camera : {rational, fisheye}) {
    const Tracked lens = track(camera, ahead);
    EXPECT_GT(lens.images, 15U);
    EXPECT_EQ(lens.balls, lens.images);
    EXPECT_EQ(lens.beyond_bound, 0U);
    EXPECT_LT(lens.mean, 2.0 * plain.mean);
    EXPECT_LT(lens.bound, 2.0 * plain.bound);
  }
}

TEST(WideLenses, ABallFarFromTheAxisOfAFisheyeIsWithinItsBound) {
  const Tracked ahead = track(wide, "[0.05, 0, 0.05]"), aside = track(wide, "[-0.1, 0.45, 0.3]");
  EXPECT_GT(aside.angle, 1.0) << "60 degrees";
  EXPECT_GT(aside.balls, 15U);
  EXPECT_EQ(aside.beyond_bound, 0U);
  EXPECT_LT(aside.mean, 3.0 * ahead.mean);
}

TEST(WideLenses, TheTrackersCameraAndTheRenderersLensAreTheSame) {
  for (const std::string& block : {pinhole, rational, fisheye, wide}) {
    const CameraIntrinsics intrinsics = *parse_setup(block + "\n", "setup").camera;
    const Camera camera = tracking_camera(intrinsics);
    const Lens lens(intrinsics);
    EXPECT_NO_THROW(camera.validate());
    for (double x = -0.5; x < intrinsics.width; x += 17)
      for (double y = -0.5; y < intrinsics.height; y += 17) {
        const auto ours = camera.undistort({x, y});
        const auto theirs = lens.pixel_ray({x, y});
        ASSERT_EQ(ours.has_value(), theirs.has_value()) << x << " " << y;
        if (!ours) continue;
        EXPECT_LT((*ours - theirs->head<2>()).norm() / (1.0 + ours->squaredNorm()), 1e-10);
      }
  }
}

}  // namespace wide_lenses_test
}  // namespace clearway

// Drawing the live overlay alone: what it takes of the time between two pictures of a camera.

#include <unistd.h>

#include <opencv2/core.hpp>

#include "apps/bench/bench.hpp"
#include "apps/console/shipped_file.hpp"
#include "apps/fusion/fusion.hpp"
#include "apps/overlay/overlay_scene.hpp"
#include "datasets/descriptions/scene.hpp"
#include "datasets/simulation/simulate.hpp"
#include "planning/robot_files/load_robot.hpp"

namespace clearway::bench {
namespace {

namespace fs = std::filesystem;

constexpr double frame_budget = 1.0 / 15.0;  ///< s between two pictures of a camera

/// A folder that goes with what is in it.
struct OverlayFolder {
  fs::path path = fs::temp_directory_path() / ("clearway_bench_overlay_" + std::to_string(::getpid()));
  OverlayFolder() { fs::create_directory(path); }
  ~OverlayFolder() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
};

/// The kitchen, painted and scanned.
Fusion kitchen(const fs::path& folder, const BenchOptions& options) {
  const fs::path recording = options.input.empty() ? folder / "kitchen.rawlog" : options.input;
  if (options.input.empty()) simulate(load_scene(shipped_file("scenes", "miniature_kitchen")), recording);
  return fuse(recording, {.resolution = options.resolution}, [](double) {});
}

Eigen::Isometry3d look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target) {
  Eigen::Isometry3d map_from_camera = Eigen::Isometry3d::Identity();
  const Eigen::Vector3d z = (target - eye).normalized(), x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
  map_from_camera.linear() << x, z.cross(x), z;
  map_from_camera.translation() = eye;
  return map_from_camera.inverse();
}

}  // namespace

BenchResult bench_overlay(const BenchOptions& options) {
  const OverlayFolder folder;
  options.say("recording and map");
  const Fusion fusion = kitchen(folder.path, options);
  const QuerySetup& query = fusion.setup.queries.at(0);
  const Robot robot = load_robot(fusion.setup.robot->name);
  const auto at = [](const std::vector<double>& q) -> Configuration {
    return Eigen::Map<const Configuration>(q.data(), static_cast<Eigen::Index>(q.size()));
  };
  const Snapshot map = fusion.map.snapshot();
  const OverlayMap shown = overlay_map(map);
  const RobotSurface surface(robot);
  OverlayScene scene;
  scene.map = &shown;
  scene.robot = &surface;
  scene.robot_pose = forward_kinematics(robot, at(query.goals.front()));
  scene.start_pose = forward_kinematics(robot, at(query.start));
  scene.goal_pose = forward_kinematics(robot, at(query.goals.back()));
  for (const Sphere& ball : map.volumes().at(0).spheres) {
    scene.path.points.push_back(ball.center);
    scene.path.clearance.push_back(0.01 * static_cast<double>(scene.path.points.size() % 7));
  }
  scene.ball = OverlayBall{map.volumes().at(0).spheres.back().center, 0.02, 0.002, true};
  scene.strip = Strip{"painting", "Not painted: none of the probe's tags is seen.", cure_of("probe_not_seen"),
                      "space paint, u undo, q quit", 0.0};
  const Camera camera{1280, 720, 1150.0, 1152.0, 642.5, 358.0, {-0.12, 0.05, 0.0005, -0.0004, 0.0}};
  const Eigen::Isometry3d camera_from_map = look_at({-0.3, 0.02, 0.38}, {0.045, 0.0, 0.075});
  const cv::Mat image(camera.height, camera.width, CV_8UC1, cv::Scalar(120));
  const auto draw = [&](std::size_t threads) {
    draw_overlay(image, camera, camera_from_map, scene, threads);
  };
  std::vector<double> one, two, paint;
  for (int run = 0; run < options.runs; ++run) {
    options.say_run(run, options.runs);
    one.push_back(cpu_seconds([&] { draw(1); }));
    const double begin = wall_time();
    draw(2);
    two.push_back(wall_time() - begin);
    paint.push_back(cpu_seconds([&] { overlay_map(map); }));
  }
  BenchResult result;
  result.ours = median(one);
  result.peer = frame_budget;
  result.peer_name = "between two pictures at 15 a second";
  result.unit = "CPU s per picture";
  result.runs = options.runs;
  result.no_ratio = "the second is a budget, not a program";
  const std::size_t faces = shown.occupied.triangles.size() + shown.volumes.at(0).faces.triangles.size();
  result.detail = {{"best_cpu_s", quantile(one, 0.0)},
                   {"p95_cpu_s", quantile(one, 0.95)},
                   {"two_threads_wall_s", median(two)},
                   {"surfaces_of_a_map_cpu_s", median(paint)},
                   {"triangles_of_the_map", faces}};
  result.compared =
      "The miniature kitchen with paint, " + std::to_string(faces) +
      " triangles of voxels, robot, two ghosts, path, ball and strip drawn into a grey image of "
      "1280 x 720 with lens distortion, on one core; tracking is not in it. The surfaces are made "
      "anew only when the map changes.";
  result.tables = {
      {"",
       {"ms", "median", "95 %"},
       {{"picture, one core, CPU", figure(1e3 * median(one)), figure(1e3 * quantile(one, 0.95))},
        {"picture, two threads, wall", figure(1e3 * median(two)), figure(1e3 * quantile(two, 0.95))},
        {"surfaces of the map, CPU", figure(1e3 * median(paint)), figure(1e3 * quantile(paint, 0.95))}}}};
  return result;
}

}  // namespace clearway::bench

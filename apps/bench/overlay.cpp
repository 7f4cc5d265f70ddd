// Drawing the live overlay alone: what it takes of the time between two pictures of a camera.

#include <opencv2/core.hpp>

#include "apps/bench/bench.hpp"
#include "apps/bench/page/bench_folder.hpp"
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

/// All that a picture may show at once: map, robot, ghosts at start and goal, path, ball and strip.
struct FullScene {
  explicit FullScene(const Fusion& fusion);
  FullScene(const FullScene&) = delete;
  FullScene& operator=(const FullScene&) = delete;

  Snapshot map;
  Robot robot;
  OverlayMap shown;
  RobotSurface surface;
  OverlayScene scene;
};

FullScene::FullScene(const Fusion& fusion)
    : map(fusion.map.snapshot()),
      robot(load_robot(fusion.setup.robot->name)),
      shown(overlay_map(map)),
      surface(robot) {
  const QuerySetup& query = fusion.setup.queries.at(0);
  const auto poses = [&](const std::vector<double>& q) {
    return forward_kinematics(robot,
                              Eigen::Map<const Configuration>(q.data(), static_cast<Eigen::Index>(q.size())));
  };
  scene.map = &shown;
  scene.robot = &surface;
  scene.robot_pose = poses(query.goals.front());
  scene.start_pose = poses(query.start);
  scene.goal_pose = poses(query.goals.back());
  for (const Sphere& ball : map.volumes().at(0).spheres) {
    scene.path.points.push_back(ball.center);
    scene.path.clearance.push_back(0.01 * static_cast<double>(scene.path.points.size() % 7));
  }
  scene.ball = OverlayBall{map.volumes().at(0).spheres.back().center, 0.02, 0.002, true};
  scene.strip = Strip{"painting", "Not painted: none of the probe's tags is seen.", cure_of("probe_not_seen"),
                      "space paint, u undo, q quit", 0.0};
}

/// Seconds of each run.
struct DrawTimes {
  std::vector<double> one;       ///< CPU, a picture by one thread
  std::vector<double> two;       ///< wall, by two threads
  std::vector<double> surfaces;  ///< CPU, the map's
};

DrawTimes draw_times(const FullScene& full, const BenchOptions& options) {
  const Camera camera{1280, 720, 1150.0, 1152.0, 642.5, 358.0, {-0.12, 0.05, 0.0005, -0.0004, 0.0}};
  const Eigen::Isometry3d camera_from_map = look_at({-0.3, 0.02, 0.38}, {0.045, 0.0, 0.075});
  const cv::Mat image(camera.height, camera.width, CV_8UC1, cv::Scalar(120));
  const auto draw = [&](std::size_t threads) {
    draw_overlay(image, camera, camera_from_map, full.scene, threads);
  };
  DrawTimes times;
  for (int run = 0; run < options.runs; ++run) {
    options.say_run(run, options.runs);
    times.one.push_back(cpu_seconds([&] { draw(1); }));
    const double begin = wall_time();
    draw(2);
    times.two.push_back(wall_time() - begin);
    times.surfaces.push_back(cpu_seconds([&] { overlay_map(full.map); }));
  }
  return times;
}

std::vector<std::string> row(const std::string& name, const std::vector<double>& seconds) {
  return {name, figure(1e3 * median(seconds)), figure(1e3 * quantile(seconds, 0.95))};
}

}  // namespace

BenchResult bench_overlay(const BenchOptions& options) {
  const BenchFolder folder("overlay");
  options.say("recording and map");
  const FullScene full(kitchen(folder.path, options));
  const DrawTimes times = draw_times(full, options);
  BenchResult result;
  result.ours = median(times.one);
  result.peer = frame_budget;
  result.peer_name = "between two pictures at 15 a second";
  result.unit = "CPU s per picture";
  result.runs = options.runs;
  result.no_ratio = "the second is a budget, not a program";
  const std::size_t faces =
      full.shown.occupied.triangles.size() + full.shown.volumes.at(0).faces.triangles.size();
  result.detail = {{"best_cpu_s", quantile(times.one, 0.0)},
                   {"p95_cpu_s", quantile(times.one, 0.95)},
                   {"two_threads_wall_s", median(times.two)},
                   {"surfaces_of_a_map_cpu_s", median(times.surfaces)},
                   {"triangles_of_the_map", faces}};
  result.compared =
      "The miniature kitchen with paint, " + std::to_string(faces) +
      " triangles of voxels, robot, two ghosts, path, ball and strip drawn into a grey image of "
      "1280 x 720 with lens distortion, on one core; tracking is not in it. The surfaces are made "
      "anew only when the map changes.";
  result.tables = {{"",
                    {"ms", "median", "95 %"},
                    {row("picture, one core, CPU", times.one), row("picture, two threads, wall", times.two),
                     row("surfaces of the map, CPU", times.surfaces)}}};
  return result;
}

}  // namespace clearway::bench

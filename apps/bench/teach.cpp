// Teaching: tags searched, poses, paint, pictures; against the ten images a second of Chong et al. 2008.

#include <chrono>
#include <cmath>
#include <limits>
#include <thread>

#include "apps/bench/bench.hpp"
#include "apps/bench/page/bench_folder.hpp"
#include "apps/fusion/fusion.hpp"
#include "apps/teach/shown_session.hpp"
#include "apps/teach/teach_picture.hpp"
#include "apps/teach/teach_screen.hpp"
#include "apps/teach/teach_session.hpp"
#include "datasets/simulation/simulate.hpp"
#include "mapping/system/parallel.hpp"
#include "planning/robot_files/load_robot.hpp"

namespace clearway::bench {
namespace {

namespace fs = std::filesystem;

constexpr double paper_s = 0.1;  ///< Chong et al. 2008: 10 images a second
constexpr int width = 1280, height = 720;
constexpr double seconds = 5.0;

/// The kitchen's stroke, seen by a larger camera, without depth.
Scene large_kitchen() {
  Scene scene = load_scene(datasets_folder() / "scenes" / "miniature_kitchen.yaml");
  CameraIntrinsics& camera = *scene.setup.camera;
  const double larger = static_cast<double>(height) / camera.height;
  camera.cx = larger * camera.cx + 0.5 * (width - larger * camera.width);
  camera.cy *= larger;
  camera.fx *= larger;
  camera.fy *= larger;
  camera.width = width;
  camera.height = height;
  scene.depth.reset();
  scene.gripper.reset();
  scene.stroke->duration = seconds;
  scene.stroke->speed.reset();
  scene.setup.acceptance.max_speed = 1.0;
  scene.setup.detector.decimate = 2;
  return scene;
}

/// The one event of a session that paints from its first image to its last.
TeachSession::EventSource paints_all_along() {
  TeachEvent begin;
  begin.action = TeachAction::paint_on;
  return [begin, is_given = false](double) mutable {
    return std::exchange(is_given, true) ? std::vector<TeachEvent>{} : std::vector{begin};
  };
}

/// A session that draws each of its images.
class Drawn final : public FusionGuide {
 public:
  Drawn(TeachSession& session, bool draws) : session_(session), draws_(draws) {}
  void begin(const Setup& setup, FreeSpaceMap& map, const FusionCounts& counts) override {
    session_.begin(setup, map, counts);
    viewer_.emplace(session_, setup, map, counts);
  }
  bool before(double since_start) override { return session_.before(since_start); }
  Brush brush() const override { return session_.brush(); }
  void see(const SeenImage& image) override {
    session_.see(image);
    if (!draws_) return;
    const double begin = wall_time();
    painter_.draw(viewer_->view(image, std::get<ImageFrame>(image.frame.content)));
    draw_ms.push_back(1e3 * (wall_time() - begin));
  }
  void end() override { session_.end(); }
  std::vector<double> draw_ms;

 private:
  TeachSession& session_;
  const bool draws_;
  std::optional<TeachViewer> viewer_;
  TeachPainter painter_{1};
};

/// The same seen thirty times a second, and ten times a second by the depth camera, as in a live session.
Scene live_kitchen() {
  Scene scene = large_kitchen();
  scene.camera->rate_hz = 30.0;
  scene.depth = load_scene(datasets_folder() / "scenes" / "miniature_kitchen.yaml").depth;
  scene.depth->beside_pictures = true;
  scene.depth->interval = 0.1;
  scene.depth->images_beside = static_cast<std::size_t>(seconds / scene.depth->interval) + 1;
  return scene;
}

/// A session as in a window, at the recording's own pace; only that its pictures go nowhere.
struct LiveRun {
  std::vector<double> latency_ms;  ///< from an image to its picture
  double images_a_second = 0.0, pictures_a_second = 0.0, depth_a_second = 0.0;
  double behind_s = 0.0;  ///< how much longer than the recording it took
};

LiveRun run_live(const fs::path& recording, const Setup& setup) {
  TeachSession session(paints_all_along(), {});
  TeachScreen screen([] {
    return TeachDisplay{[](const cv::Mat&) {},
                        [] {
                          std::this_thread::sleep_for(std::chrono::milliseconds(1));
                          return -1;
                        }};
  });
  ShownSession shown(session, &screen, {}, "");
  FusionOptions options;
  options.setup = setup;
  options.guide = &shown;
  options.is_paced = true;
  const double start = wall_time();
  const Fusion fusion = fuse(recording, options, [](double) {});
  const double wall = wall_time() - start;
  LiveRun run;
  const ScreenTimes times = screen.times();
  for (const double latency : times.latencies) run.latency_ms.push_back(1e3 * latency);
  run.images_a_second = static_cast<double>(fusion.counts.images) / wall;
  run.pictures_a_second = static_cast<double>(times.latencies.size()) / wall;
  run.depth_a_second = static_cast<double>(fusion.counts.scans_inserted) / wall;
  run.behind_s = wall - fusion.counts.duration;
  return run;
}

struct Run {
  double seconds_an_image = 0.0;  ///< wall
  std::size_t images = 0, balls = 0;
  std::vector<double> draw_ms;
};

Run run(const fs::path& recording, const Setup& setup, bool draws) {
  TeachSession session(paints_all_along(), {});
  Drawn guide(session, draws);
  FusionOptions options;
  options.setup = setup;
  options.guide = &guide;
  const double start = wall_time();
  const Fusion fusion = fuse(recording, options, [](double) {});
  const double wall = wall_time() - start;
  return {wall / static_cast<double>(fusion.counts.images), fusion.counts.images, fusion.counts.spheres,
          guide.draw_ms};
}

/// Of all runs.
struct Figures {
  Run last;                          ///< without pictures
  std::vector<double> alone, drawn;  ///< s an image
  std::vector<double> draw_ms;
  std::vector<double> latency_ms, images_hz, pictures_hz, depth_hz, behind;  ///< live
};

void append(const std::vector<double>& values, std::vector<double>& all) {
  all.insert(all.end(), values.begin(), values.end());
}

void measure(const fs::path& recording, const Setup& setup, int runs, Figures& figures) {
  for (int i = 0; i < runs; ++i) {
    figures.last = run(recording, setup, false);
    figures.alone.push_back(figures.last.seconds_an_image);
    const Run picture = run(recording, setup, true);
    figures.drawn.push_back(picture.seconds_an_image);
    append(picture.draw_ms, figures.draw_ms);
  }
}

void measure_live(const fs::path& recording, const Setup& setup, int runs, Figures& figures) {
  for (int i = 0; i < runs; ++i) {
    const LiveRun run = run_live(recording, setup);
    append(run.latency_ms, figures.latency_ms);
    figures.images_hz.push_back(run.images_a_second);
    figures.pictures_hz.push_back(run.pictures_a_second);
    figures.depth_hz.push_back(run.depth_a_second);
    figures.behind.push_back(run.behind_s);
  }
}

nlohmann::ordered_json detail_of(const Figures& figures) {
  return {{"images", figures.last.images},
          {"balls", figures.last.balls},
          {"images_a_second", 1.0 / median(figures.alone)},
          {"images_a_second_with_pictures", 1.0 / median(figures.drawn)},
          {"draw_ms_median", median(figures.draw_ms)},
          {"draw_ms_p95", quantile(figures.draw_ms, 0.95)},
          {"live_latency_ms_median", median(figures.latency_ms)},
          {"live_latency_ms_p95", quantile(figures.latency_ms, 0.95)},
          {"live_images_a_second", median(figures.images_hz)},
          {"live_pictures_a_second", median(figures.pictures_hz)},
          {"live_depth_images_a_second", median(figures.depth_hz)},
          {"live_behind_s", median(figures.behind)},
          {"threads", thread_count()}};
}

std::vector<Table> tables_of(const Figures& figures) {
  return {{"",
           {"images a second", "ours", "paper"},
           {{"detect, pose, paint", figure(1.0 / median(figures.alone)), "10"},
            {"with the picture drawn by the same thread", figure(1.0 / median(figures.drawn)), "10"}}},
          {"A live session: 30 images and 10 depth images a second come at their own pace, pictures are "
           "drawn by a thread beside, as for a window",
           {"", "ours"},
           {{"from image to picture, ms, median", figure(median(figures.latency_ms))},
            {"from image to picture, ms, 95 %", figure(quantile(figures.latency_ms, 0.95))},
            {"images searched a second", figure(median(figures.images_hz))},
            {"pictures a second", figure(median(figures.pictures_hz))},
            {"depth images fused a second", figure(median(figures.depth_hz))},
            {"seconds behind at the end", figure(median(figures.behind))}}}};
}

}  // namespace

BenchResult bench_teach(const BenchOptions& options) {
  const BenchFolder folder("teach");
  const fs::path recording = folder.path / "kitchen" / "kitchen.rawlog",
                 live_recording = folder.path / "live" / "live.rawlog";
  for (const fs::path& file : {recording, live_recording}) fs::create_directories(file.parent_path());
  const Scene scene = large_kitchen(), live = live_kitchen();
  simulate(scene, recording);
  options.say("images rendered");
  simulate(live, live_recording);
  Figures figures;
  measure(recording, scene.setup, options.runs, figures);
  measure_live(live_recording, live.setup, options.runs, figures);
  BenchResult result{median(figures.alone), paper_s,           "Chong et al. 2008", "s an image", true,
                     options.runs,          detail_of(figures)};
  result.compared =
      "Rendered images of " + std::to_string(width) + " x " + std::to_string(height) +
      " of the miniature kitchen's stroke, " + std::to_string(figures.last.images) +
      " of them: read from a rawlog, tags searched at `decimate: 2`, poses, paint; wall clock, " +
      std::to_string(thread_count()) +
      " threads. The peer is the paper's statement of ten images a second on its machine of 2008, "
      "not measured here.";
  result.tables = tables_of(figures);
  return result;
}

}  // namespace clearway::bench

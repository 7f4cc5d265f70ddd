// Teaching: tags searched, poses, paint, pictures; against the ten images a second of Chong et al. 2008.

#include <unistd.h>

#include <cmath>
#include <limits>

#include "apps/bench/bench.hpp"
#include "apps/fusion/fusion.hpp"
#include "apps/teach/teach_picture.hpp"
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

/// The kitchen's stroke, seen by a larger camera.
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

struct Run {
  double seconds_an_image = 0.0;  ///< wall
  std::size_t images = 0, balls = 0;
  std::vector<double> draw_ms;
};

Run run(const fs::path& recording, const Setup& setup, bool draws) {
  TeachEvent begin;
  begin.action = TeachAction::paint_on;
  bool is_given = false;
  TeachSession session(
      [&](double) { return std::exchange(is_given, true) ? std::vector<TeachEvent>{} : std::vector{begin}; },
      {});
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

}  // namespace

BenchResult bench_teach(const BenchOptions& options) {
  const fs::path folder = fs::temp_directory_path() / ("clearway_bench_teach_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  const Scene scene = large_kitchen();
  simulate(scene, folder / "kitchen.rawlog");
  options.say("images rendered");
  std::vector<double> alone, drawn, draw_ms;
  Run last;
  for (int i = 0; i < options.runs; ++i) {
    last = run(folder / "kitchen.rawlog", scene.setup, false);
    alone.push_back(last.seconds_an_image);
    const Run picture = run(folder / "kitchen.rawlog", scene.setup, true);
    drawn.push_back(picture.seconds_an_image);
    draw_ms.insert(draw_ms.end(), picture.draw_ms.begin(), picture.draw_ms.end());
  }
  std::error_code error;
  fs::remove_all(folder, error);
  const double ours = median(alone), with_pictures = median(drawn);
  BenchResult result{ours,
                     paper_s,
                     "Chong et al. 2008",
                     "s an image",
                     true,
                     options.runs,
                     {{"images", last.images},
                      {"balls", last.balls},
                      {"images_a_second", 1.0 / ours},
                      {"images_a_second_with_pictures", 1.0 / with_pictures},
                      {"draw_ms_median", median(draw_ms)},
                      {"draw_ms_p95", quantile(draw_ms, 0.95)},
                      {"threads", thread_count()}}};
  result.compared =
      "Rendered images of " + std::to_string(width) + " x " + std::to_string(height) +
      " of the miniature kitchen's stroke, " + std::to_string(last.images) +
      " of them: read from a rawlog, tags searched at `decimate: 2`, poses, paint; wall clock, " +
      std::to_string(thread_count()) +
      " threads. The peer is the paper's statement of ten images a second on its machine of 2008, "
      "not measured here.";
  result.tables = {{"",
                    {"images a second", "ours", "paper"},
                    {{"detect, pose, paint", figure(1.0 / ours), "10"},
                     {"with the picture drawn by the same thread", figure(1.0 / with_pictures), "10"}}}};
  return result;
}

}  // namespace clearway::bench

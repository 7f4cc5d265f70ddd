#include "datasets/simulation/simulate.hpp"

#include <algorithm>
#include <stdexcept>

#include "datasets/descriptions/probe_motion.hpp"
#include "datasets/simulation/delivered_depth.hpp"
#include "datasets/simulation/image_renderer.hpp"
#include "datasets/simulation/probe_surfaces.hpp"
#include "datasets/simulation/truth.hpp"
#include "datasets/sources/recording.hpp"
#include "mapping/system/atomic_file.hpp"
#include "mapping/system/parallel.hpp"

namespace clearway {
namespace {

constexpr double after_copies = 0.1;  // s until the first image of our own
constexpr int exposure_steps = 5;

class Simulation {
 public:
  Simulation(const Scene& scene, const std::filesystem::path& recording,
             const std::function<void(double)>& progress)
      : scene_(scene), progress_(progress), writer_(recording), truth_(scene), time_(scene.start_time) {
    result_.recording = recording;
    result_.truth = recording.parent_path() / "truth.json";
    if (recording.filename() == "truth.json") {
      throw std::invalid_argument("recording '" + recording.string() +
                                  "': this name is the truth's; expected another, such as recording.rawlog.");
    }
    require_writable(result_.truth);
  }

  SimulationResult run() {
    writer_.write(Frame{time_, "", CommentFrame{scene_.setup_text}});
    for (const auto& include : scene_.includes) copy_frames(include);
    if (scene_.depth) record_depth();
    if (scene_.camera) record_images();
    AtomicFile truth_file(result_.truth);
    truth_file.append(truth_.json());
    writer_.finish();
    truth_file.finish();
    tell(1);
    return result_;
  }

 private:
  void copy_frames(const SceneInclude& include);
  void record_depth();
  void record_images();
  GrayImage photograph(const ImageRenderer& renderer, const ProbeMotion& motion, double time,
                       size_t number) const;
  void tell(double share) const {
    if (progress_) progress_(share);
  }

  const Scene& scene_;
  const std::function<void(double)>& progress_;
  RecordingWriter writer_;
  Truth truth_;
  double time_;
  SimulationResult result_;
};

bool wanted(const SceneInclude& include, const Frame& frame) {
  const auto* cloud = std::get_if<CloudFrame>(&frame.content);
  if (!cloud && !std::holds_alternative<ImageFrame>(frame.content)) return false;
  if (include.sensors.empty()) return cloud != nullptr;
  const auto named = [&](const std::string& name) {
    return std::find(include.sensors.begin(), include.sensors.end(), name) != include.sensors.end();
  };
  return named(frame.sensor) || (cloud && named(cloud->kind));
}

void Simulation::copy_frames(const SceneInclude& include) {
  RecordingReader reader(include.recording);
  const Eigen::Isometry3d map_from_world = include.world_from_map.inverse();
  const double begin = time_;
  std::optional<double> first;
  while (auto frame = reader.next()) {
    if (!first) first = frame->time;
    if (!wanted(include, *frame)) continue;
    frame->time = begin + (frame->time - *first);
    std::visit(
        [&](auto& content) {
          if constexpr (requires { content.world_from_sensor; })
            content.world_from_sensor = map_from_world * content.world_from_sensor;
        },
        frame->content);
    writer_.write(*frame);
    time_ = std::max(time_, frame->time);
    ++result_.included_frames;
  }
  if (reader.damage()) throw std::invalid_argument(*reader.damage());
  if (result_.included_frames == 0)
    throw std::invalid_argument("recording '" + include.recording.string() +
                                "' has no frame to include; expected clouds or images of the named sensors.");
  time_ += after_copies;
}

void Simulation::record_depth() {
  const std::vector<Surface> surfaces(scene_.shapes.begin(), scene_.shapes.end());
  const SceneDepth& depth = *scene_.depth;
  const std::vector<Delivery> deliveries = deliver_depth(depth, scene_.seed);
  for (const Delivery& delivery : deliveries) {
    DepthImage image = photograph_depth(depth, delivery.image, surfaces, scene_.seed);
    const Eigen::Isometry3d true_pose = image.world_from_sensor;
    image.world_from_sensor = delivery.map_from_sensor;
    writer_.write(time_ + delivery.time, "depth", image);
    truth_.add_depth(time_ + delivery.time, true_pose);
    ++result_.depth_images;
    tell(0.1 * static_cast<double>(result_.depth_images) / static_cast<double>(deliveries.size()));
  }
  time_ += static_cast<double>(depth.map_from_sensor.size() * depth.passes) * depth.interval;
}

void Simulation::record_images() {
  const ProbeMotion motion(*scene_.stroke, *scene_.setup.probe);
  const auto still = still_surfaces(scene_);
  const ImageRenderer renderer(*scene_.setup.camera, scene_.camera->map_from_camera, still,
                               scene_.background);
  result_.duration = motion.duration();
  result_.stroke_length = motion.length();
  const double interval = 1 / scene_.camera->rate_hz;
  const size_t count = static_cast<size_t>(duration_of_pictures(scene_) / interval + 1e-9) + 1;
  const size_t batch = 4 * thread_count();
  for (size_t begin = 0; begin < count; begin += batch) {
    std::vector<GrayImage> images(std::min(batch, count - begin));
    parallel_for(images.size(), [&](size_t i) {
      images[i] = photograph(renderer, motion, static_cast<double>(begin + i) * interval, begin + i);
    });
    for (size_t i = 0; i < images.size(); ++i) {
      const double since = static_cast<double>(begin + i) * interval;
      const MovingThings moving = moving_things(scene_, motion, since);
      truth_.add_image(time_ + since, moving, still, surfaces_of(scene_.setup, moving));
      // The pose is left at the origin: where the camera stands is for the boards to say.
      writer_.write(
          Frame{time_ + since, "camera",
                ImageFrame{std::move(images[i]), *scene_.setup.camera, Eigen::Isometry3d::Identity()}});
    }
    result_.images += images.size();
    tell(0.1 + 0.9 * static_cast<double>(result_.images) / static_cast<double>(count));
  }
}

/// One picture, centred in its exposure.
GrayImage Simulation::photograph(const ImageRenderer& renderer, const ProbeMotion& motion, double time,
                                 size_t number) const {
  const SceneCamera& camera = *scene_.camera;
  const int steps = camera.exposure > 0 ? exposure_steps : 1;
  Radiance sum;
  for (int step = 0; step < steps; ++step) {
    const double instant = time + camera.exposure * ((step + 0.5) / steps - 0.5);
    Radiance picture = renderer.draw(surfaces_of(scene_.setup, moving_things(scene_, motion, instant)));
    if (step == 0) {
      sum = std::move(picture);
    } else {
      for (size_t i = 0; i < sum.values.size(); ++i) sum.values[i] += picture.values[i];
    }
  }
  for (float& value : sum.values) value /= static_cast<float>(steps);
  return expose(sum, camera.blur_px, camera.noise_sigma, scene_.seed, number);
}

}  // namespace

SimulationResult simulate(const Scene& scene, const std::filesystem::path& recording,
                          const std::function<void(double)>& progress) {
  return Simulation(scene, recording, progress).run();
}

}  // namespace clearway

#include "datasets/simulation/simulate.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>

#include "datasets/descriptions/probe_motion.hpp"
#include "datasets/simulation/delivered_depth.hpp"
#include "datasets/simulation/image_renderer.hpp"
#include "datasets/simulation/probe_surfaces.hpp"
#include "datasets/simulation/taken_pictures.hpp"
#include "datasets/simulation/true_scene.hpp"
#include "datasets/simulation/truth.hpp"
#include "datasets/sources/recording.hpp"
#include "mapping/system/atomic_file.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/parallel.hpp"

namespace clearway {
namespace {

constexpr double after_copies = 0.1;  // s until the first image of our own
constexpr int exposure_steps = 5;

/// The truth has a name that others may have taken, another recording among them.
void require_own_truth(const std::filesystem::path& file, const std::filesystem::path& recording) {
  std::error_code error;
  if (!std::filesystem::exists(file, error)) return;
  std::string begin;
  InputFile(file, "truth").read_at(0, 64, begin);
  if (begin.find("\"format\": \"clearway truth") == std::string::npos)
    throw std::invalid_argument("'" + file.string() +
                                "' was not written by simulate, which would replace it: expected another "
                                "folder for the recording.");
  if (!std::filesystem::exists(recording, error))
    throw std::invalid_argument("'" + file.string() +
                                "' is the truth of another recording, or of one that is gone, and simulate "
                                "would replace it: remove it, or take another folder for '" +
                                recording.filename().string() + "'.");
}

class Simulation {
 public:
  Simulation(const Scene& scene, const std::filesystem::path& recording,
             const std::function<void(double)>& progress)
      : stated_(scene),
        scene_(true_scene(scene)),
        progress_(progress),
        writer_(recording),
        truth_(scene_),
        time_(scene.start_time) {
    result_.recording = recording;
    result_.truth = recording.parent_path() / "truth.json";
    if (recording.filename() == "truth.json") {
      throw std::invalid_argument("recording '" + recording.string() +
                                  "': this name is the truth's; expected another, such as recording.rawlog.");
    }
    require_writable(result_.truth);
    if (recording.extension() != ".rawlog")
      throw std::invalid_argument("recording '" + recording.string() +
                                  "': simulate writes MRPT rawlogs, expected a name that ends in .rawlog.");
    require_own_truth(result_.truth, recording);
  }

  SimulationResult run() {
    writer_.write(Frame{time_, "", CommentFrame{scene_.setup_text}});
    for (const auto& include : scene_.includes) copy_frames(include);
    if (scene_.depth) deliveries_ = deliver_depth(*scene_.depth, scene_.seed);
    if (scene_.depth && !scene_.depth->beside_pictures) record_depth();
    if (scene_.camera) record_images();
    AtomicFile truth_file(result_.truth);
    truth_file.append(truth_.json(writer_.end()));
    writer_.finish();
    truth_file.finish();
    report_progress(1);
    return result_;
  }

 private:
  void copy_frames(const SceneInclude& include);
  void record_depth();
  void record_images();
  void write_depth(const Delivery& delivery, std::span<const Surface> surfaces);
  void write_depth_beside(double until, const ProbeMotion& motion, std::span<const Surface> still);
  void write_picture(const TakenPicture& picture, GrayImage image, const ProbeMotion& motion,
                     std::span<const Surface> still);
  GrayImage photograph(const ImageRenderer& renderer, const ProbeMotion& motion,
                       const TakenPicture& picture) const;
  GrayImage photograph_walking(const std::shared_ptr<const PixelRays>& rays,
                               const std::vector<Surface>& still, const ProbeMotion& motion,
                               const TakenPicture& picture) const;
  template <class Draw>
  GrayImage exposed(const TakenPicture& picture, const Draw& draw) const;
  void report_progress(double share) const {
    if (progress_) progress_(share);
  }

  const Scene& stated_;
  const Scene scene_;  ///< as it truly is
  const std::function<void(double)>& progress_;
  RecordingWriter writer_;
  Truth truth_;
  double time_;
  std::vector<Delivery> deliveries_;
  std::size_t next_delivery_ = 0;
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

void Simulation::write_depth(const Delivery& delivery, std::span<const Surface> surfaces) {
  DepthImage image = photograph_depth(*scene_.depth, delivery.image, surfaces, scene_.seed);
  truth_.add_depth(time_ + delivery.time, image.world_from_sensor);
  image.world_from_sensor = delivery.map_from_sensor;
  writer_.write(time_ + delivery.time, "depth", image);
  ++result_.depth_images;
}

void Simulation::record_depth() {
  const std::vector<Surface> surfaces(scene_.shapes.begin(), scene_.shapes.end());
  for (const Delivery& delivery : deliveries_) {
    write_depth(delivery, surfaces);
    report_progress(0.1 * static_cast<double>(result_.depth_images) /
                    static_cast<double>(deliveries_.size()));
  }
  time_ += static_cast<double>(scene_.depth->images()) * scene_.depth->interval;
}

/// The depth images that are stamped up to `until` seconds after the first picture. Their clock goes wrong by
/// the offset: they show what moves as it was that much earlier.
void Simulation::write_depth_beside(double until, const ProbeMotion& motion, std::span<const Surface> still) {
  if (!scene_.depth || !scene_.depth->beside_pictures) return;
  for (; next_delivery_ < deliveries_.size() && deliveries_[next_delivery_].time <= until; ++next_delivery_) {
    const Delivery& delivery = deliveries_[next_delivery_];
    const double taken = static_cast<double>(delivery.image) * scene_.depth->interval;
    std::vector<Surface> surfaces(still.begin(), still.end());
    const auto moving =
        surfaces_of(scene_, moving_things(scene_, motion, taken - scene_.depth->errors.clock_offset));
    surfaces.insert(surfaces.end(), moving.begin(), moving.end());
    write_depth(delivery, surfaces);
  }
}

void Simulation::write_picture(const TakenPicture& picture, GrayImage image, const ProbeMotion& motion,
                               std::span<const Surface> still) {
  const MovingThings moving = moving_things(scene_, motion, picture.taken);
  truth_.add_image(time_ + picture.stamp, camera_at(scene_, picture.taken), moving, still,
                   surfaces_of(scene_, moving));
  // The pose is left at the origin: where the camera stands is for the boards to say.
  writer_.write(Frame{time_ + picture.stamp, "camera",
                      ImageFrame{std::move(image), *stated_.setup.camera, Eigen::Isometry3d::Identity()}});
  ++result_.images;
}

void Simulation::record_images() {
  const ProbeMotion motion(*scene_.stroke, *scene_.setup.probe);
  const auto still = still_surfaces(scene_);
  const SceneCamera& camera = *scene_.camera;
  const bool stands = camera.path.empty() && camera.sway.shift == 0.0 && camera.sway.turn == 0.0;
  std::optional<ImageRenderer> renderer;
  const auto rays = std::make_shared<const PixelRays>(*scene_.setup.camera);
  if (stands) renderer.emplace(rays, camera.map_from_camera, still, scene_.background);
  result_.duration = motion.duration();
  result_.stroke_length = motion.length();
  const std::vector<TakenPicture> pictures = take_pictures(scene_);
  const size_t batch = 4 * thread_count();
  for (size_t begin = 0; begin < pictures.size(); begin += batch) {
    std::vector<GrayImage> images(std::min(batch, pictures.size() - begin));
    parallel_for(images.size(), [&](size_t i) {
      images[i] = renderer ? photograph(*renderer, motion, pictures[begin + i])
                           : photograph_walking(rays, still, motion, pictures[begin + i]);
    });
    for (size_t i = 0; i < images.size(); ++i) {
      write_depth_beside(pictures[begin + i].stamp, motion, still);
      write_picture(pictures[begin + i], std::move(images[i]), motion, still);
    }
    report_progress(0.1 +
                    0.9 * static_cast<double>(begin + images.size()) / static_cast<double>(pictures.size()));
  }
  write_depth_beside(HUGE_VAL, motion, still);
}

/// One picture, centred in its exposure.
template <class Draw>
GrayImage Simulation::exposed(const TakenPicture& picture, const Draw& draw) const {
  const SceneCamera& camera = *scene_.camera;
  const int steps = camera.exposure > 0 ? exposure_steps : 1;
  Radiance sum;
  for (int step = 0; step < steps; ++step) {
    Radiance drawn =
        draw(picture.taken + camera.exposure * ((step + 0.5) / steps - 0.5), EdgeRays{step, steps});
    if (step == 0) {
      sum = std::move(drawn);
    } else {
      for (size_t i = 0; i < sum.values.size(); ++i) sum.values[i] += drawn.values[i];
    }
  }
  const Exposure exposure = exposure_at(scene_, picture.taken);
  for (float& value : sum.values)
    value = static_cast<float>(exposure.gain) * (value / static_cast<float>(steps));
  return expose(sum, camera.blur_px, exposure.noise * camera.noise_sigma, scene_.seed, picture.number);
}

GrayImage Simulation::photograph(const ImageRenderer& renderer, const ProbeMotion& motion,
                                 const TakenPicture& picture) const {
  return exposed(picture, [&](double instant, EdgeRays edge_rays) {
    return renderer.draw(surfaces_of(scene_, moving_things(scene_, motion, instant)), edge_rays);
  });
}

/// The same by a camera that moves: what stands still is drawn anew, too.
GrayImage Simulation::photograph_walking(const std::shared_ptr<const PixelRays>& rays,
                                         const std::vector<Surface>& still, const ProbeMotion& motion,
                                         const TakenPicture& picture) const {
  return exposed(picture, [&](double instant, EdgeRays edge_rays) {
    const ImageRenderer renderer(rays, camera_at(scene_, instant), still, scene_.background, edge_rays);
    return renderer.draw(surfaces_of(scene_, moving_things(scene_, motion, instant)), edge_rays);
  });
}

}  // namespace

SimulationResult simulate(const Scene& scene, const std::filesystem::path& recording,
                          const std::function<void(double)>& progress) {
  return Simulation(scene, recording, progress).run();
}

}  // namespace clearway

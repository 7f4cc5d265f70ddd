#include "apps/overlay/recording_pictures.hpp"

#include <cstdio>

#include "apps/console/parse.hpp"
#include "apps/fusion/painter.hpp"
#include "mapping/system/parallel.hpp"

namespace clearway {
namespace {

MapOptions options_of(const Snapshot& map) {
  MapOptions options;
  options.resolution = map.resolution();
  return options;
}

}  // namespace

std::string to_tenths(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f s", seconds);
  return text;
}

GrowingPaint::GrowingPaint(const Snapshot& map)
    : final_(map), shown_(overlay_map(map)), paint_(options_of(map)) {
  for (const PaintedVolume& volume : map.volumes()) paint_.add_volume(volume.label, volume.critical_parts);
  next_.resize(map.volumes().size(), 0);
  map.visit_leaves([&](const Voxel& leaf) {
    if (leaf.state == VoxelState::conflict) conflicts_.push_back(leaf);
  });
  show();
}

const OverlayMap& GrowingPaint::at(double time) {
  bool is_new = false;
  for (std::size_t v = 0; v < next_.size(); ++v) {
    const PaintedVolume& volume = final_.volumes()[v];
    for (; next_[v] < volume.spheres.size() && volume.times[next_[v]] <= time; ++next_[v]) {
      paint_.paint(static_cast<int>(v), volume.spheres[next_[v]], volume.times[next_[v]]);
      is_new = true;
    }
  }
  if (is_new) show();
  return shown_;
}

std::size_t GrowingPaint::spheres() const {
  std::size_t count = 0;
  for (const std::size_t next : next_) count += next;
  return count;
}

void GrowingPaint::show() {
  const Snapshot painted = paint_.snapshot();
  shown_.volumes = overlay_map(painted).volumes;
  PageVoxels met{"conflict", painted.resolution()};
  for (const Voxel& leaf : conflicts_) {
    if (painted.state(leaf.center) != VoxelState::painted) continue;
    met.add(leaf.center, leaf.size);
  }
  shown_.conflicts = mesh_of(exposed_faces(met), met.size);
}

cv::Mat RecordingPictures::draw(const View& view, const ImagePoses& poses, double since_start) {
  OverlayScene scene;
  scene.map = &paint_.at(since_start);
  if (setup_.probe) scene.ball = ball_of(poses, since_start);
  scene.strip = strip(since_start);
  return draw_overlay(view.image, view.camera, view.camera_from_map, scene, thread_count());
}

cv::Mat RecordingPictures::draw_lost(const cv::Mat& image, const ImagePoses& poses, double since_start) {
  paint_.at(since_start);
  if (setup_.probe) ball_of(poses, since_start);
  cv::Mat picture;
  cv::merge(std::vector<cv::Mat>{image, image, image}, picture);
  draw_strip(picture, strip(since_start));
  return picture;
}

std::optional<OverlayBall> RecordingPictures::ball_of(const ImagePoses& poses, double since_start) {
  const ImagePose* ball = poses.find("ball", "ball", "map");
  if (ball == nullptr) return std::nullopt;
  if (!ball->is_accepted()) {
    refused_at_ = since_start;
    refusal_ = "Not painted: " + ball->reason;
    cure_ = cure_of(ball->refusal);
  }
  if (!ball->pose || !ball->bound) return std::nullopt;
  return OverlayBall{ball->pose->pose.translation(), setup_.probe->ball_radius, ball->bound->total,
                     ball->is_accepted()};
}

Strip RecordingPictures::strip(double since_start) const {
  Strip strip;
  strip.state = to_tenths(since_start) + ", " + counted(paint_.spheres(), "ball") + " painted";
  constexpr double held = 1.0;  // s: time to read it
  if (refused_at_ && since_start - *refused_at_ < held) {
    strip.refusal = refusal_;
    strip.cure = cure_;
  }
  return strip;
}

}  // namespace clearway

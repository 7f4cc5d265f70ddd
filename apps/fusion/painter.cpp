#include "apps/fusion/painter.hpp"

#include <algorithm>
#include <opencv2/core.hpp>
#include <stdexcept>

#include "apps/console/stopwatch.hpp"

namespace clearway {

namespace {

void override(double& value, const std::optional<double>& by) {
  if (by) value = *by;
}

LensDistortion::Model lens_of(LensModel model) {
  switch (model) {
    case LensModel::rational:
      return LensDistortion::Model::rational;
    case LensModel::fisheye:
      return LensDistortion::Model::fisheye;
    case LensModel::plumb_bob:
      break;
  }
  return LensDistortion::Model::plumb_bob;
}

}  // namespace

Camera tracking_camera(const CameraIntrinsics& intrinsics, const CameraErrorsSetup& errors) {
  Camera camera{intrinsics.width, intrinsics.height, intrinsics.fx,        intrinsics.fy,
                intrinsics.cx,    intrinsics.cy,     intrinsics.distortion};
  camera.lens = lens_of(intrinsics.lens);
  override(camera.errors.focal, errors.focal);
  override(camera.errors.aspect, errors.aspect);
  override(camera.errors.center, errors.center);
  if (intrinsics.is_rectified) camera.errors.distortion = kKnownDistortion;  // of the lens that was undone
  if (errors.distortion) camera.errors.distortion = errors.distortion;
  return camera;
}

TagBody tag_body(const BoardSetup& board) {
  TagBody body{board.name, {}};
  override(body.errors.scale, board.errors.scale);
  override(body.errors.size, board.errors.size);
  override(body.errors.place, board.errors.place);
  override(body.errors.turn, board.errors.turn);
  for (const TagSetup& tag : board.tags) body.tags[tag.id] = {tag.size, tag.board_from_tag};
  return body;
}

CameraIntrinsics intrinsics_of(const Setup& setup, const ImageFrame& image) {
  if (!setup.camera && image.intrinsics.width == 0)
    throw std::invalid_argument(
        "the recording does not have the camera of its images: expected `camera` in the setup");
  CameraIntrinsics camera = setup.camera ? *setup.camera : image.intrinsics;
  camera.is_rectified = camera.is_rectified || image.intrinsics.is_rectified;
  return camera;
}

Camera camera_of(const Setup& setup, const ImageFrame& image) {
  return tracking_camera(intrinsics_of(setup, image), setup.errors.camera);
}

TrackingOptions tracking_options(const Setup& setup) {
  const AcceptanceSetup& acceptance = setup.acceptance;
  const DetectorSetup& detector = setup.detector;
  TrackingOptions options;
  options.detector.family = detector.family;
  if (detector.decimate) options.detector.decimate = *detector.decimate;
  override(options.detector.sigma, detector.sigma);
  override(options.detector.sharpening, detector.sharpening);
  if (detector.max_hamming) options.detector.max_hamming = *detector.max_hamming;
  override(options.detector.min_margin, detector.min_margin);
  override(options.acceptance.max_rms_px, acceptance.max_reprojection_px);
  override(options.acceptance.min_ambiguity_ratio, acceptance.min_ambiguity);
  override(options.acceptance.max_noise, acceptance.max_noise);
  override(options.acceptance.max_speed, acceptance.max_speed);
  override(options.acceptance.max_turn_speed, acceptance.max_turn_speed);
  override(options.acceptance.max_pause, acceptance.max_pause);
  override(options.pose.pixel_noise, acceptance.pixel_noise);
  override(options.pose.edge_bias, setup.errors.edge);
  if (acceptance.min_tags)
    options.acceptance.min_base_tags = options.acceptance.min_probe_tags = *acceptance.min_tags;
  options.acceptance.fixed_camera = acceptance.fixed_camera;
  return options;
}

const BoardSetup& fixed_board(const Setup& setup, const std::string& needed_by) {
  const auto found = std::find_if(setup.boards.begin(), setup.boards.end(),
                                  [](const BoardSetup& board) { return board.map_from_board.has_value(); });
  if (found != setup.boards.end()) return *found;
  throw std::invalid_argument("setup: " + needed_by +
                              " needs a fixed board to be measured against: expected one of `boards` "
                              "to have `map_from_board`");
}

TrackingSetup tracking_setup(const Setup& setup, const ImageFrame& image) {
  const ProbeSetup& probe = *setup.probe;
  TrackingSetup tracking;
  tracking.camera = camera_of(setup, image);
  tracking.base = tag_body(fixed_board(setup, "a probe"));
  tracking.probe = {tag_body(*setup.board(probe.board)), probe.ball_center, probe.ball_radius};
  tracking.budget = {probe.robot_error, probe.tracking_error, probe.modelling_error, probe.constant_tracking};
  return tracking;
}

Painter::Painter(const Setup& setup, FreeSpaceMap& map, FusionCounts& counts)
    : setup_(setup), map_(map), counts_(counts) {
  base_ = &fixed_board(setup, "a probe");
  volumes_ = setup.volumes;
}

TrackedImage Painter::take(const Frame& frame, const ImageFrame& image, const std::vector<TagDetection>& tags,
                           double since_start, const std::optional<Brush>& brush) {
  if (!session_) session_.emplace(tracking_setup(setup_, image), tracking_options(setup_));
  const cv::Mat gray(image.image.height, image.image.width, CV_8UC1,
                     const_cast<std::uint8_t*>(image.image.pixels.data()));
  TrackedImage tracked;
  {
    const Stopwatch watch(counts_.track_s);
    tracked = session_->step(gray, tags, frame.time);
  }
  if (!tracked.sample.accepted)
    counts_.first_refusals.try_emplace(to_string(tracked.sample.refusal), tracked.sample.reason);
  if (tracked.sample.accepted && brush) use(*brush, tracked.sample, since_start);
  if (tracked.sample.accepted && !brush) paint(tracked.sample, frame.sensor, since_start);
  return tracked;
}

void Painter::finish() {
  if (session_) {
    counts_.samples = session_->probe().counts();
    counts_.base_moves = session_->probe().base_moves();
    counts_.doubts = session_->probe().doubts();
  }
  if (counts_.spheres == 0) return;
  for (double* sum : {&counts_.mean_center_sigma, &counts_.mean_reprojection_px, &counts_.mean_bound,
                      &counts_.painted_radius})
    *sum /= static_cast<double>(counts_.spheres);
}

/// A stroke ends when the hand pauses: when no sample was accepted for a second.
void Painter::continue_stroke(const std::string& sensor, double since_start) {
  constexpr double pause = 1.0;
  const bool goes_on = last_painted_ && since_start - *last_painted_ <= pause;
  last_painted_ = since_start;
  if (!goes_on) map_.begin_stroke("stroke " + std::to_string(++strokes_), sensor);
}

Sphere Painter::sphere_of(const PaintingSample& sample) const {
  const Eigen::Isometry3d map_from_base = base_->map_from_board.value_or(Eigen::Isometry3d::Identity());
  return {map_from_base * sample.sphere.center, sample.sphere.radius};
}

/// Into the volumes whose time it is.
void Painter::paint(const PaintingSample& sample, const std::string& sensor, double since_start) {
  const Stopwatch watch(counts_.paint_s);
  continue_stroke(sensor, since_start);
  const Sphere sphere = sphere_of(sample);
  bool used = false;
  for (std::size_t v = 0; v < volumes_.size(); ++v) {
    if (since_start < volumes_[v].from || since_start > volumes_[v].to) continue;
    map_.paint(static_cast<int>(v), sphere, since_start);
    used = true;
  }
  if (used)
    count(sample, sphere);
  else
    ++counts_.accepted_outside_volumes;
}

/// What is erased is the whole ball and what it may be off: nothing that it touches stays painted.
void Painter::use(const Brush& brush, const PaintingSample& sample, double since_start) {
  const Stopwatch watch(counts_.paint_s);
  Sphere sphere = sphere_of(sample);
  if (brush.use == Brush::Use::paints) {
    map_.paint(brush.volume, sphere, since_start);
    count(sample, sphere);
  } else if (brush.use == Brush::Use::erases) {
    sphere.radius = setup_.probe->ball_radius + sample.bound.total;
    map_.erase(brush.volume, sphere, since_start);
    ++counts_.erasers;
  }
}

void Painter::count(const PaintingSample& sample, const Sphere& sphere) {
  counts_.smallest_radius =
      counts_.spheres == 0 ? sphere.radius : std::min(counts_.smallest_radius, sphere.radius);
  ++counts_.spheres;
  counts_.painted_radius += sphere.radius;
  counts_.largest_bound = std::max(counts_.largest_bound, sample.bound.total);
  counts_.mean_bound += sample.bound.total;
  counts_.largest_center_sigma = std::max(counts_.largest_center_sigma, sample.center_sigma);
  counts_.mean_center_sigma += sample.center_sigma;
  counts_.mean_reprojection_px += sample.probe ? sample.probe->rms_px : 0.0;
}

}  // namespace clearway

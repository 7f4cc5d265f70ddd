#include "apps/fusion.hpp"

#include <algorithm>
#include <chrono>
#include <opencv2/core.hpp>
#include <stdexcept>

#include "apps/parse.hpp"
#include "datasets/recording.hpp"
#include "tracking/tracking_session.hpp"

namespace clearway {

namespace {

class Stopwatch {
 public:
  explicit Stopwatch(double& total) : total_(total) {}
  ~Stopwatch() { total_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count(); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  double& total_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

/// The setup embedded by `clearway simulate`: the first comment of the recording.
std::optional<Setup> embedded_setup(const std::filesystem::path& recording) {
  RecordingReader reader(recording);
  const std::optional<Frame> first = reader.next();
  if (!first) return std::nullopt;
  const auto* comment = std::get_if<CommentFrame>(&first->content);
  if (comment == nullptr) return std::nullopt;
  return parse_setup(comment->text, recording.string() + " (embedded setup)");
}

Camera tracking_camera(const CameraIntrinsics& intrinsics) {
  return {intrinsics.width, intrinsics.height, intrinsics.fx,        intrinsics.fy,
          intrinsics.cx,    intrinsics.cy,     intrinsics.distortion};
}

TagBody tag_body(const BoardSetup& board) {
  TagBody body{board.name, {}};
  for (const TagSetup& tag : board.tags) body.tags[tag.id] = {tag.size, tag.board_from_tag};
  return body;
}

/// The board that anchors the map frame: the first with a place in it.
const BoardSetup* fixed_board(const Setup& setup) {
  const auto found = std::find_if(setup.boards.begin(), setup.boards.end(),
                                  [](const BoardSetup& board) { return board.map_from_board.has_value(); });
  if (found == setup.boards.end()) {
    throw std::invalid_argument(
        "setup: a probe needs a fixed board to be measured against: expected one of `boards` "
        "to have `map_from_board`");
  }
  return &*found;
}

/// Image -> painted ball: a tracking session, made when the first image tells the camera.
class Painter {
 public:
  Painter(const Setup& setup, FreeSpaceMap& map, FusionCounts& counts)
      : setup_(setup), map_(map), counts_(counts) {
    const ProbeSetup& probe = *setup.probe;
    base_ = fixed_board(setup);
    probe_board_ = setup.board(probe.board);
    volumes_ = setup.volumes;
    for (const VolumeSetup& volume : volumes_) map_.add_volume(volume.label, volume.critical_parts);
  }

  void take(const Frame& frame, const ImageFrame& image, double since_start) {
    if (!session_) start_session(image);
    const cv::Mat gray(image.image.height, image.image.width, CV_8UC1,
                       const_cast<std::uint8_t*>(image.image.pixels.data()));
    TrackedImage tracked;
    {
      const Stopwatch watch(counts_.track_s);
      tracked = session_->step(gray, frame.time);
    }
    counts_.detections += tracked.detections.size();
    counts_.images_with_tags += tracked.detections.empty() ? 0 : 1;
    if (tracked.sample.accepted) paint(tracked.sample, since_start);
  }

  void finish() {
    if (session_) {
      counts_.samples = session_->probe().counts();
      counts_.painted_radius = session_->probe().painted_radius();
    }
    if (counts_.balls > 0) {
      counts_.mean_center_sigma /= static_cast<double>(counts_.balls);
      counts_.mean_reprojection_px /= static_cast<double>(counts_.balls);
    }
  }

 private:
  void start_session(const ImageFrame& image) {
    const ProbeSetup& probe = *setup_.probe;
    TrackingSetup tracking;
    tracking.camera = tracking_camera(setup_.camera ? *setup_.camera : image.intrinsics);
    tracking.base = tag_body(*base_);
    tracking.probe = {tag_body(*probe_board_), probe.ball_center, probe.ball_radius};
    tracking.budget = {probe.robot_error, probe.tracking_error, probe.modelling_error};
    TrackingOptions options;
    const AcceptanceSetup& acceptance = setup_.acceptance;
    if (acceptance.max_reprojection_px) options.acceptance.max_rms_px = *acceptance.max_reprojection_px;
    if (acceptance.min_ambiguity) options.acceptance.min_ambiguity_ratio = *acceptance.min_ambiguity;
    if (acceptance.max_speed) options.acceptance.max_speed = *acceptance.max_speed;
    if (acceptance.min_tags)
      options.acceptance.min_base_tags = options.acceptance.min_probe_tags = *acceptance.min_tags;
    if (acceptance.pixel_noise) options.pose.pixel_noise = *acceptance.pixel_noise;
    options.acceptance.fixed_camera = acceptance.fixed_camera;
    session_.emplace(tracking, options);
  }

  /// The ball in the map frame, into the volumes whose time it is.
  void paint(const PaintingSample& sample, double since_start) {
    const Stopwatch watch(counts_.paint_s);
    const Eigen::Isometry3d map_from_base = base_->map_from_board.value_or(Eigen::Isometry3d::Identity());
    const Sphere ball{map_from_base * sample.ball.center, sample.ball.radius};
    bool used = false;
    for (std::size_t v = 0; v < volumes_.size(); ++v) {
      if (since_start < volumes_[v].from || since_start > volumes_[v].to) continue;
      map_.paint(static_cast<int>(v), ball, since_start);
      used = true;
    }
    if (!used) {
      ++counts_.accepted_outside_volumes;
      return;
    }
    ++counts_.balls;
    counts_.largest_center_sigma = std::max(counts_.largest_center_sigma, sample.center_sigma);
    counts_.mean_center_sigma += sample.center_sigma;
    counts_.mean_reprojection_px += sample.probe ? sample.probe->rms_px : 0.0;
  }

  const Setup& setup_;
  FreeSpaceMap& map_;
  FusionCounts& counts_;
  const BoardSetup* base_ = nullptr;
  const BoardSetup* probe_board_ = nullptr;
  std::vector<VolumeSetup> volumes_;
  std::optional<TrackingSession> session_;
};

void insert_scan(const Frame& frame, const CloudFrame& cloud, const Setup& setup, FreeSpaceMap& map,
                 FusionCounts& counts) {
  const Stopwatch watch(counts.insert_s);
  Scan scan{frame.time, frame.sensor, cloud.world_from_sensor, cloud.points};
  ScanFilter filter;
  filter.min_range = setup.map.min_range.value_or(0.0);
  filter.max_range = setup.map.max_range.value_or(0.0);
  filter.thin_to = setup.map.thin_to;
  if (setup.map.crop) filter.crop = *setup.map.crop;
  const ScanCounts done = map.insert(scan, filter);
  ++counts.scans;
  counts.scan_origin_sum += scan.map_from_sensor.translation();
  counts.points.inserted += done.inserted;
  counts.points.beyond_range += done.beyond_range;
  counts.points.dropped_invalid += done.dropped_invalid;
  counts.points.dropped_filter += done.dropped_filter;
  counts.scans_refused += done.origin_invalid ? 1 : 0;
}

/// A recording that was to paint and shows no tag is a mistake of the user, told before anything is written.
void require_tags(const Fusion& fusion, const std::filesystem::path& recording) {
  if (!fusion.setup.probe || fusion.counts.images_with_tags > 0) return;
  const std::string images = fusion.counts.images == 0
                                 ? "no camera image"
                                 : "no tag in its " + grouped(fusion.counts.images) + " images";
  throw std::invalid_argument(recording.string() + ": there is " + images + ", but the setup (" +
                              fusion.setup_source +
                              ") has a probe to paint with: expected tag36h11 tags of boards '" +
                              fixed_board(fusion.setup)->name + "' and '" + fusion.setup.probe->board + "'");
}

void warn_of_leftovers(Fusion& fusion) {
  const FusionCounts& counts = fusion.counts;
  if (fusion.setup.probe && counts.balls == 0) {
    std::string reasons;
    for (const auto& [reason, count] : counts.samples) {
      if (count > 0) reasons += (reasons.empty() ? "" : ", ") + reason + " " + std::to_string(count);
    }
    fusion.warnings.push_back("nothing was painted: no sample was accepted (" + reasons + ")");
  }
  if (counts.scans_refused > 0) {
    fusion.warnings.push_back(std::to_string(counts.scans_refused) +
                              " scans start outside the map's range and were left out");
  }
}

}  // namespace

Fusion fuse(const std::filesystem::path& recording, const std::filesystem::path& setup_file,
            double resolution, const std::function<void(double)>& progress) {
  RecordingReader reader(recording);
  Fusion fusion;
  fusion.setup_source = "none";
  if (!setup_file.empty()) {
    fusion.setup = load_setup(setup_file);
    fusion.setup_source = setup_file.string();
  } else if (auto embedded = embedded_setup(recording)) {
    fusion.setup = *embedded;
    fusion.setup_source = "embedded in the recording";
  }
  MapOptions options;
  options.resolution = resolution > 0.0 ? resolution : fusion.setup.map.resolution.value_or(0.02);
  options.discretize = fusion.setup.map.discretize.value_or(false);
  fusion.map = FreeSpaceMap(options);

  std::optional<Painter> painter;
  if (fusion.setup.probe) painter.emplace(fusion.setup, fusion.map, fusion.counts);
  std::optional<double> start;
  FusionCounts& counts = fusion.counts;
  while (true) {
    std::optional<Frame> frame;
    {
      const Stopwatch watch(counts.read_s);
      frame = reader.next();
    }
    if (!frame) break;
    ++counts.frames;
    if (!start && !std::holds_alternative<CommentFrame>(frame->content)) start = frame->time;
    const double since_start = start ? frame->time - *start : 0.0;
    counts.duration = std::max(counts.duration, since_start);
    if (const auto* image = std::get_if<ImageFrame>(&frame->content)) {
      ++counts.images;
      if (painter) painter->take(*frame, *image, since_start);
    } else if (const auto* cloud = std::get_if<CloudFrame>(&frame->content)) {
      insert_scan(*frame, *cloud, fusion.setup, fusion.map, counts);
    } else if (std::holds_alternative<OdometryFrame>(frame->content)) {
      ++counts.odometry;
    }
    progress(reader.progress());
  }
  progress(1.0);
  if (painter) painter->finish();
  fusion.damage = reader.damage();
  fusion.warnings = reader.warnings();
  if (!fusion.damage) require_tags(fusion, recording);
  warn_of_leftovers(fusion);
  return fusion;
}

}  // namespace clearway

#include "apps/fusion/fusion.hpp"

#include <algorithm>
#include <stdexcept>
#include <thread>

#include "apps/console/parse.hpp"
#include "apps/console/stopwatch.hpp"
#include "apps/fusion/board_poses.hpp"
#include "apps/fusion/frame_source.hpp"
#include "apps/fusion/painter.hpp"
#include "apps/fusion/scan_inserter.hpp"

namespace clearway {

namespace {

/// The setup embedded by `clearway simulate`: the first comment of the recording.
std::optional<Setup> embedded_setup(const std::filesystem::path& recording) {
  const std::optional<Frame> first = open_frames(recording)->next();
  if (!first) return std::nullopt;
  const auto* comment = std::get_if<CommentFrame>(&first->content);
  if (comment == nullptr) return std::nullopt;
  return parse_setup(comment->text, recording.string() + " (embedded setup)");
}

/// A recording that was to paint and shows no tag is a mistake of the user, told before anything is written.
void require_tags(const Fusion& fusion, const std::filesystem::path& recording) {
  if (!fusion.setup.probe || fusion.counts.images_with_tags > 0) return;
  const std::string images = fusion.counts.images == 0
                                 ? "no camera image"
                                 : "no tag in its " + grouped(fusion.counts.images) + " images";
  throw std::invalid_argument(
      recording.string() + ": there is " + images + ", but the setup (" + fusion.setup_source +
      ") has a probe to paint with: expected tag36h11 tags of boards '" +
      fixed_board(fusion.setup, "a probe").name + "' and '" + fusion.setup.probe->board + "'");
}

void warn_of_leftovers(Fusion& fusion) {
  const FusionCounts& counts = fusion.counts;
  if (fusion.setup.probe && counts.spheres == 0) {
    std::string reasons;
    for (const auto& [reason, count] : counts.samples) {
      if (count > 0) reasons += (reasons.empty() ? "" : ", ") + reason + " " + std::to_string(count);
    }
    fusion.warnings.push_back("nothing was painted: no sample was accepted (" + reasons + ")");
  }
  if (counts.scans_without_pose > 0) {
    fusion.warnings.push_back(std::to_string(counts.scans_without_pose) +
                              " scans have no pose at their time and were left out");
  }
  if (counts.scans_refused > 0) {
    fusion.warnings.push_back(std::to_string(counts.scans_refused) +
                              " scans start outside the map's range and were left out");
  }
}

MapOptions map_options(const FusionOptions& options, const MapSetup& setup) {
  const std::string integration =
      options.integration.empty() ? setup.integration.value_or("safe") : options.integration;
  const auto processors = static_cast<int>(std::thread::hardware_concurrency());
  MapOptions map;
  map.resolution = options.resolution > 0.0 ? options.resolution : setup.resolution.value_or(map.resolution);
  map.discretize = setup.discretize.value_or(map.discretize);
  map.integration = integration == "compatible" ? Integration::compatible : Integration::safe;
  map.margins.band = setup.safe_band.value_or(map.margins.band);
  map.threads = options.threads > 0 ? options.threads : std::clamp(processors, 1, 8);
  return map;
}

}  // namespace

Fusion fuse(const std::filesystem::path& recording, const FusionOptions& options,
            const std::function<void(double)>& progress) {
  const std::unique_ptr<FrameSource> frames = open_frames(recording);
  Fusion fusion;
  fusion.setup_source = "none";
  if (!options.setup_file.empty()) {
    fusion.setup = load_setup(options.setup_file);
    fusion.setup_source = options.setup_file.string();
  } else if (auto embedded = embedded_setup(recording)) {
    fusion.setup = *embedded;
    fusion.setup_source = "embedded in the recording";
  }
  fusion.map = FreeSpaceMap(map_options(options, fusion.setup.map));
  fusion.map.keep_scans();

  std::optional<Painter> painter;
  if (fusion.setup.probe) painter.emplace(fusion.setup, fusion.map, fusion.counts);
  BoardPoses boards(fusion.setup);
  ScanInserter scans(fusion.setup, fusion.map, fusion.counts, boards);
  std::optional<double> start;
  FusionCounts& counts = fusion.counts;
  while (true) {
    std::optional<Frame> frame;
    {
      const Stopwatch watch(counts.read_s);
      frame = frames->next();
    }
    if (!frame) break;
    ++counts.frames;
    if (!start && !std::holds_alternative<CommentFrame>(frame->content)) start = frame->time;
    const double since_start = start ? frame->time - *start : 0.0;
    counts.duration = std::max(counts.duration, since_start);
    if (const auto* image = std::get_if<ImageFrame>(&frame->content)) {
      ++counts.images;
      std::optional<TrackedImage> tracked;
      if (painter) tracked = painter->take(*frame, *image, since_start);
      boards.take(*frame, *image, tracked ? &*tracked : nullptr);
      scans.release();
    } else if (const auto* cloud = std::get_if<CloudFrame>(&frame->content)) {
      scans.take(*frame, *cloud);
    } else if (std::holds_alternative<OdometryFrame>(frame->content)) {
      ++counts.odometry;
    }
    progress(frames->progress());
  }
  boards.finish();
  scans.finish();
  progress(1.0);
  if (painter) painter->finish();
  fusion.damage = frames->damage();
  if (fusion.damage) fusion.map.note_damaged_recording(fusion.counts.frames);
  fusion.warnings = frames->warnings();
  if (!fusion.damage) require_tags(fusion, recording);
  warn_of_leftovers(fusion);
  return fusion;
}

}  // namespace clearway

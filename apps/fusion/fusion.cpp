#include "apps/fusion/fusion.hpp"

#include <algorithm>
#include <stdexcept>

#include "apps/console/parse.hpp"
#include "apps/console/stopwatch.hpp"
#include "apps/fusion/board_poses.hpp"
#include "apps/fusion/body_painter.hpp"
#include "apps/fusion/emptiness.hpp"
#include "apps/fusion/moving_robot.hpp"
#include "apps/fusion/open_frames.hpp"
#include "apps/fusion/paced_frames.hpp"
#include "apps/fusion/painter.hpp"
#include "apps/fusion/recorded_frames.hpp"
#include "apps/fusion/scan_inserter.hpp"
#include "apps/fusion/tag_search.hpp"
#include "datasets/sources/ordered_frames.hpp"
#include "mapping/maps/map_damage.hpp"
#include "mapping/maps/suspect_paint.hpp"
#include "mapping/system/parallel.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {

namespace {

void count_tags(const std::vector<TagDetection>& tags, FusionCounts& counts) {
  counts.detections += tags.size();
  counts.images_with_tags += tags.empty() ? 0 : 1;
  for (const TagDetection& tag : tags) counts.ids_seen.insert(tag.id);
}

void warn_of_leftovers(Fusion& fusion) {
  const FusionCounts& counts = fusion.counts;
  if (fusion.setup.probe && counts.spheres == 0) {
    const auto accepted = counts.samples.find("accepted");
    const bool is_any = accepted != counts.samples.end() && accepted->second > 0;
    fusion.warnings.push_back(
        std::string("nothing was painted: ") +
        (is_any ? "painting was off while the ball was seen" : "no sample was accepted") + " (" +
        refusals_of(counts) + ")");
  }
  if (const StaticBoard::Moves& moves = counts.base_moves; moves.count > 0)
    fusion.warnings.push_back(
        "the base board moved before the camera, by up to " + significant(1e3 * moves.farthest, 3) + " mm (" +
        counted(static_cast<std::size_t>(moves.count), "time") +
        "), though `fixed_camera: true` says that both stand still: what was painted before and after is "
        "placed by where the board stood then");
  if (const Probe::Doubts& doubts = counts.doubts; doubts.samples > 0)
    fusion.warnings.push_back(
        counted(static_cast<std::size_t>(doubts.samples), "accepted sample rests", "accepted samples rest") +
        " on " + (doubts.tags.size() == 1 ? "tag " : "tags ") + list_of_ids(doubts.tags) +
        " alone, which another tag of the same body contradicts: one of them is not where the setup has it, "
        "and what was painted may be off by more than its bound (`clearway calibrate board` shows which)");
  for (const auto* clauses : {&counts.lost_poses, &counts.range_spikes})
    fusion.warnings.insert(fusion.warnings.end(), clauses->begin(), clauses->end());
  if (counts.scans_without_pose > 0) {
    fusion.warnings.push_back(std::to_string(counts.scans_without_pose) +
                              " scans have no pose at their time and were left out");
  }
  if (counts.scans_probe_hidden > 0) {
    fusion.warnings.push_back(counted(counts.scans_probe_hidden, "scan was", "scans were") +
                              " left out: for a moment no image shows where the probe or the "
                              "gripper in them is");
  }
  if (counts.scans_without_joints > 0) {
    fusion.warnings.push_back(counted(counts.scans_without_joints, "scan was", "scans were") +
                              " left out: at their time the robot's joints are not known; of the first, " +
                              counts.joint_gap);
  }
  if (counts.infinite_beams > 0) {
    std::string beams = grouped(counts.infinite_beams) + " beams of laser scans are +inf";
    if (counts.beams_at_range > 0)
      beams += " or, " + grouped(counts.beams_at_range) + " of them, no less than range_max" +
               (fusion.setup.source.no_return > 0.0 ? " or `no_return`" : "") +
               ", which is taken for the same";
    fusion.warnings.push_back(
        fusion.setup.source.clear_infinite
            ? beams + ", of which " + grouped(counts.points.cleared) + " free space up to range_max"
            : beams + " (REP 117: nothing within range_max; of some drivers no answer) and were left out; " +
                  "`source: {scans: {clear_infinite: true}}` of the setup lets them free space up to "
                  "range_max");
  }
  if (counts.scans_refused > 0) {
    fusion.warnings.push_back(counted(counts.scans_refused, "scan starts", "scans start") +
                              " outside the map's range, left out");
  }
}

int machine_threads() { return static_cast<int>(std::min<std::size_t>(thread_count(), 8)); }

/// Threads for tag detection; 0: no tags are needed.
std::size_t search_threads(const FusionOptions& options, const Fusion& fusion, const BoardPoses& boards) {
  if (!fusion.setup.probe && !boards.are_needed()) return 0;
  const int threads =
      options.threads > 0 ? options.threads : fusion.setup.detector.threads.value_or(machine_threads());
  return static_cast<std::size_t>(threads);
}

MapOptions map_options(const FusionOptions& options, const MapSetup& setup) {
  const std::string integration =
      options.integration.empty() ? setup.integration.value_or("safe") : options.integration;
  MapOptions map;
  map.resolution = options.resolution > 0.0 ? options.resolution : setup.resolution.value_or(map.resolution);
  map.discretize = setup.discretize.value_or(map.discretize);
  map.integration = integration == "compatible" ? Integration::compatible : Integration::safe;
  map.margins.band = setup.safe_band.value_or(map.margins.band);
  map.threads = options.threads > 0 ? options.threads : machine_threads();
  return map;
}

}  // namespace

Fusion fuse(const std::filesystem::path& recording, const FusionOptions& options,
            const std::function<void(double)>& progress) {
  Fusion fusion;
  ChosenSetup chosen = options.setup ? ChosenSetup{*options.setup, options.setup_file.string()}
                                     : choose_setup(recording, options.setup_file);
  fusion.setup = std::move(chosen.setup);
  fusion.setup_source = std::move(chosen.source);
  fusion.setup.source.camera_seconds = options.camera_seconds;
  const MapOptions map = map_options(options, fusion.setup.map);
  fusion.setup.source.resolution = map.resolution;
  std::optional<MovingRobot> robot;
  if (auto joints = recorded_joints(fusion.setup, recording)) {
    robot.emplace(*fusion.setup.robot, std::move(*joints));
    if (fusion.setup.robot->joint_file.empty())
      fusion.setup.source.bag.joint_topic = fusion.setup.robot->joint_topic;
    fusion.setup.source.bag.robot_base = robot->robot().links.front().name;
  }
  std::unique_ptr<FrameSource> frames = open_frames(recording, fusion.setup.source);
  OrderedFrames* ordered = nullptr;
  if (!frames->is_live()) {
    auto in_order = std::make_unique<OrderedFrames>(std::move(frames), recording.string());
    ordered = in_order.get();
    frames = std::move(in_order);
  }
  if (options.is_paced && !frames->is_live()) frames = std::make_unique<PacedFrames>(std::move(frames));
  RecordedFrames* recorded = nullptr;
  if (!options.frames_file.empty()) {
    auto recording_frames =
        std::make_unique<RecordedFrames>(std::move(frames), options.frames_file, fusion.setup);
    recorded = recording_frames.get();
    frames = std::move(recording_frames);
  }
  fusion.map = FreeSpaceMap(map);
  fusion.map.keep_scans();

  for (const VolumeSetup& volume : fusion.setup.volumes)
    if (fusion.setup.probe || (fusion.setup.robot && !fusion.setup.robot->paints.empty()))
      fusion.map.add_volume(volume.label, volume.critical_parts);
  std::optional<Painter> painter;
  if (fusion.setup.probe) painter.emplace(fusion.setup, fusion.map, fusion.counts);
  BoardPoses boards(fusion.setup);
  std::optional<BodyPainter> body;
  if (robot && !fusion.setup.robot->paints.empty()) body.emplace(fusion.setup, *robot, fusion.map);
  ScanInserter scans(fusion.setup, fusion.map, fusion.counts, boards, robot ? &*robot : nullptr,
                     options.observer);
  TagSearch search(*frames, tracking_options(fusion.setup).detector, search_threads(options, fusion, boards));
  TimelineKeeper timeline(fusion.timeline);
  TakenCameras cameras;
  std::optional<double> start;
  FusionCounts& counts = fusion.counts;
  if (options.guide != nullptr) options.guide->begin(fusion.setup, fusion.map, counts);
  bool is_ended_early = false;  // by who teaches, before there was an image
  while (true) {
    std::optional<SearchedFrame> searched;
    {
      const Stopwatch watch(counts.read_s);
      searched = search.next();
    }
    if (!searched) break;
    const Frame* frame = &searched->frame;
    if (!start && !std::holds_alternative<CommentFrame>(frame->content)) {
      start = frame->time;
      timeline.start_at(frame->time);
    }
    const double since_start = start ? frame->time - *start : 0.0;
    if (options.guide != nullptr && start && !options.guide->before(since_start)) {
      is_ended_early = counts.images == 0;
      break;
    }
    if (body && start)
      body->paint_until(frame->time, *start,
                        options.guide != nullptr ? std::optional(options.guide->brush()) : std::nullopt);
    ++counts.frames;
    counts.duration = std::max(counts.duration, since_start);
    if (const auto* image = std::get_if<ImageFrame>(&frame->content)) {
      ++counts.images;
      std::optional<TrackedImage> tracked;
      count_tags(searched->tags, counts);
      const auto brush = options.guide != nullptr ? std::optional(options.guide->brush()) : std::nullopt;
      if (painter) tracked = painter->take(*frame, *image, searched->tags, since_start, brush);
      if (tracked && options.observer != nullptr)
        options.observer->see({tracked->sample, fusion.setup, fixed_board(fusion.setup, "a probe"),
                               intrinsics_of(fusion.setup, *image)});
      timeline.see(*image, searched->tags, tracked ? &tracked->sample : nullptr, since_start);
      boards.take(*frame, *image, searched->tags, tracked ? &*tracked : nullptr);
      if (options.guide != nullptr)
        options.guide->see({*frame, searched->tags, tracked ? &tracked->sample : nullptr,
                            boards.gripper_at(frame->time), since_start, searched->read});
      scans.release();
    } else if (const auto* cloud = std::get_if<CloudFrame>(&frame->content)) {
      scans.take(*frame, *cloud);
      timeline.see_scan(since_start);
    } else if (std::holds_alternative<OdometryFrame>(frame->content)) {
      ++counts.odometry;
    }
    cameras.see(*frame, fusion.setup);
    progress(frames->progress());
  }
  if (ordered != nullptr) ordered->refuse_set_back();
  timeline.finish();
  boards.finish();
  scans.finish();
  if (recorded != nullptr) recorded->finish();
  if (options.guide != nullptr) options.guide->end();
  counts.read_s -= search.waited();
  counts.track_s += search.waited();
  progress(1.0);
  if (painter) painter->finish();
  if (body) {
    counts.body_spheres = body->spheres();
    counts.body_radius = body->largest_radius();
  }
  fusion.damage = frames->damage();
  const bool is_taught = is_ended_early || (options.guide != nullptr &&
                                            counts.spheres > 0);  // a session is kept whatever it painted
  if (fusion.damage && !is_taught && !has_content(fusion))
    throw std::invalid_argument(fusion.damage->substr(0, fusion.damage->find_last_not_of('.') + 1) +
                                "; nothing gets into the map");
  if (fusion.damage) fusion.map.note_damaged_recording(fusion.counts.frames);
  fusion.warnings = frames->warnings();
  fusion.cameras = cameras.all(*frames);
  if (!fusion.damage && !is_taught) {
    require_content(fusion, recording);
    if (!frames->is_live()) require_sensors(fusion, recording);
  }
  if (const std::string none = unpainted_reason(fusion); !none.empty()) fusion.warnings.push_back(none);
  if (const std::string caveat = frames->time_caveat(); !caveat.empty()) fusion.warnings.push_back(caveat);
  warn_of_leftovers(fusion);
  if (robot) fusion.warnings.insert(fusion.warnings.end(), robot->doubts().begin(), robot->doubts().end());
  const Snapshot made = fusion.map.snapshot();
  for (const std::string& caveat : {contradiction_caveat(made), suspect_paint_caveat(made)})
    if (!caveat.empty()) fusion.warnings.push_back(caveat);
  return fusion;
}

}  // namespace clearway

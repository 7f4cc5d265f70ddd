// A control loop of an arm beside a thread that fuses depth frames: how long a new map holds the loop up, how
// old its map is, and how soon it reacts to something new; against the same update made in the loop. In
// `detail`: the parts of an update, and what a loop would wait for a reader's lock on an octomap::OcTree.

#include <octomap/OcTree.h>

#include <algorithm>
#include <thread>

#include "apps/bench/bench.hpp"
#include "apps/bench/live_world.hpp"
#include "apps/bench/worlds/arm_damper.hpp"

namespace clearway::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr double frames_a_second = 30.0;

/// One depth frame's way into the loop's map. Seconds.
struct Update {
  double taken = 0.0;  ///< when the camera had it
  double collect = 0.0, insert = 0.0, snapshot = 0.0, space = 0.0, step = 0.0, publish = 0.0;
  double published = 0.0;  ///< when it was handed over
  std::uint64_t number = 0;
  int known = -1;  ///< the place whose fist is in the map, of this frame's
};

bool has_blocked_voxel(const ConfigurationSpace& space, const Sphere& place) {
  const Eigen::AlignedBox3d box(place.center.array() - place.radius, place.center.array() + place.radius);
  return !space.blocked_space(2)->visit_blocked(box, [](const Eigen::Vector3d&) { return false; });
}

Update update(LiveWorld& world, LiveControl& live, const LiveFrame& frame, double taken) {
  Update done{.taken = taken};
  const double old = steady_seconds();
  live.collect();
  const double begin = steady_seconds();
  world.map.insert(frame.scan);
  const double inserted = steady_seconds();
  Snapshot map = world.map.snapshot();
  const double shown = steady_seconds();
  ConfigurationSpace space = world.space(std::move(map));
  const double ready = steady_seconds();
  if (frame.place >= 0 && has_blocked_voxel(space, world.task.places[static_cast<std::size_t>(frame.place)]))
    done.known = frame.place;
  const double looked = steady_seconds();
  LiveControl::ReadyMap next = live.prepare(std::move(space), steady_time(taken));
  done.published = steady_seconds();
  done.number = live.publish(std::move(next));
  done.publish = steady_seconds() - done.published;
  done.step = done.published - looked;
  done.collect = begin - old;
  done.insert = inserted - begin;
  done.snapshot = shown - inserted;
  done.space = ready - shown;
  return done;
}

/// Fuses the newest frame of a camera that has begun at `begin`, over and over.
std::vector<Update> keep_updating(LiveWorld& world, LiveControl& live, double begin,
                                  const std::atomic<bool>& done) {
  std::vector<Update> updates;
  for (std::size_t next = 0; !done;) {
    const double taken = begin + static_cast<double>(next) / frames_a_second;
    std::this_thread::sleep_until(steady_time(taken));
    updates.push_back(update(world, live, world.frames[next % world.frames.size()], taken));
    next = std::max(next + 1, static_cast<std::size_t>((steady_seconds() - begin) * frames_a_second));
  }
  return updates;
}

Json reported(const std::vector<Update>& updates) {
  const auto part = [&](double Update::*value) {
    std::vector<double> all;
    for (const Update& update : updates) all.push_back(1e3 * (update.*value));
    return Json{{"median", median(all)}, {"max", quantile(all, 1.0)}};
  };
  return {{"updates", updates.size()},
          {"taking_old_maps_apart_ms", part(&Update::collect)},
          {"insert_ms", part(&Update::insert)},
          {"snapshot_ms", part(&Update::snapshot)},
          {"space_and_fields_ms", part(&Update::space)},
          {"control_step_ms", part(&Update::step)},
          {"hand_over_and_taking_apart_ms", part(&Update::publish)}};
}

/// From handing over the first map that has a fist, and from its frame, until the end of the first step with
/// a constraint for it.
Json reactions(const std::vector<Update>& updates, const std::vector<LoopTurn>& turns) {
  std::vector<double> published, taken;
  std::size_t never = 0;
  int known = -1;
  for (const Update& update : updates) {
    const bool is_new = update.known >= 0 && update.known != known;
    known = update.known;
    if (!is_new || update.published > turns.back().begin - 0.1) continue;
    const auto first = std::find_if(turns.begin(), turns.end(),
                                    [&](const LoopTurn& turn) { return turn.number >= update.number; });
    const auto has_constraint = [&](const LoopTurn& turn) { return (turn.places >> update.known & 1U) != 0; };
    if (first == turns.begin() || has_constraint(*(first - 1))) continue;  // not forgotten since last time
    const auto reacted = std::find_if(first, turns.end(), has_constraint);
    if (reacted == turns.end() || reacted->end - update.published > 0.1) {
      ++never;
      continue;
    }
    published.push_back(reacted->end - update.published);
    taken.push_back(1e3 * (reacted->end - update.taken));
  }
  return {{"new_obstacles", published.size() + never},
          {"without_a_row", never},
          {"after_publication_us", microseconds(published)},
          {"after_the_frame_ms", {{"median", median(taken)}, {"max", quantile(taken, 1.0)}}}};
}

/// A loop beside a thread that maps.
Json run_beside(LiveWorld& world, LiveControl& live, const LoopTask& task, bool real_time, double& worst) {
  std::atomic<bool> done = false;
  std::vector<Update> updates;
  std::thread mapper([&, begin = steady_seconds()] { updates = keep_updating(world, live, begin, done); });
  const LoopLog log = run_loop(live, task, real_time);
  done = true;
  mapper.join();
  worst = 0.0;
  std::vector<double> usual;
  for (const LoopTurn& turn : log.turns) usual.push_back(turn.end - turn.begin);
  const double usually = median(usual);
  for (const LoopTurn& turn : log.turns)
    if (turn.is_new) worst = std::max(worst, turn.end - turn.begin - usually);
  return {
      {"loop", reported(log)}, {"update", reported(updates)}, {"reaction", reactions(updates, log.turns)}};
}

/// The loop makes each update itself, when its frame is there.
Json run_alternating(LiveWorld& world, LiveControl& live, const LoopTask& task, double& worst) {
  std::vector<Update> updates;
  std::vector<double> held;
  const double begin = steady_seconds();
  std::size_t next = 0;
  const LoopLog log = run_loop(live, task, true, [&] {
    const double taken = begin + static_cast<double>(next) / frames_a_second, now = steady_seconds();
    if (taken > now) return;
    updates.push_back(update(world, live, world.frames[next % world.frames.size()], taken));
    next = std::max(next + 1, static_cast<std::size_t>((steady_seconds() - begin) * frames_a_second));
    held.push_back(steady_seconds() - now);
  });
  worst = quantile(held, 1.0);
  return {{"loop", reported(log)}, {"held_by_update_us", microseconds(held)}, {"update", reported(updates)}};
}

/// What MoveIt's occupancy monitor does with a frame: rays into sets of keys, then updateNode for each key
/// while it holds the lock that readers wait for. And a copy of the tree, which would need no lock.
Json octomap_under_lock(const LiveWorld& world, double resolution) {
  octomap::OcTree tree(resolution);
  std::vector<double> locked, copied;
  for (std::size_t i = 0; i < 6; ++i) {
    const Scan& scan = world.frames[i].scan;
    octomap::Pointcloud cloud;
    for (const Eigen::Vector3f& point : scan.points) {
      const Eigen::Vector3f at = (scan.map_from_sensor * point.cast<double>()).cast<float>();
      cloud.push_back(at.x(), at.y(), at.z());
    }
    const Eigen::Vector3f eye = scan.map_from_sensor.translation().cast<float>();
    octomap::KeySet free, occupied;
    tree.computeDiscreteUpdate(cloud, {eye.x(), eye.y(), eye.z()}, free, occupied, -1.0);
    const double begin = steady_seconds();
    for (const octomap::OcTreeKey& key : free) tree.updateNode(key, false);
    for (const octomap::OcTreeKey& key : occupied) tree.updateNode(key, true);
    const double end = steady_seconds();
    const octomap::OcTree copy(tree);
    copied.push_back(steady_seconds() - end);
    if (i > 0) locked.push_back(end - begin);  // the first one makes the tree
  }
  return {{"held_by_update_of_nodes_us", microseconds(locked)},
          {"copy_of_the_tree_us", microseconds(copied)}};
}

using Pointer = Json::json_pointer;

/// A row of the result of `microseconds`, times `unit`.
std::vector<std::string> percentile_row(const std::string& name, const Json& detail, const char* path) {
  const Json& reported = detail.at(Pointer(path));
  const auto cell = [&](const char* key) {
    return reported.contains(key) ? figure(reported.at(key).get<double>()) : std::string("–");
  };
  return {name, cell("median"), cell("p99"), cell("max")};
}

std::vector<Table> live_tables(const Json& detail) {
  const std::vector<std::string> us{"wall us", "median", "p99", "most"},
      ms{"wall ms", "median", "p99", "most"};
  const std::string beside = "/loop_2khz_beside_mapping", loop = beside + "/loop",
                    update = beside + "/update";
  const auto row = [&](const char* name, const std::string& path) {
    return percentile_row(name, detail, path.c_str());
  };
  const auto few = [&](const char* name, const std::string& path) {  // too few for a p99
    std::vector<std::string> cells = row(name, path);
    cells[2] = "–";
    return cells;
  };
  Table steps{"The loop at 2 kHz:", us, {}};
  steps.rows = {row("step, alone", "/loop_2khz_alone/step_us"),
                row("step, beside mapping", loop + "/step_us"),
                row("hand-over of a map", loop + "/held_by_hand_over_us"),
                row("first step with a map", loop + "/first_step_with_a_map_us"),
                few("from publication to the first step with a row for something new",
                    beside + "/reaction/after_publication_us"),
                row("the same update made in the loop", "/loop_that_maps_itself/held_by_update_us"),
                few("OctoMap: `updateNode` under a lock, one frame", "/octomap/held_by_update_of_nodes_us"),
                few("OctoMap: a copy of that tree", "/octomap/copy_of_the_tree_us")};
  Table updates{"An update beside it:", ms, {}};
  updates.rows = {row("frame into the map, two threads", update + "/insert_ms"),
                  row("snapshot", update + "/snapshot_ms"),
                  row("space and fields", update + "/space_and_fields_ms"),
                  row("control step", update + "/control_step_ms"),
                  row("taking an old map apart", update + "/taking_old_maps_apart_ms"),
                  row("from the frame to the first step with a row for something new",
                      beside + "/reaction/after_the_frame_ms"),
                  row("age of the map", loop + "/age_ms")};
  return {steps, updates};
}

/// The loops one after the other. Returns how long a new map held the loop at worst, seconds: beside a
/// thread, and made in the loop.
Pair run_loops(const BenchOptions& options, LiveWorld& world, Json& detail) {
  LoopTask paced = world.task;
  paced.period = 0.5e-3;
  LiveControl live(arm_damper(world.robot, 0.001), {.max_age = std::chrono::milliseconds(500)});
  for (std::size_t i = 0; i < 10; ++i) update(world, live, world.frames[i], steady_seconds());
  LiveControl still(arm_damper(world.robot, 0.001), {.max_age = std::chrono::hours(1)});
  const auto alone = [&](const LoopTask& task, bool real_time) {
    update(world, still, world.frames.back(), steady_seconds());
    still.fetch(world.task.one);
    return reported(run_loop(still, task, real_time));
  };
  Pair worst;
  double worst_free = 0.0;
  options.say("loop at 2 kHz alone");
  detail["loop_2khz_alone"] = alone(paced, true);
  options.say("loop at 2 kHz beside mapping");
  const auto fetch_now = [&] {  // or it begins with a map as old as the loop before took
    update(world, live, world.frames.back(), steady_seconds());
    live.fetch(world.task.one);
  };
  fetch_now();
  detail["loop_2khz_beside_mapping"] = run_beside(world, live, paced, true, worst.ours);
  options.say("loop without pause alone");
  detail["loop_free_alone"] = alone(world.task, false);
  options.say("loop without pause beside mapping");
  fetch_now();
  detail["loop_free_beside_mapping"] = run_beside(world, live, world.task, false, worst_free);
  options.say("loop that maps itself");
  detail["loop_that_maps_itself"] = run_alternating(world, live, paced, worst.peer);
  return worst;
}

}  // namespace

BenchResult bench_live(const BenchOptions& options) {
  const double resolution = options.resolution > 0.0 ? options.resolution : 0.02;
  LiveWorld world = make_live_world(resolution, influence);
  world.task.duration = std::min(options.runs, 60);  // each turn is remembered
  const VoxelCounts counts = world.map.snapshot().counts();
  const std::size_t known = counts.seen_free + counts.occupied;
  Json detail{{"known_voxels", known},
              {"blocked_voxels", world.space(world.map.snapshot()).blocked_space(2)->blocked_count()},
              {"resolution", resolution},
              {"points_a_frame", world.frames.front().scan.points.size()},
              {"seconds_a_loop", world.task.duration}};
  const Pair worst = run_loops(options, world, detail);
  options.say("OctoMap under a lock");
  detail["octomap"] = octomap_under_lock(world, resolution);
  BenchResult result{1e3 * worst.ours,
                     1e3 * worst.peer,
                     "the same update made in the loop",
                     "ms that a new map held a 2 kHz loop at worst",
                     true,
                     options.runs,
                     detail};
  result.compared =
      "A control loop of a PUMA 560 at 2 kHz (SCHED_FIFO where that is granted: " +
      std::string(detail["loop_2khz_alone"]["real_time_priority"].get<bool>() ? "here it was" : "here not") +
      ") in a map of " + figure(1e-6 * static_cast<double>(known)) + " million known voxels at " +
      length_text(resolution) + ", while 640 × 480 frames come at 30 Hz, " + count_text(world.task.duration) +
      " s per loop: a thread that maps beside it against the same update made in the loop. The OctoMap rows "
      "are what a "
      "loop would wait for, who shares one tree.";
  result.tables = live_tables(detail);
  return result;
}

}  // namespace clearway::bench

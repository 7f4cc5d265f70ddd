#include "apps/pages/report.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "apps/console/parse.hpp"
#include "apps/inspect/inspect_parts.hpp"
#include "apps/pages/map_page.hpp"
#include "apps/query/loads.hpp"
#include "mapping/files/map_file.hpp"
#include "mapping/maps/map_integration.hpp"
#include "mapping/system/atomic_file.hpp"
#include "mapping/voxels/fused_tree.hpp"

namespace clearway {

namespace {

using Json = nlohmann::ordered_json;

double joules(const Plan& plan) {
  double sum = 0.0;
  for (const PlanResult& leg : plan.legs) sum += leg.cost + leg.last_segment_cost;
  return sum;
}

int steps(const Plan& plan) {
  int sum = 0;
  for (const PlanResult& leg : plan.legs) sum += leg.search_steps;
  return sum;
}

/// Of the ball, in the map as it is: without those that were undone or erased.
std::size_t kept_balls(const ReplayReport& report) {
  std::size_t kept = 0;
  for (const PaintedVolume& volume : report.map.volumes()) kept += volume.spheres.size();
  const FusionCounts& counts = report.fusion->counts;
  return std::min(kept - std::min(kept, counts.body_spheres), counts.spheres);
}

Json recording_json(const ReplayReport& report) {
  const FusionCounts& counts = report.fusion->counts;
  return {{"file", report.recording.string()},
          {"duration_s", counts.duration},
          {"damage", report.fusion->damage ? Json(*report.fusion->damage) : Json(nullptr)},
          {"setup", report.fusion->setup_source}};
}

Json tracking_json(const FusionCounts& counts, const Setup& setup) {
  Json json{{"images", counts.images},
            {"images_with_tags", counts.images_with_tags},
            {"detections", counts.detections}};
  Json refused = Json::object();
  std::int64_t accepted = 0;
  for (const auto& [reason, count] : counts.samples) {
    if (reason == "accepted") {
      accepted = count;
    } else if (count > 0) {
      refused[reason] = count;
    }
  }
  json["accepted"] = accepted;
  json["refused"] = refused;
  json["accepted_outside_volumes"] = counts.accepted_outside_volumes;
  if (setup.probe) {
    json["error_budget"] = {{"ball_radius_m", setup.probe->ball_radius},
                            {"robot_error_m", setup.probe->robot_error},
                            {"tracking_error_m", setup.probe->tracking_error},
                            {"modelling_error_m", setup.probe->modelling_error},
                            {"tracking", setup.probe->constant_tracking ? "constant" : "bound"},
                            {"painted_radius_m", counts.painted_radius},
                            {"smallest_painted_radius_m", counts.smallest_radius},
                            {"largest_bound_m", counts.largest_bound},
                            {"mean_bound_m", counts.mean_bound},
                            {"largest_center_sigma_m", counts.largest_center_sigma},
                            {"mean_center_sigma_m", counts.mean_center_sigma},
                            {"mean_reprojection_px", counts.mean_reprojection_px}};
  }
  return json;
}

Json plan_json(const ReplayPlan& entry) {
  const Plan& plan = entry.plan;
  Json json = {{"query", entry.query},
               {"planner", plan.planner},
               {"file", entry.file.string()},
               {"status", to_string(plan.status())},
               {"explanation", plan.explanation()},
               {"legs", plan.legs.size()},
               {"search_steps", steps(plan)},
               {"cost_joules", joules(plan)},
               {"time_s", plan.time_s},
               {"verdict", plan.waypoints().empty() ? "none"
                           : plan.validation.valid  ? "valid"
                                                    : "refused"},
               {"min_clearance_m", plan.validation.min_clearance},
               {"padding_m", plan.padding}};
  if (plan.motion)
    json["motion"] = {{"smooth", true},
                      {"duration_s", plan.motion->motion.duration()},
                      {"min_clearance_m", plan.motion->validation.min_clearance}};
  if (!plan.motion_caveat.empty()) json["motion"] = {{"smooth", false}, {"note", plan.motion_caveat}};
  for (const LegLoad& load : plan.loads) json["loads"].push_back(describe_load(load));
  if (plan.survey) json.update(Json::parse(to_json(*plan.survey)));
  return json;
}

Json cameras_json(const std::vector<TakenCamera>& cameras) {
  Json json = Json::array();
  for (const TakenCamera& camera : cameras)
    json.push_back({{"sensor", camera.sensor},
                    {"taken_as", camera.is_rectified ? "rectified" : "raw"},
                    {"known_by", camera.known_by}});
  return json;
}

Json scans_json(const FusionCounts& counts) {
  Json json{{"count", counts.scans},
            {"refused", counts.scans_refused},
            {"without_pose", counts.scans_without_pose},
            {"without_probe", counts.scans_without_probe},
            {"probe_hidden", counts.scans_probe_hidden},
            {"points_inserted", counts.points.inserted},
            {"points_beyond_range", counts.points.beyond_range},
            {"points_invalid", counts.points.dropped_invalid},
            {"points_filtered", counts.points.dropped_filter}};
  if (counts.infinite_beams > 0) {
    json["beams_infinite"] = counts.infinite_beams;
    json["beams_cleared"] = counts.points.cleared;
  }
  return json;
}

Json map_json(const ReplayReport& report) {
  const MapOptions& options = report.fusion->map.options();
  const bool safe = options.integration == Integration::safe;
  Json json{{"file", "map.ot"},
            {"resolution", report.map.resolution()},
            {"integration", safe ? "safe" : "compatible"}};
  if (safe) json["safe_band"] = options.margins.band;
  if (const ScanAgreement& agreement = report.map.tree().agreement(); agreement.looked_up > 0) {
    json["hits_called_free"] = {{"share", agreement.share_called_free()},
                                {"called_free", agreement.called_free},
                                {"looked_up", agreement.looked_up},
                                {"amid_free", agreement.amid_free},
                                {"compared", agreement.compared}};
  }
  return json;
}

Json volumes_json(const Snapshot& map) {
  Json json = Json::array();
  for (const PaintedVolume& volume : map.volumes())
    json.push_back({{"label", volume.label},
                    {"critical_parts", volume.critical_parts},
                    {"balls", volume.spheres.size()}});
  return json;
}

/// Each event, what came of it, and the state after it.
PageTable teaching_table(const Json& teaching) {
  PageTable table{"teaching", {"s", "action", "what came of it", "state"}, {}};
  for (const Json& event : teaching["events"]) {
    const auto text = [&](const char* key) {
      return event.contains(key) ? event[key].get<std::string>() : "";
    };
    const std::string name = event.contains("load")       ? event["load"]["name"].get<std::string>()
                             : text("action") == "volume" ? text("label")
                                                          : text("name");
    table.rows.push_back(
        {significant(event["time"].get<double>(), 5), text("action") + (name.empty() ? "" : " " + name),
         event.contains("refused") ? "refused: " + text("refused") : text("remark"), text("state")});
  }
  return table;
}

}  // namespace

ReplayReport report_of(const Fusion& fusion, const std::filesystem::path& recording) {
  ReplayReport report;
  report.recording = recording;
  report.fusion = &fusion;
  report.timings = {{"read", fusion.counts.read_s},
                    {"track", fusion.counts.track_s},
                    {"paint", fusion.counts.paint_s},
                    {"insert", fusion.counts.insert_s}};
  return report;
}

void save_fused_map(ReplayReport& report, const std::filesystem::path& folder) {
  save_map(report.map, folder);
  report.provenance = report.fusion->map.provenance();
  save_provenance(report.provenance, folder);
}

std::string save_report(const ReplayReport& report, const std::filesystem::path& folder) {
  const std::string json = report_json(report);
  save_file(folder / "report.json", json);
  save_file(folder / "report.html", report_html(report, json));
  return json;
}

std::string report_json(const ReplayReport& report) {
  const FusionCounts& counts = report.fusion->counts;
  const VoxelCounts voxels = report.map.counts();
  Json json;
  json["recording"] = recording_json(report);
  json["frames"] = {{"total", counts.frames},
                    {"images", counts.images},
                    {"scans", counts.scans},
                    {"odometry", counts.odometry}};
  json["cameras"] = cameras_json(report.fusion->cameras);
  json["tracking"] = tracking_json(counts, report.fusion->setup);
  json["balls"] = kept_balls(report);
  if (kept_balls(report) < counts.spheres) json["balls_taken_back"] = counts.spheres - kept_balls(report);
  if (counts.body_spheres > 0) json["balls_of_the_robot"] = counts.body_spheres;
  json["scans"] = scans_json(counts);
  json["map"] = map_json(report);
  json["voxels"] = {{"painted", voxels.painted},
                    {"seen_free", voxels.seen_free},
                    {"occupied", voxels.occupied},
                    {"conflict", voxels.conflict}};
  json["conflicts"] = voxels.conflict;
  json["conflict_records"] = describe_conflicts(report.provenance);
  json["volumes"] = volumes_json(report.map);
  json["painted_volumes"] = describe_volumes(report.map);
  json["plans"] = Json::array();
  for (const ReplayPlan& plan : report.plans) json["plans"].push_back(plan_json(plan));
  json["planning_problem"] = report.planning_problem;
  if (!report.teaching.empty()) json["teaching"] = Json::parse(report.teaching);
  json["warnings"] = report.fusion->warnings;
  for (const auto& [stage, seconds] : report.timings) json["timings_s"][stage] = seconds;
  return json.dump(2) + "\n";
}

std::vector<std::pair<std::string, std::string>> report_figures(const ReplayReport& report) {
  const FusionCounts& counts = report.fusion->counts;
  const VoxelCounts voxels = report.map.counts();
  std::vector<std::pair<std::string, std::string>> rows;
  rows.emplace_back("frames", grouped(counts.frames) + " (" + counted(counts.images, "image") + ", " +
                                  counted(counts.scans, "scan") + ", " + grouped(counts.odometry) +
                                  " odometry), " + significant(counts.duration, 3) + " s");
  for (const TakenCamera& camera : report.fusion->cameras)
    rows.emplace_back("camera " + camera.sensor, shown(camera));
  if (report.fusion->setup.probe) {
    std::string refused;
    for (const auto& [reason, count] : counts.samples) {
      if (reason != "accepted" && count > 0) refused += ", " + reason + " " + std::to_string(count);
    }
    const std::size_t kept = kept_balls(report);
    rows.emplace_back(
        "balls painted",
        grouped(kept) +
            (kept < counts.spheres ? " (" + grouped(counts.spheres - kept) + " taken back)" : "") +
            " of mean r0 = " + significant(counts.painted_radius * 1000.0, 3) + " mm" +
            (refused.empty() ? "" : " (refused: " + refused.substr(2) + ")"));
    rows.emplace_back("centre error", "worst sigma " + significant(counts.largest_center_sigma * 1000.0, 2) +
                                          " mm; bound " + significant(counts.mean_bound * 1000.0, 2) +
                                          " mm, at most " + significant(counts.largest_bound * 1000.0, 2) +
                                          " mm");
  }
  rows.emplace_back("points", grouped(counts.points.inserted) + " inserted, " +
                                  grouped(counts.points.beyond_range) + " beyond range, " +
                                  grouped(counts.points.dropped_filter) + " filtered, " +
                                  grouped(counts.points.dropped_invalid) + " invalid");
  rows.emplace_back("voxels", significant(report.map.resolution() * 1000.0, 4) + " mm: " +
                                  grouped(voxels.painted) + " painted, " + grouped(voxels.seen_free) +
                                  " seen free, " + grouped(voxels.occupied) + " occupied");
  rows.emplace_back("conflicts", grouped(voxels.conflict));
  if (const std::string caveat = integration_caveat(report.map); !caveat.empty())
    rows.emplace_back("note", caveat);
  return rows;
}

std::vector<std::vector<std::string>> plan_table(const ReplayReport& report) {
  std::vector<std::vector<std::string>> rows{
      {"query", "planner", "status", "steps", "cost J", "time s", "path clearance mm", "check"}};
  for (const ReplayPlan& entry : report.plans) {
    const Plan& plan = entry.plan;
    const bool path = !plan.waypoints().empty();
    rows.push_back({entry.query, plan.planner, std::string(to_string(plan.status())),
                    path ? grouped(static_cast<std::size_t>(steps(plan))) : "-",
                    path ? significant(joules(plan), 4) : "-", significant(plan.time_s, 3),
                    path ? significant(plan.validation.min_clearance * 1000.0, 3) : "-",
                    !path                   ? "-"
                    : plan.validation.valid ? "valid"
                                            : "REFUSED"});
  }
  return rows;
}

namespace {

/// Bodies are the page's, not a plan's: loads are drawn where all plans carry the same.
std::vector<LegLoad> loads_of_all(const std::vector<ReplayPlan>& plans) {
  const std::vector<LegLoad>& loads = plans.front().plan.loads;
  const auto are_these = [&](const ReplayPlan& entry) {
    return std::equal(loads.begin(), loads.end(), entry.plan.loads.begin(), entry.plan.loads.end(),
                      [](const LegLoad& a, const LegLoad& b) { return is_same(a.load, b.load); }) &&
           entry.plan.robot == plans.front().plan.robot;
  };
  return std::all_of(plans.begin(), plans.end(), are_these) ? loads : std::vector<LegLoad>{};
}

}  // namespace

std::string report_html(const ReplayReport& report, const std::string& json) {
  const Setup& setup = report.fusion->setup;
  ReportPage page = page_of_map(MapLeaves(report.map),
                                setup.title.empty() ? report.recording.filename().string() : setup.title);
  page.subtitle = report.recording.filename().string();
  page.figures = report_figures(report);
  const FusionCounts& counts = report.fusion->counts;
  if (counts.scans > 0)
    look_from(page, report.map, counts.scan_origin_sum / static_cast<double>(counts.scans));
  page.map_place = "";
  page.recording = report.fusion->timeline;
  page.provenance.events = report.provenance.events;  // not the scans' cells, which are much
  page.provenance.strokes = report.provenance.strokes;
  page.provenance.conflicts = report.provenance.conflicts;
  page.warnings = report.fusion->warnings;
  if (report.fusion->damage) page.warnings.push_back(*report.fusion->damage);
  if (!report.planning_problem.empty()) page.warnings.push_back(report.planning_problem);
  if (!report.plans.empty()) {
    const ReplayPlan& first = report.plans.front();
    show_robot(page, with_all_loads(first.space->robot(), loads_of_all(report.plans)), first.start);
    for (const ReplayPlan& entry : report.plans) {
      page.plans.push_back(page_of_plan(entry.plan, *entry.space, entry.start, entry.query));
      if (!entry.approval.empty()) {
        auto& figures = page.plans.back().figures;
        figures.insert(figures.begin(), {"approval", entry.approval});
      }
    }
    const auto table = plan_table(report);
    page.tables.push_back({"plans", table.front(), {table.begin() + 1, table.end()}});
  }
  if (!report.teaching.empty()) page.tables.push_back(teaching_table(Json::parse(report.teaching)));
  PageTable timings{"time per stage", {"stage", "s"}, {}};
  for (const auto& [stage, seconds] : report.timings)
    timings.rows.push_back({stage, significant(seconds, 3)});
  page.tables.push_back(timings);
  page.pictures = report.pictures;
  page.json = json;
  return render_report_page(page);
}

}  // namespace clearway

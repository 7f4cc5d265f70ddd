#pragma once

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "apps/pages/report_page.hpp"

namespace clearway {

/// A rich page for tests: a small room (floor, wall, table) at 2 cm, a painted tunnel along an arc with its
/// exact spheres, the free space around it in large and small leaves, a few conflicts, a six-link arm, two
/// solved plans (the second long and sagging below zero clearance) and one that failed.
class SamplePage {
 public:
  static ReportPage make() {
    static const ReportPage page = SamplePage().page_;  // it takes longer than a copy
    return page;
  }

  /// The same with a fourth plan that has time: 60 waypoints, 0.05 s apart but for the last, after 2.92 s.
  static ReportPage make_timed() {
    ReportPage page = make();
    PagePlan& timed = page.plans.emplace_back(plan("boundary in time", 60, 0.6, 0.012));
    timed.period = 0.05;
    timed.duration = 58 * 0.05 + 0.02;
    timed.security_distance = 0.02;
    timed.max_speed = {1.0, 1.5, 2.0, 2.5, 3.0, 0.5};
    timed.max_acceleration.assign(6, 5.0);
    for (std::size_t i = 0; i < timed.waypoints.size(); ++i) {
      const Eigen::VectorXd before = timed.waypoints[i > 0 ? i - 1 : 0];
      timed.speeds.push_back((timed.waypoints[i] - before) / timed.period);
      timed.accelerations.push_back((timed.speeds[i] - timed.speeds[i > 0 ? i - 1 : 0]) / timed.period);
    }
    timed.speeds[30][1] = -1.8;  // too fast: 120 %
    return page;
  }

  /// That plan while sensors look: at 0 s one voxel is seen anew, at 1 s three, at 2 s none; the map is up to
  /// 0.3 s old.
  static ReportPage make_sensed() {
    ReportPage page = make_timed();
    PagePlan& plan = page.plans.back();
    plan.seen_voxel = 0.04;
    const Eigen::Vector3d first(0.3, 0.1, 0.5);
    plan.seen = {{0.0, {first}}, {1.0, {first, {0.34, 0.1, 0.5}, {0.34, 0.14, -0.5}}}, {2.0, {}}};
    for (std::size_t i = 0; i < plan.waypoints.size(); ++i) {
      plan.map_age.push_back(0.1 + 0.05 * static_cast<double>(i % 5));
      plan.true_separation.push_back(plan.clearance[i] + 0.01);
    }
    return page;
  }

  /// The first page of a recording of 10 s: ball i comes at 0.2 i seconds, an image every second, of which
  /// those from 3 to 5 s are refused and the others show 3 tags, a conflict at 6 s by scan 4. The first plan
  /// follows a boundary from its waypoint 20 to 39; the search made waypoint i in step i. Voxels below the
  /// map's origin in x were last seen at 100 s, the others at 160 s; the log-odds are those of two hits.
  static ReportPage make_recorded() {
    ReportPage page = make();
    page.map_place = "a map's folder";
    PagePlan& plan = page.plans.front();
    plan.phase_names = {"free motion", "boundary: end effector near what blocks it"};
    for (int i = 0; i < static_cast<int>(plan.waypoints.size()); ++i) {
      plan.phases.push_back(i >= 20 && i < 40 ? 1 : 0);
      plan.search_steps.push_back(i);
    }
    RecordingTimeline& recording = page.recording;
    recording.start = 1000.0;
    for (int i = 0; i <= 10; ++i) {
      const bool refused = i >= 3 && i <= 5;
      recording.images.push_back(i);
      recording.tags.push_back(refused ? 0 : 3);
      recording.accepted.push_back(refused ? 0 : 1);
    }
    recording.refusals = {{3.0, 5.0, 3, "probe_not_seen", "No tag of the probe was found."}};
    recording.scans = {1.0, 2.0, 6.0};
    for (std::size_t i = 0; i < page.spheres.size(); ++i) {
      const PageSphere& sphere = page.spheres[i];
      page.provenance.events.push_back(
          {sphere.volume, 0, false, {sphere.center, sphere.radius}, 0.2 * static_cast<double>(i)});
    }
    page.provenance.conflicts.records = {{{0, 0, 30}, 1006.0, true, 4, -1}};
    PageEvidence& evidence = page.evidence;
    evidence.cell = 8;
    evidence.low = {-56, -48, -8};
    evidence.size = {14, 12, 9};
    evidence.oldest = 100.0, evidence.newest = 160.0;
    evidence.least = -2.0, evidence.greatest = 1.5;
    for (int i = 0; i < evidence.size.prod(); ++i) {
      evidence.look.push_back(i % 14 < 7 ? 1 : 255);
      evidence.volume.push_back(i % 14 < 4 ? 0 : 1);
      evidence.low_odds.push_back(255);
      evidence.high_odds.push_back(255);
    }
    return page;
  }

 private:
  static constexpr double kVoxel = 0.02;

  SamplePage() {
    page_.title = "Kitchen, PUMA 560 at 1:10 <sample>";
    page_.subtitle = "synthetic recording, seed 7 & noise \xe2\x89\xa4 2 mm";
    page_.resolution = kVoxel;
    page_.figures = {
        {"frames", "120"},         {"detections", "233"},      {"samples accepted", "97"},
        {"samples refused", "23"}, {"scans integrated", "40"}, {"points", "1,228,800"},
        {"balls painted", "41"},   {"conflicts", "12"},        {"tracking error bound", "2.1 mm"},
        {"time", "8.4 s"}};
    page_.warnings = {"12 voxels are painted and occupied: they block every body (conflict).",
                      "3 frames show no probe tag."};
    page_.tables = {{"Refused samples",
                     {"reason", "samples", "share"},
                     {{"tag too small", "9", "39 %"}, {"ambiguous pose", "14", "61 %"}}},
                    {"Stages",
                     {"stage", "time", "calls", "per call", "thread", "peak memory", "note"},
                     {{"detect tags", "2.10 s", "120", "17.5 ms", "1", "48 MB", "640 \xc3\x97 480"},
                      {"integrate scans", "4.62 s", "40", "115.5 ms", "1", "210 MB", "2 cm"}}}};
    page_.json = "{\"frames\": 120, \"note\": \"</script><b>\"}\n";
    add_spheres();
    add_room();
    add_robot();
    page_.plans = {plan("beam", 60, 0.6, 0.012), plan("boundary", 240, 1.0, -0.004), failed_plan()};
  }

  void add_spheres() {
    page_.volume_labels = {"end effector", "load"};
    for (int i = 0; i <= 40; ++i) {
      const double angle = std::numbers::pi * (0.05 + 0.9 * i / 40);
      page_.spheres.push_back(
          {{0.55 * std::cos(angle), 0.45 * std::sin(angle) - 0.1, 0.42 + 0.12 * std::sin(2 * angle)},
           i % 4 == 0 ? 0.11 : 0.09,
           i < 30 ? 0 : 1});
    }
  }

  bool is_painted(const Eigen::Vector3d& corner, double size) const {
    for (const PageSphere& sphere : page_.spheres) {
      bool inside = (corner - sphere.center).norm() <= sphere.radius;
      for (int k = 0; k < 8 && inside; ++k) {
        const Eigen::Vector3d p = corner + size * Eigen::Vector3d(k & 1, k >> 1 & 1, k >> 2);
        inside = (p - sphere.center).norm() <= sphere.radius;
      }
      if (inside) return true;
    }
    return false;
  }

  static bool is_furniture(int x, int y, int z) {
    if (z < 0 || y >= 44) return true;                                              // floor, wall
    if (x > 18 && x < 48 && y > 10 && y < 40 && (z == 12 || z == 13)) return true;  // table
    if ((x == 20 || x == 46) && (y == 12 || y == 38) && z < 12) return true;        // its legs
    if (x < -20 && x > -40 && y > 26 && z > 30 && z < 46) return true;              // wall cabinet
    return x > 26 && x < 36 && y > 20 && y < 30 && z > 13 && z < 22;                // a box on the table
  }

  static void add(PageVoxels& set, int x, int y, int z, int side) {
    const auto mid = [&](int c) { return (c + 0.5 * side) * kVoxel; };
    set.add({mid(x), mid(y), mid(z)}, side * kVoxel);
  }

  void add_room() {
    PageVoxels occupied{"occupied", kVoxel}, painted{"painted", kVoxel}, conflict{"conflict", kVoxel},
        seen_free{"seen_free", kVoxel};
    for (int x = -56; x < 56; ++x)
      for (int y = -48; y < 46; ++y)
        for (int z = -2; z < 60; ++z) {
          const bool paint = is_painted(kVoxel * Eigen::Vector3d(x, y, z), kVoxel);
          const bool solid = is_furniture(x, y, z) || (paint && x == 0 && z > 24 && y < 18);
          if (solid && paint)
            add(conflict, x, y, z, 1);
          else if (solid)
            add(occupied, x, y, z, 1);
          else if (paint)
            add(painted, x, y, z, 1);
        }
    for (int x = -48; x < 16; x += 8)
      for (int y = -48; y < -16; y += 8)
        for (int z = 0; z < 40; z += 8) add(seen_free, x, y, z, 8);
    for (int x = 16; x < 24; ++x)
      for (int y = -30; y < -16; ++y)
        for (int z = 0; z < 20 - (x - 16); ++z) add(seen_free, x, y, z, 1);
    page_.voxels = {painted, occupied, conflict, seen_free};
  }

  void add_robot() {
    const auto shape = [&](std::string_view kind, Eigen::Vector3d size, int link, Eigen::Vector3d at,
                           bool critical = false) {
      PageShape s;
      s.kind = kind, s.size = size, s.link = link, s.critical = critical;
      s.part = critical ? "end effector" : "arm";
      s.link_from_shape.translation() = at;
      page_.robot.push_back(s);
    };
    shape("cylinder", {0.08, 0.24, 0}, 0, {0, 0, 0.12});
    shape("sphere", {0.075, 0, 0}, 1, {0, 0, 0.28});
    shape("capsule", {0.05, 0.24, 0}, 2, {0, 0, 0.12});
    shape("capsule", {0.042, 0.2, 0}, 3, {0, 0, 0.1});
    shape("box", {0.05, 0.06, 0.05}, 4, {0, 0, 0.02}, true);
    shape("mesh", {0, 0, 0}, 5, {0, 0, 0.05}, true);
    page_.robot.back().vertices = {
        {-0.04, -0.02, 0}, {0.04, -0.02, 0}, {0.04, 0.02, 0}, {-0.04, 0.02, 0}, {0, 0, 0.11}};
    page_.robot.back().triangles = {{0, 2, 1}, {0, 3, 2}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  }

  static std::vector<Eigen::Isometry3d> link_poses(const Eigen::VectorXd& q) {
    using Eigen::AngleAxisd, Eigen::Translation3d, Eigen::Vector3d;
    std::vector<Eigen::Isometry3d> poses(6, Eigen::Isometry3d::Identity());
    poses[1] = poses[0] * AngleAxisd(q[0], Vector3d::UnitZ());
    poses[2] = poses[1] * Translation3d(0, 0, 0.28) * AngleAxisd(q[1], Vector3d::UnitY());
    poses[3] = poses[2] * Translation3d(0, 0, 0.24) * AngleAxisd(q[2], Vector3d::UnitY());
    poses[4] = poses[3] * Translation3d(0, 0, 0.2) * AngleAxisd(q[3], Vector3d::UnitY());
    poses[5] = poses[4] * AngleAxisd(q[4], Vector3d::UnitZ()) * Translation3d(0, 0, q[5]);
    return poses;
  }

  static Eigen::VectorXd configuration(double s, double bend) {
    Eigen::VectorXd q(6);
    q << 0.1 + 2.7 * s, 0.5 + 0.25 * std::sin(3 * s), 0.9 + 0.3 * bend * std::cos(4 * s),
        0.4 * std::sin(6 * bend * s), 2 * s, 0.01 + 0.02 * s;
    return q;
  }

  static PagePlan plan(const std::string& planner, int waypoints, double bend, double least) {
    PagePlan out;
    out.name = out.planner = planner;
    out.status = "solved";
    out.explanation = "The goal was reached and the independent check holds the path valid.";
    out.joints = {"waist", "shoulder", "elbow", "wrist pitch", "wrist roll", "extension"};
    out.is_prismatic = {false, false, false, false, false, true};
    for (int i = 0; i < waypoints; ++i) {
      const double s = static_cast<double>(i) / (waypoints - 1);
      out.waypoints.push_back(configuration(s, bend));
      out.link_poses.push_back(link_poses(out.waypoints.back()));
      out.clearance.push_back(i == 5 ? std::nan("") : least + 0.06 * std::pow(std::cos(5 * s), 2));
      out.tip_path.push_back(out.link_poses.back()[5] * Eigen::Vector3d(0, 0, 0.16));
    }
    out.figures = {{"search steps", "1,204"}, {"cost", "3.21 J"},  {"length", "4.18 rad"},
                   {"time", "0.11 s"},        {"checks", "8,120"}, {"verdict", "valid"}};
    return out;
  }

  static PagePlan failed_plan() {
    PagePlan out;
    out.name = "beam, second goal";
    out.planner = "beam";
    out.status = "no_path";
    out.explanation =
        "The search ended after 412 steps with no state left to expand; the end effector leaves its painted "
        "volume "
        "at (0.31, -0.12, 0.44). Painting 0.08 m further along +x there would help most.";
    out.joints = {"waist", "shoulder", "elbow", "wrist pitch", "wrist roll", "extension"};
    out.is_prismatic = {false, false, false, false, false, true};
    out.start_poses = link_poses(configuration(0, 1));
    out.goal_poses = link_poses(configuration(1, 1));
    out.figures = {{"search steps", "412"}, {"time", "0.05 s"}};
    return out;
  }

  ReportPage page_;
};

}  // namespace clearway

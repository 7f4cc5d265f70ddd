#include "tests/evidence/people_evidence.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>

#include "mapping/files/map_file.hpp"
#include "planning/files/plan_file.hpp"
#include "planning/robot/kinematics.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/apps/run_command.hpp"

namespace clearway::evidence {
namespace {

using Json = nlohmann::json;

constexpr double to_rad = std::numbers::pi / 180.0;
constexpr double deep = 0.003;  ///< m inside of a solid: beyond a voxel and the sensors' noise

/// A thing that stands on the table, upright.
struct Solid {
  bool is_box = true;
  Eigen::Vector3d size;  ///< edges; of a cylinder radius, radius, height
  Eigen::Vector3d center;
  double turn = 0.0;

  /// How deep a point lies inside; below 0 outside.
  double depth(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d p = Eigen::AngleAxisd(-turn, Eigen::Vector3d::UnitZ()) * (point - center);
    const double up = 0.5 * size.z() - std::abs(p.z());
    if (!is_box) return std::min(size.x() - p.head<2>().norm(), up);
    return std::min((0.5 * size.head<2>() - p.head<2>().cwiseAbs()).minCoeff(), up);
  }

  std::string yaml(int number) const {
    char text[256];
    if (is_box)
      std::snprintf(
          text, sizeof text,
          "  - {name: solid%d, box: [%.5f, %.5f, %.5f], pose: [%.5f, %.5f, %.5f, 0, 0, %.4f], grey: 110}\n",
          number, size.x(), size.y(), size.z(), center.x(), center.y(), center.z(), turn);
    else
      std::snprintf(
          text, sizeof text,
          "  - {name: solid%d, cylinder: [%.5f, %.5f], pose: [%.5f, %.5f, %.5f, 0, 0, 0], grey: 90}\n",
          number, size.x(), size.z(), center.x(), center.y(), center.z());
    return text;
  }
};

class Session {
 public:
  explicit Session(std::uint64_t seed) : seed_(seed), random_(seed) {
    first_ = uniform(-65, -40);
    last_ = uniform(40, 65);
    low_ = uniform(52, 70);
    bump_ = uniform(5, 28);
    radius_ = uniform(70, 77);
    duration_ = uniform(3.5, 5.5);
    is_mistaken_ = uniform(0, 1) < 0.5;
    draw_solids();
  }

  PeopleEvidence run() {
    evidence_.sessions = 1;
    evidence_.mistakes = is_mistaken_;
    write_file(folder_ / "scene.yaml", scene());
    write_file(folder_ / "events.jsonl", events());
    if (!succeeds({"simulate", folder_.file("scene.yaml"), "--out", folder_.file("r.rawlog")}, {exit_done}))
      return evidence_;
    if (!succeeds({"teach", folder_.file("r.rawlog"), "--events", folder_.file("events.jsonl"), "--out",
                   folder_.file("taught"), "--headless", "--threads", "1"},
                  {exit_done, exit_no}))
      return evidence_;
    if (!succeeds(
            {"replay", folder_.file("taught/session"), "--out", folder_.file("again"), "--threads", "2"},
            {exit_done, exit_no}))
      return evidence_;
    judge_end();
    judge_record();
    judge_map();
    return evidence_;
  }

 private:
  double uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(random_() >> 11U) * 0x1.0p-53;
  }
  void fail(const std::string& what) {
    evidence_.broken.push_back("session " + std::to_string(seed_) + ": " + what);
  }

  /// The ball's way, mm and degrees to metres.
  Eigen::Vector3d ball(double share) const {
    const double azimuth = to_rad * (first_ + share * (last_ - first_));
    const double height = low_ + bump_ * std::sin(std::numbers::pi * share);
    return 1e-3 * Eigen::Vector3d(radius_ * std::cos(azimuth), radius_ * std::sin(azimuth), height);
  }

  void draw_solids() {
    const int count = 2 + static_cast<int>(uniform(0, 3));
    for (int i = 0; i < count; ++i) {
      const bool in_the_way = is_mistaken_ && i == 0;
      const double share = uniform(0.2, 0.8);
      const double azimuth =
          in_the_way ? to_rad * (first_ + share * (last_ - first_)) : to_rad * uniform(-80, 80);
      const double away = in_the_way ? 1e-3 * radius_ : uniform(0.05, 0.115);
      Solid solid;
      solid.is_box = uniform(0, 1) < 0.5;
      const double height = in_the_way ? ball(share).z() + uniform(-0.005, 0.015) : uniform(0.01, 0.03);
      solid.size = solid.is_box ? Eigen::Vector3d(uniform(0.012, 0.03), uniform(0.012, 0.03), height)
                                : Eigen::Vector3d(uniform(0.006, 0.014), 0.0, height);
      solid.center = {away * std::cos(azimuth), away * std::sin(azimuth), 0.5 * height};
      solid.turn = solid.is_box ? uniform(0, 3) : 0.0;
      solids_.push_back(solid);
    }
  }

  std::string scene() {
    const std::filesystem::path datasets = datasets_folder();
    std::string text = read_file(datasets / "scenes" / "miniature_kitchen.yaml");
    const auto cut = [&](const std::string& from, const std::string& to, const std::string& by) {
      const std::size_t a = text.find(from), b = to.empty() ? text.size() : text.find(to, a + 1);
      text = text.substr(0, a) + by + text.substr(b);
    };
    std::string solids;
    for (std::size_t i = 0; i < solids_.size(); ++i) solids += solids_[i].yaml(static_cast<int>(i));
    cut("  - {name: box,", "\ncamera:", solids);
    cut("stroke:\n", "", stroke_and_gripper());
    cut("setup: ", "\nseed", "setup: " + (datasets / "setups" / "miniature_kitchen.yaml").string());
    cut("seed: 1", "\nbackground", "seed: " + std::to_string(seed_));
    char camera[80];
    std::snprintf(camera, sizeof camera, "rate_hz: 10\n  exposure: %.5f", uniform(0.0, 0.005));
    cut("rate_hz: 15", "\n  noise_sigma", camera);
    return text;
  }

  std::string stroke_and_gripper() {
    char line[200];
    std::snprintf(line, sizeof line,
                  "stroke:\n  duration: %.4f\n  orientation_deg: [0, %.2f, %.2f]\n  wobble_deg: %.3f\n  "
                  "wobble_hz: %.3f\n  waypoints:\n",
                  duration_, uniform(-20, -8), uniform(15, 40), uniform(0.5, 7), uniform(0.4, 4));
    std::string text = line;
    for (int i = 0; i <= 8; ++i) {
      const Eigen::Vector3d at = ball(i / 8.0);
      std::snprintf(line, sizeof line, "    - {ball: [%.5f, %.5f, %.5f]}\n", at.x(), at.y(), at.z());
      text += line;
    }
    text += "gripper:\n  waypoints:\n";
    double time = duration_ + 0.5;
    for (const double share : {0.04, 0.5, 0.96}) {
      const Eigen::Vector3d at = ball(share);
      const double azimuth = std::atan2(at.y(), at.x());
      const double out = 1e-3 * uniform(2, 7);
      for (const double hold : {0.0, 0.8}) {
        std::snprintf(line, sizeof line, "    - {time: %.3f, tip_deg: [%.5f, %.5f, %.5f, 0, 90, %.3f]}\n",
                      time + hold, at.x() + out * std::cos(azimuth), at.y() + out * std::sin(azimuth), at.z(),
                      azimuth / to_rad);
        text += line;
      }
      held_.push_back(time + 0.7);
      time += 1.5;
    }
    return text;
  }

  std::string events() {
    constexpr double first_image = 0.4;  // after the depth images
    std::vector<std::pair<double, std::string>> events;
    const auto add = [&](double time, const std::string& rest) { events.emplace_back(time, rest); };
    add(0.0,
        R"("action":"robot","robot":"puma560_miniature","padding":0.0005,"near":[-1.2973,-0.6329,0.0951,2.7093,0.537,0.2505])");
    const double pause = first_image + duration_ * uniform(0.3, 0.7);
    add(first_image + 0.1, R"("action":"paint_on")");
    add(pause, R"("action":"paint_off")");
    add(pause + uniform(0.0, 0.2), R"("action":"paint_on")");
    add(first_image + duration_, R"("action":"paint_off")");
    if (uniform(0, 1) < 0.15) add(first_image + duration_ + 0.1, R"("action":"undo")");
    add(first_image + held_[0], R"("action":"start")");
    if (uniform(0, 1) < 0.5) add(first_image + held_[1], R"("action":"via")");
    add(first_image + held_[2], R"("action":"goal")");
    add(first_image + held_[2] + 0.05, std::string(R"("action":"plan","name":"drawn","planner":")") +
                                           (uniform(0, 1) < 0.5 ? "beam" : "boundary_plus") + "\"");
    add(first_image + held_[2] + 0.1, R"("action":"approve")");
    const char* wrong[] = {"approve", "play", "paint_off", "erase_off", "clear", "save"};
    for (int i = 0; i < 3; ++i)
      add(uniform(0.0, held_[0]),
          std::string(R"("action":")") + wrong[static_cast<int>(uniform(0, 5))] + "\"");
    std::stable_sort(events.begin(), events.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    std::string text;
    for (const auto& [time, rest] : events) text += "{\"time\":" + std::to_string(time) + "," + rest + "}\n";
    return text;
  }

  bool succeeds(const std::vector<std::string>& arguments, const std::vector<int>& statuses) {
    const CommandRun run = run_command(arguments);
    const bool is_good = std::find(statuses.begin(), statuses.end(), run.status) != statuses.end();
    if (!is_good)
      fail(arguments.front() + " ended with " + std::to_string(run.status) + ": " + run.log.substr(0, 400));
    return is_good;
  }

  void judge_end() {
    const Json teaching = Json::parse(read_file(folder_ / "taught/report.json"))["teaching"];
    bool is_told = false;
    for (const Json& event : teaching["events"]) {
      const std::string action = event["action"];
      const std::string refused = event.value("refused", "");
      if (!refused.empty()) ++evidence_.refused[action];
      if (action == "start" || action == "goal") is_told = is_told || !refused.empty();
      if (action == "plan") is_told = is_told || !refused.empty() || !event.value("remark", "").empty();
    }
    bool is_approved = false;
    for (const Json& plan : teaching["plans"]) is_approved = is_approved || plan["approved"].get<bool>();
    evidence_.approved = is_approved;
    evidence_.told = !is_approved && is_told;
    if (!is_approved && !is_told) fail("it ends without an approved plan and without a sentence");
    if (is_approved) judge_plan();
  }

  /// Nothing of the tool is led deep into a solid.
  void judge_plan() {
    const Plan plan = load_plan(folder_ / "taught/plans/drawn.json");
    const Robot robot = load_robot("puma560_miniature");
    const std::vector<Configuration> waypoints = plan.waypoints();
    double worst = 0.0;
    LinkPoses poses;
    for (std::size_t i = 0; i + 1 < waypoints.size(); ++i) {
      for (int step = 0; step <= 20; ++step) {
        forward_kinematics(robot, waypoints[i] + (step / 20.0) * (waypoints[i + 1] - waypoints[i]), poses);
        for (const Body& body : robot.bodies) {
          if (body.part != "tool") continue;
          for (const Sphere& sphere : body.cover)
            for (const Solid& solid : solids_)
              worst =
                  std::max(worst, solid.depth(poses[static_cast<std::size_t>(body.link)] * sphere.center));
        }
      }
    }
    if (worst > deep)
      fail("an approved plan leads the tool " + std::to_string(1e3 * worst) + " mm into a solid");
  }

  void judge_record() {
    for (const char* file : {"map.ot", "painted.csv", "provenance.bin", "session/events.jsonl"})
      if (read_file(folder_ / "taught" / file) != read_file(folder_ / "again" / file))
        fail(std::string(file) + " is another one when the session is done again");
    const std::filesystem::path plan = "plans/drawn.json";
    if (!std::filesystem::exists(folder_ / "taught" / plan)) return;
    const Plan first = load_plan(folder_ / "taught" / plan), second = load_plan(folder_ / "again" / plan);
    if (first.waypoints() != second.waypoints() || first.map_sha256 != second.map_sha256)
      fail("the plan is another one when the session is done again");
  }

  void judge_map() {
    const Snapshot map = load_map(folder_ / "taught");
    evidence_.mistakes_met = is_mistaken_ && map.counts().conflict > 0;
    map.visit_leaves([&](const Voxel& leaf) {
      if (leaf.state != VoxelState::painted) return;
      ++evidence_.painted;
      const bool is_inside = std::any_of(solids_.begin(), solids_.end(),
                                         [&](const Solid& solid) { return solid.depth(leaf.center) > deep; });
      evidence_.painted_inside += is_inside;
    });
  }

  const std::uint64_t seed_;
  std::mt19937_64 random_;
  TemporaryFolder folder_;
  double first_ = 0.0, last_ = 0.0, low_ = 0.0, bump_ = 0.0, radius_ = 0.0, duration_ = 0.0;
  bool is_mistaken_ = false;
  std::vector<Solid> solids_;
  std::vector<double> held_;
  PeopleEvidence evidence_;
};

}  // namespace

void PeopleEvidence::add(const PeopleEvidence& other) {
  sessions += other.sessions;
  approved += other.approved;
  told += other.told;
  mistakes += other.mistakes;
  mistakes_met += other.mistakes_met;
  painted += other.painted;
  painted_inside += other.painted_inside;
  for (const auto& [action, count] : other.refused) refused[action] += count;
  broken.insert(broken.end(), other.broken.begin(), other.broken.end());
}

PeopleEvidence teach_session(std::uint64_t seed) { return Session(seed).run(); }

}  // namespace clearway::evidence

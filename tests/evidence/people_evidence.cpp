#include "tests/evidence/people_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "datasets/descriptions/scene.hpp"
#include "datasets/simulation/surface.hpp"
#include "mapping/files/map_file.hpp"
#include "planning/files/plan_file.hpp"
#include "planning/robot/kinematics.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/apps/run_command.hpp"
#include "tests/evidence/drawn_person.hpp"

namespace clearway::evidence {
namespace {

using Json = nlohmann::json;

constexpr double deep = 0.003;  ///< m inside of a solid: beyond a voxel and the sensors' noise

class Session {
 public:
  explicit Session(std::uint64_t seed) : seed_(seed), most_attempts_(seed % 10 < 3 ? 4 : 2), person_(seed) {}

  PeopleEvidence run() {
    evidence_.sessions = 1;
    evidence_.mistakes = person_.leads_through_an_obstacle();
    evidence_.walked = person_.walks();
    evidence_.set_down = person_.sets_the_probe_down();
    write_file(folder_ / "setup.yaml", person_.setup());
    for (attempts_ = 1;; ++attempts_) {
      if (!teach()) return evidence_;
      if (is_approved() || attempts_ == most_attempts_) break;
      person_.try_again(answers_);
    }
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
  void fail(const std::string& what) {
    evidence_.broken.push_back("session " + std::to_string(seed_) + ": " + what);
  }

  /// The whole session up to now.
  bool teach() {
    std::filesystem::remove_all(folder_ / "taught");
    write_file(folder_ / "scene.yaml", person_.scene());
    write_file(folder_ / "events.jsonl", person_.events());
    if (!succeeds({"simulate", folder_.file("scene.yaml"), "--out", folder_.file("r.rawlog")}, {exit_done}) ||
        !succeeds({"teach", folder_.file("r.rawlog"), "--events", folder_.file("events.jsonl"), "--out",
                   folder_.file("taught"), "--headless", "--threads", "1"},
                  {exit_done, exit_no}))
      return false;
    report_ = Json::parse(read_file(folder_ / "taught/report.json"));
    read_answers();
    return true;
  }

  /// Of the last attempt.
  void read_answers() {
    answers_.clear();
    for (const Json& event : report_["teaching"]["events"]) {
      if (event["time"].get<double>() < person_.last_attempt_begins()) continue;
      const std::string refused = event.value("refused", ""), remark = event.value("remark", "");
      const bool is_plan = event["action"] == "plan";
      if (!refused.empty() || (is_plan && !remark.starts_with("solved and proved")))
        answers_.push_back({event["action"], refused.empty() ? remark : refused});
    }
  }

  bool is_approved() const {
    const Json& plans = report_["teaching"]["plans"];
    return std::any_of(plans.begin(), plans.end(),
                       [](const Json& plan) { return plan["approved"].get<bool>(); });
  }

  bool succeeds(const std::vector<std::string>& arguments, const std::vector<int>& statuses) {
    const CommandRun run = run_command(arguments);
    const bool is_good = std::find(statuses.begin(), statuses.end(), run.status) != statuses.end();
    if (!is_good)
      fail(arguments.front() + " ended with " + std::to_string(run.status) + ": " + run.log.substr(0, 400));
    return is_good;
  }

  void judge_end() {
    for (const Json& event : report_["teaching"]["events"])
      if (!event.value("refused", "").empty()) ++evidence_.refused[event["action"]];
    evidence_.approved = is_approved();
    ++(is_approved()
           ? evidence_.approved_by_attempt
           : evidence_.not_approved_by_reason)[is_approved() ? std::to_string(attempts_) : reason()];
    evidence_.explained = !is_approved() && !answers_.empty();
    if (!is_approved() && answers_.empty()) fail("it ends without an approved plan and without a sentence");
    for (const Json& plan : report_["teaching"]["plans"])
      if (plan["approved"].get<bool>()) judge_plan(plan["name"]);
  }

  /// The first refusal of the last attempt, without its numbers.
  std::string reason() const {
    if (answers_.empty()) return "none";
    std::string text = answers_.front().action + ": " + answers_.front().sentence;
    return text.substr(0, text.find(" at ("));
  }

  /// Nothing of the tool is led deep into a solid.
  void judge_plan(const std::string& name) {
    const Plan plan = load_plan(folder_ / ("taught/plans/" + name + ".json"));
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
            for (const Solid& solid : person_.solids())
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
    for (const Json& taught : report_["teaching"]["plans"]) {
      const std::string plan = "plans/" + taught["name"].get<std::string>() + ".json";
      if (!std::filesystem::exists(folder_ / "taught" / plan)) continue;
      const Plan first = load_plan(folder_ / "taught" / plan), second = load_plan(folder_ / "again" / plan);
      if (first.waypoints() != second.waypoints() || first.map_sha256 != second.map_sha256)
        fail("a plan is another one when the session is done again");
    }
  }

  void judge_map() {
    const Snapshot map = load_map(folder_ / "taught");
    evidence_.mistakes_met = person_.leads_through_an_obstacle() && map.counts().conflict > 0;
    map.visit_leaves([&](const Voxel& leaf) {
      if (leaf.state != VoxelState::painted) return;
      ++evidence_.painted;
      evidence_.painted_inside +=
          std::any_of(person_.solids().begin(), person_.solids().end(),
                      [&](const Solid& solid) { return solid.depth(leaf.center) > deep; });
    });
    judge_seen_surfaces(map);
  }

  /// A true ray of a depth image that ends on a solid ends at a voxel that is blocked, or next to one: paint
  /// never wins over what was seen there. The world here is rendered anew, from its truth.
  void judge_seen_surfaces(const Snapshot& map) {
    const Scene scene = load_scene(folder_ / "scene.yaml");
    std::vector<Surface> surfaces(scene.shapes.begin(), scene.shapes.end());
    std::vector<const Surface*> all;
    for (const Surface& surface : surfaces) all.push_back(&surface);
    const double edge = map.resolution();
    for (const Eigen::Isometry3d& pose : scene.depth->map_from_sensor) {
      for (int row = 2; row < 240; row += 4) {
        for (int column = 2; column < 320; column += 4) {
          const Eigen::Vector3d way =
              pose.linear() *
              Eigen::Vector3d(1.0, (159.5 - column) / 290.0, (119.5 - row) / 290.0).normalized();
          const CastResult hit = cast_ray(all, pose.translation(), way);
          if (hit.index < 0 || !scene.shapes[static_cast<std::size_t>(hit.index)].name.starts_with("solid"))
            continue;
          if (-hit.hit.normal.dot(way) < 0.4) continue;  // grazing rays may not come back
          const Eigen::Vector3d point = pose.translation() + hit.hit.along * way;
          ++evidence_.seen_points;
          bool is_blocked = false, is_painted = false;
          for (int step = -3; step <= 3; ++step) {
            const VoxelState state = map.state(point - 0.5 * step * edge * hit.hit.normal);
            is_blocked |= state == VoxelState::occupied || state == VoxelState::conflict;
            is_painted |= step >= 0 && state == VoxelState::painted;
          }
          evidence_.painted_over += is_painted && !is_blocked;
        }
      }
    }
  }

  const std::uint64_t seed_;
  const int most_attempts_;  ///< each makes the whole session anew; three persons of ten are patient
  DrawnPerson person_;
  TemporaryFolder folder_;
  int attempts_ = 0;
  Json report_;
  std::vector<DrawnPerson::Answer> answers_;
  PeopleEvidence evidence_;
};

}  // namespace

void PeopleEvidence::add(const PeopleEvidence& other) {
  sessions += other.sessions;
  approved += other.approved;
  explained += other.explained;
  walked += other.walked;
  set_down += other.set_down;
  mistakes += other.mistakes;
  mistakes_met += other.mistakes_met;
  painted += other.painted;
  painted_inside += other.painted_inside;
  seen_points += other.seen_points;
  painted_over += other.painted_over;
  for (const auto& [action, count] : other.refused) refused[action] += count;
  for (const auto& [attempt, count] : other.approved_by_attempt) approved_by_attempt[attempt] += count;
  for (const auto& [reason, count] : other.not_approved_by_reason) not_approved_by_reason[reason] += count;
  broken.insert(broken.end(), other.broken.begin(), other.broken.end());
}

PeopleEvidence teach_session(std::uint64_t seed) { return Session(seed).run(); }

}  // namespace clearway::evidence

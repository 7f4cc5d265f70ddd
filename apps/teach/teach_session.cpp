#include "apps/teach/teach_session.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "apps/query/query.hpp"
#include "mapping/files/map_digest.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/check/path_check.hpp"
#include "planning/path/trajectory.hpp"
#include "planning/plan_and_check.hpp"
#include "planning/planner_table.hpp"

namespace clearway {
namespace {

constexpr std::array<std::string_view, 9> state_names = {
    "ready", "painting", "erasing", "selecting", "planning", "planned", "playing", "approved", "ended"};

[[noreturn]] void refuse(const std::string& sentence) { throw std::invalid_argument(sentence); }

/// The query's answer, with what is drawn of it.
TaughtPlan answered(TaughtPlan taught, PlanQuery query) {
  const ConfigurationSpace& space = *taught.space;
  query.map_digest = taught.map_digest = map_sha256(space.map());
  taught.plan = plan_and_check(query);
  if (!taught.plan.is_proved()) return taught;
  const auto points = time_parameterize(space.robot(), taught.plan.waypoints()).points;
  constexpr std::size_t shown = 160;
  const std::size_t last = points.size() - 1, pieces = std::min(last, shown);
  for (std::size_t i = 0; i <= pieces; ++i) {
    const Configuration& q = points[pieces == 0 ? 0 : i * last / pieces].position;
    taught.tip_path.push_back(tip_pose(space.robot(), q).translation());
    taught.tip_clearance.push_back(space.clearance(q));
  }
  return taught;
}

}  // namespace

std::string_view to_string(TeachState state) { return state_names.at(static_cast<std::size_t>(state)); }

TeachSession::TeachSession(EventSource next_events, const TeachOptions& options)
    : next_events_(std::move(next_events)), options_(options) {}

TeachSession::~TeachSession() = default;

void TeachSession::begin(const Setup& setup, FreeSpaceMap& map, const FusionCounts& counts) {
  setup_ = &setup;
  map_ = &map;
  counts_ = &counts;
  if (!setup.robot) return;
  RobotChoice choice;
  choice.robot = setup.robot->name;
  choice.scale = setup.robot->scale;
  robot_ = std::make_shared<VirtualRobot>(choice, setup.robot->joints, setup.robot->map_from_base);
  choice_.robot = robot_;
}

bool TeachSession::before(double since_start) {
  for (const TeachEvent& event : next_events_(since_start)) apply(event);
  now_ = std::max(now_, since_start);
  if (!options_.waits_for_plans) take_plan(false);
  if (doing_ == Doing::playing && now_ > play_begin_ + play_seconds_) doing_ = Doing::nothing;
  return doing_ != Doing::ended;
}

Brush TeachSession::brush() const {
  const Brush::Use use = doing_ == Doing::painting  ? Brush::Use::paints
                         : doing_ == Doing::erasing ? Brush::Use::erases
                                                    : Brush::Use::none;
  return {use, choice_.volume};
}

void TeachSession::see(const SeenImage& image) {
  if (!robot_ || !image.map_from_gripper) return;
  robot_->lead(*image.map_from_gripper * setup_->gripper->board_from_tip, image.since_start);
  ++led_images_;
  warning_.clear();
  if (doing_ == Doing::painting || doing_ == Doing::erasing) return;
  warning_ = robot_->not_there(image.since_start);
  if (warning_.empty()) {
    const Verdict verdict = robot_->space(present_map(), map_version())->check(robot_->q());
    if (!verdict.is_free()) warning_ = verdict.sentence();
  }
  if (!warning_.empty()) ++warned_images_;
}

void TeachSession::end() {
  for (const TeachEvent& event : next_events_(std::numeric_limits<double>::infinity()))
    if (doing_ != Doing::ended) apply(event);
  take_plan(true);
  if (doing_ == Doing::painting || doing_ == Doing::erasing) end_stroke();
  doing_ = Doing::ended;
}

TeachState TeachSession::resting_state() const {
  if (choice_.is_approved) return TeachState::approved;
  if (choice_.plan) return TeachState::planned;
  return choice_.start ? TeachState::selecting : TeachState::ready;
}

TeachState TeachSession::state() const {
  switch (doing_) {
    case Doing::painting:
      return TeachState::painting;
    case Doing::erasing:
      return TeachState::erasing;
    case Doing::planning:
      return TeachState::planning;
    case Doing::playing:
      return TeachState::playing;
    case Doing::ended:
      return TeachState::ended;
    case Doing::nothing:
      break;
  }
  return resting_state();
}

Configuration TeachSession::shown_configuration() const {
  if (doing_ == Doing::playing && !motion_.empty()) {
    const auto after = std::upper_bound(motion_.begin(), motion_.end(), now_ - play_begin_,
                                        [](double time, const auto& point) { return time < point.first; });
    return after == motion_.begin() ? motion_.front().second : std::prev(after)->second;
  }
  return robot_ ? robot_->q() : Configuration();
}

std::vector<Configuration> TeachSession::goals() const {
  std::vector<Configuration> goals = choice_.vias;
  if (choice_.goal) goals.push_back(*choice_.goal);
  return goals;
}

std::size_t TeachSession::map_version() const {
  return counts_->spheres + counts_->erasers + counts_->scans_inserted + other_changes_;
}

const Snapshot& TeachSession::present_map() {
  if (!snapshot_ || snapshot_version_ != map_version()) snapshot_ = map_->snapshot();
  snapshot_version_ = map_version();
  return *snapshot_;
}

void TeachSession::apply(const TeachEvent& event) {
  now_ = std::max(now_, event.time);
  if (options_.waits_for_plans) take_plan(true);
  TaughtEvent told{event, TeachState::ready, {}, {}, false};
  told.refusal = refusal_of_state(event.action);
  told.is_late = doing_ == Doing::planning && !told.refusal.empty();
  if (told.refusal.empty()) {
    try {
      act(event, told.remark);
    } catch (const std::invalid_argument& error) {
      told.refusal = std::string(to_string(event.action)) + ": " + error.what();
    }
  }
  told.state = state();
  told_.push_back(std::move(told));
  if (options_.tell) options_.tell(told_.back());
}

std::string TeachSession::refusal_of_state(TeachAction action) const {
  const std::string name(to_string(action));
  const bool always = action == TeachAction::save || action == TeachAction::quit;
  const bool ends = action == TeachAction::undo || always;
  switch (doing_) {
    case Doing::ended:
      return name + ": the session has ended";
    case Doing::planning:
      return always ? "" : name + ": a plan is being made; wait for it";
    case Doing::painting:
      return ends || action == TeachAction::paint_off
                 ? ""
                 : name + ": a stroke is being painted; 'paint_off' ends it";
    case Doing::erasing:
      return ends || action == TeachAction::erase_off ? ""
                                                      : name + ": the ball erases; 'erase_off' ends that";
    case Doing::playing:
    case Doing::nothing:
      break;
  }
  if (action == TeachAction::paint_off)
    return name + ": nothing is being painted; 'paint_on' begins a stroke";
  if (action == TeachAction::erase_off) return name + ": nothing is being erased; 'erase_on' begins that";
  return {};
}

void TeachSession::act(const TeachEvent& event, std::string& remark) {
  if (doing_ == Doing::playing && event.action != TeachAction::save) doing_ = Doing::nothing;
  switch (event.action) {
    case TeachAction::paint_on:
    case TeachAction::erase_on:
      begin_stroke(event);
      break;
    case TeachAction::paint_off:
    case TeachAction::erase_off:
      end_stroke();
      break;
    case TeachAction::volume:
      choose_volume(event);
      break;
    case TeachAction::robot:
      choose_robot(event);
      break;
    case TeachAction::start:
    case TeachAction::via:
    case TeachAction::goal:
      choose_place(event, remark);
      break;
    case TeachAction::clear:
      remember("clear");
      choice_.start.reset();
      choice_.goal.reset();
      choice_.vias.clear();
      forget_plan();
      break;
    case TeachAction::plan:
      begin_plan(event);
      break;
    case TeachAction::play: {
      if (!choice_.plan) refuse("there is no plan; 'plan' makes one");
      const Plan& plan = plans_[*choice_.plan].plan;
      const Trajectory motion = time_parameterize(plans_[*choice_.plan].space->robot(), plan.waypoints());
      motion_.clear();
      for (const TrajectoryPoint& point : motion.points) motion_.emplace_back(point.time, point.position);
      play_begin_ = now_;
      play_seconds_ = motion.points.back().time;
      remark = "it lasts " + short_text(play_seconds_, 3) + " s";
      doing_ = Doing::playing;
      break;
    }
    case TeachAction::approve:
      approve(remark);
      break;
    case TeachAction::undo:
      undo(remark);
      break;
    case TeachAction::save:
      if (!options_.save) refuse("this session saves nothing before its end");
      if (event.name.empty()) refuse("expected a name");
      if (is_taken(event.name))
        refuse("there is a plan or a map " + quote(event.name) + " already, expected another name");
      options_.save(event.name, present_map());
      saved_.insert(event.name);
      break;
    case TeachAction::quit:
      take_plan(true);
      if (doing_ == Doing::painting || doing_ == Doing::erasing) end_stroke();
      doing_ = Doing::ended;
      break;
  }
}

void TeachSession::forget_plan() {
  choice_.plan.reset();
  choice_.failed.reset();
  choice_.is_approved = false;
}

const TaughtPlan* TeachSession::last_plan() const {
  if (choice_.plan) return &plans_[*choice_.plan];
  return choice_.failed ? &plans_[*choice_.failed] : nullptr;
}

void TeachSession::remember(const std::string& what, std::optional<int> stroke) {
  constexpr std::size_t most_undos = 1000;
  if (undos_.size() == most_undos) undos_.pop_front();
  undos_.push_back({what, choice_, stroke});
}

void TeachSession::begin_stroke(const TeachEvent& event) {
  if (!setup_->probe) refuse("the setup has no probe");
  const bool paints = event.action == TeachAction::paint_on;
  stroke_ =
      map_->begin_stroke((paints ? "stroke at " : "eraser at ") + short_text(event.time, 6) + " s", "hand");
  remember(paints ? "stroke" : "eraser", stroke_);
  forget_plan();
  doing_ = paints ? Doing::painting : Doing::erasing;
}

void TeachSession::end_stroke() {
  map_->end_stroke();
  doing_ = Doing::nothing;
}

void TeachSession::choose_volume(const TeachEvent& event) {
  if (!setup_->probe) refuse("the setup has no probe");
  const auto& volumes = map_->volumes();
  const auto found = std::find_if(volumes.begin(), volumes.end(),
                                  [&](const PaintedVolume& volume) { return volume.label == event.name; });
  if (found != volumes.end() && !event.critical_parts.empty() &&
      found->critical_parts != event.critical_parts)
    refuse("volume " + quote(event.name) + " is there already, with other critical parts");
  const bool is_new = found == volumes.end();
  const int number =
      is_new ? map_->add_volume(event.name, event.critical_parts) : static_cast<int>(found - volumes.begin());
  if (is_new) ++other_changes_;
  remember("volume");
  choice_.volume = number;
}

void TeachSession::choose_robot(const TeachEvent& event) {
  RobotChoice choice = event.robot;
  std::optional<Eigen::Isometry3d> map_from_base;
  if (setup_->robot) {
    map_from_base = setup_->robot->map_from_base;
    if (choice.robot == setup_->robot->name && !choice.scale) choice.scale = setup_->robot->scale;
  }
  auto robot = std::make_shared<VirtualRobot>(choice, event.near, map_from_base);
  remember("robot");
  choice_.robot = robot_ = std::move(robot);
  choice_.start.reset();
  choice_.goal.reset();
  choice_.vias.clear();
  forget_plan();
}

void TeachSession::require_robot() const {
  if (!robot_) refuse("no robot is chosen; 'robot' chooses one");
}

Configuration TeachSession::place_of(const TeachEvent& event) const {
  const std::string name(to_string(event.action));
  if (!event.q.empty()) return choose_configuration(event.q, name, robot_->robot(), false);
  if (!setup_->gripper) refuse("the setup has no gripper to show it with, and the event no 'q'");
  if (const std::string why = robot_->not_there(event.time); !why.empty()) refuse(why);
  return robot_->q();
}

void TeachSession::choose_place(const TeachEvent& event, std::string& remark) {
  require_robot();
  if (event.action != TeachAction::start && !choice_.start) refuse("no start is chosen; 'start' comes first");
  constexpr std::size_t most_vias = 1000;
  if (event.action == TeachAction::via && choice_.vias.size() >= most_vias)
    refuse("at most 1000 goals on the way are possible; 'clear' forgets them");
  const Configuration q = place_of(event);
  const Verdict verdict = robot_->space(present_map(), map_version())->check(q);
  if (!verdict.is_free()) refuse(verdict.sentence());
  remember(std::string(to_string(event.action)));
  if (event.action == TeachAction::start) {
    choice_.start = q;
    choice_.goal.reset();
    choice_.vias.clear();
  } else if (event.action == TeachAction::via) {
    choice_.vias.push_back(q);
  } else {
    choice_.goal = q;
  }
  forget_plan();
  for (const double value : q) remark += (remark.empty() ? "" : ", ") + short_text(value, 4);
}

bool TeachSession::is_taken(const std::string& name) const {
  return saved_.contains(name) ||
         std::any_of(plans_.begin(), plans_.end(), [&](const TaughtPlan& plan) { return plan.name == name; });
}

void TeachSession::begin_plan(const TeachEvent& event) {
  require_robot();
  if (!choice_.start) refuse("no start is chosen; 'start' chooses one");
  if (!choice_.goal) refuse("no goal is chosen; 'goal' chooses one");
  TaughtPlan plan;
  plan.name = event.name;
  for (std::size_t number = plans_.size() + 1; event.name.empty(); ++number) {
    plan.name = "plan_" + std::to_string(number);
    if (!is_taken(plan.name)) break;
  }
  if (is_taken(plan.name))
    refuse("there is a plan or a map " + quote(plan.name) + " already, expected another name");
  plan.start = *choice_.start;
  plan.robot = robot_->choice();
  plan.space = robot_->space(present_map(), map_version());
  PlanQuery query{.space = *plan.space,
                  .start = plan.start,
                  .goals = goals(),
                  .planner = make_planner(event.planner, event.options),
                  .seed = options_.seed,
                  .time_limit = options_.time_limit,
                  .robot_name = plan.robot.robot,
                  .map_file = "map.ot",
                  .name = plan.name};
  if (setup_->robot) {
    query.payload = setup_->robot->payload;
    query.gravity = setup_->robot->gravity;
  }
  Job job;
  job.result =
      std::async(std::launch::async, [plan, query]() mutable { return answered(std::move(plan), query); });
  remember("plan");
  forget_plan();
  job_ = std::move(job);
  doing_ = Doing::planning;
}

void TeachSession::take_plan(bool wait) {
  if (!job_) return;
  if (!wait && job_->result.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
  Job job = std::move(*job_);
  job_.reset();
  doing_ = Doing::nothing;
  const auto asked = std::find_if(told_.rbegin(), told_.rend(), [](const TaughtEvent& told) {
    return told.event.action == TeachAction::plan;
  });
  try {
    plans_.push_back(job.result.get());
    const Plan& plan = plans_.back().plan;
    asked->remark = plan.is_proved()                      ? "solved and proved by " + plan.planner
                    : plan.status() == PlanStatus::solved ? "not proved: " + plan.validation.first_contact
                                                          : plan.explanation();
    (plan.is_proved() ? choice_.plan : choice_.failed) = plans_.size() - 1;
  } catch (const std::invalid_argument& error) {
    asked->refusal = std::string("plan: ") + error.what();
  }
  asked->state = state();
  if (options_.tell) options_.tell(*asked);
}

void TeachSession::approve(std::string& remark) {
  if (!choice_.plan) refuse("there is no plan that is proved; 'plan' makes one");
  TaughtPlan& plan = plans_[*choice_.plan];
  if (map_sha256(present_map()) != plan.map_digest) {
    const ConfigurationSpace& space = *plan.space;
    const PathVerdict verdict =
        check_path(space.robot(), present_map(), space.policies(), space.options().padding,
                   plan.plan.waypoints(), 0.0, space.options().seen_within);
    if (!verdict.valid)
      refuse("the map has changed since it was planned: " + verdict.first_contact + "; plan again");
    remark = "the map has changed since it was planned; checked on the present one: valid";
  }
  remember("approval");
  plan.is_approved = choice_.is_approved = true;
}

void TeachSession::undo(std::string& remark) {
  if (undos_.empty()) refuse("nothing was done");
  if (doing_ == Doing::painting || doing_ == Doing::erasing) end_stroke();
  Undo last = std::move(undos_.back());
  undos_.pop_back();
  if (choice_.is_approved && !last.before.is_approved && choice_.plan)
    plans_[*choice_.plan].is_approved = false;
  if (last.stroke) {
    map_->undo_stroke(*last.stroke);
    ++other_changes_;
  }
  choice_ = std::move(last.before);
  robot_ = choice_.robot;
  remark = last.what + " is undone";
}

}  // namespace clearway

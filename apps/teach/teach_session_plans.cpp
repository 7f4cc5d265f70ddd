// What a session plans: asked for, answered, played, checked, approved.
#include <algorithm>
#include <chrono>
#include <stdexcept>

#include "apps/console/flag_names.hpp"
#include "apps/query/loads.hpp"
#include "apps/teach/stoppable_planner.hpp"
#include "apps/teach/teach_session.hpp"
#include "mapping/files/map_digest.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/check/check_legs.hpp"
#include "planning/check/check_pick.hpp"
#include "planning/plan_and_check.hpp"
#include "planning/plan_pick.hpp"
#include "planning/planned_motion.hpp"
#include "planning/planner_table.hpp"

namespace clearway {
namespace {

/// The robot of a plan's leg, with what it carries there, among what is free on the plan's map.
ConfigurationSpace space_of_leg(const TaughtPlan& taught, int leg) {
  const ConfigurationSpace& bare = *taught.space;
  const Policies policies{.parts = bare.policies(), .other = Policy::not_occupied};
  return {robot_of_leg(bare.robot(), taught.plan.loads, leg), bare.map(), policies, bare.options()};
}

/// What is drawn of a leg: its tip's way, some points of it, with the clearance there.
void add_tip_path(const ConfigurationSpace& space, const std::vector<TrajectoryPoint>& points,
                  std::size_t most, TaughtPlan& taught) {
  const std::size_t last = points.size() - 1, pieces = std::min(last, most);
  for (std::size_t i = 0; i <= pieces; ++i) {
    const Configuration& q = points[pieces == 0 ? 0 : i * last / pieces].position;
    taught.tip_path.push_back(tip_pose(space.robot(), q).translation());
    taught.tip_clearance.push_back(space.clearance(q));
  }
}

/// The query's answer, with what is drawn of it.
TaughtPlan answered(TaughtPlan taught, PlanQuery query, const std::optional<Pick>& pick) {
  constexpr std::size_t shown = 160;
  const ConfigurationSpace& space = *taught.space;
  query.map_digest = taught.map_digest = map_sha256(space.map());
  taught.plan = pick ? plan_pick(query, *pick) : plan_and_check(query);
  if (!taught.plan.is_proved()) return taught;
  give_motion(space, taught.plan);
  if (taught.plan.loads.empty()) {
    add_tip_path(space, trajectory_of(space.robot(), taught.plan).points, shown, taught);
    return taught;
  }
  const std::vector<PlanResult>& legs = taught.plan.legs;
  const std::vector<Trajectory> timed = leg_trajectories(space.robot(), taught.plan);
  for (std::size_t leg = 0; leg < legs.size(); ++leg)
    add_tip_path(space_of_leg(taught, static_cast<int>(leg)), timed[leg].points,
                 std::max<std::size_t>(1, shown / legs.size()), taught);
  return taught;
}

/// "; carries can on hand, leg 2", for what was planned.
std::string carried(const Plan& plan) {
  std::string text;
  for (const LegLoad& load : plan.loads) text += "; carries " + describe_load(load);
  return text;
}

/// "; no smooth motion: …" for a proved plan that has none.
std::string without_motion(const Plan& plan) {
  return plan.motion_caveat.empty() ? "" : "; no smooth motion: " + plan.motion_caveat;
}

/// The sentence with a cure that a session has: no action allows what a flag of `plan` does.
std::string without_allowing(const std::string& sentence) {
  const std::size_t begin = sentence.find("; allow it by name with --allow-outside");
  if (begin == std::string::npos) return sentence;
  return sentence.substr(0, begin) + "; paint there, or let a sensor look there";
}

}  // namespace

std::string sentence_of(const Plan& plan) {
  if (plan.is_proved()) return "solved and proved by " + plan.planner + carried(plan) + without_motion(plan);
  return plan.status() == PlanStatus::solved
             ? "not proved: " + without_allowing(plan.validation.first_contact)
             : plan.explanation();
}

PathVerdict check_taught(const TaughtPlan& taught, const Snapshot& map) {
  const Plan& plan = taught.plan;
  const Robot& robot = taught.space->robot();
  PathVerdict verdict =
      plan.pick
          ? check_pick(pick_of(plan, *plan.pick, robot, map), plan.policies, plan.padding, plan.seen_within)
          : check_legs(legs_of(plan, robot, map), plan.policies, plan.padding, 0.0, plan.seen_within);
  if (!verdict.valid || !plan.motion) return verdict;
  const MotionVerdict motion =
      judge_motion({robot, map, plan.policies, plan.padding, plan.seen_within, load_of(plan, robot)}, plan)
          .verdict;
  verdict.valid = motion.valid;
  verdict.undecided = motion.undecided;
  verdict.first_contact = motion.fault;
  return verdict;
}

void TeachSession::Choice::forget_plan() {
  plan.reset();
  failed.reset();
  is_approved = false;
  outdated.clear();
}

void TeachSession::forget_plan() { choice_.forget_plan(); }

const TaughtPlan* TeachSession::last_plan() const {
  if (choice_.plan) return &plans_[*choice_.plan];
  return choice_.failed ? &plans_[*choice_.failed] : nullptr;
}

void TeachSession::play(std::string& remark) {
  if (!choice_.plan) refuse("there is no plan; 'plan' makes one");
  const TaughtPlan& taught = plans_[*choice_.plan];
  const Robot& robot = taught.space->robot();
  const auto add = [&](const Trajectory& motion) {
    const double begin = motion_.empty() ? 0.0 : motion_.back().time;
    for (const TrajectoryPoint& point : motion.points)
      motion_.push_back({begin + point.time, point.position, carried_.size() - 1});
  };
  motion_.clear();
  carried_.clear();
  const std::size_t legs = taught.plan.loads.empty() ? 0 : taught.plan.legs.size();
  const std::vector<Trajectory> timed =
      legs == 0 ? std::vector<Trajectory>{} : leg_trajectories(robot, taught.plan);
  for (std::size_t leg = 0; leg < legs; ++leg) {
    carried_.push_back(robot_of_leg(robot, taught.plan.loads, static_cast<int>(leg)).loads);
    add(timed[leg]);
  }
  if (legs == 0) {
    carried_.emplace_back();
    add(trajectory_of(robot, taught.plan));
  }
  play_begin_ = now_;
  play_seconds_ = motion_.back().time;
  remark = "it lasts " + short_text(play_seconds_, 3) + " s";
  doing_ = Doing::playing;
}

bool TeachSession::is_taken(const std::string& name) const {
  return saved_.contains(name) ||
         std::any_of(plans_.begin(), plans_.end(), [&](const TaughtPlan& plan) { return plan.name == name; });
}

void TeachSession::begin_plan(const TeachEvent& event) {
  require_robot();
  if (!choice_.start) refuse("no start is chosen; 'start' chooses one");
  if (choice_.pick && !choice_.place)
    refuse("no place is chosen; 'place' says where " + quote(choice_.pick->object.name) + " goes");
  if (!choice_.pick && !choice_.goal) refuse("no goal is chosen; 'goal' chooses one");
  if (choice_.pick) require_own_voxels(*choice_.pick, present_map());  // others may be marked since
  for (const Load& load : choice_.held)
    if (choice_.goal && !holds(choice_.goal->held, load.name))
      refuse(quote(load.name) + " was attached after the goal was chosen; 'goal' chooses it anew");
  TaughtPlan plan;
  plan.name = event.name;
  for (std::size_t number = plans_.size() + 1; event.name.empty(); ++number) {
    plan.name = "plan_" + std::to_string(number);
    if (!is_taken(plan.name)) break;
  }
  if (is_taken(plan.name))
    refuse("there is a plan or a map " + quote(plan.name) + " already, expected another name");
  plan.start = choice_.start->q;
  for (const TaughtPlace& goal : goals()) plan.goals.push_back(goal.q);
  plan.robot = robot_->choice();
  plan.space = robot_->space(present_map(), map_version());
  PlanQuery query{
      .space = *plan.space,
      .start = plan.start,
      .goals = plan.goals,
      .planner = std::make_shared<StoppablePlanner>(make_planner(event.planner, event.options), is_stopped_),
      .seed = options_.seed,
      .time_limit = options_.time_limit,
      .loads = loads_of_legs(goals()),
      .robot_name = plan.robot.robot,
      .map_file = "map.ot",
      .name = plan.name};
  if (setup_->robot) {
    query.payload = setup_->robot->payload;
    query.gravity = setup_->robot->gravity;
  }
  Job job;
  job.result = std::async(std::launch::async, [plan, query, pick = choice_.pick]() mutable -> Answer {
    try {
      TaughtPlan taught = answered(std::move(plan), query, pick);
      const std::string sentence = sentence_of(taught.plan);
      return {std::move(taught), sentence};
    } catch (const std::invalid_argument& error) {
      return {{}, with_keys(error.what())};
    } catch (const PlanStopped&) {
      return {{}, "the session ended before it was made", true};
    }
  });
  remember(plan_word);
  forget_plan();
  job_ = std::move(job);
  doing_ = Doing::planning;
}

TaughtEvent TeachSession::with_answer(const TaughtEvent& asked, const Answer& answer) const {
  TaughtEvent reported = asked;
  (answer.plan ? reported.remark : reported.refusal) = answer.sentence;
  const bool is_proved = answer.plan && answer.plan->plan.is_proved();
  reported.state = is_proved ? TeachState::planned : resting_state();
  return reported;
}

/// Says how a plan went as soon as it is known. What the session does about it waits for the next event, so
/// that it does the same however fast the planner is.
void TeachSession::report_plan() {
  if (!job_ || job_->reported || !job_->is_ready()) return;
  job_->reported = job_->result.get();
  if (options_.report) options_.report(with_answer(asked_plan(), *job_->reported));
}

/// The event that asked for the plan that is being made; those that asked meanwhile were refused.
TaughtEvent& TeachSession::asked_plan() {
  return *std::find_if(done_.rbegin(), done_.rend(), [](const TaughtEvent& reported) {
    return reported.event.action == TeachAction::plan && reported.refusal.empty();
  });
}

void TeachSession::take_plan(bool wait) {
  if (!job_ || (!wait && !job_->is_ready())) return;
  const bool is_reported = job_->reported.has_value();
  Answer answer = is_reported ? std::move(*job_->reported) : job_->result.get();
  job_.reset();
  doing_ = Doing::nothing;
  TaughtEvent& asked = asked_plan();
  asked = with_answer(asked, answer);
  asked.is_late = answer.is_stopped;
  if (answer.plan) {
    plans_.push_back(std::move(*answer.plan));
    (plans_.back().plan.is_proved() ? choice_.plan : choice_.failed) = plans_.size() - 1;
  }
  if (options_.report && !is_reported) options_.report(asked);
}

/// What was asked for by hand ends with the session, and does not keep it.
void TeachSession::stop_plan() {
  is_stopped_->store(true);
  take_plan(true);
}

void TeachSession::approve(std::string& remark) {
  if (!choice_.plan)
    refuse(choice_.outdated.empty() ? "there is no plan that is proved; 'plan' makes one"
                                    : choice_.outdated + " since it was planned; plan again");
  if (choice_.is_approved) refuse("the plan is approved already; undo takes that back");
  TaughtPlan& plan = plans_[*choice_.plan];
  if (!plan.plan.motion)
    refuse("its motion is not proved, and would not be exported: " + plan.plan.motion_caveat);
  if (map_sha256(present_map()) != plan.map_digest) {
    const PathVerdict verdict = check_taught(plan, present_map());
    if (!verdict.valid)
      refuse("the map has changed since it was planned: " + verdict.first_contact + "; plan again");
    remark = "the map has changed since it was planned; checked on the present one: valid";
  }
  remember(approval_word);
  plan.is_approved = choice_.is_approved = true;
}

}  // namespace clearway

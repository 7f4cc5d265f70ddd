#include "apps/teach/teach_session.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "apps/console/flag_names.hpp"
#include "apps/query/setup_robot.hpp"
#include "apps/teach/ball_size.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr std::array<std::string_view, 10> state_names = {"ready",     "painting", "erasing", "marking",
                                                          "selecting", "planning", "planned", "playing",
                                                          "approved",  "ended"};

/// Whether a setup says when its volumes take paint, as a replay of a recording does.
bool has_times(const std::vector<VolumeSetup>& volumes) {
  return std::any_of(volumes.begin(), volumes.end(),
                     [](const VolumeSetup& volume) { return volume.from > 0.0 || std::isfinite(volume.to); });
}

}  // namespace

std::string_view to_string(TeachState state) { return state_names.at(static_cast<std::size_t>(state)); }

TeachSession::TeachSession(EventSource next_events, const TeachOptions& options)
    : next_events_(std::move(next_events)), options_(options) {}

TeachSession::~TeachSession() = default;

void TeachSession::refuse(const std::string& sentence) { throw std::invalid_argument(sentence); }

void TeachSession::begin(const Setup& setup, FreeSpaceMap& map, const FusionCounts& counts) {
  setup_ = &setup;
  map_ = &map;
  counts_ = &counts;
  const auto base = std::find_if(setup.boards.begin(), setup.boards.end(),
                                 [](const BoardSetup& board) { return board.map_from_board.has_value(); });
  if (base != setup.boards.end()) base_ = &*base;
  if (setup.robot)
    robot_ = std::make_shared<VirtualRobot>(choice_of(*setup.robot), setup.robot->joints,
                                            setup.robot->map_from_base);
  choice_.robot = robot_;
  if (setup.probe && options_.note) {
    const std::string sentence = ball_for_voxels(setup.probe->ball_radius, map.options().resolution);
    if (!sentence.empty()) options_.note(sentence);
  }
  note_ball();
}

bool TeachSession::before(double since_start) {
  for (const TeachEvent& event : next_events_(since_start)) apply(event);
  now_ = std::max(now_, since_start);
  if (options_.waits_for_plans)
    report_plan();
  else
    take_plan(false);
  if (doing_ == Doing::playing && now_ > play_begin_ + play_seconds_) doing_ = Doing::nothing;
  if (is_asked_to_end()) apply({.time = now_, .action = TeachAction::quit});
  return doing_ != Doing::ended;
}

Brush TeachSession::brush() const {
  const Brush::Use use = doing_ == Doing::painting  ? Brush::Use::paints
                         : doing_ == Doing::erasing ? Brush::Use::erases
                                                    : Brush::Use::none;
  return {use, choice_.volume};
}

void TeachSession::see(const SeenImage& image) {
  if (doing_ == Doing::marking && image.sample != nullptr && image.sample->accepted) mark(*image.sample);
  if (image.sample != nullptr && image.sample->accepted && base_ != nullptr)
    ball_ = {*base_->map_from_board * image.sample->sphere.center, image.sample->bound.total,
             image.since_start};
  see_base(image);
  if (!image.map_from_gripper) return;
  shown_tip_ = {*image.map_from_gripper * setup_->gripper->board_from_tip, image.since_start};
  if (!robot_) return;
  robot_->lead(shown_tip_->map_from_tip, shown_tip_->time);
  ++led_images_;
  warning_.clear();
  if (doing_ == Doing::painting || doing_ == Doing::erasing || doing_ == Doing::marking) return;
  warning_ = not_there(image.since_start);
  if (warning_.empty()) {
    try {
      const Verdict verdict = check(robot_->q(), choice_.held);
      if (!verdict.is_free()) warning_ = verdict.sentence();
    } catch (const std::invalid_argument& error) {  // a load for which the map has grown too large
      warning_ = error.what();
    }
  }
  if (!warning_.empty()) ++warned_images_;
}

void TeachSession::end() {
  const double last_image = now_;
  for (const TeachEvent& event : next_events_(std::numeric_limits<double>::infinity())) {
    if (doing_ == Doing::ended) break;
    if (event.time > last_image + 1.0) late_events_.push_back(event.time);
    apply(event);
  }
  finish();
}

void TeachSession::finish() {
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
    case Doing::marking:
      return TeachState::marking;
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

/// Where the plan that is played is by now. @pre it has points
const TeachSession::Played& TeachSession::played() const {
  const auto after = std::upper_bound(motion_.begin(), motion_.end(), now_ - play_begin_,
                                      [](double time, const Played& point) { return time < point.time; });
  return after == motion_.begin() ? motion_.front() : *std::prev(after);
}

Configuration TeachSession::shown_configuration() const {
  if (doing_ == Doing::playing && !motion_.empty()) return played().q;
  return robot_ ? robot_->q() : Configuration();
}

const std::vector<Load>& TeachSession::shown_loads() const {
  return doing_ == Doing::playing && !motion_.empty() ? carried_.at(played().leg) : choice_.held;
}

std::vector<TaughtPlace> TeachSession::goals() const {
  std::vector<TaughtPlace> goals = choice_.vias;
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
  if (is_asked_to_end() && event.action != TeachAction::quit)
    return;  // it may rest on a plan that was stopped
  TaughtEvent reported{event, TeachState::ready, {}, {}, false};
  reported.refusal = refusal_of_state(event.action);
  reported.is_late = doing_ == Doing::planning && !reported.refusal.empty();
  if (reported.refusal.empty()) {
    try {
      act(event, reported.remark);
    } catch (const std::invalid_argument& error) {
      reported.refusal = with_keys(error.what());
    }
  }
  reported.state = state();
  done_.push_back(std::move(reported));
  if (options_.report) options_.report(done_.back());
}

std::string TeachSession::refusal_of_state(TeachAction action) const {
  const bool ends = action == TeachAction::undo || action == TeachAction::save || action == TeachAction::quit;
  const bool undoes_stroke = action == TeachAction::undo_stroke;
  switch (doing_) {
    case Doing::ended:
      return "the session has ended";
    case Doing::planning:
      return action == TeachAction::quit ? "" : "a plan is being made; wait for it";
    case Doing::painting:
      return ends || undoes_stroke || action == TeachAction::paint_off
                 ? ""
                 : "a stroke is being painted; 'paint_off' ends it";
    case Doing::erasing:
      return ends || undoes_stroke || action == TeachAction::erase_off
                 ? ""
                 : "the ball erases; 'erase_off' ends that";
    case Doing::marking:
      return ends || action == TeachAction::object_off ? ""
                                                       : "a stroke marks an object; 'object_off' ends it";
    case Doing::playing:
    case Doing::nothing:
      break;
  }
  if (action == TeachAction::object_off) return "no object is being marked; 'object' begins that";
  if (action == TeachAction::paint_off) return "nothing is being painted; 'paint_on' begins a stroke";
  if (action == TeachAction::erase_off) return "nothing is being erased; 'erase_on' begins that";
  return {};
}

void TeachSession::act(const TeachEvent& event, std::string& remark) {
  if (doing_ == Doing::playing && event.action != TeachAction::save) doing_ = Doing::nothing;
  switch (event.action) {
    case TeachAction::paint_on:
    case TeachAction::erase_on:
      begin_stroke(event, remark);
      break;
    case TeachAction::paint_off:
      end_stroke();
      remark = new_conflicts();
      break;
    case TeachAction::erase_off:
      end_stroke();
      break;
    case TeachAction::volume:
      choose_volume(event, remark);
      break;
    case TeachAction::robot:
      choose_robot(event, remark);
      break;
    case TeachAction::branch:
      choose_branch(event.time, remark);
      break;
    case TeachAction::start:
    case TeachAction::via:
    case TeachAction::goal:
      choose_place(event, remark);
      break;
    case TeachAction::clear:
      remember("clear");
      forget_places();
      break;
    case TeachAction::plan:
      begin_plan(event);
      break;
    case TeachAction::object:
      begin_object(event);
      break;
    case TeachAction::object_off:
      end_object(remark);
      break;
    case TeachAction::pick:
      choose_pick(event, remark);
      break;
    case TeachAction::place:
      choose_placing(event, remark);
      break;
    case TeachAction::attach:
      attach(event, remark);
      break;
    case TeachAction::detach:
      detach(event, remark);
      break;
    case TeachAction::play:
      play(remark);
      break;
    case TeachAction::approve:
      approve(remark);
      break;
    case TeachAction::undo:
      undo(remark);
      break;
    case TeachAction::undo_stroke:
      undo_stroke(remark);
      break;
    case TeachAction::save:
      save_map(event.name);
      break;
    case TeachAction::quit:
      stop_plan();
      finish();
      break;
  }
}

void TeachSession::save_map(const std::string& name) {
  if (!options_.save) refuse("this session saves nothing before its end");
  if (name.empty()) refuse("expected a name");
  if (is_taken(name)) refuse("there is a plan or a map " + quote(name) + " already, expected another name");
  options_.save(name, present_map());
  saved_.insert(name);
}

void TeachSession::forget_places() {
  choice_.start.reset();
  choice_.goal.reset();
  choice_.vias.clear();
  choice_.pick.reset();
  choice_.grasp.reset();
  choice_.place.reset();
  forget_plan();
}

void TeachSession::begin_stroke(const TeachEvent& event, std::string& remark) {
  if (!setup_->probe) refuse("the setup has no probe");
  const bool paints = event.action == TeachAction::paint_on;
  if (paints) conflicts_before_ = present_map().counts().conflict;
  if (paints && has_times(setup_->volumes))
    remark = "into volume " + quote(map_->volumes()[static_cast<std::size_t>(choice_.volume)].label) +
             ", whatever `from` and `to` of the setup's volumes say; 'volume' chooses another";
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

/// A remark on conflicts that came since the stroke began; empty when none did.
std::string TeachSession::new_conflicts() {
  const std::size_t conflicts = present_map().counts().conflict;
  if (conflicts <= conflicts_before_) return {};
  return counted(conflicts - conflicts_before_, "painted voxel is", "painted voxels are") +
         " where a sensor saw an obstacle (red): blocked, and paint behind is suspect; 'undo' takes the "
         "stroke back";
}

}  // namespace clearway

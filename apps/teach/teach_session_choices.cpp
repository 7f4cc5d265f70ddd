// What a person chooses: the volume that takes the paint, the robot, and where it starts and goes.
#include <algorithm>
#include <set>
#include <stdexcept>

#include "apps/query/query.hpp"
#include "apps/query/setup_robot.hpp"
#include "apps/teach/ball_size.hpp"
#include "apps/teach/teach_session.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {

void TeachSession::choose_volume(const TeachEvent& event, std::string& remark) {
  if (!setup_->probe) refuse("the setup has no probe");
  if (event.name.empty()) refuse("the label of the volume is empty, expected a name");
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
  undos_.back().adds_volume = is_new;
  choice_.volume = number;
  remark = unknown_parts(map_->volumes()[static_cast<std::size_t>(number)]);
}

void TeachSession::choose_robot(const TeachEvent& event, std::string& remark) {
  RobotChoice choice = event.robot;
  std::optional<Eigen::Isometry3d> map_from_base;
  if (setup_->robot) {
    map_from_base = setup_->robot->map_from_base;
    choice = with_terms_of(*setup_->robot, std::move(choice));
  }
  if (event.base_at_ball) map_from_base = base_at_ball(event.time);
  auto robot = std::make_shared<VirtualRobot>(choice, event.near, map_from_base);
  remember("robot");
  choice_.robot = robot;
  use_robot(std::move(robot), event.time);
  choice_.held.clear();
  forget_places();
  if (event.base_at_ball) {
    const Eigen::Vector3d at = map_from_base->translation();
    remark = "its base is at " + place_text(at.x()) + ", " + place_text(at.y()) + ", " + place_text(at.z()) +
             " m, within " + short_text(1e3 * ball_->bound, 2) + " mm";
  }
  for (const PaintedVolume& volume : map_->volumes()) remark = joined(remark, unknown_parts(volume));
  note_ball();
}

/// Where the ball, set down, touches what the robot is to stand on. The base turns no other way for it.
Eigen::Isometry3d TeachSession::base_at_ball(double time) const {
  if (!setup_->probe) refuse("the setup has no probe whose ball could show the base");
  if (!ball_ || time - ball_->time > VirtualRobot::longest_gap)
    refuse("the ball has not been accepted " +
           (ball_ ? "for " + short_text(time - ball_->time, 2) + " s" : std::string("yet")) +
           "; hold it where the base is to stand");
  Eigen::Isometry3d map_from_base = robot_ ? robot_->robot().map_from_base : Eigen::Isometry3d::Identity();
  map_from_base.translation() = ball_->center - setup_->probe->ball_radius * map_from_base.linear().col(2);
  return map_from_base;
}

/// Whether the ball is large enough for the robot's hand.
void TeachSession::note_ball() const {
  if (!setup_->probe || !robot_ || !options_.note) return;
  const std::string sentence = ball_for_hand(setup_->probe->ball_radius, *robot_);
  if (!sentence.empty()) options_.note(sentence);
}

/// The robot that was before stays as it was, for undo.
void TeachSession::choose_branch(double time, std::string& remark) {
  require_robot();
  auto robot = std::make_shared<VirtualRobot>(*robot_);
  const std::string which = robot->take_next_branch();
  remember("branch");
  choice_.robot = robot;
  use_robot(std::move(robot), time);
  remark = "arm configuration " + which;
}

/// A remark on critical parts of a volume that are none of the robot's, nor loads that it holds.
std::string TeachSession::unknown_parts(const PaintedVolume& volume) const {
  if (!robot_) return {};
  std::set<std::string> known;
  for (const Body& body : robot_->robot().bodies) known.insert(body.part);
  std::vector<std::string> unknown;
  for (const std::string& part : volume.critical_parts)
    if (!known.contains(part) && !holds(choice_.held, part)) unknown.push_back(part);
  if (unknown.empty()) return {};
  return "robot " + quote(robot_->robot().name) + " has no part " + listed(unknown) + ", which volume " +
         quote(volume.label) + " is for; it has " + listed({known.begin(), known.end()});
}

/// One that is new follows the probe from where it was seen last, and does not wait for the next image.
void TeachSession::use_robot(std::shared_ptr<VirtualRobot> robot, double time) {
  if (robot == robot_) return;
  robot_ = std::move(robot);
  if (robot_ && shown_tip_ && time - shown_tip_->time <= VirtualRobot::longest_gap)
    robot_->lead(shown_tip_->map_from_tip, shown_tip_->time);
}

void TeachSession::require_robot() const {
  if (!robot_) refuse("no robot is chosen; 'robot' chooses one");
}

/// A gripper that is placed was measured against the board.
void TeachSession::see_base(const SeenImage& image) {
  if (base_ == nullptr) return;
  const auto is_of_base = [&](const TagDetection& seen) {
    return std::any_of(base_->tags.begin(), base_->tags.end(),
                       [&](const TagSetup& tag) { return tag.id == seen.id; });
  };
  const bool is_seen =
      image.map_from_gripper || std::any_of(image.tags.begin(), image.tags.end(), is_of_base);
  is_base_hidden_ = !is_seen;
  if (is_seen) base_seen_at_ = image.since_start;
}

/// Why the virtual robot is not where the gripper probe has it: without the board that all is measured
/// against, the probe may be in full view.
std::string TeachSession::not_there(double time) const {
  const bool is_board_lost =
      is_base_hidden_ && (!base_seen_at_ || time - *base_seen_at_ > VirtualRobot::longest_gap);
  if (!is_board_lost) return robot_->not_there(time);
  const std::string board = "the base board " + quote(base_->name) + " was not seen ";
  return board + (base_seen_at_ ? "for " + short_text(time - *base_seen_at_, 2) + " s" : "yet");
}

Configuration TeachSession::place_of(const TeachEvent& event) const {
  if (!event.q.empty()) return choose_configuration(event.q, "q", robot_->robot(), false);
  if (!setup_->gripper) refuse("the setup has no gripper to show it with, and the event no 'q'");
  if (const std::string why = not_there(event.time); !why.empty()) refuse(why);
  return robot_->q();
}

Verdict TeachSession::check(const Configuration& q, const std::vector<Load>& held) {
  return robot_->space(present_map(), map_version(), held)->check(q);
}

/// Who places the robot before anything is painted may not know that paint comes first. A ball that holds no
/// voxel as a whole paints none.
std::string TeachSession::cure_of(const Verdict& verdict) {
  const auto& volumes = map_->volumes();
  const bool is_painted = std::any_of(volumes.begin(), volumes.end(),
                                      [](const PaintedVolume& volume) { return !volume.spheres.empty(); });
  if (verdict.obstruction != Obstruction::outside_painted) return {};
  if (!is_painted) return "; nothing is painted yet, 'paint_on' begins a stroke";
  const VoxelCounts counts = present_map().counts();
  if (counts.painted + counts.conflict > 0) return {};
  return "; the balls are too small to hold a voxel of " + short_text(1e3 * map_->options().resolution, 3) +
         " mm, so nothing is painted: a finer --resolution or a larger ball does";
}

void TeachSession::choose_place(const TeachEvent& event, std::string& remark) {
  require_robot();
  if (event.action != TeachAction::start && !choice_.start) refuse("no start is chosen; 'start' comes first");
  constexpr std::size_t most_vias = 1000;
  if (event.action == TeachAction::via && choice_.vias.size() >= most_vias)
    refuse("at most 1000 goals on the way are possible; 'clear' forgets them");
  if (event.action == TeachAction::via && choice_.pick)
    refuse("a pick has no goals on the way; 'goal' says where the robot goes in the end");
  const TaughtPlace place{place_of(event), choice_.held};
  const Verdict verdict = check(place.q, place.held);
  if (!verdict.is_free()) refuse(verdict.sentence() + cure_of(verdict));
  if (event.action != TeachAction::start)
    require_begin(choice_.vias.empty() ? *choice_.start : choice_.vias.back());
  remember(std::string(to_string(event.action)));
  if (event.action == TeachAction::start) {
    forget_places();
    choice_.start = place;
  } else if (event.action == TeachAction::via) {
    choice_.vias.push_back(place);
  } else {
    choice_.goal = place;
  }
  forget_plan();
  for (const double value : place.q) remark += (remark.empty() ? "" : ", ") + short_text(value, 4);
  if (!place.held.empty()) remark += "; with " + names_of(place.held);
}

}  // namespace clearway

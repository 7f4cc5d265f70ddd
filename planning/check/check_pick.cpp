#include "planning/check/check_pick.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "mapping/system/plain_text.hpp"
#include "planning/check/path_check_links.hpp"
#include "planning/check/pick_maps.hpp"
#include "planning/check/pick_terms.hpp"
#include "planning/check/pick_ways.hpp"

namespace clearway {
namespace {

using check::PickTerms, check::same_tip;

/// The waypoints of a leg lie on the straight way of the tip that is stated, its attitude kept.
void require_straight(const PickTerms& terms, PickTerms::Leg index, const Eigen::Vector3d& way) {
  const std::vector<Configuration>& path = terms.leg(index);
  const Eigen::Isometry3d begin = terms.tip_at(path.front());
  const double length = way.norm();
  const Eigen::Vector3d along = way / length;
  const std::string name = names_of_legs(true)[index];
  for (const Configuration& q : path) {
    const Eigen::Isometry3d tip = terms.tip_at(q);
    const Eigen::Vector3d moved = tip.translation() - begin.translation();
    const double on = moved.dot(along);
    const double aside = (moved - on * along).norm(),
                 turned = check::angle_of(begin.linear().transpose() * tip.linear());
    if (!(on >= -same_tip && on <= length + same_tip && aside <= same_tip && turned <= same_tip))
      terms.refuse("a waypoint of " + name + " is off its straight way");
  }
  const Eigen::Vector3d whole = terms.tip_at(path.back()).translation() - begin.translation();
  if (!((whole - way).norm() <= same_tip)) terms.refuse(name + " is not of the length that is stated");
}

std::vector<std::vector<Configuration>> edges_of(const std::vector<Configuration>& path) {
  std::vector<std::vector<Configuration>> edges{{path.front()}};
  for (std::size_t i = 0; i + 1 < path.size(); ++i) edges.push_back({path[i], path[i + 1]});
  return edges;
}

void require_ways(const PickTerms& terms) {
  for (const auto& [index, way] : terms.ways()) require_straight(terms, index, way);
  for (const auto& [index, way] : terms.ways()) require_no_bow(terms, index, way, {terms.leg(index), {}});
}

/// The check of the path.
class PickCheck {
 public:
  explicit PickCheck(const PickTerms& terms) : terms_(terms) {}

  PathVerdict run() {
    try {
      terms_.require_rigid_hold();
      terms_.require_legs();
      terms_.require_grasp();
      for (const Leg index : {reach, lift, carry, lower, retreat})
        terms_.require_hand(index, edges_of(leg(index)));
      require_ways(terms_);
      check_all();
    } catch (const check::PickRefusal& refusal) {
      verdict_.valid = false;
      verdict_.first_contact = refusal.sentence;
    }
    if (!verdict_.valid) verdict_.min_clearance = 0.0;
    return verdict_;
  }

 private:
  using Leg = PickTerms::Leg;
  using enum PickTerms::Leg;

  const std::vector<Configuration>& leg(Leg index) const { return terms_.leg(index); }

  void check_all() {
    verdict_.valid = true;
    verdict_.min_clearance = HUGE_VAL;
    const Pick& pick = terms_.pick;
    const Snapshot &map = terms_.plan.map, freed = without_object(terms_);
    const Robot carrying = terms_.loaded();
    const std::size_t up = terms_.first_past_contact(leg(lift)),
                      down = terms_.last_before_contact(leg(lower));
    add(terms_.standing(pick.map_from_object, false), map, approach, leg(approach));
    add(terms_.standing(pick.map_from_object, true), freed, reach, leg(reach));
    add_open(pick.map_from_object, freed, reach);
    const auto first = leg(lift).begin();
    const std::vector<Configuration> on_support(first, first + static_cast<std::ptrdiff_t>(up) + 1);
    check_contact(carrying, freed, pick.map_from_object, lift, on_support, 0);
    add(carrying, freed, lift, {first + static_cast<std::ptrdiff_t>(up), leg(lift).end()}, up);
    add(carrying, freed, carry, leg(carry));
    const auto begin = leg(lower).begin();
    add(carrying, freed, lower, {begin, begin + static_cast<std::ptrdiff_t>(down) + 1});
    check_contact(carrying, freed, pick.map_from_place, lower,
                  {begin + static_cast<std::ptrdiff_t>(down), leg(lower).end()}, down);
    add(terms_.standing(pick.map_from_place, true), freed, retreat, leg(retreat));
    add_open(pick.map_from_place, freed, retreat);
    if (terms_.has_goal()) add(terms_.standing(pick.map_from_place, false), freed, leave, leg(leave));
  }

  /// From where the hand is open first to where it is so last it is not deep in the object.
  void add_open(const Eigen::Isometry3d& map_from_object, const Snapshot& freed, Leg index) {
    const std::optional<Robot> robot = terms_.standing_core(map_from_object);
    if (!robot || !verdict_.valid) return;
    const std::vector<Configuration>& path = leg(index);
    const auto is_open = [&](const Configuration& q) { return terms_.is_open(q); };
    const auto first = std::find_if(path.begin(), path.end(), is_open);
    const auto last = std::find_if(path.rbegin(), std::make_reverse_iterator(first), is_open).base();
    add(*robot, freed, index, {first, last}, static_cast<std::size_t>(first - path.begin()));
  }

  /// The first or last metres of a leg, on which the load may touch the layer and nothing else may.
  void check_contact(const Robot& carrying, const Snapshot& freed, const Eigen::Isometry3d& map_from_object,
                     Leg index, const std::vector<Configuration>& path, std::size_t offset) {
    add(terms_.plan.robot, freed, index, path, offset);
    add(carrying, without_layer(terms_, freed, map_from_object), index, path, offset);
    if (verdict_.valid) require_heights(terms_, carrying, map_from_object, index, {path, {}});
  }

  /// The check of a part of a leg; what follows the first refusal is not looked at.
  void add(const Robot& robot, const Snapshot& map, Leg index, const std::vector<Configuration>& path,
           std::size_t offset = 0) {
    if (!verdict_.valid) return;
    const PathVerdict part =
        check_tubes(robot, map, terms_.policies, terms_.padding, path, {}, 0.0, terms_.seen_within);
    verdict_.checker = part.checker;
    note_clearance(index, offset, part.clearance);
    if (part.valid) {
      verdict_.min_clearance = std::min(verdict_.min_clearance, part.min_clearance);
      return;
    }
    verdict_.valid = false;
    verdict_.undecided = part.undecided;
    verdict_.edge = part.edge < 0 ? -1 : part.edge + static_cast<int>(first_waypoint(index) + offset);
    verdict_.parameter = part.parameter;
    verdict_.first_contact = "leg " + names_of_legs(true)[index] + ", its " + part.first_contact;
  }

  std::size_t first_waypoint(Leg index) const {
    std::size_t first = 0;
    for (std::size_t i = 0; i < index; ++i) first += terms_.leg(i).size() - 1;
    return first;
  }

  void note_clearance(Leg index, std::size_t offset, const std::vector<double>& clearance) {
    const std::size_t first = first_waypoint(index) + offset;
    for (std::size_t i = 0; i < clearance.size(); ++i) {
      if (first + i >= verdict_.clearance.size()) verdict_.clearance.push_back(clearance[i]);
      double& known = verdict_.clearance[std::min(first + i, verdict_.clearance.size() - 1)];
      known = std::min(known, clearance[i]);
    }
  }

  const PickTerms& terms_;
  PathVerdict verdict_;
};

}  // namespace

PathVerdict check_pick(const PickToCheck& plan, const std::map<std::string, Policy>& policies, double padding,
                       double seen_within) {
  require_sound(plan.pick, plan.map.resolution(), padding);
  try {
    return PickCheck(PickTerms(plan, policies, padding, seen_within)).run();
  } catch (const check::FileDisagrees& error) {
    PathVerdict verdict;
    verdict.first_contact = error.what();
    return verdict;
  }
}

std::vector<std::string> pick_notes(const PickToCheck& plan, double padding) {
  require_sound(plan.pick, plan.map.resolution(), padding);
  try {
    const PickTerms terms(plan, {}, padding, 0.0);
    const std::string object = quote(plan.pick.object.name);
    std::vector<std::string> notes;
    if (!check::is_object_occupied(terms))
      notes.push_back("nothing that the map knows stands where " + object + " is taken");
    if (!is_layer_occupied(terms, without_object(terms), plan.pick.map_from_place))
      notes.push_back("nothing that the map knows stands below the place of " + object);
    const bool is_taken = plan.legs.size() > PickTerms::reach && !plan.legs[PickTerms::reach].empty();
    if (const std::string hand = is_taken ? check::hold_note(terms) : ""; !hand.empty())
      notes.push_back(hand);
    return notes;
  } catch (const check::FileDisagrees&) {
    return {};  // which check_pick refuses
  }
}

}  // namespace clearway

#include <string>

#include "mapping/system/number_text.hpp"
#include "planning/check/check_pick.hpp"
#include "planning/check/path_check_links.hpp"
#include "planning/check/pick_maps.hpp"
#include "planning/check/pick_terms.hpp"
#include "planning/check/pick_ways.hpp"
#include "planning/path/bezier.hpp"

namespace clearway {
namespace {

using check::PickTerms;

/// The check of a motion.
class PickMotionCheck {
 public:
  PickMotionCheck(const PickTerms& terms, const MotionToCheck& motion) : terms_(terms), motion_(motion) {}

  MotionVerdict run() {
    try {
      terms_.require_rigid_hold();
      terms_.require_legs();
      terms_.require_grasp();
      verdict_ = check_rates(terms_.plan.robot, motion_, terms_.grips());
      if (!verdict_.valid) return verdict_;
      if (motion_.rests.size() != terms_.plan.legs.size())
        terms_.refuse("its motion has " + counted(motion_.rests.size(), "leg") + ", its path " +
                      std::to_string(terms_.plan.legs.size()));
      check_legs();
    } catch (const check::PickRefusal& refusal) {
      verdict_.valid = false;
      verdict_.fault = "motion: " + refusal.sentence;
      verdict_.leg = refusal.leg;
    }
    if (!verdict_.valid) verdict_.min_clearance = 0.0;
    return verdict_;
  }

 private:
  using Leg = PickTerms::Leg;
  using enum PickTerms::Leg;

  /// The curve of each leg, as check_pick has the path.
  void check_legs() {
    const Pick& pick = terms_.pick;
    const std::vector<KnotRange> knots = knots_of_legs(motion_, terms_.grips());
    const Snapshot &map = terms_.plan.map, freed = without_object(terms_);
    const Robot carrying = terms_.loaded();
    const std::size_t up = end_of_lift_contact(knots[lift]), down = begin_of_lower_contact(knots[lower]);
    for (const Leg index : {reach, lift, carry, lower, retreat})
      terms_.require_hand(index, cubics_of(knots[index]));
    for (const auto& [index, way] : terms_.ways())
      require_no_bow(terms_, index, way, tubes_of(motion_.motion, knots[index], 1));
    prove(terms_.standing(pick.map_from_object, false), map, approach, knots[approach]);
    prove(terms_.standing(pick.map_from_object, true), freed, reach, knots[reach]);
    prove_open(pick.map_from_object, freed, reach, knots[reach]);
    prove_contact(carrying, freed, pick.map_from_object, lift, {knots[lift].first, up});
    prove(carrying, freed, lift, {up, knots[lift].last});
    prove(carrying, freed, carry, knots[carry]);
    prove(carrying, freed, lower, {knots[lower].first, down});
    prove_contact(carrying, freed, pick.map_from_place, lower, {down, knots[lower].last});
    prove(terms_.standing(pick.map_from_place, true), freed, retreat, knots[retreat]);
    prove_open(pick.map_from_place, freed, retreat, knots[retreat]);
    if (terms_.has_goal()) prove(terms_.standing(pick.map_from_place, false), freed, leave, knots[leave]);
  }

  std::vector<Configuration> positions(KnotRange knots) const {
    return stretch_of(motion_.motion, knots.first, knots.last).positions;
  }

  /// The control points of the cubic between each two knots, in whose hull it lies.
  std::vector<std::vector<Configuration>> cubics_of(KnotRange knots) const {
    const Motion part = stretch_of(motion_.motion, knots.first, knots.last);
    std::vector<std::vector<Configuration>> cubics{{part.positions.front()}};
    for (std::size_t k = 0; k + 1 < part.positions.size(); ++k)
      cubics.push_back(
          cubic_between({part.positions[k], part.velocities[k], part.accelerations[k]},
                        {part.positions[k + 1], part.velocities[k + 1], part.accelerations[k + 1]},
                        part.period)
              .control);
    return cubics;
  }

  // Between two knots the curve may pass the end of the contact: that piece is proved with the layer.

  std::size_t end_of_lift_contact(KnotRange knots) const {
    const std::vector<Configuration> lifted = positions(knots);
    std::size_t up = terms_.first_past_contact(lifted);
    if (up > 0 && terms_.is_beyond_contact(terms_.pick.map_from_object, lifted[up])) --up;
    return knots.first + up;
  }

  std::size_t begin_of_lower_contact(KnotRange knots) const {
    const std::vector<Configuration> lowered = positions(knots);
    std::size_t down = terms_.last_before_contact(lowered);
    if (down + 1 < lowered.size() && terms_.is_beyond_contact(terms_.pick.map_from_place, lowered[down]))
      ++down;
    return knots.first + down;
  }

  /// Proves a part of a leg; what follows the first refusal is not looked at.
  void prove(const Robot& robot, const Snapshot& map, Leg index, KnotRange range) {
    if (!verdict_.valid) return;
    prove_tubes(robot, map, terms_.policies, terms_.padding, terms_.seen_within, motion_.motion, range,
                verdict_);
    if (verdict_.valid) return;
    verdict_.leg = index;
    verdict_.fault = "motion: leg " + names_of_legs(true)[index] + ", " +
                     verdict_.fault.substr(std::string("motion: ").size());
  }

  /// While the hand is open it is not deep in the object.
  void prove_open(const Eigen::Isometry3d& map_from_object, const Snapshot& freed, Leg index,
                  KnotRange range) {
    const std::optional<Robot> robot = terms_.standing_core(map_from_object);
    if (!robot) return;
    const auto is_open = [&](std::size_t knot) { return terms_.is_open(motion_.motion.positions[knot]); };
    while (range.first < range.last && !is_open(range.first)) ++range.first;
    while (range.first < range.last && !is_open(range.last)) --range.last;
    prove(*robot, freed, index, range);
  }

  void prove_contact(const Robot& carrying, const Snapshot& freed, const Eigen::Isometry3d& map_from_object,
                     Leg index, KnotRange range) {
    prove(terms_.plan.robot, freed, index, range);
    prove(carrying, without_layer(terms_, freed, map_from_object), index, range);
    if (verdict_.valid)
      require_heights(terms_, carrying, map_from_object, index, tubes_of(motion_.motion, range, 1));
  }

  const PickTerms& terms_;
  const MotionToCheck& motion_;
  MotionVerdict verdict_;
};

}  // namespace

MotionVerdict check_pick_motion(const PickToCheck& plan, const MotionToCheck& motion,
                                const std::map<std::string, Policy>& policies, double padding,
                                double seen_within) {
  require_sound(plan.pick, plan.map.resolution(), padding);
  try {
    return PickMotionCheck(PickTerms(plan, policies, padding, seen_within), motion).run();
  } catch (const check::FileDisagrees& error) {
    MotionVerdict verdict;
    verdict.fault = "motion: " + std::string(error.what());
    return verdict;
  }
}

}  // namespace clearway

#include "planning/leg_motions.hpp"

#include <map>
#include <string>

#include "planning/planned_motion.hpp"
#include "planning/robot_files/torque_terms.hpp"

namespace clearway {

LegMotions::LegMotions(const ConfigurationSpace& space, const Plan& plan) {
  if (plan.pick) {
    const std::string& object = plan.pick->object.name;
    std::map<std::string, Policy> policies;
    if (const auto known = plan.policies.find(object); known != plan.policies.end()) policies.insert(*known);
    scene_ = std::make_unique<PickScene>(space, *plan.pick, policies);
    for (const LegLoad& load : plan.loads)
      if (load.load.name == object) scene_->hold(load.load.link_from_load, std::nullopt);
    list_legs_of_pick(plan);
  } else {
    list_loaded_legs(space, plan);
  }
  std::map<const ConfigurationSpace*, std::shared_ptr<const TorqueTerms>> known;
  for (Leg& leg : legs_) {
    std::shared_ptr<const TorqueTerms>& torques = known[leg.space];
    if (!torques) {
      const Robot& robot = leg.space->robot();
      torques = std::make_shared<const TorqueTerms>(torque_terms(robot, load_of(plan, robot)));
    }
    leg.torques = torques;
  }
}

SmoothMotion LegMotions::make(std::size_t leg, SmoothMotionOptions options) const {
  const Leg& of = legs_[leg];
  options.torques = of.torques;
  options.is_tube_free = of.is_tube_free;
  if (of.is_straight) options.straighten = 0.0;
  SmoothMotion made = smooth_motion(*of.space, of.stretches, options);
  made.leg_ends = {made.leg_ends.back()};
  made.stops += of.stretches.size() - 1;
  return made;
}

void LegMotions::list_legs_of_pick(const Plan& plan) {
  const ConfigurationSpace &bare = scene_->bare(), &carrying = scene_->carrying();
  const auto beside_layer = [&](const ConfigurationSpace& on_layer) {
    return [&](const Configuration& from, const Configuration& to, const Eigen::VectorXd& aside) {
      return carrying.is_edge_free(from, to, aside) ||
             (bare.is_edge_free(from, to, aside) && on_layer.is_edge_free(from, to, aside));
    };
  };
  const auto add = [&](const ConfigurationSpace& space, bool is_straight) -> Leg& {
    const std::vector<Configuration>& path = plan.legs[legs_.size()].waypoints;
    std::vector<std::vector<Configuration>> stretches{path};
    if (is_straight) stretches = stretches_of(bare.robot(), *plan.pick, path);
    return legs_.emplace_back(
        Leg{.stretches = std::move(stretches), .space = &space, .is_straight = is_straight});
  };
  const auto by_hand = [&](const ConfigurationSpace& open, const ConfigurationSpace& closing) {
    return [&, pick = *plan.pick](const Configuration& from, const Configuration& to,
                                  const Eigen::VectorXd& aside) {
      const bool is_open = with_grip(bare.robot(), pick, from, false) == from &&
                           with_grip(bare.robot(), pick, to, false) == to;
      return (is_open ? open : closing).is_edge_free(from, to, aside);
    };
  };
  add(scene_->before(), false);
  add(scene_->grasping(), true).is_tube_free = by_hand(scene_->reaching(), scene_->grasping());
  add(carrying, true).is_tube_free = beside_layer(scene_->lifting());
  add(carrying, false);
  add(carrying, true).is_tube_free = beside_layer(scene_->lowering());
  add(scene_->releasing(), true).is_tube_free = by_hand(scene_->retreating(), scene_->releasing());
  if (legs_.size() < plan.legs.size()) add(scene_->after(), false);
}

void LegMotions::list_loaded_legs(const ConfigurationSpace& space, const Plan& plan) {
  std::map<std::vector<std::string>, const ConfigurationSpace*> known = {{{}, &space}};
  for (std::size_t leg = 0; leg < plan.legs.size(); ++leg) {
    Robot robot = robot_of_leg(space.robot(), plan.loads, static_cast<int>(leg));
    std::vector<std::string> names;
    Policies policies{.parts = space.policies(), .other = Policy::not_occupied};
    for (const Load& load : robot.loads) {
      names.push_back(load.name);
      if (const auto given = plan.policies.find(load.name); given != plan.policies.end())
        policies.parts[load.name] = given->second;
    }
    const ConfigurationSpace*& own = known[names];
    if (!own) {
      spaces_.push_back(
          std::make_unique<ConfigurationSpace>(std::move(robot), space.map(), policies, space.options()));
      own = spaces_.back().get();
    }
    legs_.push_back({.stretches = {plan.legs[leg].waypoints}, .space = own});
  }
}

}  // namespace clearway

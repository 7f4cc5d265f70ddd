#pragma once

#include <gtest/gtest.h>

#include "apps/check/check_contract.hpp"
#include "planning/robot_files/load_robot.hpp"

namespace clearway {
namespace check_contract_test {

inline Configuration at(double x, double y) { return Eigen::Vector2d(x, y); }

inline Eigen::Isometry3d pose_at(double x) { return Eigen::Isometry3d(Eigen::Translation3d(x, 0.0, 0.0)); }

inline Load box(const std::string& name, const std::string& link) {
  Load load;
  load.name = name;
  load.link = link;
  load.shape = Shape::box({0.1, 0.1, 0.1});
  return load;
}

inline Pick pick_of_box(const std::string& name) {
  Pick pick;
  pick.object = box(name, "base");
  return pick;
}

using Terms = std::vector<AcceptedTerm>;

/// A plan of the disc with two legs, and a map whose record has the same query, each as a test makes it.
struct Question {
  CheckOptions options{};
  Robot robot = load_robot("point");
  Plan plan{};
  QueryTerms query{};
  bool has_record = true;
  Snapshot map{};

  Question() {
    options.robot.robot = "point";
    plan.robot = "point";
    plan.joints = {"x", "y"};
    plan.map_sha256 = "digest";
    plan.query = "own";
    plan.start = at(0, 0);
    plan.goals = {at(1, 0), at(1, 1)};
    plan.policies = {{"base", Policy::known_free}};
    for (const auto& [from, to] : {std::pair(at(0, 0), at(1, 0)), std::pair(at(1, 0), at(1, 1))}) {
      plan.legs.emplace_back().status = PlanStatus::solved;
      plan.legs.back().waypoints = {from, to};
    }
    query = {.name = "own",
             .robot = "point",
             .scale = 1.0,
             .map_from_base = Eigen::Isometry3d::Identity(),
             .policies = {{"base", Policy::known_free}},
             .padding = 0.0,
             .start = plan.start,
             .goals = plan.goals};
  }

  /// Of the same robot, which the plan does not answer.
  void make_query_another() {
    query.name = "another";
    query.start = at(0.5, 0.5);
  }

  Contract contract(bool is_timed = false) const {
    const auto record = has_record ? std::optional(QueryRecord{"digest", {query}}) : std::nullopt;
    return state_contract(options, plan, robot, map, "digest", record, is_timed);
  }

  Terms deviating() const { return deviating_from(contract()); }

  Terms deviating_from(const Contract& contract) const {
    Terms terms;
    for (const Deviation& deviation : deviations(contract, plan, robot, {})) {
      terms.push_back(deviation.term);
      EXPECT_FALSE(deviation.is_accepted);
    }
    return terms;
  }
};

}  // namespace check_contract_test
}  // namespace clearway

// Where each term of a contract comes from, and what of a plan deviates from it, without the command.
#include "apps/check/check_contract.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "mapping/free_space_map.hpp"
#include "planning/robot_files/load_robot.hpp"

namespace clearway {
namespace check_contract_test {

Configuration at(double x, double y) { return Eigen::Vector2d(x, y); }

Load box(const std::string& name, const std::string& link) {
  Load load;
  load.name = name;
  load.link = link;
  load.shape = Shape::box({0.1, 0.1, 0.1});
  return load;
}

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

  Contract contract() const {
    const auto record = has_record ? std::optional(QueryRecord{"digest", {query}}) : std::nullopt;
    return state_contract(options, plan, robot, map, "digest", record, false);
  }
  std::vector<AcceptedTerm> deviating() const {
    std::vector<AcceptedTerm> terms;
    for (const Deviation& deviation : deviations(contract(), plan, robot, {})) {
      terms.push_back(deviation.term);
      EXPECT_FALSE(deviation.is_accepted);
    }
    return terms;
  }
};

using Terms = std::vector<AcceptedTerm>;

TEST(CheckContract, WhatThePlanAnswersAsIsDeviatesInNothing) { EXPECT_EQ(Question().deviating(), Terms{}); }

/// A flag before the record, the record before the plan; of other queries the longest age, as a bound.
TEST(CheckContract, AgesAreThoseOfTheFlagElseOfTheRecordElseOfThePlan) {
  const auto age = [](const Question& question) {
    const Term<double> term = question.contract().seen_within;
    return std::pair(term.value, term.source);
  };
  Question question;
  question.query.seen_within = 5.0;
  question.plan.seen_within = 7.0;
  EXPECT_EQ(age(question), std::pair(5.0, TermSource::map));
  question.options.robot.seen_within = 3.0;
  EXPECT_EQ(age(question), std::pair(3.0, TermSource::flag));
  question.options.robot.seen_within = 0.0;
  EXPECT_EQ(age(question), std::pair(0.0, TermSource::flag));
  question.options.robot.seen_within.reset();
  question.has_record = false;
  EXPECT_EQ(age(question), std::pair(7.0, TermSource::plan));
  question.has_record = true;
  question.query.name = "another";
  question.query.start = at(0.5, 0.5);
  EXPECT_EQ(age(question), std::pair(5.0, TermSource::map));
  question.plan.seen_within = 0.0;
  EXPECT_EQ(age(question), std::pair(5.0, TermSource::map));
  question.plan.seen_within = 4.0;
  EXPECT_EQ(age(question), std::pair(4.0, TermSource::plan));
  question.query.seen_within = 0.0;
  question.plan.seen_within = 0.0;
  EXPECT_EQ(age(question), std::pair(0.0, TermSource::plan));
}

TEST(CheckContract, APlanThatAsksForNoAgeOrALongerOneDeviates) {
  Question question;
  question.query.seen_within = 5.0;
  for (const auto& [said, is_kept] :
       {std::pair(0.0, false), std::pair(5.1, false), std::pair(5.0, true), std::pair(1.0, true)}) {
    question.plan.seen_within = said;
    EXPECT_EQ(question.deviating(), is_kept ? Terms{} : Terms{AcceptedTerm::policy}) << said;
  }
}

/// Lengths grow with the scale, weights with its third power.
TEST(CheckContract, AccuracyAndPayloadAreThoseOfTheRobotAtTheContractsScale) {
  for (const double scale : {0.5, 1.0, 2.0}) {
    Question question;
    question.has_record = false;
    question.robot.position_accuracy = 0.004;
    question.options.robot.scale = scale;
    question.options.dynamics.payload = 3.0;
    const Contract contract = question.contract();
    EXPECT_DOUBLE_EQ(contract.position_accuracy, 0.004 * scale);
    EXPECT_DOUBLE_EQ(contract.padding.value, 0.004 * scale);
    EXPECT_EQ(contract.padding.source, TermSource::by_default);
    EXPECT_DOUBLE_EQ(joint_load_of(contract).payload, 3.0 * std::pow(scale, 3));
  }
}

/// Neither by saying so nor by leaving it open: only flag or record loosen what a load must lie in.
TEST(CheckContract, APlanLoosensNotWhatItsLoadMustLieIn) {
  Question question;
  question.plan.loads = {{box("box", "base"), {}}};
  const auto policy = [&] { return question.contract().policies.at("box").value; };
  for (const bool has_record : {true, false}) {
    question.has_record = has_record;
    EXPECT_EQ(policy(), Policy::known_free);
    question.plan.policies["box"] = Policy::not_occupied;
    EXPECT_EQ(policy(), Policy::known_free);
    question.plan.policies["box"] = Policy::painted;
    EXPECT_EQ(policy(), Policy::painted);
    question.plan.policies.erase("box");
  }
  question.has_record = true;
  question.query.loads = question.plan.loads;
  question.query.policies["box"] = Policy::not_occupied;
  EXPECT_EQ(policy(), Policy::not_occupied);
}

/// As a planner does, whichever flags say what holds it.
TEST(CheckContract, ALoadThatNoFlagNamesMustLieInWhatItsHolderMust) {
  Question question;
  question.has_record = false;
  question.plan.policies.clear();
  question.plan.loads = {{box("box", "base"), {}}};
  FreeSpaceMap painted({.resolution = 0.1});
  painted.add_volume("floor", {"base"});
  question.map = painted.snapshot();
  const auto expect = [&](const std::vector<std::string>& flags, Policy expected) {
    question.options.robot.policies = flags;
    EXPECT_EQ(question.contract().policies.at("box").value, expected) << flags.size();
  };
  expect({"not_occupied", "base=known_free"}, Policy::known_free);
  expect({"known_free", "base=painted"}, Policy::painted);
  expect({"painted", "base=not_occupied"}, Policy::not_occupied);
  expect({"base=not_occupied"}, Policy::not_occupied);
  expect({}, Policy::painted);  // the volume names its holder
  expect({"not_occupied", "box=painted"}, Policy::painted);
  question.plan.policies["box"] = Policy::not_occupied;
  expect({"not_occupied", "base=known_free"}, Policy::known_free);
}

/// A state's joints that slide do so in proportion to the robot's size.
TEST(CheckContract, StatesAreThoseOfTheRobotAtTheContractsScale) {
  Question question;
  question.has_record = false;
  question.robot.states.push_back({"home", {{"x", 1.0}, {"y", -0.5}}});
  question.options.start = "home";
  question.options.goals = {"home"};
  question.options.robot.scale = 0.5;
  const Contract contract = question.contract();
  EXPECT_TRUE(contract.start.value.isApprox(at(0.5, -0.25)));
  ASSERT_EQ(contract.goals.value.size(), 1U);
  EXPECT_TRUE(contract.goals.value[0].isApprox(at(0.5, -0.25)));
}

/// On each leg by itself, the first and the last.
TEST(CheckContract, ALoadThatThePlanLeavesOffOnALegDeviates) {
  for (const std::vector<int>& legs : {std::vector<int>{}, {0}, {1}, {0, 1}}) {
    Question question;
    question.query.loads = {{box("box", "base"), {}}};
    question.plan.loads = {{box("box", "base"), legs}};
    question.plan.policies["box"] = Policy::known_free;
    const std::size_t left_off = legs.empty() ? 0 : 2 - legs.size();
    EXPECT_EQ(question.deviating(), Terms(left_off, AcceptedTerm::load)) << legs.size();
  }
  Question question;
  question.query.loads = {{box("box", "base"), {0}}};
  question.plan.policies["box"] = Policy::known_free;
  for (const auto& [legs, is_kept] : {std::pair(std::vector<int>{0}, true), {{1}, false}, {{}, true}}) {
    question.plan.loads = {{box("box", "base"), legs}};
    EXPECT_EQ(question.deviating(), is_kept ? Terms{} : Terms{AcceptedTerm::load});
  }
}

/// A pick frees voxels: it is the record's where no flag says one, and never the plan's.
TEST(CheckContract, APickIsOfTheRecordAndNeverOfThePlan) {
  Question question;
  Pick pick;
  pick.object = box("can", "base");
  question.plan.pick = pick;
  EXPECT_FALSE(question.contract().pick.value.has_value());
  question.query.pick = pick;
  question.plan.pick.reset();
  const Contract contract = question.contract();
  ASSERT_TRUE(contract.pick.value.has_value());
  EXPECT_EQ(contract.pick.source, TermSource::map);
  EXPECT_TRUE(is_same(*contract.pick.value, pick));
  EXPECT_EQ(carried_under(contract).size(), 1U);
  EXPECT_EQ(carried_under(contract).front().legs, legs_that_carry());
}

}  // namespace check_contract_test
}  // namespace clearway

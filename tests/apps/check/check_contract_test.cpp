// Where each term of a contract comes from, and what of a plan deviates from it, without the command.
#include "apps/check/check_contract.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "mapping/free_space_map.hpp"
#include "tests/apps/check/check_question.hpp"

namespace clearway {
namespace check_contract_test {

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
  question.make_query_another();
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

/// Each term as flags, record and plan say it, 3 and 2 and 1; of a plan alone some are the robot's or none.
TEST(CheckContract, ATermIsTheFlagsElseTheRecordsElseThePlans) {
  const Eigen::Vector3d down = -Eigen::Vector3d::UnitZ();
  for (const TermSource source : {TermSource::flag, TermSource::map, TermSource::plan}) {
    Question question;
    question.plan.robot_scale = 1.25;
    question.plan.map_from_base = pose_at(1.0);
    question.plan.payload = 1.0;
    question.plan.gravity = down;
    question.plan.padding = 0.1;
    question.plan.policies = {{"base", Policy::not_occupied}};
    question.has_record = source != TermSource::plan;
    question.query.scale = 2.0;
    question.query.map_from_base = pose_at(2.0);
    question.query.payload = 2.0;
    question.query.gravity = 2.0 * down;
    question.query.padding = 0.2;
    question.query.start = at(0.2, 0.0);
    question.query.goals = {at(0.2, 0.2)};
    CheckOptions& flags = question.options;
    if (source == TermSource::flag) {
      flags.robot.scale = 3.0;
      flags.robot.base = {3.0, 0.0, 0.0};
      flags.robot.padding = 0.3;
      flags.robot.policies = {"base=painted"};
      flags.dynamics.payload = 3.0;
      flags.dynamics.gravity = {0.0, 0.0, -3.0};
      flags.start = "0.3,0";
      flags.goals = {"0.3,0.3"};
    }
    const Contract contract = question.contract();
    const double number = source == TermSource::flag ? 3.0 : source == TermSource::map ? 2.0 : 1.0;
    EXPECT_EQ(contract.query, question.has_record ? "own" : "");
    EXPECT_EQ(contract.scale.value, number);
    EXPECT_EQ(contract.scale.source, number == 1.0 ? TermSource::by_default : source);
    EXPECT_EQ(contract.map_from_base.value.matrix(), pose_at(number).matrix());
    EXPECT_EQ(contract.map_from_base.source, source);
    EXPECT_EQ(contract.payload.value, number);
    EXPECT_EQ(contract.payload.source, source);
    EXPECT_EQ(contract.gravity.value, Eigen::Vector3d(number * down));
    EXPECT_EQ(contract.gravity.source, source);
    EXPECT_DOUBLE_EQ(contract.padding.value, 0.1 * number);
    EXPECT_EQ(contract.padding.source, source);
    EXPECT_EQ(contract.policies.at("base").source, source);
    EXPECT_EQ(contract.policies.at("base").value, number == 3.0   ? Policy::painted
                                                  : number == 2.0 ? Policy::known_free
                                                                  : Policy::not_occupied);
    EXPECT_EQ(contract.start.value, at(number == 3.0 ? 0.3 : number == 2.0 ? 0.2 : 0.0, 0.0));
    EXPECT_EQ(contract.start.source, source);
    EXPECT_EQ(contract.goals.source, source);
    EXPECT_EQ(contract.goals.value, number == 1.0   ? question.plan.goals
                                    : number == 2.0 ? question.query.goals
                                                    : std::vector{at(0.3, 0.3)});
    EXPECT_EQ(contract.map_sha256.value, "digest");
  }
}

TEST(CheckContract, AFlagForAllPartsIsThePolicyOfEach) {
  Question question;
  for (const auto& [flag, policy] : {std::pair("painted", Policy::painted),
                                     {"known_free", Policy::known_free},
                                     {"not_occupied", Policy::not_occupied}}) {
    question.options.robot.policies = {flag};
    EXPECT_EQ(question.contract().policies.at("base").value, policy);
    EXPECT_EQ(question.contract().policies.at("base").source, TermSource::flag);
  }
  question.has_record = false;
  question.options.robot.policies.clear();
  question.plan.policies.clear();
  EXPECT_EQ(question.contract().policies.at("base").source, TermSource::by_default);
  EXPECT_EQ(question.contract().policies.at("base").value, Policy::known_free);  // of a critical part
}

TEST(CheckContract, OtherQueriesOfTheMapBoundWhatAPlanMaySay) {
  Question question;
  question.make_query_another();
  question.robot.position_accuracy = 0.004;
  const auto padding = [&](double recorded, double said) {
    question.query.padding = recorded;
    question.plan.padding = said;
    const Term<double> term = question.contract().padding;
    return std::pair(term.value, term.source);
  };
  EXPECT_EQ(padding(0.003, 0.002), std::pair(0.003, TermSource::map));
  EXPECT_EQ(padding(0.003, 0.003), std::pair(0.003, TermSource::plan));
  EXPECT_EQ(padding(0.003, 0.0035), std::pair(0.0035, TermSource::plan));
  EXPECT_EQ(padding(0.005, 0.0035), std::pair(0.004, TermSource::by_default));
  EXPECT_EQ(padding(0.005, 0.0045), std::pair(0.0045, TermSource::plan));
  const auto policy = [&](Policy recorded, Policy said) {
    question.query.policies["base"] = recorded;
    question.plan.policies["base"] = said;
    const Term<Policy> term = question.contract().policies.at("base");
    return std::pair(term.value, term.source);
  };
  constexpr auto strict = Policy::painted, middling = Policy::known_free, loose = Policy::not_occupied;
  EXPECT_EQ(policy(middling, loose), std::pair(middling, TermSource::map));
  EXPECT_EQ(policy(middling, middling), std::pair(middling, TermSource::plan));
  EXPECT_EQ(policy(middling, strict), std::pair(strict, TermSource::plan));
  const auto base = [&](double said) {
    question.plan.map_from_base = pose_at(said);
    const auto term = question.contract().map_from_base;
    return std::pair(term.value.translation().x(), term.source);
  };
  EXPECT_EQ(base(0.0), std::pair(0.0, TermSource::plan));
  EXPECT_EQ(base(0.5), std::pair(0.0, TermSource::map));
  question.query.robot = "planar2";  // which says nothing of the disc
  EXPECT_EQ(base(0.5), std::pair(0.5, TermSource::plan));
  EXPECT_EQ(padding(0.003, 0.0), std::pair(0.004, TermSource::by_default));
}

TEST(CheckContract, LoadsAreTheRecordsAndThoseThatThePlanCarriesBeside) {
  Question question;
  question.query.loads = {{box("mine", "base"), {1}}};
  question.plan.loads = {{box("mine", "base"), {}}, {box("more", "base"), {0}}};
  const Contract contract = question.contract();
  EXPECT_EQ(contract.loads.source, TermSource::map);
  ASSERT_EQ(contract.loads.value.size(), 2U);
  EXPECT_EQ(contract.loads.value[0].legs, std::vector{1});
  EXPECT_EQ(contract.loads.value[1].load.name, "more");
  EXPECT_EQ(contract.loads.value[1].legs, std::vector{0});
  EXPECT_EQ(carried_under(contract).size(), 2U);
  EXPECT_TRUE(contract.policies.contains("mine") && contract.policies.contains("more"));
  question.query.pick = pick_of_box("can");
  question.query.loads.clear();
  EXPECT_THROW(question.contract(), std::invalid_argument);  // nothing else rides beside what is picked
  question.plan.loads = {{box("can", "base"), {2, 3, 4}}};
  EXPECT_TRUE(question.contract().loads.value.empty());
}

/// Of a pick the plan says where its six legs end; a goal that is stated comes behind them.
TEST(CheckContract, GoalsOfAPickAreThePlansAndTheStatedOneBehindThem) {
  Question question;
  question.query.pick = pick_of_box("can");
  question.query.goals.clear();
  question.plan.goals.clear();
  for (int i = 0; i < 7; ++i) question.plan.goals.push_back(at(0.1 * i, 0.0));
  const std::vector<Configuration> legs(question.plan.goals.begin(), question.plan.goals.end() - 1);
  const auto with = [&](const Configuration& goal) {
    std::vector<Configuration> all = legs;
    all.push_back(goal);
    return all;
  };
  EXPECT_EQ(question.contract().goals.value, question.plan.goals);
  question.query.goals = {at(0.7, 0.7)};
  EXPECT_EQ(question.contract().goals.value, with(at(0.7, 0.7)));
  EXPECT_EQ(question.contract().goals.source, TermSource::plan);
  question.options.goals = {"0.8,0.8"};
  EXPECT_EQ(question.contract().goals.value, with(at(0.8, 0.8)));
  EXPECT_EQ(question.contract().goals.source, TermSource::flag);
}

/// One for each pose: where the plan's leg ends, else its goal, else nowhere.
TEST(CheckContract, OfPosesThePlanSaysWhichConfigurationsTheyAre) {
  Question question;
  question.query.goal_poses = {GoalPose{pose_at(1.0)}, GoalPose{pose_at(2.0)}, GoalPose{pose_at(3.0)}};
  question.plan.legs.back().waypoints.clear();
  question.plan.legs.front().waypoints.back() = at(0.9, 0.0);
  const Contract contract = question.contract();
  EXPECT_EQ(contract.goal_poses.size(), 3U);
  EXPECT_EQ(contract.goals.source, TermSource::map);
  EXPECT_EQ(contract.goals.value, (std::vector{at(0.9, 0.0), at(1, 1), Configuration()}));
  EXPECT_EQ(contract.tip_link.value, "base");
  question.options.goals = {"1,0", "1,1"};
  EXPECT_TRUE(question.contract().goal_poses.empty());
  EXPECT_EQ(question.contract().goals.value, question.plan.goals);
  EXPECT_EQ(question.contract().tip_link.value, "");
  question.options.goals.clear();
  question.query.tip = "wing";
  EXPECT_THROW(question.contract(), std::invalid_argument);
}

TEST(CheckContract, PartsMayBeOutsideByAFlagOrByTheRecordOfTheQuery) {
  Question question;
  question.query.allow_outside = {"all"};
  question.options.survey.allow_outside = {"base"};
  EXPECT_EQ(question.contract().demands.allow_outside, (std::vector<std::string>{"base", "all"}));
  question.make_query_another();
  EXPECT_EQ(question.contract().demands.allow_outside, (std::vector<std::string>{"base"}));
  question.options.survey.allow_outside = {"wing"};
  EXPECT_THROW(question.contract(), std::invalid_argument);
}

TEST(CheckContract, TheGripTimeIsOfAMotionAlone) {
  Question question;
  question.options.grip_time = 2.0;
  EXPECT_FALSE(question.contract().grip_time.value.has_value());
  question.plan.motion.emplace().grip_time = 1.0;
  EXPECT_EQ(question.contract().grip_time.value, 2.0);
  EXPECT_EQ(question.contract().grip_time.source, TermSource::flag);
  question.options.grip_time.reset();
  EXPECT_EQ(question.contract().grip_time.value, 1.0);
  EXPECT_EQ(question.contract().grip_time.source, TermSource::plan);
}

/// A sentence that begins so is among the notes.
bool is_noted(const Contract& contract, const std::string& begin) {
  return std::any_of(contract.notes.begin(), contract.notes.end(),
                     [&](const std::string& note) { return note.starts_with(begin); });
}

TEST(CheckContract, WhatThePlanAloneSaysIsNotedWhereItIsUnusual) {
  const char *base = "the base is the plan's", *gravity = "the gravity is the plan's",
             *policy = "the policy of base is the plan's",
             *dynamics = "payload and gravity are only compared";
  Question question;
  question.has_record = false;
  question.plan.policies["base"] = Policy::painted;
  for (const char* note : {base, gravity, policy, dynamics})
    EXPECT_FALSE(is_noted(question.contract(), note)) << note;
  question.plan.map_from_base = pose_at(0.1);
  question.plan.gravity.x() = 0.1;
  EXPECT_TRUE(is_noted(question.contract(), base));
  EXPECT_TRUE(is_noted(question.contract(true), gravity));
  EXPECT_FALSE(is_noted(question.contract(), gravity)) << "a path has no torques";
  question.options.dynamics.payload = 1.0;
  EXPECT_TRUE(is_noted(question.contract(), dynamics));
  EXPECT_FALSE(is_noted(question.contract(true), dynamics));
  question.options.dynamics = {{}, {0.0, 0.0, -9.81}};
  EXPECT_TRUE(is_noted(question.contract(), dynamics));
  EXPECT_FALSE(is_noted(question.contract(true), gravity));
}

TEST(CheckContract, TheRobotIsThatOfTheContractsScaleAndPlaceAndItsTipThatOfAPickByFlag) {
  Question question;
  question.options.robot.scale = 2.0;
  question.options.robot.base = {0.5, 0.0, 0.0};
  Contract contract = question.contract();
  const Robot placed = robot_of(contract, question.robot);
  EXPECT_EQ(placed.scale, 2.0 * question.robot.scale);
  EXPECT_EQ(placed.map_from_base.matrix(), pose_at(0.5).matrix());
  const auto tip = [&] { return tipped_robot_of(contract, question.robot).tip_link; };
  contract.tip = "slide";
  EXPECT_EQ(tip(), question.robot.tip_link);
  contract.pick = {pick_of_box("can"), TermSource::flag};
  EXPECT_EQ(question.robot.links[static_cast<std::size_t>(tip())].name, "slide");
  contract.pick.source = TermSource::map;
  EXPECT_EQ(tip(), question.robot.tip_link);
  EXPECT_EQ(policies_of(contract), (std::map{std::pair(std::string("base"), Policy::known_free)}));
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
  const Pick pick = pick_of_box("can");
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

// Of each term how far a plan may be from the contract, and what of it is taken over where that is accepted.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/apps/check/check_question.hpp"

namespace clearway {
namespace check_deviations_test {

using check_contract_test::at;
using check_contract_test::box;
using check_contract_test::pick_of_box;
using check_contract_test::pose_at;
using check_contract_test::Question;
using check_contract_test::Terms;

/// The contract that the plan keeps, and either of them as a test changes it.
struct Answer : Question {
  Contract contract = Question::contract();

  Terms deviating() const { return deviating_from(contract); }

  std::string sentence() const {
    const std::vector<Deviation> found = deviations(contract, plan, robot, {});
    EXPECT_EQ(found.size(), 1U);
    return found.empty() ? "" : found.front().sentence;
  }
};

TEST(CheckDeviations, LengthsAnglesAndScaleMayBeOffByTheTolerancesOfAContract) {
  using Change = std::function<void(Answer&, double)>;
  const std::vector<std::pair<AcceptedTerm, Change>> changes{
      {AcceptedTerm::scale, [](Answer& answer, double by) { answer.plan.robot_scale += by; }},
      {AcceptedTerm::base,
       [](Answer& answer, double by) { answer.plan.map_from_base.translation().z() += by; }},
      {AcceptedTerm::held,
       [](Answer& answer, double by) {
         answer.contract.held["grip"] = {0.25, TermSource::by_default};
         answer.plan.held["grip"] = 0.25 + by;
       }},
      {AcceptedTerm::payload, [](Answer& answer, double by) { answer.plan.gravity.y() += by; }},
      {AcceptedTerm::goals, [](Answer& answer, double by) { answer.plan.start[1] += by; }},
      {AcceptedTerm::goals, [](Answer& answer, double by) { answer.plan.goals[1][0] += by; }},
      {AcceptedTerm::goals, [](Answer& answer, double by) { answer.plan.legs[0].waypoints[0][1] += by; }},
      {AcceptedTerm::goals, [](Answer& answer, double by) { answer.plan.legs[0].waypoints[1][0] += by; }},
      {AcceptedTerm::goals, [](Answer& answer, double by) { answer.plan.legs[1].waypoints[1][1] += by; }}};
  for (std::size_t i = 0; i < changes.size(); ++i) {
    for (const double sign : {1.0, -1.0}) {
      Answer near, far;
      changes[i].second(near, sign * 0.9e-6);
      changes[i].second(far, sign * 1.1e-6);
      EXPECT_EQ(near.deviating(), Terms{}) << i;
      EXPECT_EQ(far.deviating(), Terms{changes[i].first}) << i;
    }
  }
  Answer large;  // of a scale it is a share
  large.contract.scale.value = large.plan.robot_scale = 100.0;
  large.plan.robot_scale += 0.9e-4;
  EXPECT_EQ(large.deviating(), Terms{});
  large.plan.robot_scale += 0.2e-4;
  EXPECT_EQ(large.deviating(), Terms{AcceptedTerm::scale});
  Answer turned;  // where it stands
  turned.plan.map_from_base.rotate(Eigen::AngleAxisd(2e-6, Eigen::Vector3d::UnitX()));
  EXPECT_EQ(turned.deviating(), Terms{AcceptedTerm::base});
}

TEST(CheckDeviations, APlanMayAskForMoreAndNotForLess) {
  Answer answer;
  answer.contract.padding.value = 0.01;
  answer.plan.padding = 0.02;
  answer.contract.payload.value = 2.0;
  answer.plan.payload = 3.0;
  EXPECT_EQ(answer.deviating(), Terms{});
  answer.plan.padding = 0.01;
  answer.plan.payload = 2.0;
  EXPECT_EQ(answer.deviating(), Terms{});
  answer.plan.padding = std::nextafter(0.01, 0.0);
  EXPECT_EQ(answer.deviating(), Terms{AcceptedTerm::padding});
  answer.plan.padding = 0.02;
  answer.plan.payload = std::nextafter(2.0, 0.0);
  EXPECT_EQ(answer.deviating(), Terms{AcceptedTerm::payload});
  answer.plan.payload = 2.0;
  answer.plan.map_sha256 = "another";
  EXPECT_EQ(answer.deviating(), Terms{AcceptedTerm::map});
  answer.plan.map_sha256 = "digest";
  answer.plan.robot = "robots/point.yaml";  // the same by its file
  EXPECT_EQ(answer.deviating(), Terms{});
  answer.plan.robot = "points";
  EXPECT_EQ(answer.deviating(), Terms{AcceptedTerm::robot});
}

TEST(CheckDeviations, VoxelsOfAnotherEdgeAreAnotherMapAndSaidInMillimetres) {
  Answer answer;
  answer.contract.map_resolution = 0.05;
  for (const double as_good : {0.0, 0.05, 0.05 + 0.9e-6, 0.05 - 0.9e-6}) {  // 0: the plan says none
    answer.plan.map_resolution = as_good;
    EXPECT_EQ(answer.deviating(), Terms{}) << as_good;
  }
  for (const double other : {0.05 + 1.1e-6, 0.05 - 1.1e-6, 0.02}) {
    answer.plan.map_resolution = other;
    EXPECT_EQ(answer.deviating(), Terms{AcceptedTerm::map}) << other;
  }
  EXPECT_EQ(answer.sentence(),
            "map: expected voxels of 50 mm, the plan was made on those of 20 mm (--cloud-resolution)");
  answer.plan.map_sha256 = "another";
  EXPECT_EQ(answer.sentence(),
            "map: expected one with the sha256 digest…, the plan was made on another, another…");
}

TEST(CheckDeviations, AHeldJointOfWhichThePlanSaysNothingDeviates) {
  Answer answer;
  answer.contract.held["grip"] = {0.25, TermSource::flag};
  answer.plan.held["other"] = 0.25;
  EXPECT_EQ(answer.deviating(), Terms{AcceptedTerm::held});
  EXPECT_NE(answer.sentence().find("expected to stand at 0.25, the plan says nothing of it"),
            std::string::npos)
      << answer.sentence();
}

TEST(CheckDeviations, PoliciesMayBeStricterThanAskedAndUnsaidWhereTheUsualOneCounts) {
  constexpr Policy all[] = {Policy::painted, Policy::known_free, Policy::not_occupied};
  for (const TermSource source :
       {TermSource::flag, TermSource::map, TermSource::by_default, TermSource::plan}) {
    for (const Policy asked : all) {
      Answer answer;
      answer.contract.policies["base"] = {asked, source};
      for (const Policy said : all) {
        answer.plan.policies = {{"base", said}};
        const bool is_kept = source == TermSource::plan || said <= asked;
        EXPECT_EQ(answer.deviating(), is_kept ? Terms{} : Terms{AcceptedTerm::policy});
      }
      answer.plan.policies = {{"wing", Policy::painted}};
      const bool is_usual = source == TermSource::plan || source == TermSource::by_default;
      EXPECT_EQ(answer.deviating(), is_usual ? Terms{} : Terms{AcceptedTerm::policy});
    }
  }
}

TEST(CheckDeviations, AnAgeCountsWhereTheRecordAsksForIt) {
  Answer answer;
  for (const TermSource source : {TermSource::flag, TermSource::map, TermSource::plan}) {
    for (const double asked : {0.0, 5.0}) {
      for (const double said : {0.0, 4.0, 5.0, std::nextafter(5.0, 6.0)}) {
        answer.contract.seen_within = {asked, source};
        answer.plan.seen_within = said;
        const bool is_kept = source != TermSource::map || asked == 0.0 || (said > 0.0 && said <= asked);
        EXPECT_EQ(answer.deviating(), is_kept ? Terms{} : Terms{AcceptedTerm::policy}) << said;
      }
    }
  }
}

TEST(CheckDeviations, ALoadMayNotBeMissingOrAnother) {
  Answer answer;
  answer.contract.loads = {{{box("box", "base"), {}}}, TermSource::map};
  answer.contract.policies["box"] = {Policy::known_free, TermSource::map};
  EXPECT_EQ(answer.deviating(), Terms{AcceptedTerm::load});  // and of its policy nothing is said, too
  answer.plan.loads = {{box("other", "base"), {}}, {box("box", "base"), {}}};
  EXPECT_EQ(answer.deviating(), Terms{AcceptedTerm::policy});
  answer.plan.policies["box"] = Policy::known_free;
  EXPECT_EQ(answer.deviating(), Terms{});
  answer.plan.loads[1].load.link_from_load.translation().x() = 2e-6;
  EXPECT_EQ(answer.deviating(), Terms{AcceptedTerm::load});
}

/// A plan that was cut or numbered anew could leave a load off where it has to ride.
TEST(CheckDeviations, ALoadThatRidesOnSingleLegsNeedsThemAndTheirNumbers) {
  for (const TermSource source : {TermSource::map, TermSource::plan}) {
    for (const std::vector<int>& legs : {std::vector<int>{}, {0}, {1}, {2}, {1, 2, 3}}) {
      Answer answer;
      answer.contract.loads = {{{box("box", "base"), legs}}, source};
      answer.contract.policies["box"] = {Policy::known_free, TermSource::plan};
      answer.plan.loads = answer.contract.loads.value;
      const bool are_numbered = source == TermSource::map && !legs.empty();
      std::size_t beyond = 0;
      for (const int leg : legs) beyond += are_numbered && leg >= 2 ? 1 : 0;
      EXPECT_EQ(answer.deviating(), Terms(beyond, AcceptedTerm::load)) << legs.size();
      answer.contract.goals.source = TermSource::plan;
      EXPECT_EQ(answer.deviating(), Terms(beyond + (are_numbered ? 1 : 0), AcceptedTerm::load));
    }
  }
}

TEST(CheckDeviations, APickIsStatedByBothOrByNeither) {
  for (const auto& [stated, planned] :
       {std::pair("", ""), {"can", ""}, {"", "can"}, {"can", "can"}, {"can", "cup"}}) {
    Answer answer;
    const std::string expected = stated, said = planned;
    if (!expected.empty()) answer.contract.pick.value = pick_of_box(expected);
    if (!said.empty()) answer.plan.pick = pick_of_box(said);
    EXPECT_EQ(answer.deviating(), expected == said ? Terms{} : Terms{AcceptedTerm::load}) << expected << said;
  }
}

TEST(CheckDeviations, EachGoalHasItsLegAndNoLegIsLeftOver) {
  Answer answer;
  answer.plan.legs.pop_back();
  EXPECT_EQ(answer.deviating(), Terms{AcceptedTerm::goals});  // the second is not reached
  answer.plan.goals.pop_back();
  EXPECT_EQ(answer.deviating(), Terms(2, AcceptedTerm::goals));  // nor asked for
  answer.plan.goals.clear();
  EXPECT_EQ(answer.deviating(), Terms{AcceptedTerm::goals});
  Answer more;
  more.plan.legs.push_back(more.plan.legs.back());
  EXPECT_EQ(more.deviating(), Terms{AcceptedTerm::goals});
  EXPECT_NE(more.sentence().find("legs: expected 2, one for each goal, the plan has 3"), std::string::npos);
  Answer empty;
  empty.plan.legs[0].waypoints.clear();
  EXPECT_EQ(empty.deviating(), Terms{AcceptedTerm::goals});
  Answer none;
  none.contract.goals.value.clear();
  EXPECT_EQ(none.deviating(), Terms{AcceptedTerm::goals});
  none = {};
  none.contract.start.value = {};
  EXPECT_EQ(none.deviating(), Terms{AcceptedTerm::goals});
  none = {};
  none.plan.start = {};  // then the path says where it begins
  EXPECT_EQ(none.deviating(), Terms{});
}

/// The disc's tip is at (x, y): poses are of the last legs.
TEST(CheckDeviations, LegsEndWhereTheirPosesAre) {
  const auto there = [](double x, double y, double within = 0.0) {
    return GoalPose{Eigen::Isometry3d(Eigen::Translation3d(x, y, 0.0)), within};
  };
  Answer answer;
  answer.contract.goal_poses = {there(1.0, 1.0)};
  EXPECT_EQ(answer.deviating(), Terms{});
  answer.contract.goal_poses = {there(1.0, 0.75)};
  EXPECT_EQ(answer.deviating(), Terms{AcceptedTerm::goals});
  EXPECT_NE(answer.sentence().find("goal 2 of 2: expected "), std::string::npos) << answer.sentence();
  EXPECT_NE(answer.sentence().find("250 mm and 0 rad from there"), std::string::npos) << answer.sentence();
  answer.contract.goal_poses = {there(1.0, 0.0), there(1.0, 1.0)};
  EXPECT_EQ(answer.deviating(), Terms{});
  answer.contract.goal_poses = {there(1.0, 1.0), there(1.0, 0.0)};
  EXPECT_EQ(answer.deviating(), Terms(2, AcceptedTerm::goals));
  answer.contract.goal_poses = {there(1.0, 0.9, 0.11)};
  EXPECT_EQ(answer.deviating(), Terms{});
  answer.contract.map_from_base.value = answer.plan.map_from_base = pose_at(0.5);  // it moves with the base
  EXPECT_EQ(answer.deviating(), Terms{AcceptedTerm::goals});
  answer.contract.goal_poses = {there(1.5, 1.0)};
  EXPECT_EQ(answer.deviating(), Terms{});
  answer.contract.goals.value[1] = {};  // which no leg reaches: said once
  EXPECT_EQ(answer.deviating(), Terms(2, AcceptedTerm::goals));
}

/// The contract after all deviations of these terms were accepted.
Contract adopted(const Answer& answer, const std::set<AcceptedTerm>& accepted) {
  Contract contract = answer.contract;
  adopt_accepted(deviations(contract, answer.plan, answer.robot, accepted), answer.plan, answer.robot,
                 contract);
  return contract;
}

TEST(CheckDeviations, WhatIsAcceptedIsTakenFromThePlanAndNothingElse) {
  Answer answer;
  answer.contract.padding = {0.01, TermSource::map};
  answer.contract.payload = {2.0, TermSource::map};
  answer.contract.seen_within = {5.0, TermSource::map};
  answer.plan.robot_scale = 2.0;
  answer.plan.map_from_base = pose_at(1.0);
  answer.plan.payload = 1.0;
  answer.plan.gravity = -Eigen::Vector3d::UnitX();
  answer.plan.policies = {{"base", Policy::not_occupied}};
  answer.plan.loads = {{box("box", "base"), {}}};
  answer.plan.pick = pick_of_box("box");
  for (const AcceptedTerm term :
       {AcceptedTerm::robot, AcceptedTerm::scale, AcceptedTerm::base, AcceptedTerm::padding,
        AcceptedTerm::payload, AcceptedTerm::policy, AcceptedTerm::load, AcceptedTerm::goals}) {
    const auto of = [&](AcceptedTerm other) { return term == other ? TermSource::plan : TermSource::map; };
    const Contract contract = adopted(answer, {term});
    EXPECT_EQ(contract.scale.source, of(AcceptedTerm::scale));
    EXPECT_EQ(contract.scale.value, term == AcceptedTerm::scale ? 2.0 : 1.0);
    EXPECT_EQ(contract.map_from_base.source, of(AcceptedTerm::base));
    EXPECT_EQ(contract.map_from_base.value.translation().x(), term == AcceptedTerm::base ? 1.0 : 0.0);
    EXPECT_EQ(contract.padding.source, of(AcceptedTerm::padding));
    EXPECT_EQ(contract.padding.value, term == AcceptedTerm::padding ? 0.0 : 0.01);
    EXPECT_EQ(contract.payload.source, of(AcceptedTerm::payload));
    EXPECT_EQ(contract.payload.value, term == AcceptedTerm::payload ? 1.0 : 2.0);
    EXPECT_EQ(contract.gravity.value == answer.plan.gravity, term == AcceptedTerm::payload);
    EXPECT_EQ(contract.policies.at("base").source, of(AcceptedTerm::policy));
    EXPECT_EQ(contract.seen_within.source, of(AcceptedTerm::policy));
    EXPECT_EQ(contract.seen_within.value, term == AcceptedTerm::policy ? 0.0 : 5.0);
    EXPECT_EQ(contract.pick.value.has_value(), term == AcceptedTerm::load);
    EXPECT_EQ(contract.policies.contains("box"), term == AcceptedTerm::load);
  }
}

TEST(CheckDeviations, WhatAPlanAsksForBeyondTheContractIsNotTakenForLooser) {
  Answer answer;
  answer.contract.payload.value = 1.0;
  answer.plan.payload = 2.0;
  answer.plan.gravity.x() = 1.0;
  EXPECT_EQ(adopted(answer, {AcceptedTerm::payload}).payload.value, 1.0);
  EXPECT_EQ(adopted(answer, {AcceptedTerm::payload}).gravity.value.x(), 1.0);
  answer.contract.seen_within = {5.0, TermSource::map};
  answer.plan.seen_within = 4.0;
  answer.plan.policies["base"] = Policy::not_occupied;
  EXPECT_EQ(adopted(answer, {AcceptedTerm::policy}).seen_within.value, 5.0);
  answer.plan.seen_within = 6.0;
  EXPECT_EQ(adopted(answer, {AcceptedTerm::policy}).seen_within.value, 6.0);
  answer.contract.seen_within.source = TermSource::flag;
  EXPECT_EQ(adopted(answer, {AcceptedTerm::policy}).seen_within.value, 5.0);
  answer.contract.policies["wing"] = {Policy::not_occupied, TermSource::map};
  answer.plan.policies["wing"] = Policy::painted;
  EXPECT_EQ(adopted(answer, {AcceptedTerm::policy}).policies.at("wing").value, Policy::not_occupied);
}

TEST(CheckDeviations, AnAcceptedLoadComesWithItsPolicyAndAnAcceptedPickWithItsTip) {
  Answer answer;
  answer.contract.loads = {{{box("box", "base"), {}}}, TermSource::map};
  answer.contract.policies["box"] = {Policy::known_free, TermSource::map};
  answer.plan.loads = {{box("cup", "base"), {}}, {box("jug", "base"), {}}};
  answer.plan.policies["cup"] = Policy::not_occupied;
  const Contract loaded = adopted(answer, {AcceptedTerm::load});
  EXPECT_EQ(loaded.loads.value.size(), 2U);
  EXPECT_EQ(loaded.policies.at("cup").value, Policy::not_occupied);
  EXPECT_EQ(loaded.policies.at("jug").value, Policy::painted);  // nobody says: the strictest
  EXPECT_EQ(loaded.policies.at("box").value, Policy::known_free);
  EXPECT_EQ(loaded.tip, "");
  answer = {};
  answer.plan.pick = pick_of_box("can");
  answer.plan.tip = "slide";
  EXPECT_EQ(adopted(answer, {AcceptedTerm::load}).tip, "slide");
  EXPECT_EQ(adopted(answer, {AcceptedTerm::load}).tip_link.value, "slide");
  EXPECT_EQ(adopted(answer, {AcceptedTerm::load}).tip_link.source, TermSource::plan);
  answer.contract.tip = "base";
  EXPECT_EQ(adopted(answer, {AcceptedTerm::load}).tip, "base");
  answer.plan.loads = {{box("cup", "base"), {}}};
  EXPECT_THROW(adopted(answer, {AcceptedTerm::load}), std::invalid_argument);
  answer.plan.loads = {{box("can", "base"), {}}};
  EXPECT_EQ(adopted(answer, {AcceptedTerm::load}).loads.value.size(), 1U);
}

}  // namespace check_deviations_test
}  // namespace clearway

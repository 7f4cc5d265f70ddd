#include "apps/check/recorded_terms.hpp"

#include <gtest/gtest.h>

namespace clearway {
namespace recorded_terms_test {

Eigen::Isometry3d at(double x, double y, double z) {
  return Eigen::Isometry3d(Eigen::Translation3d(x, y, z));
}

RecordedTerms queries_at(const std::vector<Eigen::Isometry3d>& bases) {
  RecordedTerms terms;
  for (const Eigen::Isometry3d& base : bases) terms.others.emplace_back().map_from_base = base;
  return terms;
}

TEST(RecordedTerms, ABaseThatAnyOfTheQueriesHasIsKept) {
  const Eigen::Isometry3d first = at(1.0, -2.0, 0.5), second = at(-0.3, 0.4, 0.0);
  const RecordedTerms terms = queries_at({first, second});
  EXPECT_FALSE(terms.base_instead_of(first).has_value());
  EXPECT_FALSE(terms.base_instead_of(second).has_value());
  const Eigen::Isometry3d turned =
      second * Eigen::AngleAxisd(1e-3, Eigen::Vector3d::UnitZ());  // where it stands
  for (const Eigen::Isometry3d& other : {at(1.001, -2.0, 0.5), at(0.3, -0.4, 0.0), turned}) {
    const auto instead = terms.base_instead_of(other);
    ASSERT_TRUE(instead.has_value());
    EXPECT_EQ(instead->matrix(), first.matrix());
  }
  EXPECT_FALSE(queries_at({}).base_instead_of(first).has_value());
}

/// Lengths of other scales say nothing of this one.
TEST(RecordedTerms, OnlyQueriesForTheRobotAtItsScaleBound) {
  const Configuration start = Eigen::Vector2d(0.0, 0.0), goal = Eigen::Vector2d(1.0, 0.0);
  QueryTerms query;
  query.name = "another";
  query.start = start, query.goals = {start};
  const auto others = [&](const std::string& robot, double scale) {
    query.robot = robot, query.scale = scale;
    std::vector<std::string> notes;
    return recorded_terms(QueryRecord{"digest", {query}}, {"", "arm", 2, 0.5, start, {goal}}, "digest", notes)
        .others.size();
  };
  EXPECT_EQ(others("arm", 0.5), 1U);
  EXPECT_EQ(others("robots/arm.yaml", 0.5), 1U);
  EXPECT_EQ(others("arm", 1.0), 0U);
  for (const double sign : {1.0, -1.0}) {  // a share of it
    EXPECT_EQ(others("arm", 0.5 + sign * 0.45e-6), 1U);
    EXPECT_EQ(others("arm", 0.5 + sign * 0.55e-6), 0U);
  }
  EXPECT_EQ(others("legs", 0.5), 0U);
}

/// Of a record with one query that the plan, from (0, 0) to (1, 0), may answer.
struct Asked {
  QueryTerms query;
  std::string map = "digest", made_for, by_name;
  std::vector<std::string> notes;

  Asked() {
    query.name = "own";
    query.robot = "arm";
    query.start = Eigen::Vector2d(0.0, 0.0);
    query.goals = {Eigen::Vector2d(1.0, 0.0)};
  }

  RecordedTerms answered() {
    const RecordQuestion question{
        by_name, "arm", 2, 1.0, Eigen::Vector2d(0.0, 0.0), {Eigen::Vector2d(1.0, 0.0)}};
    notes.clear();
    return recorded_terms(QueryRecord{map, {query}, made_for}, question, "digest", notes);
  }
};

TEST(RecordedTerms, TheQueryIsFoundByNameElseByStartAndGoalsElseAsTheWholeOfThem) {
  Asked asked;
  EXPECT_TRUE(asked.answered().query.has_value());
  EXPECT_TRUE(asked.answered().others.empty());
  EXPECT_TRUE(asked.notes.empty());
  asked.query.goals.push_back(Eigen::Vector2d(1.0, 1.0));
  EXPECT_TRUE(asked.answered().query.has_value());
  EXPECT_EQ(asked.notes, std::vector<std::string>{"the plan is a part of the map's query 'own'"});
  asked.query.start = Eigen::Vector2d(0.5, 0.0);
  EXPECT_FALSE(asked.answered().query.has_value());
  EXPECT_EQ(asked.answered().others.size(), 1U);
  EXPECT_EQ(asked.notes, (std::vector<std::string>{
                             "the plan's query is none of the map's own",
                             "the plan's policies, padding, ages, base, loads, payload and gravity are held "
                             "to the loosest of the map's queries for 'arm'"}));
  asked.by_name = "own";
  EXPECT_TRUE(asked.answered().query.has_value());
  EXPECT_TRUE(asked.notes.empty());
}

TEST(RecordedTerms, ARecordOfAnotherMapOrAQueryForAnotherRobotDoesNotCount) {
  Asked asked;
  asked.made_for = "before";
  EXPECT_TRUE(asked.answered().query.has_value());
  EXPECT_EQ(asked.notes.size(), 1U);
  asked.map = "another";
  EXPECT_FALSE(asked.answered().query.has_value());
  EXPECT_TRUE(asked.answered().others.empty());
  EXPECT_EQ(asked.notes.size(), 1U);
  asked = {};
  asked.query.robot = "legs";
  EXPECT_FALSE(asked.answered().query.has_value());
  EXPECT_EQ(asked.notes,
            std::vector<std::string>{"the map's query 'own' is for robot 'legs' and does not count"});
  asked = {};
  asked.by_name = "own";
  asked.query.start = Eigen::Vector3d::Zero();  // of three joints, which nothing names
  EXPECT_TRUE(asked.answered().query.has_value());
  asked.by_name.clear();
  EXPECT_FALSE(asked.answered().query.has_value());
  EXPECT_EQ(asked.answered().others.size(), 1U);  // of the same robot
  std::vector<std::string> notes;
  EXPECT_FALSE(recorded_terms(std::nullopt, {}, "digest", notes).query.has_value());
  EXPECT_TRUE(notes.empty());
}

/// A plan of two of the robot's three joints, x and y, that holds z at 0.5, from (0, 0) to (1, 0).
RecordQuestion holding() {
  return {.query = "",
          .robot = "arm",
          .dof = 2,
          .scale = 1.0,
          .start = Eigen::Vector2d(0.0, 0.0),
          .goals = {Eigen::Vector2d(1.0, 0.0)},
          .joints = {"x", "y"},
          .held = {{"z", 0.5}},
          .usual_joints = {"x", "y", "z"}};
}

TEST(RecordedTerms, AQueryIsTheSameWhicheverOfItsJointsThePlanHoldsWhereTheyAre) {
  QueryTerms query;
  query.name = "own", query.robot = "arm";
  query.joints = {"z", "y", "x"};
  query.start = Eigen::Vector3d(0.5, 0.0, 0.0);
  query.goals = {Eigen::Vector3d(0.5, 0.0, 1.0)};
  std::vector<std::string> notes;
  const auto answered = [&](const RecordQuestion& question) {
    notes.clear();
    return recorded_terms(QueryRecord{"digest", {query}}, question, "digest", notes);
  };
  const RecordedTerms terms = answered(holding());
  ASSERT_TRUE(terms.query.has_value());
  EXPECT_EQ(terms.query->start, Configuration(Eigen::Vector2d(0.0, 0.0)));
  EXPECT_EQ(terms.query->goals, std::vector<Configuration>{Eigen::Vector2d(1.0, 0.0)});
  EXPECT_TRUE(terms.apart.empty());
  EXPECT_TRUE(notes.empty());

  query.goals[0][0] = 0.7;  // to which z would have to move
  EXPECT_FALSE(answered(holding()).query.has_value());
  EXPECT_EQ(answered(holding()).others.size(), 1U);
  RecordQuestion named = holding();
  named.query = "own";
  EXPECT_EQ(answered(named).apart,
            std::vector<std::string>{
                "joint z: expected to come to 0.7 by the map's query 'own', it stands at 0.5"});

  query.joints.clear();  // an older record
  query.start = Eigen::Vector3d(0.0, 0.0, 0.5);
  query.goals = {Eigen::Vector3d(1.0, 0.0, 0.5)};
  ASSERT_TRUE(answered(holding()).query.has_value());
  EXPECT_EQ(answered(holding()).query->start, Configuration(Eigen::Vector2d(0.0, 0.0)));

  query.joints = {"x"};  // of a smaller group: the other joint is the plan's
  query.start = Configuration::Zero(1);
  query.goals = {Configuration::Ones(1)};
  RecordQuestion lifted = holding();
  lifted.start = Eigen::Vector2d(0.0, 0.3);
  lifted.goals = {Eigen::Vector2d(1.0, 0.4)};
  ASSERT_TRUE(answered(lifted).query.has_value());
  EXPECT_EQ(answered(lifted).query->start, lifted.start);
  EXPECT_EQ(answered(lifted).query->goals, lifted.goals);
  EXPECT_EQ(answered(lifted).apart, std::vector<std::string>{"joint y: the map's query 'own' does not move "
                                                             "it, the plan does"});
  lifted.goals = {Eigen::Vector2d(1.0, 0.3)};
  EXPECT_TRUE(answered(lifted).apart.empty());
}

/// A joint that was renamed, or became a fixed one of the URDF.
TEST(RecordedTerms, AJointOfTheQueryThatTheRobotDoesNotHaveIsToldApart) {
  QueryTerms query;
  query.name = "own", query.robot = "arm";
  query.joints = {"xx", "y"};
  query.start = Eigen::Vector2d(0.0, 0.0);
  query.goals = {Eigen::Vector2d(1.5, 0.0)};
  RecordQuestion question = holding();
  question.query = "own";
  std::vector<std::string> notes;
  const RecordedTerms terms = recorded_terms(QueryRecord{"digest", {query}}, question, "digest", notes);
  ASSERT_EQ(terms.apart.size(), 2U);
  EXPECT_EQ(terms.apart[0].rfind("joint xx: expected by the map's query 'own', none", 0), 0U);
  EXPECT_EQ(terms.apart[1], "joint x: the map's query 'own' does not move it, the plan does");
}

TEST(RecordedTerms, AnotherRobotsQueryWithTheSameEndsComesLast) {
  QueryTerms other, own;
  other.name = "other", other.robot = "legs";
  own.name = "own", own.robot = "arm";
  for (QueryTerms* query : {&other, &own}) {
    query->start = Eigen::Vector2d(0.0, 0.0);
    query->goals = {Eigen::Vector2d(1.0, 0.0)};
  }
  std::vector<std::string> notes;
  const RecordedTerms terms = recorded_terms(QueryRecord{"digest", {other, own}}, holding(), "digest", notes);
  ASSERT_TRUE(terms.query.has_value());
  EXPECT_EQ(terms.query->name, "own");
}

LegLoad load_named(const std::string& name, double edge, std::vector<int> legs = {}) {
  LegLoad load;
  load.load.name = name;
  load.load.link = "hand";
  load.load.shape = Shape::box({edge, edge, edge});
  load.legs = std::move(legs);
  return load;
}

std::vector<std::string> names_of(const std::optional<std::vector<LegLoad>>& loads) {
  std::vector<std::string> names;
  if (loads)
    for (const LegLoad& load : *loads) names.push_back(load.load.name);
  return names;
}

TEST(RecordedTerms, WhatAllQueriesCarryThePlanCarriesToo) {
  using Names = std::vector<std::string>;
  RecordedTerms terms;
  Plan plan;
  plan.goals.resize(2);
  EXPECT_FALSE(terms.loads_instead_of(plan).has_value());
  terms.others.resize(2);
  terms.others[0].loads = {load_named("beam", 0.2), load_named("box", 0.1)};
  terms.others[1].loads = {load_named("box", 0.1)};
  EXPECT_EQ(names_of(terms.loads_instead_of(plan)), Names{"box"});
  plan.loads = {load_named("beam", 0.2)};
  EXPECT_EQ(names_of(terms.loads_instead_of(plan)), Names{"box"});
  plan.loads.push_back(load_named("box", 0.05));
  EXPECT_EQ(names_of(terms.loads_instead_of(plan)), Names{"box"});
  plan.loads.back() = load_named("box", 0.1, {0});  // not on the second leg
  EXPECT_EQ(names_of(terms.loads_instead_of(plan)), Names{"box"});
  for (const std::vector<int>& legs : {std::vector<int>{}, std::vector<int>{0, 1}}) {
    plan.loads.back() = load_named("box", 0.1, legs);
    EXPECT_FALSE(terms.loads_instead_of(plan).has_value());
  }
  plan.loads.clear();
  terms.others[1].loads = {load_named("box", 0.1, {1})};  // on one leg of another query
  EXPECT_FALSE(terms.loads_instead_of(plan).has_value());
  terms.others.pop_back();
  EXPECT_EQ(names_of(terms.loads_instead_of(plan)), (Names{"beam", "box"}));
}

TEST(RecordedTerms, TheLeastPayloadAndAnyOfTheGravitiesCount) {
  RecordedTerms terms;
  const Eigen::Vector3d earth(0, 0, -9.81), moon(0, 0, -1.62), side(9.81, 0, 0);
  EXPECT_EQ(terms.smallest_payload(), 0.0);
  EXPECT_FALSE(terms.gravity_instead_of(moon).has_value());
  terms.others.resize(2);
  terms.others[0].payload = 3.0, terms.others[1].payload = 2.0;
  terms.others[0].gravity = earth, terms.others[1].gravity = side;
  EXPECT_EQ(terms.smallest_payload(), 2.0);
  EXPECT_FALSE(terms.gravity_instead_of(side).has_value());
  EXPECT_EQ(terms.gravity_instead_of(moon), earth);
  terms.others[1].payload.reset(), terms.others[1].gravity.reset();  // an older record
  EXPECT_EQ(terms.smallest_payload(), 0.0);
  EXPECT_FALSE(terms.gravity_instead_of(moon).has_value());
}

/// In whatever order they are.
TEST(RecordedTerms, OfSeveralQueriesTheLoosestPolicyTheLeastPaddingAndTheLongestAgeCount) {
  RecordedTerms terms;
  EXPECT_TRUE(terms.loosest_policies().empty());
  EXPECT_FALSE(terms.smallest_padding().has_value());
  EXPECT_EQ(terms.longest_age(), 0.0);
  QueryTerms first, second;
  first.policies = {{"arm", Policy::painted}, {"tool", Policy::not_occupied}};
  second.policies = {{"arm", Policy::known_free}, {"tool", Policy::painted}, {"box", Policy::painted}};
  first.padding = 0.01, second.padding = 0.02;
  first.seen_within = 5.0, second.seen_within = 3.0;
  for (const std::vector<QueryTerms>& others : {std::vector{first, second}, std::vector{second, first}}) {
    terms.others = others;
    EXPECT_EQ(terms.loosest_policies(),
              (std::map<std::string, Policy>{
                  {"arm", Policy::known_free}, {"tool", Policy::not_occupied}, {"box", Policy::painted}}));
    EXPECT_EQ(terms.smallest_padding(), 0.01);
    EXPECT_EQ(terms.longest_age(), 5.0);
    terms.others.insert(terms.others.begin() + 1, QueryTerms{});  // of any age
    EXPECT_EQ(terms.longest_age(), 0.0);
    EXPECT_EQ(terms.smallest_padding(), 0.0);
  }
}

}  // namespace recorded_terms_test
}  // namespace clearway

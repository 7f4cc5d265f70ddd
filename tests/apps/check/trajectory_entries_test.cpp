// Several trajectories of a DisplayTrajectory, executed one after the other, at `clearway check`.
#include "apps/check/trajectory_entries.hpp"

#include <cmath>

#include "tests/apps/check/check_command.hpp"

namespace clearway {
namespace check_test {

/// For the robot `point`, within paint of 1 m about the origin.
class CheckEntries : public Check {
 protected:
  struct Point {
    Json positions, velocities = Json::array();
  };
  /// Points a second apart, the first at 0; without times where `seconds` is 0.
  static Json entry(const Json& names, const std::vector<Point>& points, int seconds = 1) {
    Json message{{"joint_names", names}, {"points", Json::array()}};
    int time = 0;
    for (const Point& point : points) {
      message["points"].push_back({{"positions", point.positions},
                                   {"velocities", point.velocities},
                                   {"time_from_start", {{"sec", time}, {"nanosec", 0}}}});
      time += seconds;
    }
    return {{"joint_trajectory", message}};
  }
  CommandRun run(const std::vector<Json>& entries, const Json& start = Json()) const {
    Json message{{"trajectory", entries}};
    if (!start.is_null()) message["trajectory_start"] = {{"joint_state", start}};
    return run_command({"check", folder_.write("t.json", message.dump()), "--map", folder_.file("map"),
                        "--robot", "point", "--json"});
  }
};

const Json both = {"x", "y"};

/// The whole way and its figures are those of the same points in one trajectory that rests where two meet.
TEST_F(CheckEntries, TheyAreJudgedAsOneThatRestsWhereTheyMeet) {
  const CheckEntries::Point rest0{{-0.3, 0.0}, {0, 0}}, rest1{{0.2, 0.0}, {0, 0}}, rest2{{0.2, 0.5}, {0, 0}};
  for (const int seconds : {0, 1}) {
    const CommandRun two = run({entry(both, {rest0, rest1}, seconds), entry(both, {rest1, rest2}, seconds)});
    const CommandRun one = run({entry(both, {rest0, rest1, rest2}, seconds)});
    ASSERT_EQ(two.status, exit_done) << two.out << two.log;
    Json told = Json::parse(two.out), expected = Json::parse(one.out);
    for (Json* json : {&told, &expected})
      for (Json& rate : (*json)["motion"]["not_judged"])
        rate.erase("sentence");  // names the entry of several
    EXPECT_EQ(told, expected);
  }
}

/// From rest to rest in a second: 6 times the way.
TEST_F(CheckEntries, APeakIsThatOfTheOneThatHasIt) {
  const CheckEntries::Point near{{0.2, 0.1}, {0, 0}}, middle{{0.2, 0.0}, {0, 0}}, far{{-0.3, 0.0}, {0, 0}};
  for (const std::size_t place : {0U, 1U}) {
    const Json one = entry(both, {near, middle}), other = entry(both, {middle, far}),
               back = entry(both, {far, middle}), forth = entry(both, {middle, near});
    const CommandRun two = run(place == 0 ? std::vector{back, forth} : std::vector{one, other});
    ASSERT_EQ(two.status, exit_done) << two.out << two.log;
    const Json rate = Json::parse(two.out)["motion"]["not_judged"][0];
    EXPECT_NEAR(rate["peak"].get<double>(), 6.0 * 0.5, 1e-9) << rate;
    EXPECT_NE(rate["sentence"].get<std::string>().find("of trajectory[" + std::to_string(place) + "]"),
              std::string::npos)
        << rate;
  }
}

/// Each may name joints of its own: the others stay where they were left, or where a later one finds them.
TEST_F(CheckEntries, JointsThatOneDoesNotNameStayWhereTheyAre) {
  const Json along = entry({"x"}, {{{0.0}}, {{0.7}}}), up = entry({"y"}, {{{0.0}}, {{0.7}}}),
             beside = entry({"y"}, {{{0.9}}, {{0.0}}});
  const CommandRun first = run({along});
  EXPECT_EQ(first.status, exit_bad_input) << "nothing says where y is";
  const CommandRun bent = run({along, up});  // to (0.7, 0.7), beyond the paint
  EXPECT_EQ(bent.status, exit_no) << bent.log;
  const Json said = Json::parse(bent.out);
  EXPECT_NE(said["first_contact"].get<std::string>().find("trajectory[1]: edge 0"), std::string::npos)
      << said;
  EXPECT_EQ(said["contract"]["goals"]["value"], Json::parse("[[0.7, 0.7]]"));
  EXPECT_EQ(run({entry({"x"}, {{{0.7}}, {{0.0}}}), up}).status, exit_done);
  EXPECT_EQ(run({entry({"x"}, {{{0.7}}, {{0.0}}}), beside}).status, exit_no) << "y is 0.9 all the while";
  EXPECT_EQ(run({along, entry({"x"}, {{{0.7}}, {{0.1}}})}, {{"name", {"y"}}, {"position", {0.1}}}).status,
            exit_done);
  EXPECT_EQ(run({along, entry({"x"}, {{{0.7}}, {{0.1}}})}, {{"name", {"y"}}, {"position", {0.9}}}).status,
            exit_no);
}

TEST_F(CheckEntries, WhatDoesNotFollowIsNamedByEntryAndJoint) {
  const Json first = entry(both, {{{0.0, 0.0}}, {{0.3, 0.0}}});
  const auto refusal = [&](const std::vector<Json>& entries) {
    const CommandRun refused = run(entries);
    EXPECT_EQ(refused.status, exit_bad_input) << refused.out;
    EXPECT_TRUE(refused.complains_in_one_sentence()) << refused.log;
    return refused.log;
  };
  const std::string jump = refusal({first, entry(both, {{{0.3, 0.01}}, {{0.3, 0.5}}})});
  EXPECT_NE(jump.find("trajectory[1]: begins with joint 'y' at 0.01, expected it at 0, where the ones before "
                      "leave it"),
            std::string::npos)
      << jump;
  EXPECT_NE(refusal({first, entry(both, {{{0.3, 0.0}, {0.1, 0}}, {{0.3, 0.5}, {0, 0}}})})
                .find("trajectory[1]: moves joint 'x' at its first point"),
            std::string::npos);
  EXPECT_NE(refusal({entry(both, {{{0.0, 0.0}, {0, 0}}, {{0.3, 0.0}, {0, 0.1}}}), first})
                .find("trajectory[0]: moves joint 'y' at its last point"),
            std::string::npos);
  EXPECT_NE(refusal({first, entry(both, {{{0.3, 0.0}, {0, 0}}, {{0.3, 0.2}, {0, 0.1}}}),
                     entry(both, {{{0.3, 0.2}}, {{0.3, 0.3}}})})
                .find("trajectory[1]: moves joint 'y' at its last point"),
            std::string::npos);
  EXPECT_NE(
      refusal({first, entry(both, {{{0.3, 0.0}}, {{0.3, 0.5}}}, 0)}).find("trajectory[1]: has no times"),
      std::string::npos);
  EXPECT_NE(
      refusal({first, entry({"z"}, {{{0.3}}, {{0.5}}})}).find("trajectory[1]: the trajectory has values"),
      std::string::npos);
}

/// MoveIt's timing leaves an acceleration at the end, and writes one point at 0 s where there is no way to
/// go.
TEST_F(CheckEntries, AnAccelerationAtAnEndAndASinglePointAreNoFault) {
  const CheckEntries::Point rest0{{-0.3, 0.0}, {0, 0}}, rest1{{0.2, 0.0}, {0, 0}}, rest2{{0.2, 0.5}, {0, 0}};
  Json first = entry(both, {rest0, rest1}, 2);
  for (Json& point : first["joint_trajectory"]["points"]) point["accelerations"] = {0.3, 0.0};
  const CommandRun two = run({first, entry(both, {rest1}), entry(both, {rest1, rest2}, 2)});
  EXPECT_EQ(two.status, exit_done) << two.out << two.log;
}

/// The robot comes from --start to the first point, whatever joints the entries name.
TEST_F(CheckEntries, AStartBeforeTheFirstPointIsTaken) {
  Json along = entry({"x"}, {{{0.1}}, {{0.3}}});
  for (int i : {0, 1}) along["joint_trajectory"]["points"][i]["time_from_start"]["sec"] = i + 1;
  const Json message{{"trajectory", {along, entry({"y"}, {{{0.0}}, {{0.2}}})}}};
  const CommandRun taken = run_command({"check", folder_.write("t.json", message.dump()), "--map",
                                        folder_.file("map"), "--robot", "point", "--start=0,0", "--json"});
  EXPECT_EQ(taken.status, exit_done) << taken.out << taken.log;
  EXPECT_TRUE(Json::parse(taken.out)["deviations"].empty()) << taken.out;
}

/// A speed beyond the limit of 1 m/s in the second, though the whole takes long enough.
TEST_F(CheckEntries, ALimitIsKeptInEach) {
  const Json slow = entry(both, {{{0.0, 0.0}}, {{0.1, 0.0}}}, 9);
  const std::vector<CheckEntries::Point> way{{{0.1, 0.0}, {0, 0}}, {{-0.7, 0.0}, {0, 0}}};
  const CommandRun kept = run({slow, entry(both, way, 3)});
  EXPECT_EQ(kept.status, exit_done) << kept.out << kept.log;
  const CommandRun fast = run({slow, entry(both, way, 1)});
  EXPECT_EQ(fast.status, exit_no);
  EXPECT_NE(Json::parse(fast.out)["motion"]["fault"].get<std::string>().find("trajectory[1]: motion: edge 0"),
            std::string::npos)
      << fast.out;
}

}  // namespace check_test
}  // namespace clearway

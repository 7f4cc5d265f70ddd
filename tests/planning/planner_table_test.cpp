#include "planning/planner_table.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <stdexcept>

#include "planning/auto_planner.hpp"
#include "planning/beam/beam.hpp"
#include "planning/beam/beam_guided.hpp"
#include "planning/beam/beam_reference.hpp"
#include "planning/boundary/boundary.hpp"
#include "planning/boundary/boundary_plus.hpp"
#include "planning/boundary/boundary_sides.hpp"
#include "planning/boundary/constraint.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/sampling/fcl_planners.hpp"
#include "planning/sampling/ompl_planners.hpp"
#include "planning/sampling/rrtconnect.hpp"
#include "tests/worlds/batch_worlds.hpp"
#include "tests/worlds/beam_world.hpp"

namespace clearway {
namespace planner_table_test {

/// What a planner made of this struct says of its options.
template <typename P>
PlannerOptions typed(const typename P::Options& options = {}) {
  return P(options).options();
}

/// One option as text, and the options of a planner whose struct has it so and all else at its default.
struct SameOption {
  std::string name, text;
  PlannerOptions in_force;
};

using SameOptions = std::vector<SameOption>;

template <typename P>
SameOptions beam_options() {
  return {{"width", "7", typed<P>({.width = 7})},
          {"step", "0.1,0.02", typed<P>({.step = {0.1, 0.02}})},
          {"step_deg", "2.5", typed<P>({.step_deg = {2.5}})},
          {"max_steps", "300", typed<P>({.max_steps = 300})},
          {"last_segment", "false", typed<P>({.last_segment = false})},
          {"node_only", "true", typed<P>({.node_only = true})},
          {"prismatic_scale", "0.25", typed<P>({.prismatic_scale = 0.25})}};
}

/// Where the options of the constraint method lie in the struct of `P`.
template <typename P>
PlannerOptions with_local(const ConstraintOptions& local) {
  if constexpr (std::is_same_v<typename P::Options, ConstraintOptions>) {
    return typed<P>(local);
  } else {
    return typed<P>({.local = local});
  }
}

template <typename P>
SameOptions local_options() {
  return {{"max_step", "0.05", with_local<P>({.max_step = 0.05})},
          {"influence_distance", "0.4", with_local<P>({.influence_distance = 0.4})},
          {"security_distance", "0.01", with_local<P>({.security_distance = 0.01})},
          {"xi", "0.002", with_local<P>({.xi = 0.002})},
          {"prismatic_scale", "3", with_local<P>({.prismatic_scale = 3.0})}};
}

SameOptions operator+(SameOptions some, const SameOptions& more) {
  some.insert(some.end(), more.begin(), more.end());
  return some;
}

template <typename P>
SameOptions boundary_options() {
  return local_options<P>() + SameOptions{{"max_steps", "900", with_local<P>({.max_steps = 900})},
                                          {"enter_ratio", "0.2", typed<P>({.enter_ratio = 0.2})},
                                          {"leave_ratio", "1", typed<P>({.leave_ratio = 1.0})},
                                          {"side", "lower", typed<P>({.side = BoundarySide::lower})}};
}

/// What all of OMPL's planners have.
template <typename P>
SameOptions sampling_options() {
  return {{"prismatic_scale", "0.5", typed<P>({.prismatic_scale = 0.5})},
          {"max_samples", "77", typed<P>({.max_samples = 77})}};
}

template <typename P>
SameOptions fcl_options() {
  return sampling_options<P>() + SameOptions{{"resolution", "0.004", typed<P>({.resolution = 0.004})},
                                             {"simplify", "false", typed<P>({.simplify = false})}};
}

template <typename P>
SameOptions shortcuts() {
  return {{"shortcuts", "0", typed<P>({.shortcuts = 0})}};
}

template <typename P>
SameOptions range() {
  return {{"range", "1.5", typed<P>({.range = 1.5})}};
}

const std::map<std::string, SameOptions>& all_options() {
  static const std::map<std::string, SameOptions> all = {
      {"auto", sampling_options<AutoPlanner>() + shortcuts<AutoPlanner>() +
                   SameOptions{{"threads", "2", typed<AutoPlanner>({.threads = 2})}}},
      {"beam", beam_options<Beam>()},
      {"beam_reference", beam_options<BeamReference>()},
      {"beam_guided", range<BeamGuided>() + sampling_options<BeamGuided>() +
                          SameOptions{{"width", "5", typed<BeamGuided>({.width = 5})},
                                      {"stride", "2.5", typed<BeamGuided>({.stride = 2.5})},
                                      {"guided_share", "1", typed<BeamGuided>({.guided_share = 1.0})},
                                      {"routes", "0", typed<BeamGuided>({.routes = 0})},
                                      {"attempts", "20", typed<BeamGuided>({.attempts = 20})}}},
      {"constraint", local_options<Constraint>() +
                         SameOptions{{"max_steps", "900", with_local<Constraint>({.max_steps = 900})}}},
      {"boundary", boundary_options<Boundary>()},
      {"boundary_sides", boundary_options<BoundarySides>()},
      {"boundary_plus", local_options<BoundaryPlus>() + shortcuts<BoundaryPlus>() +
                            SameOptions{{"stride", "2", typed<BoundaryPlus>({.stride = 2.0})},
                                        {"local_steps", "50", typed<BoundaryPlus>({.local_steps = 50})},
                                        {"planes", "0", typed<BoundaryPlus>({.planes = 0})},
                                        {"plane_steps", "9", typed<BoundaryPlus>({.plane_steps = 9})},
                                        {"max_samples", "0", typed<BoundaryPlus>({.max_samples = 0})},
                                        {"guided_share", "0", typed<BoundaryPlus>({.guided_share = 0.0})},
                                        {"smooth", "false", typed<BoundaryPlus>({.smooth = false})}}},
      {"rrtconnect", range<RrtConnect>() + sampling_options<RrtConnect>() + shortcuts<RrtConnect>() +
                         SameOptions{{"guided_share", "0", typed<RrtConnect>({.guided_share = 0.0})}}},
      {"rrtconnect_ompl", range<RrtConnectOmpl>() + sampling_options<RrtConnectOmpl>() +
                              SameOptions{{"simplify", "false", typed<RrtConnectOmpl>({.simplify = false})}}},
      {"est", range<Est>() + sampling_options<Est>() + shortcuts<Est>()},
      {"prm", sampling_options<Prm>() + shortcuts<Prm>()},
      {"rrtstar", range<RrtStar>() + sampling_options<RrtStar>() + shortcuts<RrtStar>()},
      {"bitstar", sampling_options<BitStar>() + shortcuts<BitStar>() +
                      SameOptions{{"batch", "30", typed<BitStar>({.batch = 30})}}},
      {"rrtconnect_fcl", range<RrtConnectFcl>() + fcl_options<RrtConnectFcl>()},
      {"kpiece_fcl", range<KpieceFcl>() + fcl_options<KpieceFcl>()},
      {"prm_fcl", fcl_options<PrmFcl>()},
      {"bitstar_fcl",
       fcl_options<BitStarFcl>() + SameOptions{{"batch", "30", typed<BitStarFcl>({.batch = 30})}}},
  };
  return all;
}

TEST(PlannerTable, EveryOptionOfEveryPlannerHasATypedFormThatMakesTheSamePlannerAsItsText) {
  for (const PlannerEntry& planner : planner_table()) {
    const auto found = all_options().find(std::string(planner.name));
    ASSERT_NE(found, all_options().end()) << planner.name << " has no typed options here";
    const PlannerOptions defaults = planner.make({})->options();
    PlannerOptions untried = defaults;
    for (const auto& [name, text, in_force] : found->second) {
      const PlannerOptions of_text = make_planner(planner.name, {{name, text}})->options();
      EXPECT_EQ(of_text, in_force) << planner.name << ", " << name;
      EXPECT_EQ(of_text.at(name), text) << planner.name;
      EXPECT_NE(of_text, defaults) << planner.name << ", " << name << ": a default tries nothing";
      EXPECT_EQ(untried.erase(name), 1U) << planner.name << ", " << name;
    }
    for (const auto& [name, value] : untried)
      ADD_FAILURE() << planner.name << ": " << name << " is not tried";
  }
}

template <typename P>
void expect_defaults() {
  const P planner;
  EXPECT_EQ(planner.options(), make_planner(P::table_name)->options()) << P::table_name;
  EXPECT_EQ(planner.name(), make_planner(P::table_name)->name());
  EXPECT_EQ(planner.name(), P::table_name);
}

TEST(PlannerTable, APlannerMadeOfNothingIsThatOfTheTableWithoutOptions) {
  expect_defaults<Beam>(), expect_defaults<BeamGuided>(), expect_defaults<BeamReference>();
  expect_defaults<Boundary>(), expect_defaults<BoundaryPlus>(), expect_defaults<BoundarySides>();
  expect_defaults<Constraint>(), expect_defaults<Est>(), expect_defaults<Prm>();
  expect_defaults<RrtConnect>(), expect_defaults<RrtConnectFcl>();
  expect_defaults<KpieceFcl>(), expect_defaults<PrmFcl>(), expect_defaults<BitStarFcl>();
  expect_defaults<AutoPlanner>(), expect_defaults<RrtConnectOmpl>();
  expect_defaults<RrtStar>(), expect_defaults<BitStar>();
}

std::string refusal_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "nothing refused";
}

/// Whoever asks why gets a sentence, also where there was no time for anything.
TEST(PlannerTable, EveryPlannerWithoutTimeSaysSo) {
  const Robot robot = load_robot("planar2");
  const ConfigurationSpace space(robot, worlds::voxels_about(robot, 9), {.critical_by_default = false});
  const PathCost cost(robot);
  Random random(2);
  int late = 0;
  for (int i = 0; i < 20; ++i) {
    const Configuration start = random.configuration(robot), goal = random.configuration(robot);
    for (const PlannerEntry& planner : planner_table()) {
      const PlanResult result = planner.make({})->plan({space, cost, start, goal, 1, [] { return true; }});
      EXPECT_FALSE(result.explanation.empty()) << planner.name << ": " << to_string(result.status);
      late += result.status == PlanStatus::timed_out;
    }
  }
  EXPECT_GT(late, 20);
}

TEST(PlannerTable, TypedValuesOutOfRangeAreRefusedInTheWordsOfTheText) {
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(refusal_of([] { Beam({.width = 0}); }),
            "beam: option 'width' is '0': expected a whole number from 1 to 100000");
  EXPECT_EQ(refusal_of([] { BeamReference({.width = 100001}); }),
            "beam_reference: option 'width' is '100001': expected a whole number from 1 to 100000");
  EXPECT_EQ(refusal_of([] {
              Beam({.step = {0.1, 20.0}});
            }),
            "beam: option 'step' is '20': expected auto or numbers from 1e-06 to 10, separated by commas");
  EXPECT_EQ(refusal_of([=] { BeamGuided({.stride = nan}); }),
            "beam_guided: option 'stride' is 'nan': expected a number from 1 to 100");
  EXPECT_EQ(refusal_of([=] { BeamGuided({.prismatic_scale = infinity}); }),
            "beam_guided: option 'prismatic_scale' is 'inf': expected auto or a number from 0 (automatic, "
            "too) to 1000000");
  EXPECT_EQ(refusal_of([] { Constraint({.max_steps = -1}); }),
            "constraint: option 'max_steps' is '-1': expected auto or a whole number from 1 to 100000000");
  EXPECT_EQ(refusal_of([] { Boundary({.leave_ratio = 0.0}); }),
            "boundary: option 'leave_ratio' is '0': expected a number from 0.01 to 1");
  EXPECT_EQ(
      refusal_of([] { BoundarySides({.local = {.xi = -0.1}}); }),
      "boundary_sides: option 'xi' is '-0.1': expected auto or a number from 0 (automatic, too) to 1000");
  EXPECT_EQ(refusal_of([] { BoundaryPlus({.plane_steps = 0}); }),
            "boundary_plus: option 'plane_steps' is '0': expected a whole number from 1 to 1000000");
  EXPECT_EQ(refusal_of([] { RrtConnect({.shortcuts = -5}); }),
            "rrtconnect: option 'shortcuts' is '-5': expected a whole number from 0 to 1000000");
  EXPECT_EQ(refusal_of([] { RrtStar({.max_samples = 0}); }),
            "rrtstar: option 'max_samples' is '0': expected a whole number from 1 to 100000000");
  EXPECT_EQ(refusal_of([] { BitStar({.batch = 0}); }),
            "bitstar: option 'batch' is '0': expected a whole number from 1 to 1000000");
  EXPECT_EQ(refusal_of([] { RrtConnectFcl({.resolution = 0.0}); }), refusal_of([] {
              make_planner("rrtconnect_fcl", {{"resolution", "0"}});
            }));
}

TEST(PlannerTable, BoundaryPlusRefusesWhatItWouldNotUse) {
  EXPECT_EQ(
      refusal_of([] { BoundaryPlus({.local = {.max_steps = 9}}); }),
      "boundary_plus: option 'local.max_steps' is 9: expected 0, since local_steps and plane_steps count");
  EXPECT_EQ(refusal_of([] { BoundaryPlus({.local = {.max_step = 0.1}, .stride = 2.0}); }), refusal_of([] {
              make_planner("boundary_plus", {{"max_step", "0.1"}, {"stride", "2"}});
            }));
  const PlannerOptions printed = BoundaryPlus({.local = {.max_step = 0.1}}).options();
  EXPECT_EQ(make_planner("boundary_plus", printed)->options(), printed);
}

TEST(PlannerTable, TypedOptionsPlanAsTheirTextDoes) {
  const VoxelScene scene{0.05, {box_of(0.5, 0.3, -0.1, 0.8, 0.6, 0.5)}, {}, {}};
  const BeamWorld world(load_robot("planar2"), scene);
  const Configuration start = vector_of({-0.4, 0.3}), goal = vector_of({1.2, -0.2});
  const auto of_typed = [&](const Planner& planner) {
    return planner.plan({world.space, world.cost, start, goal});
  };
  expect_equal(of_typed(Beam({.width = 4, .step = {0.03}})),
               world.plan("beam", start, goal, {{"width", "4"}, {"step", "0.03"}}), "beam");
  const PlanResult lower = of_typed(Boundary({.side = BoundarySide::lower}));
  EXPECT_EQ(lower.waypoints, world.plan("boundary", start, goal, {{"side", "lower"}}).waypoints);
  const Configuration near = vector_of({-0.3, 0.5});
  const PlanResult few =
      RrtStar({.max_samples = 200, .shortcuts = 3}).plan({world.space, world.cost, start, near});
  EXPECT_FALSE(few.waypoints.empty()) << few.explanation;
  EXPECT_EQ(few.waypoints,
            world.plan("rrtstar", start, near, {{"max_samples", "200"}, {"shortcuts", "3"}}).waypoints);
}

}  // namespace planner_table_test
}  // namespace clearway

// What the map knows of where a robot goes, and what is refused for it.
#include "planning/survey/path_survey.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <set>

#include "mapping/voxels/fused_tree.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "planning/space/part_policies.hpp"
#include "tests/worlds/voxel_scene.hpp"

namespace clearway {
namespace path_survey_test {

Configuration at(double x, double y) { return Eigen::Vector2d(x, y); }

/// Seen free along one ray from (-2, 0) to (2, 0); a wall at its end.
Snapshot seen_line() {
  FreeSpaceMap map({.resolution = 0.1});
  Scan scan;
  scan.map_from_sensor.translation() = Eigen::Vector3d(-1.95, 0.05, 0.05);
  scan.points = {Eigen::Vector3f(3.9f, 0.0f, 0.0f)};
  map.insert(scan);
  return map.snapshot();
}

Snapshot wall() { return VoxelScene{0.1, {box_of(1.0, -1.0, -0.1, 1.2, 1.0, 0.1)}, {}, {}}.snapshot(); }

const std::map<std::string, Policy> anything{{"base", Policy::not_occupied}};

TEST(PathSurvey, a_part_that_is_wholly_outside_of_a_seen_map_somewhere_on_its_way_is_refused) {
  const Robot disc = load_robot("point");
  const PathSurvey inside = survey_path(disc, seen_line(), anything, {at(-1, 0), at(1, 0)});
  EXPECT_TRUE(inside.leaving.empty());
  EXPECT_FALSE(refusal(inside, {}));
  // Outside between two waypoints that are inside.
  const PathSurvey away = survey_path(disc, seen_line(), anything, {at(0, 0), at(0, 1), at(0, 0)});
  ASSERT_EQ(away.leaving.size(), 1u);
  EXPECT_EQ(away.leaving[0].part, "base");
  EXPECT_NEAR(away.leaving[0].distance, 1.0 - 0.2 - 0.1, 1e-6);
  EXPECT_NEAR(away.leaving[0].point.y(), 1.0, 1e-6);
  const auto sentence = refusal(away, {});
  ASSERT_TRUE(sentence);
  for (const char* words : {"base leaves the map's bounds by 0.7 m", "--allow-outside base"})
    EXPECT_NE(sentence->find(words), std::string::npos) << *sentence;
}

TEST(PathSurvey, allows_what_is_allowed_by_name) {
  const PathSurvey away = survey_path(load_robot("point"), seen_line(), anything, {at(0, 0), at(0, 5)});
  EXPECT_FALSE(refusal(away, {.allow_outside = {"base"}}));
  EXPECT_FALSE(refusal(away, {.allow_outside = {"all"}}));
  EXPECT_TRUE(refusal(away, {.allow_outside = {"tool"}}));
}

TEST(PathSurvey, a_part_that_must_be_in_known_space_is_not_reported_to_leave) {
  for (const Policy policy : {Policy::known_free, Policy::painted}) {
    const PathSurvey survey = survey_path(load_robot("point"), seen_line(), {{"base", policy}}, {at(0, 5)});
    EXPECT_TRUE(survey.leaving.empty());
    EXPECT_TRUE(survey.unknown_free.empty());
    EXPECT_EQ(unknown_sentence(survey), "");
  }
}

TEST(PathSurvey, a_map_of_obstacles_alone_has_no_bounds_within_reach_but_one_out_of_reach_refuses) {
  const PathSurvey beside = survey_path(load_robot("point"), wall(), anything, {at(-2, 0), at(-2, 1)});
  EXPECT_TRUE(beside.is_of_obstacles_alone);
  EXPECT_TRUE(beside.leaving.empty());
  EXPECT_NE(unknown_sentence(beside).find("unknown space counts as free for base"), std::string::npos);
  Robot far = load_robot("puma560");
  const Configuration ready = Configuration::Zero(6);
  EXPECT_TRUE(survey_path(far, wall(), {}, {ready}).leaving.empty());
  for (const double distance : {8.0, 1e8}) {
    far.map_from_base.translation().x() = distance;
    const PathSurvey survey = survey_path(far, wall(), {}, {ready});
    EXPECT_EQ(survey.leaving.size(), 7u) << distance;  // all but the base
    EXPECT_TRUE(refusal(survey, {}));
    EXPECT_EQ(survey.swept->beyond, survey.swept->total());
  }
}

TEST(PathSurvey, an_empty_map_has_no_inside) {
  const PathSurvey survey = survey_path(load_robot("point"), Snapshot(), anything, {at(0, 0)});
  ASSERT_EQ(survey.leaving.size(), 1u);
  EXPECT_TRUE(std::isinf(survey.leaving[0].distance));
  EXPECT_EQ(refusal(survey, {})->find("inf"), std::string::npos);
}

TEST(PathSurvey, bodies_that_no_joint_moves_are_refused_only_when_asked) {
  const Robot robot = load_robot("puma560");
  const Snapshot map = VoxelScene{0.05, {box_of(-0.2, -0.2, 0.0, 0.2, 0.2, 0.2)}, {}, {}}.snapshot();
  const PathSurvey survey = survey_path(robot, map, {}, {});  // reported without a path, too
  EXPECT_FALSE(survey.swept);
  ASSERT_EQ(survey.standing.size(), 1u);
  EXPECT_EQ(survey.standing[0].part, "base");
  EXPECT_FALSE(refusal(survey, {}));
  const auto sentence = refusal(survey, {.strict = true});
  ASSERT_TRUE(sentence);
  EXPECT_NE(sentence->find("base touches " + std::to_string(survey.standing[0].voxels) + " occupied voxels"),
            std::string::npos)
      << *sentence;
}

TEST(PathSurvey, what_is_only_seen_is_refused_only_when_asked) {
  PathSurvey survey;
  survey.only_seen = {"cover"};
  EXPECT_FALSE(refusal(survey, {}));
  const auto sentence = refusal(survey, {.strict = true});
  ASSERT_TRUE(sentence);
  EXPECT_EQ(*sentence, only_seen_sentence({"cover"}) + ", which --strict refuses");
}

TEST(PathSurvey, what_one_leg_alone_meets_is_reported_whichever_it_is) {
  const Robot disc = load_robot("point"), arm = load_robot("puma560");
  const LegsToCheck in{disc, seen_line(), {at(-1, 0), at(1, 0)}},
      out{disc, seen_line(), {at(1, 0), at(1, 5)}};
  const Snapshot block = VoxelScene{0.05, {box_of(-0.2, -0.2, 0.0, 0.2, 0.2, 0.2)}, {}, {}}.snapshot();
  const LegsToCheck clear{arm, wall(), {}}, met{arm, block, {}};
  for (const bool is_first : {true, false}) {
    const PathSurvey leaving = survey_legs(is_first ? std::vector{out, in} : std::vector{in, out}, anything);
    ASSERT_EQ(leaving.leaving.size(), 1u);
    EXPECT_EQ(leaving.leaving[0].place.edge, is_first ? 0 : 1);
    EXPECT_TRUE(refusal(leaving, {}));
    const PathSurvey standing = survey_legs(is_first ? std::vector{met, clear} : std::vector{clear, met}, {});
    ASSERT_EQ(standing.standing.size(), 1u);
    EXPECT_TRUE(refusal(standing, {.strict = true}));
  }
}

/// Whatever is between the legs: what each sweeps, and the oldest look of all.
TEST(PathSurvey, what_legs_sweep_is_the_sum_and_what_is_unknown_of_one_is_unknown_of_all) {
  const Robot disc = load_robot("point");
  FreeSpaceMap builder({.resolution = 0.1});
  for (const auto& [y, time] : {std::pair(0.05, 1.0), std::pair(1.05, 4.0), std::pair(3.05, 9.0)}) {
    Scan scan;
    scan.time = time;
    scan.map_from_sensor.translation() = Eigen::Vector3d(-1.95, y, 0.05);
    scan.points = {Eigen::Vector3f(2.9f, 0.0f, 0.0f)};
    builder.insert(scan);
  }
  builder.paint(builder.add_volume("free", {}), {{-0.5, 0.0, 0.0}, 0.35});
  const Snapshot map = builder.snapshot();
  const LegsToCheck first{disc, map, {at(-1, 0), at(1, 0)}}, second{disc, map, {at(-1, 1), at(3, 1)}},
      none{disc, map, {}}, nowhere{disc, map, {at(5, 5)}};
  const auto swept = [&](const std::vector<LegsToCheck>& legs) { return survey_legs(legs, anything).swept; };
  const SweptVoxels one = *swept({first}), two = *swept({second});
  for (const auto& all : {*swept({first, second}), *swept({second, first})}) {
    EXPECT_EQ(all.painted, one.painted + two.painted);
    EXPECT_EQ(all.seen_free, one.seen_free + two.seen_free);
    EXPECT_EQ(all.seen_once, one.seen_once + two.seen_once);
    EXPECT_EQ(all.occupied, one.occupied + two.occupied);
    EXPECT_EQ(all.unknown, one.unknown + two.unknown);
    EXPECT_EQ(all.beyond, one.beyond + two.beyond);
    EXPECT_EQ(all.oldest_look, 8.0);  // from the first scan to the last
  }
  EXPECT_EQ(two.oldest_look, 5.0);
  for (const std::size_t count : {one.painted, one.seen_free, one.seen_once, one.occupied, two.beyond})
    EXPECT_GT(count, 0U);
  EXPECT_FALSE(swept({first, none}) || swept({none, first}));
  EXPECT_GT(swept({nowhere})->beyond, 0U);
  EXPECT_FALSE(swept({first, nowhere})->oldest_look || swept({nowhere, first})->oldest_look);
}

/// A row of voxels that somebody made free, of which no look is known.
TEST(PathSurvey, voxels_made_free_by_hand_are_counted_where_the_map_has_any) {
  for (const std::uint64_t freed : {0U, 11U}) {
    const auto tree = std::make_shared<FusedTree>(0.1);
    for (int x = -5; x <= 5; ++x) tree->free_voxel_by_hand({x, 0, 0});
    tree->add_hand_edits({.freed = freed});
    const PathSurvey survey =
        survey_path(load_robot("point"), Snapshot(tree, {}), anything, {at(-1, 0), at(1, 0)});
    EXPECT_EQ(survey.swept->seen_free, 11U);
    EXPECT_EQ(survey.swept->maybe_by_hand, freed);
  }
}

TEST(PathSurvey, what_is_refused_for_it_was_valid_before) {
  const PathSurvey away = survey_path(load_robot("point"), seen_line(), anything, {at(0, 0), at(0, 5)});
  PathVerdict met, valid;
  met.first_contact = "a contact";
  valid.valid = true;
  refuse_surveyed(away, {}, met);
  EXPECT_EQ(met.first_contact, "a contact");
  refuse_surveyed(away, {.allow_outside = {"base"}}, valid);
  EXPECT_TRUE(valid.valid);
  refuse_surveyed(away, {}, valid);
  EXPECT_FALSE(valid.valid);
  EXPECT_EQ(valid.first_contact, refusal(away, {}));
}

TEST(PathSurvey, parts_that_are_allowed_outside_must_exist) {
  const Robot robot = load_robot("puma560");
  require_parts({"all", "link3"}, robot, "--allow-outside");
  EXPECT_THROW(require_parts({"elbow"}, robot, "--allow-outside"), std::invalid_argument);
}

TEST(PartPolicies, free_space_is_known_however_much_of_it_is_painted) {
  Robot robot = load_robot("puma560");
  robot.critical_parts.clear();
  for (const double seen : {0.1, 0.2, 0.3, 0.4}) {  // one to four voxels seen free beside one painted
    FreeSpaceMap map({.resolution = 0.1});
    map.paint(map.add_volume("free", {"other"}), {Eigen::Vector3d(0.05, 0.05, 0.05), 0.09});
    Scan scan;
    scan.map_from_sensor.translation() = Eigen::Vector3d(0.15, 0.05, 0.05);
    scan.points = {Eigen::Vector3f(static_cast<float>(seen), 0.0f, 0.0f)};
    map.insert(scan);
    for (const auto& [part, policy] : part_policies(robot, map.snapshot(), {}))
      EXPECT_EQ(policy, Policy::known_free) << part << " " << map.snapshot().counts().seen_free;
  }
}

TEST(PartPolicies, when_voxels_were_seen_is_asked_only_where_some_part_is_under_known_free) {
  const Snapshot map = seen_line();
  using Parts = std::map<std::string, Policy>;
  require_seen_within(5.0, map, Parts{{"base", Policy::known_free}});
  require_seen_within(5.0, map, Parts{{"base", Policy::painted}, {"tool", Policy::known_free}});
  require_seen_within(0.0, map, Parts{{"base", Policy::not_occupied}});
  EXPECT_THROW(require_seen_within(5.0, map, Parts{{"base", Policy::not_occupied}}), std::invalid_argument);
  EXPECT_THROW(require_seen_within(5.0, map, Parts{{"a", Policy::painted}, {"b", Policy::not_occupied}}),
               std::invalid_argument);
}

TEST(PathSurvey, where_a_part_leaves_the_map_is_said_to_four_digits) {
  LeavingPart leaving{"tool", 0.123456, {1.23456, -0.0123456, 12.3456}, {}};
  EXPECT_EQ(to_text(leaving), "tool leaves the map's bounds by 0.1235 m at (1.235, -0.01235, 12.35)");
  leaving.distance = std::numeric_limits<double>::infinity();
  EXPECT_EQ(to_text(leaving), "tool leaves the map's bounds at (1.235, -0.01235, 12.35)");
}

TEST(PartPolicies, a_robot_that_names_no_critical_part_is_known_free_wherever_free_space_is_known) {
  Robot robot = load_robot("puma560");
  const auto all = [&](const Snapshot& map, const Policies& policies) {
    std::set<Policy> used;
    for (const auto& [part, policy] : part_policies(robot, map, policies)) used.insert(policy);
    return used;
  };
  EXPECT_EQ(all(seen_line(), {}),
            (std::set<Policy>{Policy::known_free, Policy::not_occupied}));  // the tool is
  robot.critical_parts.clear();
  EXPECT_EQ(all(seen_line(), {}), std::set<Policy>{Policy::known_free});
  EXPECT_EQ(all(wall(), {}), std::set<Policy>{Policy::not_occupied});
  EXPECT_EQ(all(Snapshot(), {}), std::set<Policy>{Policy::not_occupied});
  const Snapshot painted = VoxelScene{0.1, {}, {{Eigen::Vector3d::Zero(), 0.5}}, {}}.snapshot();
  EXPECT_EQ(all(painted, {}), std::set<Policy>{Policy::known_free});
  // What is asked for wins.
  EXPECT_EQ(all(seen_line(), {.other = Policy::not_occupied}), std::set<Policy>{Policy::not_occupied});
  EXPECT_EQ(all(seen_line(), {.critical_by_default = false}), std::set<Policy>{Policy::not_occupied});
  const auto one = part_policies(robot, seen_line(), {.parts = {{"link3", Policy::not_occupied}}});
  EXPECT_EQ(one.at("link3"), Policy::not_occupied);
  EXPECT_EQ(one.at("link2"), Policy::known_free);
}

}  // namespace path_survey_test
}  // namespace clearway

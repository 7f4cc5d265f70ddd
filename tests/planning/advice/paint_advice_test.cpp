#include "planning/advice/paint_advice.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <regex>

#include "planning/planner_table.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/random_world.hpp"

namespace clearway {
namespace paint_advice_test {

/// A compact painted volume about the straight way of the tool, with a pocket in it that was not painted: the
/// hole of Fig. 17 of Chong et al. 2008, drawn by seed.
struct HoledVolume {
  FreeSpaceMap map{{.resolution = 0.03}};
  int volume;
  Configuration start, goal;

  HoledVolume(const Robot& robot, std::uint64_t seed) : volume(map.add_volume("free", robot.critical_parts)) {
    constexpr double degree = std::numbers::pi / 180.0;
    Random random(seed);
    start.resize(6);
    start << random.between(-1.0, 1.0), -0.8, 0.3, 0.0, 0.4, 0.0;
    goal = start;
    goal[0] += random.between(25.0, 60.0) * degree;
    for (const int j : {1, 2, 4}) goal[j] += random.between(-20.0, 20.0) * degree;
    const auto tip = [&](double t) {
      return tip_pose(robot, start + t * (goal - start)).translation().eval();
    };
    const Sphere pocket{tip(random.between(0.35, 0.65)), random.between(0.05, 0.12)};
    for (int i = 0; i < 400; ++i) {
      const Eigen::Vector3d aside = random.point(0.25);
      const Sphere sphere{tip(random.between(-0.1, 1.1)) + aside, random.between(0.12, 0.22)};
      if ((sphere.center - pocket.center).norm() >= sphere.radius + pocket.radius) map.paint(volume, sphere);
    }
  }
};

TEST(PaintAdvice, PaintingWhatItSaysMakesThePlanSucceedInNineOfTenHoledVolumes) {
  const Robot robot = load_robot("puma560");
  const PathCost cost(robot);
  const auto planner = make_planner("beam", {{"width", "1"}, {"max_steps", "400"}});
  int failed = 0, mended = 0;
  for (std::uint64_t seed = 1; failed < 20 && seed < 2000; ++seed) {
    HoledVolume scene(robot, seed);
    const ConfigurationSpace space(robot, scene.map.snapshot());
    const PlanProblem problem{space, cost, scene.start, scene.goal, 1};
    if (planner->plan(problem).status != PlanStatus::no_path) continue;
    ++failed;
    const PaintAdvice advice = advise_paint(*planner, problem, true);
    for (const PaintHint& hint : advice.spheres) {
      EXPECT_EQ(hint.part, "tool");
      scene.map.paint(scene.volume, hint.sphere);
    }
    const ConfigurationSpace painted(robot, scene.map.snapshot());
    mended += planner->plan({painted, cost, scene.start, scene.goal, 1}).status == PlanStatus::solved;
  }
  EXPECT_EQ(failed, 20);
  EXPECT_GE(mended, 18);
}

TEST(PaintAdvice, CutsTheNameOfAPartThatIsLongerThanASentence) {
  const PaintAdvice advice{{{{Eigen::Vector3d::Zero(), 0.1}, std::string(5000, 'x')}}};
  EXPECT_LT(advice.sentence().size(), 250U);
  EXPECT_NE(advice.sentence().find("for xxx"), std::string::npos);
}

TEST(PaintAdvice, SaysWhetherPaintIsNeededByAllOrByThisPlanner) {
  PaintAdvice advice;
  EXPECT_EQ(advice.sentence(), "");
  advice.way_exists = true;
  EXPECT_EQ(advice.sentence(), "beam_guided finds a path that needs no more paint.");
  advice.spheres = {{{Eigen::Vector3d::Zero(), 0.1}, "hand"}};
  EXPECT_TRUE(advice.sentence().starts_with(
      "beam_guided finds a path that needs no more paint; for this planner painting would connect"))
      << advice.sentence();
  advice.way_exists = false;
  EXPECT_TRUE(advice.sentence().starts_with("Painting would connect start and goal: ")) << advice.sentence();
}

/// The places in brackets.
std::vector<Eigen::Vector3d> places_in(const std::string& sentence) {
  std::vector<Eigen::Vector3d> places;
  const std::regex place("\\((-?[0-9.]+), (-?[0-9.]+), (-?[0-9.]+)\\)");
  for (std::sregex_iterator it(sentence.begin(), sentence.end(), place), end; it != end; ++it)
    places.emplace_back(std::stod((*it)[1]), std::stod((*it)[2]), std::stod((*it)[3]));
  return places;
}

double distance_to_line(const std::vector<Eigen::Vector3d>& line, const Eigen::Vector3d& point) {
  double least = HUGE_VAL;
  for (std::size_t i = 1; i < line.size(); ++i) {
    const Eigen::Vector3d way = line[i] - line[i - 1];
    const double share = std::clamp((point - line[i - 1]).dot(way) / way.squaredNorm(), 0.0, 1.0);
    least = std::min(least, (line[i - 1] + share * way - point).norm());
  }
  return least;
}

TEST(PaintAdvice, AStrokeThatBendsIsNamedByThePlacesWhereItTurns) {
  for (const double turn : {0.0, 1.6, 3.1}) {  // of the whole stroke, rad
    PaintAdvice advice;
    for (int i = 0; i <= 40; ++i) {
      const double along = turn == 0.0 ? i / 40.0 : 0.0, angle = turn * i / 40.0;
      advice.spheres.push_back(
          {{Eigen::Vector3d(0.3 * std::cos(angle) + along, 0.3 * std::sin(angle), 0.5), 0.05}, "tool"});
    }
    const std::string sentence = advice.sentence();
    const std::vector<Eigen::Vector3d> places = places_in(sentence);
    if (turn == 0.0) {
      EXPECT_EQ(sentence,
                "Painting would connect start and goal: 50 mm around (0.300, 0.000, 0.500) and on to "
                "(1.300, 0.000, 0.500) for tool.");
    }
    ASSERT_GE(places.size(), turn == 0.0 ? 2U : 4U) << sentence;
    EXPECT_LE(places.size(), 7U) << sentence;
    for (const PaintHint& hint : advice.spheres)
      EXPECT_LT(distance_to_line(places, hint.sphere.center), 0.5 * hint.sphere.radius) << sentence;
  }
}

TEST(PaintAdvice, JoinsTwoVolumesAndNamesThePlaceBetweenThem) {
  const Robot robot = load_robot("puma560");
  const PathCost cost(robot);
  Configuration start(6);
  start << -0.9, -0.8, 0.3, 0.0, 0.4, 0.0;
  Configuration goal = start;
  goal[0] = 0.9;
  FreeSpaceMap map({.resolution = 0.03});
  const int volume = map.add_volume("free", robot.critical_parts);
  for (int i = 0; i <= 60; ++i) {
    const double turn = -0.9 + 1.8 * i / 60.0;
    if (std::abs(turn) < 0.5) continue;  // the gap
    Configuration q = start;
    q[0] = turn;
    map.paint(volume, {tip_pose(robot, q).translation(), 0.25});
  }
  const ConfigurationSpace space(robot, map.snapshot());
  const auto planner = make_planner("beam_guided", {{"max_samples", "500"}});
  const PlanProblem problem{space, cost, start, goal, 1};
  const PlanResult result = planner->plan(problem);
  ASSERT_EQ(result.status, PlanStatus::no_path) << result.explanation;
  const PaintAdvice advice = advise_paint(*planner, problem, false);
  ASSERT_FALSE(advice.spheres.empty());
  EXPECT_FALSE(advice.way_exists);
  EXPECT_NE(advice.sentence().find("Painting would connect start and goal: "), std::string::npos);
  for (const PaintHint& hint :
       advice.spheres) {  // in the gap, where the hand turns from one side to the other
    const Eigen::Vector3d ends[] = {tip_pose(robot, start).translation(),
                                    tip_pose(robot, goal).translation()};
    for (const Eigen::Vector3d& end : ends) EXPECT_GT((hint.sphere.center - end).norm(), 0.15);
    map.paint(volume, hint.sphere);
  }
  const ConfigurationSpace painted(robot, map.snapshot());
  EXPECT_EQ(planner->plan({painted, cost, start, goal, 1}).status, PlanStatus::solved);
}

TEST(PaintAdvice, LooksForItWhereVoxelsMustHaveBeenSeenLately) {
  const Robot robot = load_robot("point");
  const PathCost cost(robot);
  FreeSpaceMap map({.resolution = 0.1});
  Scan scan;
  scan.points = {Eigen::Vector3f(2.0f, 0.0f, 0.0f)};
  scan.time = 100.0;
  map.insert(scan);
  const ConfigurationSpace space(robot, map.snapshot(), {.parts = {{"base", Policy::known_free}}},
                                 {.seen_within = 10.0});
  const PlanProblem problem{space, cost, Eigen::Vector2d(-1.0, 0.0), Eigen::Vector2d(1.0, 0.0), 1};
  EXPECT_NO_THROW(advise_paint(*make_planner("rrtconnect", {}), problem, false));
}

TEST(PaintAdvice, SaysNothingWhereNoPartHasToStayInPaint) {
  const Robot robot = load_robot("puma560");
  const PathCost cost(robot);
  FreeSpaceMap map({.resolution = 0.03});
  const ConfigurationSpace space(robot, map.snapshot(),
                                 {.parts = {}, .other = Policy::not_occupied, .critical_by_default = false});
  const Configuration q = Configuration::Zero(6);
  const PaintAdvice advice = advise_paint(*make_planner("beam"), {space, cost, q, q, 1}, true);
  EXPECT_TRUE(advice.spheres.empty());
  EXPECT_TRUE(advice.sentence().empty());
}

}  // namespace paint_advice_test
}  // namespace clearway

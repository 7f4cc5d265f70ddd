// The twins beam and beam_reference where beam_test does not set them beside each other: painted and known
// free space, sliding joints, other sizes, payload, padding, a step for each joint, more heads than bits in a
// word.

#include <array>
#include <map>
#include <string>

#include "planning/planner_table.hpp"
#include "planning/robot_files/load_robot.hpp"
#include "tests/worlds/beam_world.hpp"
#include "tests/worlds/random_world.hpp"
#include "tests/worlds/trials.hpp"

namespace clearway {
namespace beam_reference_test {

/// The robot with its first two joints sliding, by at most half a metre either way.
Robot sliding(Robot robot) {
  for (std::size_t j = 0; j < 2; ++j)
    robot.joints[j].kind = JointKind::prismatic, robot.joints[j].lower = -0.5, robot.joints[j].upper = 0.5;
  return robot;
}

/// Where the hands of configurations between start and goal are, painted; a little is left out, and some
/// blocks stand about.
VoxelScene painted_way(const Robot& robot, const Configuration& start, const Configuration& goal,
                       Random& random) {
  VoxelScene scene{0.03, {}, {}, robot.critical_parts};
  for (const Body& body : robot.bodies) {
    if (body.part != robot.critical_parts.front()) continue;
    for (double t = 0.0; t <= 1.0; t += 0.2) {
      const LinkPoses poses = forward_kinematics(robot, Configuration(start + t * (goal - start)));
      const Eigen::Vector3d middle =
          poses[static_cast<std::size_t>(body.link)] * body.link_from_shape.translation();
      const double room = t == 0.0 || t > 0.99 ? 0.12 : random.between(0.0, 0.1);
      scene.painted.push_back(
          {middle + random.point(t == 0.0 || t > 0.99 ? 0.0 : 0.05), body.shape.bounding_radius() + room});
    }
  }
  for (int i = 0; i < 6; ++i) {
    const Eigen::Vector3d low = random.point(0.6);
    scene.occupied.emplace_back(low, low + Eigen::Vector3d::Constant(0.07));
  }
  return scene;
}

TEST(BeamReference, HasATwinInPaintWithSlidingJointsOtherSizesPayloadPaddingAndManyHeads) {
  std::map<PlanStatus, int> count;
  std::size_t most_heads_in_a_step = 0;
  const int scenes = trials(25, 40);
  for (int i = 0; i < scenes; ++i) {
    Random random(100 + static_cast<std::uint64_t>(i));
    const double size = i % 3 == 0 ? 0.7 : 1.0;
    Robot robot = load_robot("arm5");
    if (i % 2 == 1) robot = sliding(std::move(robot));
    robot = scaled(robot, size);
    const auto n = static_cast<Eigen::Index>(robot.dof());
    const Configuration start = 0.5 * random.configuration(robot);
    Configuration goal = start;
    std::string steps;
    for (Eigen::Index j = 0; j < n; ++j) {
      const bool slides = robot.joints[static_cast<std::size_t>(j)].kind == JointKind::prismatic;
      goal[j] += random.between(-0.4, 0.4) * (slides ? 0.3 * size : 1.0);
      steps += (j == 0 ? "" : ",") + std::to_string((slides ? 0.02 : 0.06) * random.between(0.8, 1.5));
    }
    const VoxelScene scene = painted_way(robot, start, goal, random);
    Policies policies;
    if (i % 4 == 3) policies.parts[robot.critical_parts.front()] = Policy::known_free;  // paint is known free
    const Snapshot map = scene.snapshot();
    const ConfigurationSpace space(robot, map, policies, {.padding = i % 5 == 4 ? 0.01 : 0.0});
    const PathCost cost(robot, {.payload_mass = i % 2 == 0 ? 0.0 : 2.0});
    const int width = i % 20 == 4 ? 80 : std::array{1, 3, 8, 15}[static_cast<std::size_t>(i) % 4];
    const PlannerOptions options = {{"width", std::to_string(width)},
                                    {"step", steps},
                                    {"max_steps", std::to_string(3 + i % 8)},
                                    {"node_only", i % 7 == 6 ? "true" : "false"}};
    const PlanProblem problem{space, cost, start, goal};
    const PlanResult fast = make_planner("beam", options)->plan(problem);
    ++count[fast.status];
    if (fast.status == PlanStatus::start_invalid || fast.status == PlanStatus::goal_invalid) continue;
    const PlanResult slow = make_planner("beam_reference", options)->plan(problem);
    expect_equal(fast, slow, std::to_string(i) + ": " + fast.explanation);
    most_heads_in_a_step =
        std::max(most_heads_in_a_step,
                 static_cast<std::size_t>(fast.statistics.at("heads") / std::max(1, fast.search_steps)));
  }
  EXPECT_GT(count[PlanStatus::solved], 5);
  EXPECT_GT(count[PlanStatus::no_path], 5);
  EXPECT_GT(most_heads_in_a_step, 64U);
}

}  // namespace beam_reference_test
}  // namespace clearway

// A robot moves while its map changes: one thread fuses scans and hands over maps, the other controls.
//
// A disc slides along x. A gate closes its way at x = 1 m; once it waits there, the gate opens.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <mapping/free_space_map.hpp>
#include <planning/constraint/live_control.hpp>
#include <planning/robot_files/load_robot.hpp>
#include <thread>

using namespace clearway;
using Clock = std::chrono::steady_clock;

/// A lidar at the origin sees a wall at x = 3 m, or the gate before it. (The disc itself is left out: of a
/// real scan ScanFilter::bodies takes it away.)
Scan look(bool is_gate_open) {
  const float range = is_gate_open ? 3.02f : 1.02f;
  Scan scan;
  for (int i = -300; i <= 300; ++i) {
    const float slope = 0.003f * static_cast<float>(i);
    scan.points.push_back({range, range * slope, 0.01f});
  }
  return scan;
}

int main() {
  const Robot robot = load_robot("point");  // a disc of 0.2 m radius; joints x and y, metres
  const Policies unknown_is_free{.other = Policy::not_occupied, .critical_by_default = false};
  const DamperOptions damper{.max_step = 0.004,  // m a step
                             .influence_distance = 0.25,
                             .security_distance = 0.05,
                             .xi = 0.02,
                             .weight = Eigen::VectorXd::Ones(2)};
  // The loop brakes by itself when its newest frame is older than this.
  LiveControl live(damper, {.max_age = std::chrono::milliseconds(500)});

  std::atomic<bool> is_gate_open = false, is_done = false;
  std::thread mapping([&] {
    FreeSpaceMap map({.resolution = 0.05});
    while (!is_done) {
      const auto taken = Clock::now();
      map.insert(look(is_gate_open), {.max_range = 4.0});
      live.publish(ConfigurationSpace(robot, map.snapshot(), unknown_is_free), taken);
      std::this_thread::sleep_until(taken + std::chrono::milliseconds(20));
    }
  });

  Configuration q = Eigen::Vector2d(0.0, 0.0);
  const Configuration goal = Eigen::Vector2d(2.0, 0.0);
  const auto end = Clock::now() + std::chrono::seconds(60);
  double waited_at = 0.0, nearest = damper.influence_distance;
  int still = 0;
  while ((goal - q).norm() > 1e-3 && Clock::now() < end) {
    const auto now = Clock::now();
    const Eigen::VectorXd step = live.step(q, step_to_goal(damper, q, goal), now);
    q += step;
    if (live.has_map()) nearest = std::min(nearest, live.control().separation());
    const bool is_held = live.has_map() && !live.is_braking() && step.norm() < 1e-6;
    still = is_held ? still + 1 : 0;
    if (still == 20 && !is_gate_open) {
      waited_at = q[0];
      is_gate_open = true;
    }
    std::this_thread::sleep_until(now + std::chrono::milliseconds(2));
  }
  is_done = true;
  mapping.join();

  const bool waited = std::abs(waited_at - 0.75) < 0.01;  // gate - radius - security distance
  const bool arrived = (goal - q).norm() <= 1e-3;
  const bool kept_distance = nearest > damper.security_distance - 1e-3;
  std::printf("waited before the closed gate at x = %.2f m\n", waited_at);
  std::printf("went on when it opened, to x = %.2f m\n", q[0]);
  std::printf("kept %.2f m from what it saw: %s\n", damper.security_distance, kept_distance ? "yes" : "no");
  return waited && arrived && kept_distance ? 0 : 1;
}

// Lets another program move an arm, chunk by chunk: each is passed only when its motion, and the way the arm
// stops after it, is proved free in the newest map.
//
// A policy that knows no map turns the base of a PUMA 560 towards a wall, at growing speed.

#include <iostream>
#include <limits>
#include <mapping/free_space_map.hpp>
#include <planning/gate/gate.hpp>
#include <planning/robot_files/load_robot.hpp>

using namespace clearway;

/// A wall at y = 0.4 m, seen from the robot's side of it.
Snapshot wall() {
  FreeSpaceMap map({.resolution = 0.02});
  Scan scan;
  scan.map_from_sensor.translation() = Eigen::Vector3d(0.8, -0.6, 0.6);
  for (float x = -0.8f; x <= 0.8f; x += 0.01f) {
    for (float z = -0.6f; z <= 0.8f; z += 0.01f) scan.points.push_back({x, 1.01f, z});
  }
  map.insert(scan);
  return map.snapshot();
}

/// What the policy wants next: eight configurations, 50 ms apart, from `q` on at `speed` (rad/s).
MotionChunk ask_policy(Configuration q, double begin, double speed) {
  MotionChunk chunk;
  for (int i = 0; i < 8; ++i) {
    chunk.times.push_back(begin + 0.05 * i);
    chunk.positions.push_back(q);
    q[0] += 0.05 * speed;
  }
  return chunk;
}

/// The first part of a chunk, up to where its motion may go.
MotionChunk part_of(const MotionChunk& chunk, const ProvedPart& part) {
  MotionChunk first;
  for (std::size_t i = 0; chunk.times[i] < part.time; ++i) {
    first.times.push_back(chunk.times[i]);
    first.positions.push_back(chunk.positions[i]);
  }
  first.times.push_back(part.time);
  first.positions.push_back(part.position);
  return first;
}

int main() {
  const Robot robot = load_robot("puma560");
  const Policies unknown_is_free{.other = Policy::not_occupied, .critical_by_default = false};
  Gate gate({.limits = {.max_velocity = {2.0}, .deceleration = {4.0}}});  // rad/s, rad/s^2
  // A mapping thread would publish a map for each frame; see 05_changing_map.cpp.
  gate.publish(ConfigurationSpace(robot, wall(), unknown_is_free, {.padding = robot.position_accuracy}));

  Configuration q(6);
  q << -0.8, -0.8, 0.3, 0.0, 0.4, 0.0;
  double time = 0.0;
  int passed = 0;
  GateVerdict verdict;
  for (double speed = 0.4;; speed += 0.2) {
    const MotionChunk chunk = ask_policy(q, time, speed);
    verdict = gate.judge(chunk);
    if (!verdict.is_passed()) break;
    ++passed;  // a robot would run it now, interpolating linearly in the joints
    time = chunk.times.back();
    q = chunk.positions.back();
  }
  std::cout << passed << " chunks passed\n"
            << "refused: " << to_string(verdict.reason) << "\n  " << verdict.sentence << '\n';
  if (!verdict.piece || !verdict.may_go) return 1;

  // The part that may still be run passes as a chunk of its own, and leaves the arm standing before the wall.
  const MotionChunk refused = ask_policy(q, time, 0.4 + 0.2 * passed);
  const GateVerdict part = gate.judge(part_of(refused, *verdict.may_go));
  std::cout << "up to " << verdict.may_go->time
            << " s it may go: " << (part.is_passed() ? "passed" : "refused") << '\n';

  // What a policy must not send.
  MotionChunk hostile = ask_policy(verdict.may_go->stop, time, 0.1);
  hostile.positions[3][2] = std::numeric_limits<double>::quiet_NaN();
  const GateVerdict nan = gate.judge(hostile);
  const GateVerdict jump = gate.judge(ask_policy(q.array() - 0.5, time, 0.1));
  std::cout << to_string(nan.reason) << ": " << nan.sentence << '\n'
            << to_string(jump.reason) << ": " << jump.sentence << '\n';
  return passed > 1 && verdict.reason == GateReason::blocked && part.is_passed() &&
                 nan.reason == GateReason::not_finite && jump.reason == GateReason::jump
             ? 0
             : 1;
}

#include "planning/team/team_check.hpp"

#include <algorithm>
#include <cmath>

#include "planning/check/path_check.hpp"
#include "planning/check/path_check_model.hpp"
#include "planning/robot/joined_robot.hpp"

namespace clearway {
namespace {

constexpr double tolerance = 1e-4;  ///< m, of the least separation
constexpr double finest = 1e-9;     ///< share of a period that is not halved any more

/// All robots as one, then each obstacle as a body of the root that is placed by its motion.
Robot robot_of(const Team& team) {
  std::vector<std::pair<std::string, Robot>> robots;
  for (const TeamRobot& robot : team.robots) robots.emplace_back(robot.name, robot.space->robot());
  Robot all = joined_robot(robots);
  for (const MovingObstacle& obstacle : team.obstacles) {
    Body body;
    body.part = obstacle.name;
    body.shape = obstacle.shape;
    all.bodies.push_back(std::move(body));
  }
  return all;
}

/// Two bodies that must stay apart and what is known of them: how far they are at least, beyond what moved
/// since.
struct Pair {
  std::size_t first = 0, second = 0;
  bool with_obstacle = false;
  double room = -1.0;
};

/// The least separation of some pairs.
struct Least {
  double distance = 0.0, time = 0.0;
  std::string between;
};

class TeamChecker {
 public:
  TeamChecker(const Team& team, const TeamRun& run, double cap)
      : team_(team), run_(run), robot_(robot_of(team)), arm_(robot_), fcl_(robot_) {
    of_robots_.distance = from_obstacles_.distance = std::max(cap, 10.0 * tolerance);
    for (std::size_t k = 0; k <= run.steps(); ++k) {
      std::vector<Configuration> all;
      for (const TeamTrace& trace : run.traces) all.push_back(trace.positions[k]);
      path_.push_back(joined(all));
    }
    list_pairs();
  }

  TeamVerdict run() {
    find_least();
    const Least& least = from_obstacles_.distance < of_robots_.distance ? from_obstacles_ : of_robots_;
    verdict_.least_separation = least.distance;
    verdict_.between_robots = of_robots_.distance;
    verdict_.time = least.time;
    verdict_.between = least.between;
    verdict_.robots_are_apart = of_robots_.distance > 0.0;
    verdict_.is_apart = least.distance > 0.0;
    for (std::size_t i = 0; i < team_.robots.size() && verdict_.contact.empty(); ++i) {
      const ConfigurationSpace& space = *team_.robots[i].space;
      const PathVerdict path =
          check_path(space.robot(), space.map(), space.policies(), space.options().padding,
                     run_.traces[i].positions, 0.0, space.options().seen_within);
      if (path.valid) continue;
      verdict_.is_apart = verdict_.robots_are_apart = false;
      verdict_.contact = team_.robots[i].name + ": " + path.first_contact;
    }
    return verdict_;
  }

  void find_shares(double max_acceleration) {
    for (std::size_t i = 0; i < team_.robots.size(); ++i) {
      const std::vector<Joint>& joints = team_.robots[i].space->robot().joints;
      Eigen::VectorXd before = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(joints.size()));
      const std::vector<Configuration>& positions = run_.traces[i].positions;
      for (std::size_t k = 1; k < positions.size(); ++k) {
        const Eigen::VectorXd speed = (positions[k] - positions[k - 1]) / run_.period;
        for (std::size_t j = 0; j < joints.size(); ++j) {
          const auto at = static_cast<Eigen::Index>(j);
          verdict_.greatest_speed_share =
              std::max(verdict_.greatest_speed_share, std::abs(speed[at]) / joints[j].max_velocity);
          verdict_.greatest_acceleration_share =
              std::max(verdict_.greatest_acceleration_share,
                       std::abs(speed[at] - before[at]) / run_.period / max_acceleration);
        }
        before = speed;
      }
    }
  }

 private:
  /// Bodies of different robots of which one moves, and every body with each obstacle. Of two that both stand
  /// still contact alone counts: no motion makes their distance.
  void list_pairs() {
    std::vector<std::size_t> owner;
    for (std::size_t i = 0; i < team_.robots.size(); ++i)
      owner.insert(owner.end(), team_.robots[i].space->robot().bodies.size(), i);
    bodies_ = owner.size();
    for (std::size_t a = 0; a < bodies_; ++a) {
      for (std::size_t b = a + 1; b < bodies_; ++b)
        if (owner[a] != owner[b])
          (arm_.is_policed(a) || arm_.is_policed(b) ? pairs_ : standing_).push_back({a, b, false});
      for (std::size_t o = 0; o < team_.obstacles.size(); ++o) pairs_.push_back({a, bodies_ + o, true});
    }
  }

  /// How much the pair approaches during a whole period at most.
  double approach(const Pair& pair, const Eigen::VectorXd& abs_dq) const {
    const double first = arm_.motion(pair.first, abs_dq);
    if (pair.second < bodies_) return first + arm_.motion(pair.second, abs_dq);
    return first + team_.obstacles[pair.second - bodies_].greatest_speed() * run_.period;
  }

  double time_at(std::size_t step, double share) const {
    return (static_cast<double>(step) + share) * run_.period;
  }

  void place(std::size_t step, double share) {
    const std::size_t next = std::min(step + 1, path_.size() - 1);
    arm_.place(path_[step] + share * (path_[next] - path_[step]), poses_);
    for (std::size_t o = 0; o < team_.obstacles.size(); ++o)
      poses_[bodies_ + o] = team_.obstacles[o].motion.pose(time_at(step, share));
  }

  Least& least_of(const Pair& pair) { return pair.with_obstacle ? from_obstacles_ : of_robots_; }

  /// Distance where the bodies are placed; notes it when it is the least so far.
  double measure(const Pair& pair, std::size_t step, double share) {
    const double apart = fcl_.distance(pair.first, poses_[pair.first], pair.second, poses_[pair.second]);
    note(pair, apart, step, share);
    return apart;
  }

  void note(const Pair& pair, double apart, std::size_t step, double share) {
    if (apart >= least_of(pair).distance) return;
    least_of(pair) = {apart, time_at(step, share),
                      robot_.bodies[pair.first].part + " and " + robot_.bodies[pair.second].part};
  }

  /// Proves the pair `least - tolerance` apart between two shares of a step, looking at the middle. What the
  /// finest share leaves unproved counts as the least that it can be.
  void prove(const Pair& pair, std::size_t step, double from, double to, double approach) {
    const double middle = 0.5 * (from + to);
    place(step, middle);
    const double apart = measure(pair, step, middle);
    if (apart - 0.5 * (to - from) * approach >= least_of(pair).distance - tolerance) return;
    if (least_of(pair).distance <= 0.0) return;
    if (to - from <= finest) {
      note(pair, apart - 0.5 * (to - from) * approach, step, middle);
      return;
    }
    prove(pair, step, from, middle, approach);
    prove(pair, step, middle, to, approach);
  }

  /// Bounding boxes of the bodies are too far apart to count.
  bool is_far(const Pair& pair) {
    const check::PointDistance &first = fcl_.point_distance(pair.first),
                               &second = fcl_.point_distance(pair.second);
    const double reach = first.box_half.norm() + second.box_half.norm();
    const Eigen::Vector3d between =
        poses_[pair.second] * second.box_center - poses_[pair.first] * first.box_center;
    return between.norm() - reach > least_of(pair).distance + 1.0;
  }

  void find_least() {
    if (!standing_.empty()) place(0, 0.0);
    for (const Pair& pair : standing_)
      if (fcl_.distance(pair.first, poses_[pair.first], pair.second, poses_[pair.second]) <= 0.0)
        note(pair, 0.0, 0, 0.0);
    for (std::size_t k = 0; k < path_.size(); ++k) {
      const Eigen::VectorXd abs_dq =
          k + 1 < path_.size() ? (path_[k + 1] - path_[k]).cwiseAbs().eval() : (0.0 * path_[k]).eval();
      bool is_placed = false;
      for (Pair& pair : pairs_) {
        const double nearer = approach(pair, abs_dq);
        if (pair.room - nearer >= least_of(pair).distance - tolerance) {
          pair.room -= nearer;
          continue;
        }
        if (!is_placed) place(k, 0.0);
        is_placed = true;
        pair.room = is_far(pair) ? least_of(pair).distance + 1.0 : measure(pair, k, 0.0);
        if (pair.room - nearer < least_of(pair).distance - tolerance) {
          prove(pair, k, 0.0, 1.0, nearer);
          is_placed = false;
        }
        pair.room -= nearer;
      }
    }
    for (Least* least : {&of_robots_, &from_obstacles_})
      least->distance = std::max(0.0, least->distance - tolerance);
  }

  const Team& team_;
  const TeamRun& run_;
  const Robot robot_;
  const check::KdlArm arm_;
  const check::FclBodies fcl_;
  TeamVerdict verdict_;
  Least of_robots_, from_obstacles_;
  std::size_t bodies_ = 0;  ///< of robots; those of obstacles follow
  std::vector<Configuration> path_;
  std::vector<Pair> pairs_, standing_;
  check::BodyPoses poses_;
};

}  // namespace

TeamVerdict check_team(const Team& team, const TeamRun& run, double max_acceleration, double cap) {
  TeamChecker checker(team, run, cap);
  checker.find_shares(max_acceleration);
  return checker.run();
}

}  // namespace clearway

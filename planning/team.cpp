#include "planning/team.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "planning/option_reader.hpp"
#include "planning/team_member.hpp"

namespace clearway {
namespace {

void require(bool holds, const std::string& sentence) {
  if (!holds) throw std::invalid_argument(sentence);
}

void check_inputs(const Team& team, const TeamOptions& options) {
  require(!team.robots.empty(), "a team needs at least one robot");
  require(options.period > 0.0 && std::isfinite(options.period), "team: period: expected more than 0 s");
  require(options.duration >= options.period && options.duration / options.period <= 1e6,
          "team: duration: expected one to a million periods");
  require(options.max_acceleration > 0.0, "team: max_acceleration: expected more than 0");
  std::set<std::string> names;
  for (const TeamRobot& member : team.robots) {
    const Robot& robot = member.space->robot();
    const auto n = static_cast<Eigen::Index>(robot.dof());
    require(names.insert(member.name).second,
            "two robots are called '" + member.name + "': expected names that differ");
    require(member.start.size() == n && member.goal.size() == n,
            "robot '" + member.name + "': start and goal: expected " + std::to_string(n) + " values each");
    for (const Joint& joint : robot.joints) {
      require(joint.max_velocity > 0.0, "robot '" + member.name + "', joint '" + joint.name +
                                            "': its velocity limit is 0 or not given; expected one over 0 " +
                                            "to move it in time");
    }
  }
}

constexpr double creeping = 1e-3;  ///< share of the longest step: the damper creeps towards a stop for ever
constexpr double patience = 2.0;   ///< s of that, in a scene that does not move, are a deadlock

/// What the others are for robot `i`: their bodies, then the obstacles.
struct Surroundings {
  std::vector<PlacedShape> shapes;
  std::vector<std::string> names;
  std::size_t bodies = 0;  ///< the first so many belong to other robots
};

class TeamMotion {
 public:
  TeamMotion(const Team& team, const TeamOptions& options) : team_(team), options_(options) {
    run_.period = options.period;
    choose_figures();
    for (std::size_t i = 0; i < team.robots.size(); ++i) {
      members_.push_back(std::make_unique<TeamMember>(team.robots[i], options, run_.figures, i));
    }
  }

  TeamRun run(const std::function<bool()>& out_of_time) {
    if (!check_ends()) return finished(0);
    const auto steps = static_cast<std::size_t>(std::llround(options_.duration / options_.period));
    std::size_t still = 0;
    for (std::size_t k = 0; k < steps; ++k) {
      if (out_of_time()) {
        run_.status = PlanStatus::timed_out;
        run_.explanation = "Out of time after " + time_text(k) + ".";
        return finished(k);
      }
      const double moved = step(static_cast<double>(k) * options_.period);
      still = moved > creeping ? 0 : still + 1;
      if (has_arrived() && moved == 0.0) return arrived(k);
      if (static_cast<double>(still) * options_.period > patience && team_.obstacles.empty() && !team_.sensed)
        return stuck(k);
    }
    run_.status = PlanStatus::timed_out;
    run_.explanation = "Not all robots arrived within " + time_text(steps) + waiting();
    return finished(steps);
  }

 private:
  std::string time_text(std::size_t k) const {
    return short_text(static_cast<double>(k) * options_.period) + " s";
  }

  /// Auto values; see TeamFigures.
  void choose_figures() {
    TeamFigures& figures = run_.figures;
    const ConstraintOptions& given = options_.boundary.local;
    std::vector<double> reach;
    for (const TeamRobot& robot : team_.robots)
      reach.push_back(weighted_reach(*robot.space, given.prismatic_scale));
    const double longest = *std::max_element(reach.begin(), reach.end());
    figures.influence_distance = given.influence_distance > 0.0 ? given.influence_distance : longest / 5.0;
    const double d_i = figures.influence_distance;
    figures.security_distance = given.security_distance > 0.0
                                    ? given.security_distance
                                    : std::clamp(least_at_ends(d_i) / 2.0, 1e-3 * d_i, d_i / 8.0);
    const double margin = d_i - figures.security_distance;
    double fastest = 0.0;
    for (std::size_t i = 0; i < team_.robots.size(); ++i) {
      const double step = given.max_step > 0.0 ? given.max_step
                                               : longest_step(*team_.robots[i].space, given.prismatic_scale,
                                                              options_, margin / (2.0 * reach[i]));
      figures.max_step.push_back(step);
      fastest = std::max(fastest, step * reach[i]);
    }
    figures.xi = given.xi > 0.0 ? given.xi : std::min(2.0 * fastest, margin);
    require(margin > 0.0 && figures.xi <= margin * (1.0 + 1e-12),
            "team: security_distance " + to_text(figures.security_distance) + ", influence_distance " +
                to_text(d_i) + ", xi " + to_text(figures.xi) +
                ": expected security < influence and xi <= influence - security");
    for (const MovingObstacle& obstacle : team_.obstacles)
      figures.greatest_obstacle_speed = std::max(figures.greatest_obstacle_speed, obstacle.greatest_speed());
  }

  /// The least separation, at most `limit`, of all robots at their starts, and of all at their goals.
  double least_at_ends(double limit) const {
    double least = limit;
    for (const bool at_goal : {false, true}) {
      for (std::size_t i = 0; i < team_.robots.size(); ++i) {
        const ConfigurationSpace& space = *team_.robots[i].space;
        const Configuration& q = at_goal ? team_.robots[i].goal : team_.robots[i].start;
        for (const ProximityRow& row : space.proximity_rows(q, limit)) least = std::min(least, row.distance);
        std::vector<ObstacleRow> rows;
        ObstacleRows(space.robot())
            .append(forward_kinematics(space.robot(), q), around(i, at_goal).shapes, limit, rows);
        for (const ObstacleRow& row : rows) least = std::min(least, row.distance);
      }
    }
    return least;
  }

  /// The others as they stand at the start or the goal, and at the start the obstacles.
  Surroundings around(std::size_t i, bool at_goal) const {
    Surroundings all;
    for (std::size_t j = 0; j < team_.robots.size(); ++j) {
      const TeamRobot& other = team_.robots[j];
      if (j == i) continue;
      const Robot& robot = other.space->robot();
      for (const PlacedShape& body :
           placed_bodies(robot, forward_kinematics(robot, at_goal ? other.goal : other.start)))
        all.shapes.push_back(body);
      for (const Body& body : robot.bodies) all.names.push_back(other.name + "/" + body.part);
    }
    all.bodies = all.shapes.size();
    if (at_goal) return all;
    for (const MovingObstacle& obstacle : team_.obstacles) {
      all.shapes.push_back(obstacle.placed(0.0, options_.period));
      all.names.push_back(obstacle.name);
    }
    return all;
  }

  /// Start and goal of each robot by itself, then against the others. Returns false with the sentence told.
  bool check_ends() {
    for (const bool at_goal : {false, true}) {
      for (std::size_t i = 0; i < team_.robots.size(); ++i) {
        const TeamRobot& member = team_.robots[i];
        const Configuration& q = at_goal ? member.goal : member.start;
        const std::string who = "Robot '" + member.name + "' at its " + (at_goal ? "goal" : "start") + ": ";
        const Verdict verdict = member.space->check(q);
        std::string sentence = verdict.is_free() ? "" : verdict.sentence();
        std::vector<ObstacleRow> rows;
        const Robot& robot = member.space->robot();
        const Surroundings others = around(i, at_goal);
        if (sentence.empty())
          ObstacleRows(robot).append(forward_kinematics(robot, q), others.shapes,
                                     run_.figures.influence_distance, rows);
        for (const ObstacleRow& row : rows) {
          if (row.distance > 0.0) continue;
          sentence = robot.bodies[static_cast<std::size_t>(row.body)].part + " touches " +
                     others.names[static_cast<std::size_t>(row.obstacle)];
          break;
        }
        if (sentence.empty()) continue;
        run_.status = at_goal ? PlanStatus::goal_invalid : PlanStatus::start_invalid;
        run_.explanation = who + sentence + ".";
        return false;
      }
    }
    return true;
  }

  /// All robots look at each other and at the obstacles.
  void look(double time) {
    std::vector<std::vector<PlacedShape>> bodies;
    for (std::size_t i = 0; i < members_.size(); ++i) {
      if (team_.sensed) members_[i]->see(team_.sensed(i, time));
      bodies.push_back(members_[i]->bodies());
    }
    std::vector<PlacedShape> obstacles;
    for (const MovingObstacle& obstacle : team_.obstacles)
      obstacles.push_back(obstacle.placed(time, options_.period));
    for (std::size_t i = 0; i < members_.size(); ++i) {
      std::vector<PlacedShape> robots;
      for (std::size_t j = 0; j < members_.size(); ++j)
        if (j != i) robots.insert(robots.end(), bodies[j].begin(), bodies[j].end());
      members_[i]->look(robots, obstacles);
    }
  }

  /// One period of all robots. Returns the longest step, as a share of what was allowed.
  double step(double time) {
    look(time);
    for (std::size_t i = 0; i < members_.size(); ++i) {
      const OutrunBy by = members_[i]->choose();
      if (by.kind != OutrunBy::nothing && run_.outrun.empty()) tell_outrun(i, by, time);
    }
    double longest = 0.0;
    for (auto& member : members_) longest = std::max(longest, member->move());
    return longest;
  }

  void tell_outrun(std::size_t i, const OutrunBy& by, double time) {
    const auto at = static_cast<std::size_t>(std::max(0, by.index));
    const std::string what = by.kind == OutrunBy::obstacle ? "'" + team_.obstacles[at].name + "'"
                             : by.kind == OutrunBy::robot  ? "another robot"
                             : by.kind == OutrunBy::fixed  ? "an obstacle where no joint moves it away"
                                                           : "what surrounds it";
    run_.outrun = "At " + short_text(time) + " s robot '" + team_.robots[i].name +
                  "' could not keep the separation demanded by " + what;
  }

  bool has_arrived() const {
    return std::all_of(members_.begin(), members_.end(),
                       [](const auto& member) { return member->is_at_goal(); });
  }

  TeamRun arrived(std::size_t k) {
    run_.status = PlanStatus::solved;
    const auto deadlocks =
        std::accumulate(members_.begin(), members_.end(), 0,
                        [](int sum, const auto& member) { return sum + member->trace().deadlocks; });
    run_.explanation = "All robots stand at their goals after " + time_text(k) + " and " +
                       std::to_string(deadlocks) + " deadlocks.";
    return finished(k + 1);
  }

  TeamRun stuck(std::size_t k) {
    run_.status = PlanStatus::no_path;
    run_.explanation = "No robot moves any more after " + time_text(k) + waiting();
    return finished(k + 1);
  }

  std::string waiting() const {
    std::string text;
    for (const auto& member : members_) {
      if (member->is_at_goal()) continue;
      text += (text.empty() ? ": " : "; ") + member->where();
    }
    return text + ".";
  }

  /// The run as it stands after `steps` periods.
  TeamRun finished(std::size_t steps) {
    look(static_cast<double>(steps) * options_.period);
    for (auto& member : members_) run_.traces.push_back(member->trace());
    if (!run_.outrun.empty()) run_.explanation += " " + run_.outrun + ".";
    return std::move(run_);
  }

  const Team& team_;
  const TeamOptions& options_;
  TeamRun run_;
  std::vector<std::unique_ptr<TeamMember>> members_;
};

}  // namespace

double TeamRun::least_separation() const {
  double least = figures.influence_distance;
  for (const TeamTrace& trace : traces)
    for (const double separation : trace.separations) least = std::min(least, separation);
  return least;
}

double TeamRun::step_bound() const {
  double first = 0.0, second = figures.greatest_obstacle_speed * period;
  for (const TeamTrace& trace : traces) {
    second = std::max(second, std::min(first, trace.greatest_motion));
    first = std::max(first, trace.greatest_motion);
  }
  return first + second;
}

TeamOptions team_options(const std::string& planner, const PlannerOptions& options) {
  require(planner == "constraint" || planner == "boundary",
          "planner '" + planner +
              "' cannot lead a team: expected constraint or boundary, which move step by step");
  TeamOptions all;
  OptionReader reader(planner, options);
  all.follows_boundaries = planner == "boundary";
  if (all.follows_boundaries) {
    all.boundary = read_boundary_options(reader);
  } else {
    all.boundary.local = read_constraint_options(reader);
  }
  reader.refuse_unknown();
  return all;
}

TeamRun run_team(const Team& team, const TeamOptions& options, const std::function<bool()>& out_of_time) {
  check_inputs(team, options);
  return TeamMotion(team, options).run(out_of_time);
}

}  // namespace clearway

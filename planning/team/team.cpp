#include "planning/team/team.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "mapping/system/number_text.hpp"
#include "planning/problem/option_reader.hpp"
#include "planning/team/team_member.hpp"
#include "planning/team/team_setup.hpp"

namespace clearway {
namespace {

constexpr double creeping = 1e-3;  ///< share of the longest step: the damper creeps towards a stop for ever
constexpr double patience = 2.0;   ///< s of that, in a scene that does not move any more, are a deadlock
constexpr double patience_with_sensors = 10.0;  ///< s: what is gone stays in the map for a while
constexpr double hovering = 1e-2;  ///< share of the way that it could have gone: a robot at voxels trembles

class TeamMotion {
 public:
  TeamMotion(const Team& team, const TeamOptions& options) : team_(team), options_(options) {
    run_.period = options.period;
    run_.figures = choose_figures(team, options);
    for (std::size_t i = 0; i < team.robots.size(); ++i) {
      members_.push_back(std::make_unique<TeamMember>(team.robots[i], options, run_.figures, i));
    }
  }

  TeamRun run(const std::function<bool()>& out_of_time) {
    const PlanResult ends = check_team_ends(team_, options_);
    if (ends.status != PlanStatus::solved) {
      run_.status = ends.status;
      run_.explanation = ends.explanation;
      return finished(0);
    }
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
      const bool is_quiet = static_cast<double>(k) * options_.period >= last_motion();
      if (has_arrived() && moved == 0.0 && is_quiet) return arrived(k);
      if (is_over(k, still)) return stuck(k);
    }
    if (has_arrived()) return arrived(steps - 1);
    run_.status = PlanStatus::timed_out;
    run_.explanation = "Not all robots arrived within " + time_text(steps) + waiting();
    return finished(steps);
  }

 private:
  std::string time_text(std::size_t k) const {
    return short_text(static_cast<double>(k) * options_.period) + " s";
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
      if (!obstacle.is_sensed) obstacles.push_back(obstacle.placed(time, options_.period));
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
      if (is_outrun(by) && run_.outrun.empty()) report_outrun(i, by, time);
    }
    double longest = 0.0;
    for (auto& member : members_) longest = std::max(longest, member->move());
    return longest;
  }

  /// Name of the known obstacle of that number.
  std::string known_obstacle(int number) const {
    for (const MovingObstacle& obstacle : team_.obstacles)
      if (!obstacle.is_sensed && number-- == 0) return obstacle.name;
    return "";
  }

  /// Only what moves can outrun a robot: a demand of another robot, of the map that it began with or of
  /// itself that gives way is no excuse.
  static bool is_outrun(const OutrunBy& by) { return by.kind >= OutrunBy::sensed; }

  void report_outrun(std::size_t i, const OutrunBy& by, double time) {
    const std::string what = by.kind == OutrunBy::obstacle  ? "'" + known_obstacle(by.index) + "'"
                             : by.kind == OutrunBy::fixed   ? "an obstacle where no joint moves it away"
                             : by.kind == OutrunBy::overlap ? "what sensors saw where it stood"
                                                            : "what sensors saw";
    run_.outrun = "At " + short_text(time) + " s robot '" + team_.robots[i].name +
                  "' could not keep the separation demanded by " + what;
  }

  /// When the last obstacle comes to rest, s; those that repeat their ways never do, and do not count.
  double last_motion() const {
    double last = 0.0;
    for (const MovingObstacle& obstacle : team_.obstacles)
      if (!obstacle.motion.repeats()) last = std::max(last, obstacle.motion.poses().back().time);
    return last;
  }

  /// Robots came nowhere in the last `still` steps or, with sensors, in their patience, and nothing else will
  /// move.
  bool is_over(std::size_t k, std::size_t still) const {
    for (const MovingObstacle& obstacle : team_.obstacles)
      if (obstacle.motion.repeats()) return false;
    const double longest = team_.sensed ? patience_with_sensors : patience;
    if (static_cast<double>(k) * options_.period <= last_motion() + longest) return false;
    if (!team_.sensed) return static_cast<double>(still) * options_.period > longest;
    const auto steps = static_cast<std::size_t>(longest / options_.period);
    return std::all_of(members_.begin(), members_.end(),
                       [&](const auto& member) { return member->share_gone(steps) <= hovering; });
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
                       counted(deadlocks, "deadlock") + ".";
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

TeamRun run_team(const Team& team, const TeamOptions& options, const std::function<bool()>& out_of_time) {
  check_team_inputs(team, options);
  return TeamMotion(team, options).run(out_of_time);
}

}  // namespace clearway

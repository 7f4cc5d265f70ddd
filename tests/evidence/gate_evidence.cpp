#include "tests/evidence/gate_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "planning/check/path_check.hpp"
#include "planning/gate/gate.hpp"
#include "planning/survey/path_survey.hpp"
#include "tests/evidence/drawn_world.hpp"

namespace clearway::evidence {
namespace {

constexpr double taken = 1000.0, max_age = 2.0, tolerance = 1e-3;
constexpr double nan = std::numeric_limits<double>::quiet_NaN(),
                 infinity = std::numeric_limits<double>::infinity();

/// What the drawn gate is given, in numbers of its own.
struct Terms {
  std::vector<double> velocity{}, deceleration{};
  double reaction = 0.0;
  bool ages = false;
  SurveyDemands demands{};
};

Terms draw_terms(const Robot& robot, Random& random) {
  Terms terms{.reaction = random.below(3) == 0 ? random.between(0.0, 0.1) : 0.0,
              .ages = random.below(2) == 0};
  for (std::size_t j = 0; j < robot.dof(); ++j) {
    terms.velocity.push_back(random.between(0.3, 3.0));
    terms.deceleration.push_back(random.between(1.0, 20.0));
  }
  if (random.below(3) == 0)
    terms.demands.allow_outside = {
        robot.bodies[static_cast<std::size_t>(random.below(static_cast<int>(robot.bodies.size())))].part};
  return terms;
}

GateOptions options_of(const Terms& terms) {
  GateOptions options{.limits = {.max_velocity = terms.velocity,
                                 .deceleration = terms.deceleration,
                                 .reaction = terms.reaction},
                      .tolerance = tolerance,
                      .allow_outside = terms.demands.allow_outside};
  if (terms.ages) options.max_age = max_age;
  return options;
}

/// The way that a robot goes on at `velocity` until it stands, by v t - d t^2 / 2 of the joint that takes
/// longest.
Configuration coasting(const Terms& terms, const Eigen::VectorXd& velocity) {
  double longest = 0.0;
  for (Eigen::Index j = 0; j < velocity.size(); ++j)
    longest = std::max(longest, std::abs(velocity[j]) / terms.deceleration[static_cast<std::size_t>(j)]);
  return velocity * terms.reaction + velocity * longest - velocity * (longest / 2.0);
}

Eigen::VectorXd rate(const MotionChunk& chunk, std::size_t edge) {
  const double time = chunk.times[edge + 1] - chunk.times[edge];
  Eigen::VectorXd velocity = chunk.positions[edge + 1];
  for (Eigen::Index j = 0; j < velocity.size(); ++j)
    velocity[j] = (velocity[j] - chunk.positions[edge][j]) / time;
  return velocity;
}

/// Where a chunk begins, what wandering made of it.
MotionChunk wander(const ConfigurationSpace& space, const Terms& terms, const Configuration& from,
                   Random& random) {
  const Robot& robot = space.robot();
  const double speed = random.between(0.02, 0.9), turning = random.below(2) == 0 ? 0.0 : random.unit();
  const double period = random.between(0.01, 0.2);
  Eigen::VectorXd way(from.size());
  const auto turn = [&] {
    for (Eigen::Index j = 0; j < way.size(); ++j)
      way[j] = speed * terms.velocity[static_cast<std::size_t>(j)] * random.between(-1.0, 1.0);
  };
  turn();
  MotionChunk chunk;
  Configuration q = from;
  double time = taken + random.between(-1.5, 1.5);
  const int count = random.below(20) == 0 ? 2 + random.below(63) : 2 + random.below(7);
  for (int i = 0; i < count; ++i) {
    chunk.times.push_back(time);
    chunk.positions.push_back(q);
    const double step = period * random.between(0.5, 1.0);
    time += step;
    if (random.unit() < turning) turn();
    for (Eigen::Index j = 0; j < q.size(); ++j) {
      const Joint& joint = robot.joints[static_cast<std::size_t>(j)];
      q[j] = std::clamp(q[j] + way[j] * step, joint.lower, joint.upper);
    }
  }
  return chunk;
}

/// One thing that a program must not do, or may hardly do.
void spoil(MotionChunk& chunk, const Robot& robot, Random& random) {
  const auto any = [&] {
    return static_cast<std::size_t>(random.below(static_cast<int>(chunk.times.size())));
  };
  const auto joint = [&] { return static_cast<Eigen::Index>(random.below(static_cast<int>(robot.dof()))); };
  const double odd[] = {nan,    infinity, -infinity, 1e308,   -1e308, 1e17,
                        1e-320, 0.0,      -0.0,      1e6 + 1, 3.0e5,  std::nextafter(1.0, 2.0)};
  const double value = odd[random.below(12)];
  const std::size_t at = any(), other = any();
  switch (random.below(16)) {
    case 0:
    case 1:
      chunk.positions[at][joint()] = value;
      break;
    case 2:
      chunk.times[at] = value;
      break;
    case 3:
      chunk.times[at] = chunk.times[other];
      break;
    case 4:
      std::swap(chunk.times[at], chunk.times[other]);
      break;
    case 5:
      std::swap(chunk.positions[at], chunk.positions[other]);
      break;
    case 6:  // elsewhere, by about the tolerance or much more
      for (Configuration& q : chunk.positions)
        q[joint()] += (random.below(2) == 0 ? 1.0 : -1.0) * tolerance * std::exp(random.between(-1.0, 6.0));
      break;
    case 7:
      chunk.positions.front()[joint()] += tolerance * random.between(-3.0, 3.0);
      break;
    case 8: {  // about a joint limit
      const auto j = joint();
      const Joint& limited = robot.joints[static_cast<std::size_t>(j)];
      const double limit = random.below(2) == 0 ? limited.lower : limited.upper;
      const double farther = limit * (1.0 + (random.below(2) == 0 ? 3e-7 : -3e-7));
      const double next = std::nextafter(limit, random.below(2) == 0 ? -infinity : infinity);
      chunk.positions[at][j] = random.below(2) == 0 ? farther : next;
      break;
    }
    case 9:  // faster, evenly
      for (double& time : chunk.times)
        time = chunk.times.front() + (time - chunk.times.front()) / std::exp(random.between(-0.5, 2.0));
      std::sort(chunk.times.begin(), chunk.times.end());
      break;
    case 10:  // an old map, or a clock of its own
      for (double& time : chunk.times) time += random.between(-6.0, 6.0);
      std::sort(chunk.times.begin(), chunk.times.end());
      break;
    case 11: {
      const Eigen::Index size = random.below(12);
      chunk.positions[at] = Eigen::VectorXd::Zero(size);
      break;
    }
    case 12:
      if (random.below(2) == 0) chunk.times.pop_back();
      if (random.below(2) == 0) chunk.positions.pop_back();
      break;
    case 13:  // too many
      while (chunk.times.size() < 65 && chunk.times.size() == chunk.positions.size()) {
        chunk.times.push_back(chunk.times.back() + 0.01);
        chunk.positions.push_back(chunk.positions.back());
      }
      break;
    case 14:  // ends in a moment that stands still
      chunk.times.push_back(std::nextafter(chunk.times.back(), infinity));
      chunk.positions.push_back(chunk.positions.back());
      break;
    default:  // a waypoint anywhere
      chunk.positions[at] = random.configuration(robot);
      if (random.below(2) == 0)
        for (std::size_t i = at; i < chunk.times.size(); ++i) chunk.times[i] += 10.0;
  }
}

/// What single precision took beyond a limit is at it.
double at_limit(double value, const Joint& joint) {
  for (const double limit : {joint.lower, joint.upper})
    if (std::abs(value - limit) <= std::abs(limit) / 8388608.0)
      return std::clamp(value, joint.lower, joint.upper);
  return value;
}

MotionChunk at_limits(MotionChunk chunk, const Robot& robot) {
  for (Configuration& q : chunk.positions)
    for (std::size_t j = 0; j < robot.dof() && q.size() == static_cast<Eigen::Index>(robot.dof()); ++j)
      q[static_cast<Eigen::Index>(j)] = at_limit(q[static_cast<Eigen::Index>(j)], robot.joints[j]);
  return chunk;
}

/// Why a chunk must not pass whatever the map says, by rules written down once more; empty: it may.
std::string forbidden(const MotionChunk& chunk, const Robot& robot, const Terms& terms,
                      const std::vector<Configuration>& places) {
  if (chunk.positions.size() < 2 || chunk.positions.size() > 64) return "number of configurations";
  if (chunk.positions.size() != chunk.times.size()) return "number of times";
  for (std::size_t i = 0; i < chunk.times.size(); ++i) {
    if (!(std::abs(chunk.times[i]) <= 1e300)) return "a time is not finite";
    if (chunk.positions[i].size() != static_cast<Eigen::Index>(robot.dof())) return "size of a configuration";
    for (std::size_t j = 0; j < robot.dof(); ++j) {
      const double value = chunk.positions[i][static_cast<Eigen::Index>(j)];
      if (!(value >= robot.joints[j].lower && value <= robot.joints[j].upper)) return "a joint limit";
      if (!(std::abs(value) <= 1e6)) return "a value too large";
      if (i == 0) continue;
      const double time = chunk.times[i] - chunk.times[i - 1];
      if (!(time > 0.0)) return "order of times";
      const double way = std::abs(value - chunk.positions[i - 1][static_cast<Eigen::Index>(j)]);
      const double own = robot.joints[j].max_velocity > 0.0 ? robot.joints[j].max_velocity : infinity;
      if (way > std::min(own, terms.velocity[j]) * time * (1.0 + 1e-6)) return "a velocity";
    }
  }
  if (chunk.times.back() - chunk.times.front() > 60.0) return "a duration";
  if (terms.ages && !(std::abs(chunk.times.front() - taken) <= max_age)) return "an old map";
  const bool is_there = std::any_of(places.begin(), places.end(), [&](const Configuration& place) {
    return ((place - chunk.positions.front()).array().abs() <= tolerance).all();
  });
  return places.empty() || is_there ? "" : "a jump";
}

/// Whether the joints would have to change their rates by more than they can.
bool is_corner(const MotionChunk& chunk, std::size_t at, const Terms& terms) {
  const Eigen::VectorXd change = rate(chunk, at) - rate(chunk, at - 1);
  const double time = std::min(chunk.times[at] - chunk.times[at - 1], chunk.times[at + 1] - chunk.times[at]);
  for (Eigen::Index j = 0; j < change.size(); ++j)
    if (std::abs(change[j]) > terms.deceleration[static_cast<std::size_t>(j)] * time * (1.0 + 1e-6) + 1e-9)
      return true;
  return false;
}

/// All that a robot may do that is asked to run a chunk and must stop: there and back.
void append_motion(const MotionChunk& chunk, const Terms& terms, std::vector<Configuration>& path) {
  for (std::size_t i = 0; i < chunk.positions.size(); ++i) {
    const Configuration& q = chunk.positions[i];
    path.push_back(q);
    if (i == 0 || (i + 1 < chunk.positions.size() && !is_corner(chunk, i, terms))) continue;
    path.push_back(q + coasting(terms, rate(chunk, i - 1)));
    path.push_back(q);
  }
}

/// A robot that wanders from a free place, in one drawn world.
class Wanderer {
 public:
  Wanderer(std::uint64_t seed, std::uint64_t world)
      : world_(world % 2 == 0 ? draw_world(seed * 1000003 + world)
                              : draw_world_that_ends(seed * 1000003 + world)),
        random_(seed * 0x2545f4914f6cdd1dULL + world),
        terms_(draw_terms(robot(), random_)),
        gate_(options_of(terms_)) {
    Policies policies{.parts = world_.space->policies(), .critical_by_default = false};
    gate_.publish({robot(), world_.space->map(), policies, world_.space->options()}, taken);
  }

  GateEvidence run(std::uint64_t count) {
    for (std::uint64_t i = 0; i < count; ++i) {
      if (i % 100 == 0) start_anew();
      ask(i);
    }
    put_to_check();
    return std::move(evidence_);
  }

 private:
  const Robot& robot() const { return world_.space->robot(); }
  bool is_valid(const std::vector<Configuration>& path, double more, std::string* why = nullptr) const {
    const ConfigurationSpace& space = *world_.space;
    const PathVerdict verdict =
        check_path(robot(), space.map(), space.policies(), space.options().padding + more, path);
    if (why != nullptr) *why = (verdict.undecided ? "undecided: " : "") + verdict.first_contact;
    return verdict.valid;
  }

  /// Why `check` refuses a plan of that path for where it leads.
  std::optional<std::string> survey(const std::vector<Configuration>& path) const {
    const ConfigurationSpace& space = *world_.space;
    const bool may_leave = std::any_of(space.policies().begin(), space.policies().end(),
                                       [](const auto& part) { return part.second == Policy::not_occupied; });
    if (!may_leave) return std::nullopt;  // a survey takes time
    return refusal(survey_path(robot(), space.map(), space.policies(), path), terms_.demands);
  }

  void start_anew() {
    put_to_check();
    at_ = random_.configuration(robot());
    for (int i = 0; i < 200 && !world_.space->is_free(at_); ++i) at_ = random_.configuration(robot());
    places_.clear();
    gate_.restart();
  }

  void ask(std::uint64_t number) {
    MotionChunk chunk = wander(*world_.space, terms_, at_, random_);
    const bool is_hostile = random_.below(10) < 7;
    if (is_hostile) spoil(chunk, robot(), random_);
    const bool is_whole = chunk.times.size() == chunk.positions.size() &&
                          std::all_of(chunk.positions.begin(), chunk.positions.end(),
                                      [&](const Configuration& q) { return q.size() == at_.size(); });
    if (is_hostile && is_whole && !chunk.times.empty() && random_.below(4) == 0)
      spoil(chunk, robot(), random_);
    ++evidence_.asked;
    evidence_.hostile += is_hostile;
    const GateVerdict verdict = gate_.judge(chunk);
    chunk = at_limits(std::move(chunk), robot());
    const std::string rule = forbidden(chunk, robot(), terms_, places_);
    if (verdict.is_passed()) {
      if (!rule.empty())
        evidence_.broken.push_back(world_.what + ", chunk " + std::to_string(number) +
                                   ": passed in spite of " + rule);
      else
        remember(chunk);
    } else {
      ++evidence_.refused[std::string(to_string(verdict.reason))];
    }
    if (number % 10 == 0 && rule.empty()) weigh(chunk, verdict);
  }

  void remember(const MotionChunk& chunk) {
    ++evidence_.passed;
    const auto distance = [&](const Configuration& place) {
      return (place - chunk.positions.front()).cwiseAbs().maxCoeff();
    };
    const auto nearest = std::min_element(places_.begin(), places_.end(), [&](const auto& a, const auto& b) {
      return distance(a) < distance(b);
    });
    if (nearest != places_.end()) path_.push_back(*nearest);
    append_motion(chunk, terms_, path_);
    const Configuration& end = chunk.positions.back();
    const Configuration stop = end + coasting(terms_, rate(chunk, chunk.positions.size() - 2));
    places_ = {end, stop};
    at_ = random_.below(2) == 0 ? end : stop;
  }

  void put_to_check() {
    std::string why;
    if (path_.size() > 1) {
      evidence_.checked_edges += path_.size() - 1;
      if (!is_valid(path_, 0.0, &why)) evidence_.broken.push_back(world_.what + ": passed, but " + why);
      if (const auto refused = survey(path_))
        evidence_.broken.push_back(world_.what + ": passed, but " + *refused);
    }
    path_.clear();
  }

  /// Was a chunk refused that is farther from everything than braking moves it?
  void weigh(const MotionChunk& chunk, const GateVerdict& verdict) {
    double braking = 0.0;
    for (std::size_t i = 0; i + 1 < chunk.positions.size(); ++i) {
      const Configuration way = coasting(terms_, rate(chunk, i));
      braking = std::max(braking, world_.space->motion_bound(way.cwiseAbs()));
      if (!limit_violation(robot(), chunk.positions[i + 1] + way).empty()) return;  // no voxel's business
    }
    std::vector<Configuration> path;
    append_motion(chunk, terms_, path);
    if (!is_valid(chunk.positions, braking) || survey(path)) return;
    ++evidence_.clear;
    if (!verdict.is_passed()) ++evidence_.clear_but_refused[std::string(to_string(verdict.reason))];
  }

  DrawnWorld world_;
  Random random_;
  Terms terms_;
  Gate gate_;
  Configuration at_;                   ///< where the next chunk starts
  std::vector<Configuration> places_;  ///< where it may
  std::vector<Configuration> path_;    ///< what was passed since it started anew
  GateEvidence evidence_;
};

}  // namespace

void GateEvidence::add(const GateEvidence& other) {
  asked += other.asked;
  hostile += other.hostile;
  passed += other.passed;
  checked_edges += other.checked_edges;
  clear += other.clear;
  for (const auto& [reason, count] : other.refused) refused[reason] += count;
  for (const auto& [reason, count] : other.clear_but_refused) clear_but_refused[reason] += count;
  broken.insert(broken.end(), other.broken.begin(), other.broken.end());
}

GateEvidence judge_chunks(std::uint64_t seed, std::uint64_t world, std::uint64_t count) {
  return Wanderer(seed, world).run(count);
}

}  // namespace clearway::evidence

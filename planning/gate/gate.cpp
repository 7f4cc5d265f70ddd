#include "planning/gate/gate.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "mapping/system/require.hpp"
#include "planning/gate/motion_proof.hpp"

namespace clearway {

struct Gate::Map {
  ProofSpace proof;
  double taken;  ///< seconds
  std::shared_ptr<const Provenance> history;
  JointLimits limits;
  std::uint64_t number;
};

namespace {

/// What single precision took beyond a limit is at it.
Configuration at_limits(const Robot& robot, Configuration q) {
  const auto drawn = drawn_to_limits({{}, {q}}, robot);
  return drawn ? drawn->positions.front() : q;
}

/// The largest difference of a joint.
double gap(const Configuration& a, const Configuration& b) { return (a - b).cwiseAbs().maxCoeff(); }

/// Where the robot is, of the places where it may be.
const Configuration& nearest_of(const std::vector<Configuration>& places, const Configuration& q) {
  return *std::min_element(places.begin(), places.end(), [&](const Configuration& a, const Configuration& b) {
    return gap(a, q) < gap(b, q);
  });
}

bool has_same_joints(const Robot& a, const Robot& b) {
  return std::equal(
      a.joints.begin(), a.joints.end(), b.joints.begin(), b.joints.end(),
      [](const Joint& one, const Joint& other) { return one.name == other.name && one.kind == other.kind; });
}

/// @param where the robot is, as "where the last passed motion ends"
std::string jump_sentence(const Robot& robot, const Configuration& from, const Configuration& to,
                          double tolerance, const std::string& where) {
  Eigen::Index worst = 0;
  (to - from).cwiseAbs().maxCoeff(&worst);
  return "positions[0] is not where the robot is: joint " +
         shortened(robot.joints[static_cast<std::size_t>(worst)].name) + " is " + short_text(to[worst], 6) +
         ", " + where + " it is " + short_text(from[worst], 6) + ", expected within " +
         short_text(tolerance) + " (rad or m)";
}

/// Where a chunk seems to go on from within the last passed one; empty: nowhere.
std::string leaving_hint(const std::vector<Configuration>& passed, const Configuration& first,
                         double tolerance) {
  for (std::size_t i = 0; i < passed.size(); ++i)
    if (gap(passed[i], first) <= tolerance)
      return "; it is where configuration " + std::to_string(i) +
             " of that is: leaves_at says that the robot leaves it there";
  return {};
}

std::string no_such_place(std::size_t leaves_at, std::size_t passed) {
  return "leaves_at is " + std::to_string(leaves_at) + ", but " +
         (passed == 0 ? "no chunk was passed before"
                      : "the last passed chunk has " + counted(passed, "configuration"));
}

/// What a jump is compared with.
std::string where_it_is(const MotionChunk& passed, const std::optional<std::size_t>& leaves_at) {
  if (leaves_at) return "at leaves_at, " + std::to_string(*leaves_at) + ",";
  return passed.positions.empty() ? "where the robot was said to start" : "where the last passed motion ends";
}

std::string stale_sentence(double age, double max_age) {
  return age > 0.0
             ? "the newest map is " + short_text(age) + " s older than the chunk, expected at most " +
                   short_text(max_age) + " s"
             : "the newest map is " + short_text(-age) + " s younger than the chunk, expected at most " +
                   short_text(max_age) + " s: are their clocks one?";
}

GateReason reason_of(Obstruction obstruction) {
  switch (obstruction) {
    case Obstruction::none:
      return GateReason::not_proved;
    case Obstruction::not_finite:
      return GateReason::not_finite;
    case Obstruction::joint_limit:
      return GateReason::joint_limit;
    case Obstruction::self_collision:
      return GateReason::self_collision;
    default:
      return GateReason::blocked;
  }
}

/// Empty, or which joint opens or closes while it holds a load. @param before where it held it; none:
/// anywhere
std::string lost_grip(const Robot& robot, const MotionChunk& chunk,
                      const std::optional<Configuration>& before, double tolerance) {
  const Configuration& first = chunk.positions.front();
  for (const Configuration& q : chunk.positions)
    if (std::string moved = grip_violation(robot, first, q); !moved.empty()) return moved;
  if (!before) return {};
  for (const Load& load : robot.loads)
    for (const int j : grip_joints(robot, load))
      if (std::abs(first[j] - (*before)[j]) > tolerance) return grip_violation(robot, *before, first);
  return {};
}

std::string obstruction_sentence(const Verdict& verdict) {
  if (!verdict.is_free()) return verdict.sentence();
  const std::string part = verdict.part.empty() ? "the robot" : shortened(verdict.part);
  return part + " comes too near to " +
         (verdict.point.allFinite() ? "a blocked voxel" : "something or to another part") +
         " to be proved free";
}

std::string leaving_sentence(const LeavingPart& leaving) {
  return (leaving.distance > 0.0
              ? to_text(leaving)
              : leaving.part + " comes too near to leaving the map's bounds to be proved inside") +
         why_refused_outside(leaving.part);
}

/// What stopped the proof, and how far the motion may go.
void explain(const ProofSpace& proof, const Provenance* history, const JointLimits& limits,
             const MotionChunk& chunk, const StraightPiece& piece, GateVerdict& verdict) {
  const ProofEnd end = find_proof_end(proof, piece);
  verdict.reason = end.leaving ? GateReason::outside_map : reason_of(end.obstruction.obstruction);
  verdict.piece = piece.name;
  verdict.parameter = end.parameter;
  verdict.obstruction = end.obstruction;
  if (end.leaving) verdict.obstruction.part = end.leaving->part;
  verdict.sentence = to_text(piece.name) + ": " +
                     (end.leaving ? leaving_sentence(*end.leaving) : obstruction_sentence(end.obstruction));
  const bool has_voxel = verdict.reason == GateReason::blocked || verdict.reason == GateReason::not_proved;
  if (has_voxel && end.obstruction.point.allFinite()) {
    verdict.evidence = evidence_of(proof.space.map(), history, end.obstruction.point);
    verdict.sentence += "; " + verdict.evidence->sentence();
  }
  verdict.may_go = proved_part(proof, chunk, limits, piece.name);
}

}  // namespace

Gate::Gate(GateOptions options) : options_(std::move(options)) {
  require(options_.tolerance >= 0.0 && std::isfinite(options_.tolerance),
          "gate: tolerance is " + short_text(options_.tolerance) + ", expected a finite number not below 0");
  require(options_.max_age > 0.0,
          "gate: max_age is " + short_text(options_.max_age) + ", expected seconds above 0");
  require_limits(options_.limits);
  require(!options_.start || options_.start->allFinite(), "gate: start has a value that is not finite");
  restart(options_.start);
}

Gate::~Gate() = default;

void Gate::restart(std::optional<Configuration> start) {
  if (const std::shared_ptr<const Map> map = maps_.get(); map != nullptr && start) {
    start = at_limits(map->proof.space.robot(), *std::move(start));
    const std::string violation = limit_violation(map->proof.space.robot(), *start);
    require(violation.empty(), "gate: start: " + violation);
  }
  standing_.clear();
  passed_ = {};
  gripped_ = start;
  if (start) standing_.push_back(std::move(*start));
}

std::uint64_t Gate::publish(ConfigurationSpace space, double taken,
                            std::shared_ptr<const Provenance> history) {
  const JointLimits limits = joint_limits(space.robot(), options_.limits);
  if (options_.start) {
    const std::string violation = limit_violation(space.robot(), at_limits(space.robot(), *options_.start));
    require(violation.empty(), "gate: start: " + violation);
  }
  require(options_.max_age == std::numeric_limits<double>::infinity() || std::isfinite(taken),
          "gate: expected the time at which the map was taken, because max_age asks for it");
  const std::shared_ptr<const Map> before = maps_.get();
  require(before == nullptr || has_same_joints(before->proof.space.robot(), space.robot()),
          "gate: expected a robot with the joints of that of the map before, in their order");
  space.renew();
  BoundsProof bounds(space, options_.allow_outside);
  maps_.publish(std::make_shared<const Map>(
      Map{{std::move(space), std::move(bounds)}, taken, std::move(history), limits, published_ + 1}));
  return ++published_;
}

GateVerdict Gate::judge(const MotionChunk& chunk, std::optional<std::size_t> leaves_at) {
  const std::shared_ptr<const Map> map = maps_.get();
  if (map == nullptr) return {.reason = GateReason::no_map, .sentence = "no map has come yet"};
  const std::optional<MotionChunk> drawn = drawn_to_limits(chunk, map->proof.space.robot());
  return judge_on(*map, drawn ? *drawn : chunk, leaves_at);
}

std::vector<Configuration> Gate::places_for(const Map& map, const MotionChunk& chunk,
                                            std::optional<std::size_t> leaves_at) const {
  const Robot& robot = map.proof.space.robot();
  const Configuration& first = chunk.positions.front();
  std::vector<Configuration> places;
  const auto add = [&](const Configuration& place) {
    require(place.size() == first.size(), "gate: start: " + limit_violation(robot, place));
    places.push_back(by_whole_turns(robot, place, first));
  };
  if (leaves_at)
    add(passed_.positions[*leaves_at]);
  else
    std::for_each(standing_.begin(), standing_.end(), add);
  return places;
}

GateVerdict Gate::judge_on(const Map& map, const MotionChunk& chunk, std::optional<std::size_t> leaves_at) {
  GateVerdict verdict;
  const auto refused = [&](GateReason reason, std::string sentence) {
    verdict.reason = reason;
    verdict.sentence = std::move(sentence);
    return verdict;
  };
  verdict.map = map.number;
  const Robot& robot = map.proof.space.robot();
  if (ChunkFault fault = find_fault(chunk, robot, map.limits); fault.reason != GateReason::none)
    return refused(fault.reason, std::move(fault.sentence));
  const double age = chunk.times.front() - map.taken;
  if (options_.max_age != std::numeric_limits<double>::infinity() && !(std::abs(age) <= options_.max_age))
    return refused(GateReason::stale_map, stale_sentence(age, options_.max_age));
  const Configuration& first = chunk.positions.front();
  if (leaves_at && *leaves_at >= passed_.positions.size())
    return refused(GateReason::jump, no_such_place(*leaves_at, passed_.positions.size()));
  const std::vector<Configuration> places = places_for(map, chunk, leaves_at);
  std::vector<Configuration> standing;  // nobody says which of them it is
  std::copy_if(places.begin(), places.end(), std::back_inserter(standing),
               [&](const Configuration& place) { return gap(place, first) <= options_.tolerance; });
  if (!places.empty() && standing.empty())
    return refused(GateReason::jump,
                   jump_sentence(robot, nearest_of(places, first), first, options_.tolerance,
                                 where_it_is(passed_, leaves_at)) +
                       (leaves_at ? "" : leaving_hint(passed_.positions, first, options_.tolerance)));

  if (const std::string lost = lost_grip(robot, chunk, gripped_, options_.tolerance); !lost.empty())
    return refused(GateReason::joint_limit, lost);
  std::vector<StraightPiece> pieces = straight_pieces(chunk, map.limits, standing);
  if (leaves_at) {
    const Configuration& place = passed_.positions[*leaves_at];
    if (const auto stop = stop_at_leaving(passed_, *leaves_at, chunk, map.limits))
      pieces.insert(pieces.begin(), {{MotionPiece::Kind::braking, 0}, place, *stop});
  }
  const std::size_t unproved = first_unproved(map.proof, pieces);
  if (unproved < pieces.size()) {
    explain(map.proof, map.history.get(), map.limits, chunk, pieces[unproved], verdict);
    return verdict;
  }
  const Configuration& end = chunk.positions.back();
  const Configuration stop = stop_from(end, edge_velocity(chunk, chunk.positions.size() - 2), map.limits);
  verdict.may_go = ProvedPart{chunk.times.back(), end, stop};
  standing_.assign({end, stop});
  passed_ = chunk;
  if (!gripped_) gripped_ = first;
  return verdict;
}

}  // namespace clearway

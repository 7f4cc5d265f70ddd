#include "planning/check/spline_check.hpp"

#include <algorithm>
#include <cmath>
#include <locale>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/path/bezier.hpp"

namespace clearway {
namespace {

constexpr double excess = 1e-6;               ///< share of a limit that rounding may take
constexpr double single_precision = 0x1p-24;  ///< of positions that were learned or sent with it
constexpr double text_digit = 1e-9;           ///< rad, m, s and their quotients: twice what rounding takes
constexpr double most_rounding = 0.01;        ///< of a limit, however short the time between two points
constexpr double rounded_away = 1e-9;         ///< rad or m: of positions
constexpr double wide_tube = 5e-4, narrow_tube = 5e-5;  ///< rad or m of a joint
constexpr std::size_t most_tubes = 200'000;
constexpr double narrowest = 0x1p-30;  ///< share of an edge's time

/// A part of an edge's curve in a tube about its chord.
struct Span {
  Bezier curve;
  std::size_t edge = 0;
  double from = 0.0, to = 1.0;  ///< shares of the edge's time
};

/// Chords, how far the curve leaves each, and where each begins and ends.
struct Tubes {
  std::vector<Configuration> chords;
  std::vector<Eigen::VectorXd> deviations;
  std::vector<std::pair<const Span*, const Span*>> spans;  ///< first and last, of each chord
};

void require_points(const Robot& robot, const std::vector<SplinePoint>& points) {
  const auto refuse = [](std::size_t i, const std::string& what) {
    throw std::invalid_argument("point " + std::to_string(i) + " of the trajectory: " + what);
  };
  if (points.empty()) throw std::invalid_argument("the trajectory has no points, expected at least one");
  const auto dof = static_cast<Eigen::Index>(robot.dof());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const SplinePoint& point = points[i];
    const auto fits = [&](const Eigen::VectorXd& values) {
      return values.size() == dof && values.allFinite();
    };
    const std::string expected = ", expected " + std::to_string(dof) + " finite values";
    if (!fits(point.position)) refuse(i, "its position is none" + expected);
    if (point.velocity.size() != 0 && !fits(point.velocity)) refuse(i, "its velocity is none" + expected);
    if (point.acceleration.size() != 0 && !fits(point.acceleration))
      refuse(i, "its acceleration is none" + expected);
    if (point.acceleration.size() != 0 && point.velocity.size() == 0)
      refuse(i, "it has an acceleration without a velocity, expected both");
    if (!std::isfinite(point.time) || (i > 0 && !(point.time > points[i - 1].time)))
      refuse(i, "its time is not above that of the point before");
  }
}

Bezier curve_between(const SplinePoint& from, const SplinePoint& to) {
  const double h = to.time - from.time;
  const BezierEnd begin{from.position, from.velocity, from.acceleration},
      end{to.position, to.velocity, to.acceleration};
  if (from.velocity.size() == 0 || to.velocity.size() == 0)
    return linear_between(from.position, to.position, h);
  const bool has_accelerations = from.acceleration.size() > 0 && to.acceleration.size() > 0;
  return has_accelerations ? quintic_between(begin, end, h) : cubic_between(begin, end, h);
}

/// The share of its time at which a curve has first gone so far along a chord; none: it does not.
std::optional<double> first_reach(const Bezier& curve, const Configuration& from, const Eigen::VectorXd& step,
                                  double parameter, double width = 1.0) {
  const double wanted = parameter * step.squaredNorm();
  const auto is_beyond = [&](const Eigen::VectorXd& q) { return step.dot(q - from) >= wanted; };
  if (is_beyond(curve.control.front())) return 0.0;
  if (std::none_of(curve.control.begin(), curve.control.end(), is_beyond)) return std::nullopt;
  if (width < narrowest) return is_beyond(curve.control.back()) ? std::optional(1.0) : std::nullopt;
  const auto [first, second] = halves(curve);
  if (const auto reached = first_reach(first, from, step, parameter, width / 2.0)) return *reached / 2.0;
  const auto reached = first_reach(second, from, step, parameter, width / 2.0);
  return reached ? std::optional(0.5 + *reached / 2.0) : std::nullopt;
}

class SplineChecker {
 public:
  SplineChecker(const Robot& robot, const std::vector<SplinePoint>& points) : robot_(robot), points_(points) {
    for (std::size_t edge = 0; edge + 1 < points.size(); ++edge) curves_.push_back(curve_of(edge));
  }

  SplineVerdict& verdict() { return verdict_; }

  void require_rates() {
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (controls_at(i) >= 4) compare_stated("velocity", i, points_[i].velocity, &Joint::max_velocity);
      if (controls_at(i) >= 6)
        compare_stated("acceleration", i, points_[i].acceleration, &Joint::max_acceleration);
    }
    for (std::size_t edge = 0; edge < curves_.size(); ++edge) {
      const Bezier velocity = derivative(curves_[edge]);
      const double h = velocity.duration;
      for (std::size_t j = 0; j < robot_.dof(); ++j) {
        const double limit = robot_.joints[j].max_velocity;
        const auto at = static_cast<Eigen::Index>(j);
        const double places = std::abs(points_[edge].position[at]) + std::abs(points_[edge + 1].position[at]);
        compare("velocity", edge, j, velocity, limit,
                (text_digit * (limit + 3.0) + single_precision * places) / h, verdict_.velocity_share,
                verdict_.free_velocity);
      }
      if (curves_[edge].control.size() == 2) continue;
      const Bezier acceleration = derivative(velocity);
      for (std::size_t j = 0; j < robot_.dof(); ++j) {
        const double limit = robot_.joints[j].max_acceleration;
        compare("acceleration", edge, j, acceleration, limit, text_digit * (2.0 * limit + 12.0 / h) / h,
                verdict_.acceleration_share, verdict_.free_acceleration);
      }
      const Bezier jerk = derivative(acceleration);
      for (std::size_t j = 0; j < robot_.dof(); ++j)
        raise(verdict_.jerk, peak_at(edge, j, peak(jerk, static_cast<Eigen::Index>(j))));
    }
  }

  /// The curve stays within the joint limits: where a control point does not, it is looked at itself.
  bool is_within_limits() {
    for (std::size_t edge = 0; edge < curves_.size(); ++edge)
      for (std::size_t j = 0; j < robot_.dof(); ++j)
        if (!is_within_limits(edge, j)) return false;
    return points_.size() > 1 || is_lone_point_within_limits();
  }

  void prove(const Snapshot& map, const std::map<std::string, Policy>& policies, double padding,
             double seen_within) {
    for (const double width : {wide_tube, narrow_tube}) {
      const std::vector<Span> spans = spans_of(width);
      const Tubes tubes = tubes_of(spans, width == wide_tube ? 4096 : 1, width);
      verdict_.path =
          check_tubes(robot_, map, policies, padding, tubes.chords, tubes.deviations, 0.0, seen_within);
      if (verdict_.chords.empty()) verdict_.chords = tubes.chords;
      verdict_.path.clearance.clear();
      if (verdict_.path.valid) return;
      place_contact(tubes);
    }
  }

 private:
  Bezier curve_of(std::size_t edge) {
    Bezier curve = curve_between(points_[edge], points_[edge + 1]);
    const std::size_t controls = curve.control.size();
    ++(controls == 2 ? verdict_.lines : controls == 4 ? verdict_.cubics : verdict_.quintics);
    return curve;
  }

  /// "edge 3, 1.25 s after the start: "
  std::string at(std::size_t edge, double share) const {
    std::ostringstream text;
    text.imbue(std::locale::classic());
    const double begin = points_[edge].time;
    const double length = edge + 1 < points_.size() ? points_[edge + 1].time - begin : 0.0;
    text << "edge " << edge << ", " << begin + share * length << " s after the start: ";
    return text.str();
  }

  RatePeak peak_at(std::size_t edge, std::size_t j, const BezierPeak& found) const {
    const double h = points_[edge + 1].time - points_[edge].time;
    return {std::abs(found.value), j, points_[edge].time + found.share * h, {}};
  }

  /// @param free of joints whose limit is not known
  void compare(const char* what, std::size_t edge, std::size_t j, const Bezier& rate, double limit,
               double rounding, std::optional<double>& share, std::optional<RatePeak>& free) {
    const BezierPeak found = peak(rate, static_cast<Eigen::Index>(j));
    if (!(limit > 0.0)) return raise(free, peak_at(edge, j, found));
    share = std::max(share.value_or(0.0), std::abs(found.value) / limit);
    if (std::abs(found.value) > limit * (1.0 + excess) + std::min(rounding, most_rounding * limit))
      refuse_rate(what, edge, found, j, limit);
  }

  /// Of the curves that begin or end at a point, the most control points: 4 of cubics, 6 of quintics.
  std::size_t controls_at(std::size_t point) const {
    std::size_t most = 0;
    if (point > 0) most = curves_[point - 1].control.size();
    if (point < curves_.size()) most = std::max(most, curves_[point].control.size());
    return most;
  }

  /// What the points state is not blurred by the time between them.
  void compare_stated(const char* what, std::size_t point, const Eigen::VectorXd& rates,
                      double Joint::*limit) {
    for (Eigen::Index j = 0; j < rates.size(); ++j) {
      const double most = robot_.joints[static_cast<std::size_t>(j)].*limit;
      if (!(most > 0.0) || std::abs(rates[j]) <= most * (1.0 + excess) + text_digit) continue;
      const std::size_t edge = std::min(point, std::max<std::size_t>(points_.size(), 2) - 2);
      refuse_rate(what, edge, {rates[j], point > edge ? 1.0 : 0.0}, static_cast<std::size_t>(j), most);
    }
  }

  void refuse_rate(const char* what, std::size_t edge, const BezierPeak& found, std::size_t j, double limit) {
    if (!verdict_.fault.empty()) return;
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text << "motion: " << at(edge, found.share) << "the " << what << " of joint "
         << shortened(robot_.joints[j].name) << " is " << found.value << ", its limit " << limit;
    verdict_.fault = text.str();
  }

  bool is_within_limits(std::size_t edge, std::size_t j) {
    const Joint& joint = robot_.joints[j];
    const auto at_joint = static_cast<Eigen::Index>(j);
    const std::vector<Eigen::VectorXd>& control = curves_[edge].control;
    const auto is_inside = [&](double value) {
      return value >= joint.lower - rounded_away && value <= joint.upper + rounded_away;
    };
    if (std::all_of(control.begin(), control.end(),
                    [&](const Eigen::VectorXd& point) { return is_inside(point[at_joint]); }))
      return true;
    for (const BezierPeak& found : {lowest(curves_[edge], at_joint), highest(curves_[edge], at_joint)})
      if (!is_inside(found.value)) return refuse_limits(edge, found, joint);
    return true;
  }

  bool is_lone_point_within_limits() {
    for (std::size_t j = 0; j < robot_.dof(); ++j) {
      const double value = points_.front().position[static_cast<Eigen::Index>(j)];
      if (value < robot_.joints[j].lower || value > robot_.joints[j].upper)
        return refuse_limits(0, {value, 0.0}, robot_.joints[j]);
    }
    return true;
  }

  bool refuse_limits(std::size_t edge, const BezierPeak& found, const Joint& joint) {
    std::ostringstream text;
    text.imbue(std::locale::classic());
    text << at(edge, found.share) << "joint " << shortened(joint.name) << " is "
         << text_beside(found.value, found.value > joint.upper ? joint.upper : joint.lower)
         << ", outside its limits " << joint.lower << " to " << joint.upper;
    verdict_.path.first_contact = text.str();
    verdict_.path.edge = static_cast<int>(edge);
    verdict_.path.parameter = found.share;
    return false;
  }

  Configuration inside_limits(const Configuration& q) const {
    Configuration inside = q;
    for (std::size_t j = 0; j < robot_.dof(); ++j) {
      double& value = inside[static_cast<Eigen::Index>(j)];
      value = std::clamp(value, robot_.joints[j].lower, robot_.joints[j].upper);
    }
    return inside;
  }

  /// How far control points of curves in a row leave the chord between their ends.
  Eigen::VectorXd tube_about(const Span* first, const Span* last) const {
    const Configuration from = inside_limits(first->curve.control.front());
    const Eigen::VectorXd step = inside_limits(last->curve.control.back()) - from;
    const double length = step.squaredNorm();
    Eigen::VectorXd widest = Eigen::VectorXd::Zero(step.size());
    for (const Span* span = first; span <= last; ++span)
      for (const Eigen::VectorXd& q : span->curve.control) {
        const double share = length > 0.0 ? std::clamp(step.dot(q - from) / length, 0.0, 1.0) : 0.0;
        widest = widest.cwiseMax((q - from - share * step).cwiseAbs());
      }
    return (widest.array() * (1.0 + 1e-9)).matrix();
  }

  /// The curves, cut until each is so near to its chord.
  std::vector<Span> spans_of(double width) const {
    std::vector<Span> spans, open;
    for (std::size_t edge = 0; edge < curves_.size(); ++edge) {
      open.push_back({curves_[edge], edge});
      while (!open.empty()) {
        Span span = std::move(open.back());
        open.pop_back();
        if (tube_about(&span, &span).maxCoeff() <= width) {
          spans.push_back(std::move(span));
          continue;
        }
        if (spans.size() >= most_tubes || span.to - span.from < narrowest)
          throw std::invalid_argument(
              "the trajectory swings so far between its points that more than 200000 straight pieces "
              "would be needed to check it");
        auto [first, second] = halves(span.curve);
        const double middle = 0.5 * (span.from + span.to);
        open.push_back({std::move(second), edge, middle, span.to});
        open.push_back({std::move(first), edge, span.from, middle});
      }
    }
    return spans;
  }

  /// One tube for several spans in a row where it stays narrow enough.
  Tubes tubes_of(const std::vector<Span>& spans, std::size_t most, double width) const {
    Tubes tubes{{inside_limits(points_.front().position)}, {}, {}};
    for (std::size_t begin = 0; begin < spans.size();) {
      std::size_t end = begin + 1;
      Eigen::VectorXd tube = tube_about(&spans[begin], &spans[begin]);
      for (std::size_t length = 2; length <= most && begin + length <= spans.size(); length *= 2) {
        const Eigen::VectorXd wider = tube_about(&spans[begin], &spans[begin + length - 1]);
        if (wider.maxCoeff() > width) break;
        end = begin + length;
        tube = wider;
      }
      tubes.chords.push_back(inside_limits(spans[end - 1].curve.control.back()));
      tubes.deviations.push_back(tube);
      tubes.spans.emplace_back(&spans[begin], &spans[end - 1]);
      begin = end;
    }
    if (tubes.deviations.empty())
      tubes.deviations.push_back(Eigen::VectorXd::Zero(tubes.chords.front().size()));
    return tubes;
  }

  /// Says of a contact on a chord when and on which edge of the trajectory it is.
  void place_contact(const Tubes& tubes) {
    PathVerdict& path = verdict_.path;
    const auto colon = path.first_contact.find(": ");
    if (path.edge < 0 || !path.first_contact.starts_with("edge ") || colon == std::string::npos) return;
    std::size_t edge = 0;
    double share = 0.0;
    if (!tubes.spans.empty()) {
      const auto chord = static_cast<std::size_t>(path.edge);
      const auto& [first, last] = tubes.spans[chord];
      const Configuration& from = tubes.chords[chord];
      const Eigen::VectorXd step = tubes.chords[chord + 1] - from;
      edge = last->edge;
      share = last->to;
      for (const Span* span = first; span <= last; ++span)
        if (const auto reached = first_reach(span->curve, from, step, path.parameter)) {
          edge = span->edge;
          share = span->from + *reached * (span->to - span->from);
          break;
        }
    }
    path.first_contact = at(edge, share) + path.first_contact.substr(colon + 2);
    path.edge = static_cast<int>(edge);
    path.parameter = share;
  }

  const Robot& robot_;
  const std::vector<SplinePoint>& points_;
  SplineVerdict verdict_;
  std::vector<Bezier> curves_;
};

}  // namespace

void raise(std::optional<RatePeak>& known, const std::optional<RatePeak>& other) {
  if (other && (!known || other->value > known->value)) known = other;
}

void raise_peaks(SplineVerdict& verdict, const SplineVerdict& other) {
  raise(verdict.free_velocity, other.free_velocity);
  raise(verdict.free_acceleration, other.free_acceleration);
  raise(verdict.jerk, other.jerk);
}

SplineVerdict check_splines(const Robot& robot, const Snapshot& map,
                            const std::map<std::string, Policy>& policies, double padding,
                            const std::vector<SplinePoint>& points, double seen_within) {
  require_points(robot, points);
  SplineChecker checker(robot, points);
  checker.require_rates();
  if (checker.is_within_limits()) checker.prove(map, policies, padding, seen_within);
  return checker.verdict();
}

std::vector<std::pair<double, MotionState>> spline_states(const std::vector<SplinePoint>& points) {
  constexpr double most = 1e6;
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(points.front().position.size());
  std::vector<std::pair<double, MotionState>> states;
  if (points.size() == 1)
    states.emplace_back(points.front().time, MotionState{points[0].position, rest, rest, {}});
  const double step = std::max(0.008, (points.back().time - points.front().time) / most);
  for (std::size_t edge = 0; edge + 1 < points.size(); ++edge) {
    const Bezier curve = curve_between(points[edge], points[edge + 1]);
    const Bezier velocity = derivative(curve), acceleration = derivative(velocity);
    const int pieces = std::max(8, static_cast<int>(std::ceil(curve.duration / step - 1e-9)));
    for (int i = 0; i <= pieces; ++i) {
      const double share = static_cast<double>(i) / pieces;
      states.emplace_back(
          points[edge].time + share * curve.duration,
          MotionState{value_at(curve, share), value_at(velocity, share), value_at(acceleration, share), {}});
    }
  }
  return states;
}

}  // namespace clearway

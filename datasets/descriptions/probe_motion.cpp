#include "datasets/descriptions/probe_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace clearway {
namespace {

/// Centripetal Catmull-Rom between b and c (Barry and Goldman's pyramid): passes through its points, has a
/// continuous tangent and makes no loops.
Eigen::Vector3d curve(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                      const Eigen::Vector3d& d, double part) {
  const double t1 = std::sqrt((b - a).norm()), t2 = t1 + std::sqrt((c - b).norm()),
               t3 = t2 + std::sqrt((d - c).norm());
  const double t = t1 + part * (t2 - t1);
  const auto mix = [t](const Eigen::Vector3d& p, double from, const Eigen::Vector3d& q, double to) {
    return Eigen::Vector3d(((to - t) * p + (t - from) * q) / (to - from));
  };
  const auto ab = mix(a, 0, b, t1), bc = mix(b, t1, c, t2), cd = mix(c, t2, d, t3);
  return mix(mix(ab, 0, bc, t2), t1, mix(bc, t1, cd, t3), t2);
}

constexpr int steps = 200;  // per waypoint: chords stay within 1e-5 of the curve's length
constexpr std::uint64_t tremor_stream = 7'200'000'000;
constexpr double same_place = 1e-6;  // m

bool is_timed(const SceneStroke& stroke) { return !stroke.speed && !stroke.duration; }

Eigen::Matrix3d turned(const Eigen::Vector3d& by) {
  return by.norm() > 0 ? Eigen::AngleAxisd(by.norm(), by.normalized()).toRotationMatrix()
                       : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
}

}  // namespace

ProbeMotion::ProbeMotion(const SceneStroke& stroke, const ProbeSetup& probe)
    : stroke_(stroke), tremor_(stroke.tremor, stroke.seed, tremor_stream), ball_center_(probe.ball_center) {
  const auto& points = stroke.waypoints;
  knots_.push_back({0, points[0].ball, 0});
  for (size_t i = 0; i + 1 < points.size(); ++i) {
    const Eigen::Vector3d &from = points[i].ball, &to = points[i + 1].ball;
    Eigen::Vector3d before = i > 0 ? points[i - 1].ball : Eigen::Vector3d(2 * from - to);
    Eigen::Vector3d after = i + 2 < points.size() ? points[i + 2].ball : Eigen::Vector3d(2 * to - from);
    if ((before - from).norm() < same_place) before = 2 * from - to;  // it rested there
    if ((after - to).norm() < same_place) after = 2 * to - from;
    const bool rests = (to - from).norm() < same_place;
    for (int step = 1; step <= steps; ++step) {
      const double part = static_cast<double>(step) / steps;
      const Eigen::Vector3d ball = rests || step == steps ? to : curve(before, from, to, after, part);
      knots_.push_back(
          {knots_.back().along + (ball - knots_.back().ball).norm(), ball, static_cast<double>(i) + part});
    }
  }
  duration_ = is_timed(stroke)  ? points.back().time
              : stroke.duration ? *stroke.duration
                                : length() / *stroke.speed;
}

double ProbeMotion::begin() const { return is_timed(stroke_) ? stroke_.waypoints.front().time : 0.0; }

/// Where the ball is on its way: at constant speed over all of it, or from each waypoint to the next.
ProbeMotion::Knot ProbeMotion::knot_at(double time) const {
  std::size_t first = 1, last = knots_.size() - 1;
  double share = std::clamp(time / duration_, 0.0, 1.0);
  if (is_timed(stroke_)) {
    const auto& points = stroke_.waypoints;
    std::size_t leg = 0;
    while (leg + 2 < points.size() && points[leg + 1].time < time) ++leg;
    share = std::clamp((time - points[leg].time) / (points[leg + 1].time - points[leg].time), 0.0, 1.0);
    first = leg * steps + 1;
    last = (leg + 1) * steps;
  }
  const Knot &begin = knots_[first - 1], &end = knots_[last];
  if (end.along - begin.along < same_place)
    return {begin.along, begin.ball, begin.waypoint + share * (end.waypoint - begin.waypoint)};
  const double along = begin.along + (end.along - begin.along) * share;
  const auto at = [&](std::size_t i) { return knots_.begin() + static_cast<std::ptrdiff_t>(i); };
  const auto after = std::lower_bound(at(first), at(last), along,
                                      [](const Knot& knot, double value) { return knot.along < value; });
  const Knot &to = *after, &from = *(after - 1);
  const double part = (along - from.along) / (to.along - from.along);
  return {along, (1 - part) * from.ball + part * to.ball,
          from.waypoint + part * (to.waypoint - from.waypoint)};
}

ProbeMotion::State ProbeMotion::at(double time) const {
  const Knot knot = knot_at(time);
  const std::size_t index = std::min(static_cast<std::size_t>(knot.waypoint), stroke_.waypoints.size() - 2);
  const double phase = 2 * std::numbers::pi * stroke_.wobble_hz * time;
  const Eigen::Vector3d sway = stroke_.wobble * Eigen::Vector3d(std::sin(phase), std::sin(0.73 * phase + 1),
                                                                std::sin(0.41 * phase + 2));
  const Eigen::Quaterniond turn = stroke_.waypoints[index].map_from_probe.slerp(
      knot.waypoint - static_cast<double>(index), stroke_.waypoints[index + 1].map_from_probe);
  State state;
  state.map_ball = knot.ball + tremor_.shift(time);
  state.map_from_probe = Eigen::Isometry3d::Identity();
  state.map_from_probe.linear() = turn.toRotationMatrix() * turned(sway) * turned(tremor_.turn(time));
  state.map_from_probe.translation() = state.map_ball - state.map_from_probe.linear() * ball_center_;
  return state;
}

}  // namespace clearway

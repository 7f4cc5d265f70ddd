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

}  // namespace

ProbeMotion::ProbeMotion(const SceneStroke& stroke, const ProbeSetup& probe)
    : stroke_(stroke), ball_center_(probe.ball_center) {
  const auto& points = stroke.waypoints;
  constexpr int steps = 200;  // per waypoint: chords stay within 1e-5 of the curve's length
  knots_.push_back({0, points[0].ball, 0});
  for (size_t i = 0; i + 1 < points.size(); ++i) {
    const Eigen::Vector3d &from = points[i].ball, &to = points[i + 1].ball;
    const Eigen::Vector3d before = i > 0 ? points[i - 1].ball : Eigen::Vector3d(2 * from - to);
    const Eigen::Vector3d after = i + 2 < points.size() ? points[i + 2].ball : Eigen::Vector3d(2 * to - from);
    for (int step = 1; step <= steps; ++step) {
      const double part = static_cast<double>(step) / steps;
      const Eigen::Vector3d ball = step == steps ? to : curve(before, from, to, after, part);
      knots_.push_back(
          {knots_.back().along + (ball - knots_.back().ball).norm(), ball, static_cast<double>(i) + part});
    }
  }
  duration_ = stroke.duration ? *stroke.duration : length() / *stroke.speed;
}

ProbeMotion::State ProbeMotion::at(double time) const {
  const double along = length() * std::clamp(time / duration_, 0.0, 1.0);
  auto after = std::lower_bound(knots_.begin() + 1, knots_.end() - 1, along,
                                [](const Knot& knot, double value) { return knot.along < value; });
  const Knot &to = *after, &from = *(after - 1);
  const double part = (along - from.along) / (to.along - from.along);
  const double waypoint = from.waypoint + part * (to.waypoint - from.waypoint);
  const size_t index = std::min(static_cast<size_t>(waypoint), stroke_.waypoints.size() - 2);

  const double phase = 2 * std::numbers::pi * stroke_.wobble_hz * time;
  const Eigen::Vector3d sway = stroke_.wobble * Eigen::Vector3d(std::sin(phase), std::sin(0.73 * phase + 1),
                                                                std::sin(0.41 * phase + 2));
  const Eigen::Quaterniond turn = stroke_.waypoints[index].map_from_probe.slerp(
      waypoint - static_cast<double>(index), stroke_.waypoints[index + 1].map_from_probe);
  State state;
  state.map_ball = (1 - part) * from.ball + part * to.ball;
  state.map_from_probe = Eigen::Isometry3d::Identity();
  state.map_from_probe.linear() =
      turn.toRotationMatrix() * (sway.norm() > 0
                                     ? Eigen::AngleAxisd(sway.norm(), sway.normalized()).toRotationMatrix()
                                     : Eigen::Matrix3d(Eigen::Matrix3d::Identity()));
  state.map_from_probe.translation() = state.map_ball - state.map_from_probe.linear() * ball_center_;
  return state;
}

}  // namespace clearway

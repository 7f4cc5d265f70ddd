#include "planning/check/pick_ways.hpp"

#include <algorithm>

#include "planning/check/path_check_shape.hpp"

namespace clearway::check {
namespace {

constexpr double least_sinking = 1e-4, most_sinking = 1e-3;  ///< m
constexpr double finest_advance = 1e-9;                      ///< of an edge

/// How far the body may be from where it is on a chord.
double aside(const KdlArm& arm, std::size_t body, const MotionTubes& curve, std::size_t i) {
  return curve.deviations.empty() ? 0.0 : arm.motion(body, curve.deviations[i]) * (1.0 + 1e-9);
}

/// Conservative advancement: on by less than the room there is above `low` and below `high`.
void require_height(const PickTerms& terms, const KdlArm& arm, std::size_t body, const Configuration& from,
                    const Configuration& to, double low, double high, PickTerms::Leg index) {
  const Eigen::VectorXd step = to - from;
  const double rate = arm.motion(body, step.cwiseAbs()) * (1.0 + 1e-9);
  for (double t = 0.0;;) {
    const double height = lowest(terms.shape, arm.place(from + t * step, body));
    const double room = std::min(height - low, high - height);
    if (!(room > 0.0))
      terms.refuse_on(index, ": the load leaves the height at which it may touch what it stands on");
    const double ahead = rate > 0.0 ? 0.9 * room / rate : 1.0;
    if (!(t + ahead < 1.0)) return;
    if (!(ahead > finest_advance))
      terms.refuse_on(index, ": cannot prove that the load stays above what it stands on");
    t += ahead;
  }
}

}  // namespace

void require_no_bow(const PickTerms& terms, PickTerms::Leg index, const Eigen::Vector3d& way,
                    const MotionTubes& curve) {
  const Robot carrying = terms.loaded();
  const KdlArm arm(carrying);
  const std::size_t body = carrying.bodies.size() - 1;
  const double length = way.norm(), most = same_tip * (2.0 + extent(terms.shape));
  const Eigen::Vector3d along = way / length;
  std::vector<Eigen::Vector3d> points;
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {1.0, -1.0})
      points.push_back(terms.shape.support(sign * Eigen::Vector3d::Unit(axis)));
  const std::vector<Configuration>& path = curve.chords;
  const Eigen::Isometry3d begin = arm.place(path.front(), body);
  const auto off = [&](const Eigen::Isometry3d& pose) {
    double farthest = 0.0;
    for (const Eigen::Vector3d& point : points) {
      const Eigen::Vector3d moved = pose * point - begin * point;
      const double on = moved.dot(along);
      farthest = std::max({farthest, (moved - on * along).norm(), -on, on - length});
    }
    return farthest;
  };
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    const Eigen::VectorXd step = path[i + 1] - path[i];
    const double rate = arm.motion(body, step.cwiseAbs()) * (1.0 + 1e-9);
    for (double t = 0.0;;) {
      const double room = most - off(arm.place(path[i] + t * step, body)) - aside(arm, body, curve, i);
      if (!(room > 0.0)) terms.refuse_on(index, " leaves its straight way between waypoints");
      const double ahead = rate > 0.0 ? 0.9 * room / rate : 1.0;
      if (!(t + ahead < 1.0)) break;
      if (!(ahead > finest_advance)) terms.refuse_on(index, ": cannot prove that its way is straight");
      t += ahead;
    }
  }
}

void require_heights(const PickTerms& terms, const Robot& carrying, const Eigen::Isometry3d& map_from_object,
                     PickTerms::Leg index, const MotionTubes& curve) {
  const double plane = lowest(terms.shape, map_from_object);
  const double contact = contact_length(terms.pick, terms.plan.map.resolution(), terms.padding);
  const double sinking = std::clamp(terms.padding, least_sinking, most_sinking);
  const KdlArm arm(carrying);
  const std::size_t body = carrying.bodies.size() - 1;
  for (std::size_t i = 0; i + 1 < curve.chords.size(); ++i) {
    const double off = aside(arm, body, curve, i);
    require_height(terms, arm, body, curve.chords[i], curve.chords[i + 1], plane - sinking + off,
                   plane + contact + sinking - off, index);
  }
}

}  // namespace clearway::check

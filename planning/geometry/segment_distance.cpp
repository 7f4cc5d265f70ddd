#include "planning/geometry/segment_distance.hpp"

#include <algorithm>
#include <array>

namespace clearway {

NearestPair segment_to_segment(const Eigen::Vector3d& a0, const Eigen::Vector3d& a1,
                               const Eigen::Vector3d& b0, const Eigen::Vector3d& b1) {
  const Eigen::Vector3d u = a1 - a0, v = b1 - b0, w = a0 - b0;
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v), uw = u.dot(w), vw = v.dot(w);
  NearestPair best{a0, b0, 1e300};
  const auto take = [&](double s, double t) {
    const Eigen::Vector3d a = a0 + s * u, b = b0 + t * v;
    const double distance = (a - b).norm();
    if (distance < best.distance) best = {a, b, distance};
  };
  const auto nearest_on = [](double numerator, double squared) {
    return squared > 0.0 ? std::clamp(numerator / squared, 0.0, 1.0) : 0.0;
  };
  take(0.0, nearest_on(vw, vv));  // the four ends against the other segment
  take(1.0, nearest_on(vw + uv, vv));
  take(nearest_on(-uw, uu), 0.0);
  take(nearest_on(uv - uw, uu), 1.0);
  const double determinant = uu * vv - uv * uv;
  if (determinant > 1e-14 * uu * vv) {  // and the inside of both, unless they are parallel
    const double s = std::clamp((uv * vw - vv * uw) / determinant, 0.0, 1.0);
    const double t = nearest_on(vw + s * uv, vv);
    take(s, t);
    take(nearest_on(t * uv - uw, uu), t);
  }
  return best;
}

NearestPair segment_to_box(const Eigen::Vector3d& a0, const Eigen::Vector3d& a1,
                           const Eigen::Vector3d& half) {
  const Eigen::Vector3d u = a1 - a0;
  // Half the derivative of the squared distance at parameter t; it never decreases with t.
  const auto slope = [&](double t) {
    double sum = 0.0;
    for (int i = 0; i < 3; ++i) {
      const double x = a0[i] + t * u[i];
      if (x > half[i]) sum += u[i] * (x - half[i]);
      if (x < -half[i]) sum += u[i] * (x + half[i]);
    }
    return sum;
  };
  double low = 0.0, high = 1.0;
  double slope_low = slope(low), slope_high = slope(high);
  double t = 0.0;
  if (slope_low >= 0.0) {
    t = 0.0;
  } else if (slope_high <= 0.0) {
    t = 1.0;
  } else {
    for (int i = 0; i < 3; ++i) {
      for (double plane : {-half[i], half[i]}) {
        const double crossing = (plane - a0[i]) / u[i];  // of one along the plane no number, or infinite
        if (!(crossing > low && crossing < high)) continue;
        const double value = slope(crossing);
        (value < 0.0 ? low : high) = crossing;
        (value < 0.0 ? slope_low : slope_high) = value;
      }
    }
    t = low + (high - low) * (slope_low / (slope_low - slope_high));  // linear between two crossings
  }
  const Eigen::Vector3d a = a0 + t * u;
  const Eigen::Vector3d b = a.cwiseMax(-half).cwiseMin(half);
  return {a, b, (a - b).norm()};
}

}  // namespace clearway

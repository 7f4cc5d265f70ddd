#include "apps/bench/worlds/noise_laws.hpp"

#include <cmath>

#include "datasets/descriptions/random_numbers.hpp"

namespace clearway::bench {
namespace {

constexpr double patch = 0.17;  ///< of multipath, radians

/// Smooth over the field of view, 0 to 1.
double patch_value(const RandomNumbers& numbers, const Eigen::Vector3d& at) {
  const double u = std::atan2(at.y(), at.x()) / patch + 64.0;
  const double v = std::atan2(at.z(), at.head<2>().norm()) / patch + 64.0;
  const double x = std::floor(u), y = std::floor(v);
  const auto corner = [&](double i, double j) {
    return numbers.uniform(static_cast<std::uint64_t>(i) * 1024 + static_cast<std::uint64_t>(j));
  };
  const double low = (x + 1 - u) * corner(x, y) + (u - x) * corner(x + 1, y);
  const double high = (x + 1 - u) * corner(x, y + 1) + (u - x) * corner(x + 1, y + 1);
  return (y + 1 - v) * low + (v - y) * high;
}

}  // namespace

std::vector<NoiseLaw> noise_laws(double pose_shift, double pose_turn) {
  const auto scaled = [&](double scale) {
    RoomErrors errors;
    errors.sequence = {.pose_shift = pose_shift, .pose_turn = pose_turn};
    errors.depth.range_scale = scale;
    return errors;
  };
  RoomErrors steps = scaled(0.0), flight = scaled(0.0);
  steps.depth.disparity_step = 0.25;
  steps.depth.flying = 1.0;
  flight.depth.disparity_step = 0.0;
  flight.depth.flying = 1.0;
  return {{"the assumed sigma", scaled(1.0)},
          {"half of it", scaled(0.5)},
          {"twice it", scaled(2.0)},
          {"steps of disparity, flying pixels", steps},
          {"time of flight with multipath", flight, true}};
}

void disturb(const NoiseLaw& law, std::size_t index, CloudFrame& frame) {
  if (!law.is_time_of_flight) return;
  const RandomNumbers numbers(11, 2 * index), patches(11, 2 * index + 1);
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    const Eigen::Vector3d at = frame.points[i].cast<double>();
    const double range = at.norm();
    if (!std::isfinite(range) || !(range > 0.0)) continue;
    const double sigma = (0.004 + 0.002 * range) * (numbers.uniform(4 * i + 2) < 0.02 ? 5.0 : 1.0);
    const double reported =
        range * (1.0 + 0.025 * std::pow(patch_value(patches, at), 2)) + sigma * numbers.gaussian(2 * i).first;
    frame.points[i] = (at * (std::max(reported, 0.05) / range)).cast<float>();
  }
}

}  // namespace clearway::bench

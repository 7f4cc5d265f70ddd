#include "planning/constraint/broad_phase.hpp"

#include <algorithm>

namespace clearway {
namespace {

/// Numbers that the widest registers hold.
constexpr std::size_t registers = 8;

}  // namespace

void BroadPhase::add(int link, const Sphere& bound, std::span<const Sphere> cover) {
  const auto first = static_cast<int>(spheres_.size()), count = static_cast<int>(cover.size());
  for (const Sphere& sphere : cover) spheres_.push_back({sphere, static_cast<int>(covers_.size())});
  covers_.push_back({link, bound, first, first + count});
  const std::size_t points = std::max(spheres_.size(), covers_.size()) + registers;
  sphere_of_.resize(points);
  for (std::vector<double>* vector : {&x_, &y_, &z_, &clearance_}) vector->resize(points);
  near_.reserve(spheres_.size());
}

void BroadPhase::put(std::size_t at, const Eigen::Isometry3d& pose, const Eigen::Vector3d& point) {
  const Eigen::Vector3d placed = pose.linear().lazyProduct(point) + pose.translation();
  x_[at] = placed.x();
  y_[at] = placed.y();
  z_[at] = placed.z();
}

/// Clearances of the first points, which are filled up to whole registers, so that none is looked up alone.
void BroadPhase::look_up(std::size_t count, bool closely) {
  const std::size_t whole = (count + registers - 1) / registers * registers;
  for (std::size_t i = count; i < whole; ++i) {
    x_[i] = x_[count - 1];
    y_[i] = y_[count - 1];
    z_[i] = z_[count - 1];
  }
  const auto part = [whole](std::vector<double>& all) { return std::span(all).first(whole); };
  const PointArrays points{part(x_), part(y_), part(z_)};
  if (closely) {
    space_.clearances(points, part(clearance_));
  } else {
    space_.coarse_clearances(points, part(clearance_));
  }
}

std::span<const NearSphere> BroadPhase::look(const LinkPoses& map_from_link,
                                             std::span<const SphereReach> reach) {
  near_.clear();
  if (covers_.empty()) return near_;
  const auto pose = [&](const Cover& cover) -> const Eigen::Isometry3d& {
    return map_from_link[static_cast<std::size_t>(cover.link)];
  };
  for (std::size_t i = 0; i < covers_.size(); ++i) put(i, pose(covers_[i]), covers_[i].bound.center);
  look_up(covers_.size(), false);
  std::size_t count = 0;
  for (std::size_t i = 0; i < covers_.size(); ++i) {
    const Cover& cover = covers_[i];
    // Beyond its max_distance the field says nothing.
    const double within = cover.bound.radius + reach[i].near;
    if (within <= space_.max_distance() && clearance_[i] >= within) continue;
    for (int sphere = cover.first; sphere < cover.last; ++sphere) {
      put(count, pose(cover), spheres_[static_cast<std::size_t>(sphere)].shape.center);
      sphere_of_[count++] = sphere;
    }
  }
  for (const bool closely : {false, true}) {
    if (count == 0) return near_;
    look_up(count, closely);
    count = keep_near(count, reach);
  }
  for (std::size_t i = 0; i < count; ++i) {
    const CoverSphere& sphere = spheres_[static_cast<std::size_t>(sphere_of_[i])];
    const auto& [near, close] = reach[static_cast<std::size_t>(sphere.body)];
    near_.push_back({sphere.body,
                     clearance_[i] - sphere.shape.radius < close,
                     sphere.shape.radius,
                     near,
                     {x_[i], y_[i], z_[i]}});
  }
  return near_;
}

/// Leaves off the points whose spheres are out of reach.
std::size_t BroadPhase::keep_near(std::size_t count, std::span<const SphereReach> reach) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const CoverSphere& sphere = spheres_[static_cast<std::size_t>(sphere_of_[i])];
    const double within = sphere.shape.radius + reach[static_cast<std::size_t>(sphere.body)].near;
    sphere_of_[kept] = sphere_of_[i];
    x_[kept] = x_[i];
    y_[kept] = y_[i];
    z_[kept] = z_[i];
    clearance_[kept] = clearance_[i];
    kept += clearance_[i] < within ? 1 : 0;
  }
  return kept;
}

}  // namespace clearway

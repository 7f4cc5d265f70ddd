#include "apps/fusion/body_painter.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr double rounding = 1e-9;  ///< m, of poses and distances

/// Points of a grid over the shape, its middle and its axis among them.
std::vector<Eigen::Vector3d> grid_over(const Shape& shape) {
  constexpr int half = 6;
  const Eigen::Vector3d reach = shape.bounds(Eigen::Isometry3d::Identity()).sizes() / 2.0;
  std::vector<Eigen::Vector3d> points;
  for (int i = -half; i <= half; ++i)
    for (int j = -half; j <= half; ++j)
      for (int k = -half; k <= half; ++k)
        points.emplace_back(reach.x() * i / half, reach.y() * j / half, reach.z() * k / half);
  return points;
}

bool lies_in(const Sphere& sphere, const Sphere& larger) {
  return (sphere.center - larger.center).norm() + sphere.radius <= larger.radius + rounding;
}

[[noreturn]] void fail(const std::string& part, const std::string& what) {
  throw std::invalid_argument("setup, robot, field 'paints': part " + quote(part) + " " + what);
}

}  // namespace

std::vector<Sphere> inner_spheres(const Shape& shape, double margin, std::size_t most) {
  std::vector<Sphere> candidates, spheres;
  for (const Eigen::Vector3d& point : grid_over(shape)) {
    const double radius = -shape.signed_distance(point) - margin - rounding;
    if (radius > 0.0) candidates.push_back({point, radius});
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Sphere& a, const Sphere& b) { return a.radius > b.radius; });
  for (const Sphere& sphere : candidates) {
    if (spheres.size() >= most) break;
    const bool is_new = std::none_of(spheres.begin(), spheres.end(),
                                     [&](const Sphere& larger) { return lies_in(sphere, larger); });
    if (is_new) spheres.push_back(sphere);
  }
  return spheres;
}

BodyPainter::BodyPainter(const Setup& setup, const MovingRobot& robot, FreeSpaceMap& map)
    : robot_(robot), map_(map), volumes_(setup.volumes) {
  std::vector<std::size_t> painting_bodies;
  const std::vector<double> errors = robot.place_errors();
  const std::vector<Body>& bodies = robot.robot().bodies;
  for (const std::string& part : setup.robot->paints) {
    bool is_there = false, paints = false;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      if (bodies[i].part != part) continue;
      is_there = true;
      painting_bodies.push_back(i);
      if (!bodies[i].shape.has_exact_distance())
        fail(part, "is a mesh: expected a part of spheres, capsules, cylinders or boxes");
      for (int link = bodies[i].link; link >= 0;) {
        const Link& on_way = robot.robot().links[static_cast<std::size_t>(link)];
        if (on_way.is_held)
          fail(part, "hangs on a joint that is held, which the recorded joints do not have");
        link = on_way.parent;
      }
      Painting painting{bodies[i].link, inner_spheres(bodies[i].shape, errors[i])};
      for (Sphere& sphere : painting.spheres) sphere.center = bodies[i].link_from_shape * sphere.center;
      paints = paints || !painting.spheres.empty();
      paintings_.push_back(std::move(painting));
    }
    if (!is_there) fail(part, "is none of robot '" + robot.robot().name + "'");
    if (!paints) fail(part, "has no body that is larger than place_error and joint_error leave open");
  }
  times_ = robot.times(painting_bodies);
}

void BodyPainter::paint(const LinkPoses& poses, double since_start, const std::optional<Brush>& brush) {
  constexpr double pause = 1.0;
  if (since_start < 0.0) return;
  std::vector<int> volumes;
  if (brush && brush->use == Brush::Use::paints) volumes.push_back(brush->volume);
  for (std::size_t v = 0; v < volumes_.size() && !brush; ++v)
    if (since_start >= volumes_[v].from && since_start <= volumes_[v].to)
      volumes.push_back(static_cast<int>(v));
  if (volumes.empty()) return;
  if (!brush && !(last_painted_ && since_start - *last_painted_ <= pause))
    map_.begin_stroke("robot's stroke " + std::to_string(++strokes_), "joints");
  last_painted_ = since_start;
  for (const Painting& painting : paintings_) {
    for (const Sphere& sphere : painting.spheres) {
      const Sphere placed{poses[static_cast<std::size_t>(painting.link)] * sphere.center, sphere.radius};
      for (const int volume : volumes) map_.paint(volume, placed, since_start);
      ++spheres_;
    }
  }
}

double BodyPainter::largest_radius() const {
  double largest = 0.0;
  for (const Painting& painting : paintings_)
    for (const Sphere& sphere : painting.spheres) largest = std::max(largest, sphere.radius);
  return largest;
}

void BodyPainter::paint_until(double time, double start, const std::optional<Brush>& brush) {
  for (; next_ < times_.size() && times_[next_] <= time; ++next_) {
    if (const auto poses = robot_.poses(times_[next_])) paint(*poses, times_[next_] - start, brush);
  }
}

}  // namespace clearway

#include "apps/bench/worlds/field_points.hpp"

#include <random>

namespace clearway::bench {

Points look_up_points(const Eigen::AlignedBox3d& box, std::size_t count, std::size_t run) {
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> part(0.0, 1.0);
  const auto draw = [&] { return Eigen::Vector3d(part(engine), part(engine), part(engine)); };
  Points points;
  Eigen::Vector3d step = Eigen::Vector3d::Zero();
  while (points.size() < count) {
    if (points.size() % run == 0 || !box.contains(points.back() + step)) {
      points.push_back(box.min() + draw().cwiseProduct(box.sizes()));
      step = 0.005 * (draw().array() - 0.5).matrix().normalized();
    } else {
      points.push_back(points.back() + step);
    }
  }
  return points;
}

Points body_points(const Eigen::AlignedBox3d& box, std::size_t count) {
  std::mt19937 engine(2);
  std::uniform_real_distribution<double> part(-0.5, 0.5);
  const auto draw = [&] { return Eigen::Vector3d(part(engine), part(engine), part(engine)); };
  Points spheres, points;
  for (int i = 0; i < 64; ++i)
    spheres.emplace_back((i - 32) / 64.0, 0.06 * part(engine), 0.06 * part(engine));
  const Eigen::AlignedBox3d inner(box.min().array() + 0.5, box.max().array() - 0.5);
  while (points.size() < count) {
    Eigen::Vector3d at = inner.center() + draw().cwiseProduct(inner.sizes());
    Eigen::Vector3d step = 0.005 * draw().normalized();
    Eigen::Matrix3d turned = Eigen::AngleAxisd(6.0 * part(engine), draw().normalized()).matrix();
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.005, draw().normalized()).matrix();
    for (int i = 0; i < 128; ++i) {
      for (const Eigen::Vector3d& sphere : spheres) points.push_back(at + turned * sphere);
      if (!inner.contains(at + step)) step = -step;
      at += step;
      turned = turned * turn;
    }
  }
  return points;
}

}  // namespace clearway::bench

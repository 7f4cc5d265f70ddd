#include "apps/bench/worlds/ground_drive.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace clearway::bench {
namespace {

constexpr double one_degree = M_PI / 180.0, farthest = 80.0;
constexpr double step = 0.5;  // of the vehicle between two scans, metres

/// The ground's height, for a lidar 1.7 m over it; all lengths but the waves' grow with the lidar's height.
double ground_at(double x, double y, double scale) {
  const double kerb = std::abs(y) > 4.0 * scale ? 0.12 : 0.0;
  return scale * (0.10 * std::sin(x / 7.0) + 0.08 * std::sin(y / 5.0 + x / 11.0) + kerb);
}

struct DriveWorld {
  double scale;
  std::vector<Eigen::AlignedBox3d> boxes;

  DriveWorld(double lidar_height, double length, std::uint64_t seed) : scale(lidar_height / 1.7) {
    std::mt19937_64 random(seed);
    const auto uniform = [&](double low, double high) {
      return low + (high - low) * static_cast<double>(random() >> 11U) * 0x1p-53;
    };
    for (int i = 0; i < 50; ++i) {
      const bool is_post = i % 3 == 0;
      const Eigen::Vector3d size = is_post ? Eigen::Vector3d(0.12, 0.12, 3.0)
                                           : Eigen::Vector3d(uniform(0.5, 6), uniform(0.5, 4), uniform(1, 5));
      const double side = uniform(0.0, 1.0) < 0.5 ? -1.0 : 1.0;
      const Eigen::Vector3d middle(uniform(-10.0, length + 20.0),
                                   side * (size.y() / 2 + uniform(2.5, 15.0)) * std::max(1.0, scale),
                                   size.z() / 2 - 0.4);
      boxes.emplace_back(middle - size / 2, middle + size / 2);
    }
  }

  /// Metres along the ray; infinite: nothing within reach.
  double range(const Eigen::Vector3d& from, const Eigen::Vector3d& way, bool& is_ground) const {
    double nearest = HUGE_VAL;
    for (double at = 0.3; at < farthest;) {
      const Eigen::Vector3d place = from + at * way;
      const double over = place.z() - ground_at(place.x(), place.y(), scale);
      if (over < 0.002) {
        nearest = at;
        break;
      }
      if (way.z() >= 0.0 && over > 1.0) break;
      at += std::max(0.01, 0.7 * over);
    }
    is_ground = nearest < HUGE_VAL;
    for (const Eigen::AlignedBox3d& box : boxes) {
      const Eigen::Array3d first = (box.min() - from).array() / way.array();
      const Eigen::Array3d second = (box.max() - from).array() / way.array();
      const double enters = first.min(second).maxCoeff(), leaves = first.max(second).minCoeff();
      if (enters > 0.0 && enters <= leaves && enters < nearest) nearest = enters, is_ground = false;
    }
    return nearest;
  }
};

/// Where the vehicle truly is.
Eigen::Isometry3d place_of(std::size_t scan, double height, double scale) {
  const double t = static_cast<double>(scan), x = step * t, y = 0.5 * std::sin(t / 25.0);
  Eigen::Isometry3d pose(Eigen::Translation3d(x, y, ground_at(x, y, scale) + height));
  pose.rotate(Eigen::AngleAxisd(0.02 * std::cos(t / 25.0), Eigen::Vector3d::UnitZ()));
  pose.rotate(Eigen::AngleAxisd(0.008 * std::sin(0.13 * t), Eigen::Vector3d::UnitY()));
  pose.rotate(Eigen::AngleAxisd(0.010 * std::sin(0.20 * t), Eigen::Vector3d::UnitX()));
  return pose;
}

}  // namespace

GroundDrive drive(const DrivenLidar& lidar, std::size_t scans, std::uint64_t seed) {
  GroundDrive drive;
  drive.lidar_height = lidar.height;
  drive.length = step * static_cast<double>(scans);
  drive.seed = seed;
  const DriveWorld world(lidar.height, drive.length, seed);
  std::mt19937_64 random(seed + 1);
  std::normal_distribution<double> noise(0.0, 1.0);
  for (std::size_t i = 0; i < scans; ++i) {
    const Eigen::Isometry3d pose = place_of(i, lidar.height, world.scale);
    const bool is_held_out = i % 5 == 2;
    Scan scan;
    for (int ring = 0; ring < lidar.rings; ++ring) {
      const double elevation =
          one_degree * (lidar.lowest + (lidar.highest - lidar.lowest) * ring / (lidar.rings - 1));
      const double turned = 2 * M_PI / lidar.around * std::abs(noise(random));  // each ring's own
      for (int ray = 0; ray < lidar.around; ++ray) {
        const double azimuth = turned + 2 * M_PI * ray / lidar.around;
        const Eigen::Vector3d way(std::cos(elevation) * std::cos(azimuth),
                                  std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
        bool is_ground = false;
        const double range = world.range(pose.translation(), pose.linear() * way, is_ground);
        if (!(range < farthest)) continue;
        if (is_held_out) {
          if (ray % 4 == 0) (is_ground ? drive.ground : drive.standing).push_back(pose * (range * way));
        } else {
          scan.points.push_back(((range + 0.02 * noise(random)) * way).cast<float>());
        }
      }
    }
    if (is_held_out) continue;
    const auto error = [&](double sigma) {
      return Eigen::Vector3d(sigma * noise(random), sigma * noise(random), sigma * noise(random));
    };
    const Eigen::Vector3d turn = error(0.05 * one_degree);
    scan.map_from_sensor =
        Eigen::Translation3d(error(0.01)) * pose * Eigen::AngleAxisd(turn.norm(), turn.normalized());
    drive.scans.push_back(std::move(scan));
  }
  return drive;
}

std::vector<Eigen::Vector3d> GroundDrive::above(double height, std::size_t count) const {
  const DriveWorld world(lidar_height, length, seed);
  std::mt19937_64 random(seed + 2);
  std::uniform_real_distribution<double> along(0.0, length), beside(-5.0, 5.0);
  std::vector<Eigen::Vector3d> places;
  while (places.size() < count) {
    const double x = along(random), y = beside(random);
    if (std::abs(std::abs(y) - 4.0 * world.scale) < 2.0 * height) continue;  // beside a kerb
    const Eigen::Vector3d place(x, y, ground_at(x, y, world.scale) + height);
    if (std::all_of(world.boxes.begin(), world.boxes.end(), [&](const Eigen::AlignedBox3d& box) {
          return box.exteriorDistance(place) > 2.0 * height;
        }))
      places.push_back(place);
  }
  return places;
}

}  // namespace clearway::bench

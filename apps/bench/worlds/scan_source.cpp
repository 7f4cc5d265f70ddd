#include "apps/bench/worlds/scan_source.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>

#include "apps/bench/page/measure.hpp"
#include "apps/bench/page/result.hpp"
#include "apps/bench/worlds/room_scans.hpp"
#include "datasets/descriptions/random_numbers.hpp"
#include "datasets/sources/recording.hpp"
#include "mapping/files/cloud_file.hpp"

namespace clearway::bench {
namespace {

constexpr std::size_t round_of = 24;  ///< frames

ScanSource in_turn(std::vector<Scan> scans) {
  const auto kept = std::make_shared<const std::vector<Scan>>(std::move(scans));
  return {[kept](std::size_t index) { return kept->at(index); }, kept->size()};
}

std::vector<Scan> read_scans(const std::filesystem::path& file) {
  constexpr std::size_t most_points = 100'000'000;
  std::vector<Scan> scans;
  if (is_cloud_file(file)) {
    ViewedCloud cloud = read_viewed_cloud(file);
    Scan scan;
    scan.map_from_sensor = cloud.file_from_viewpoint;
    for (const Eigen::Vector3f& point : cloud.points)
      scan.points.push_back((cloud.file_from_viewpoint.inverse() * point.cast<double>()).cast<float>());
    scans.push_back(std::move(scan));
    return scans;
  }
  RecordingReader reader(file);
  std::size_t points = 0;
  while (points < most_points) {
    std::optional<Frame> frame = reader.next();
    if (!frame) break;
    if (auto* cloud = std::get_if<CloudFrame>(&frame->content); cloud != nullptr && !cloud->points.empty()) {
      points += cloud->points.size();
      scans.push_back(scan_of(*cloud));
    }
  }
  return scans;
}

}  // namespace

ScanSource room_frames(std::size_t count) { return in_turn(room_scans(round_of, std::min(count, round_of))); }

ScanSource desk_frames(std::size_t count) { return in_turn(desk_scans(round_of, std::min(count, round_of))); }

ScanSource lidar_turns(std::size_t count) {
  const auto turn = [](std::size_t index) {
    const RandomNumbers noise(1, index);
    Scan scan;
    scan.sensor = "lidar";
    const Eigen::Vector3d origin(0.3 * static_cast<double>(index % 20), 0.1 * static_cast<double>(index % 20),
                                 1.8);
    scan.map_from_sensor.translation() = origin;
    for (int ring = 0; ring < 64; ++ring) {
      const double elevation = (-25.0 + 40.0 * ring / 63.0) * M_PI / 180.0;
      for (int step = 0; step < 1172; ++step) {
        const double azimuth = 2.0 * M_PI * (step + 0.5) / 1172.0;
        const Eigen::Vector3d way(std::cos(elevation) * std::cos(azimuth),
                                  std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
        const Eigen::Array3d low(-18.0, -14.0, 0.0), high(18.0, 14.0, 6.0);
        const Eigen::Array3d wall = (way.array() > 0.0).select(high, low);
        const double range = ((wall - origin.array()) / way.array()).minCoeff();
        scan.points.push_back(
            (way * (range + 0.02 * noise.gaussian(static_cast<std::uint64_t>(1172 * ring + step)).first))
                .cast<float>());
      }
    }
    return scan;
  };
  return {turn, count};
}

ScanSource scans_of(const std::filesystem::path& file) {
  std::vector<Scan> scans = read_scans(file);
  if (scans.empty())
    throw std::invalid_argument(file.string() + ": holds no scan, expected range scans or a cloud");
  return in_turn(std::move(scans));
}

double insert_stock(octomap::OcTree& tree, const Scan& scan, double max_range, bool discretize) {
  octomap::Pointcloud cloud;
  cloud.reserve(scan.points.size());
  for (const Eigen::Vector3f& point : scan.points) {
    const Eigen::Vector3f at = (scan.map_from_sensor * point.cast<double>()).cast<float>();
    cloud.push_back(at.x(), at.y(), at.z());
  }
  const Eigen::Vector3f origin = scan.map_from_sensor.translation().cast<float>();
  return cpu_seconds([&] {
    tree.insertPointCloud(cloud, {origin.x(), origin.y(), origin.z()}, max_range > 0.0 ? max_range : -1.0,
                          false, discretize);
  });
}

}  // namespace clearway::bench

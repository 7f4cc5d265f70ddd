#include "apps/bench/judges/held_out.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <unordered_map>

#include "apps/bench/worlds/room_scans.hpp"
#include "mapping/scans/safe_margins.hpp"

namespace clearway::bench {
namespace {

const double grazing_cosine = std::cos(70.0 * std::numbers::pi / 180.0);
constexpr std::size_t judged_every = 23;  // held-out points of a scan: neighbours say the same

/// The points of a cloud by their direction from the sensor.
class FieldOfView {
 public:
  explicit FieldOfView(const std::vector<Eigen::Vector3f>& points) {
    for (const Eigen::Vector3f& point : points) {
      const Eigen::Vector3d at = point.cast<double>();
      if (at.allFinite() && at.norm() > 0.0) bins_[key(bin(at))].push_back(at);
    }
  }

  /// Of the plane through what lies around a point; none when that is too little.
  std::optional<Eigen::Vector3d> normal(const Eigen::Vector3d& point) const {
    const double range = point.norm(), sigma = SafeMargins{}.trim(range) / SafeMargins{}.sigmas;
    const double reach = std::max(0.03, 4.0 * sigma);
    const int wide = static_cast<int>(std::ceil(reach / range / width));
    const Eigen::Vector2i middle = bin(point);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    int count = 0;
    for (int x = -wide; x <= wide; ++x) {
      for (int y = -wide; y <= wide; ++y) {
        const auto found = bins_.find(key(middle + Eigen::Vector2i(x, y)));
        if (found == bins_.end()) continue;
        for (const Eigen::Vector3d& neighbour : found->second) {
          const Eigen::Vector3d offset = neighbour - point;
          if (std::abs(offset.dot(point)) > 4.0 * reach * range) continue;  // beyond a depth edge
          sum += offset;
          squares += offset * offset.transpose();
          ++count;
        }
      }
    }
    if (count < 12) return std::nullopt;
    const Eigen::Matrix3d covariance = squares / count - sum * sum.transpose() / (count * count);
    return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors().col(0);
  }

 private:
  static constexpr double width = 0.005;  // radians
  static Eigen::Vector2i bin(const Eigen::Vector3d& at) {
    return {static_cast<int>(std::floor(std::atan2(at.y(), at.x()) / width)),
            static_cast<int>(std::floor(std::atan2(at.z(), at.head<2>().norm()) / width))};
  }
  static std::int64_t key(const Eigen::Vector2i& at) { return std::int64_t{at.x()} * 65536 + at.y(); }
  std::unordered_map<std::int64_t, std::vector<Eigen::Vector3d>> bins_;
};

void judge(const CloudFrame& frame, HeldOutSequence& sequence) {
  const FieldOfView view(frame.points);
  for (std::size_t i = sequence.scans.size() % judged_every; i < frame.points.size(); i += judged_every) {
    const Eigen::Vector3d point = frame.points[i].cast<double>();
    const double range = point.norm();
    if (!std::isfinite(range) || !(range > 0.0)) continue;
    if (sequence.max_range > 0.0 && range > sequence.max_range) continue;
    HeldOutPoint held;
    held.measured = frame.world_from_sensor * point;
    const auto normal = frame.kind == "laser2d" ? std::nullopt : view.normal(point);
    held.grazing = normal && std::abs(normal->dot(point)) < grazing_cosine * range;
    sequence.held_out.push_back(held);
  }
}

}  // namespace

HeldOutSequence hold_out(const FurnishedRoom& room, const std::vector<CloudFrame>& frames, bool exact_poses) {
  HeldOutSequence sequence;
  sequence.source = "generated room; normals: truth";
  sequence.max_range = room.camera().max_range;
  for (std::size_t index = 0; index < frames.size(); ++index) {
    const Eigen::Isometry3d& truth = room.camera().map_from_sensor[index];
    Scan scan = scan_of(frames[index]);
    scan.map_from_sensor = exact_poses ? truth : room.stated_pose(index);
    if (index % 2 == 0) {
      sequence.scans.push_back(std::move(scan));
      continue;
    }
    for (std::size_t i = index % judged_every; i < scan.points.size(); i += judged_every) {
      const Eigen::Vector3d point = scan.points[i].cast<double>(), ray = point.normalized();
      const Hit hit = room.truth(index, ray);
      if (!std::isfinite(hit.along)) continue;
      HeldOutPoint held;
      held.measured = scan.map_from_sensor * point;
      held.exact = truth * (hit.along * ray);
      held.grazing = std::abs(hit.normal.dot(truth.linear() * ray)) < grazing_cosine;
      sequence.held_out.push_back(held);
    }
  }
  return sequence;
}

HeldOutSequence hold_out_wide(const FurnishedRoom& room) {
  HeldOutSequence sequence;
  sequence.source = "generated room, wide views; normals: truth";
  sequence.max_range = room.camera().max_range;
  std::size_t arrived = 0;
  for (const Delivery& delivery : room.deliveries()) {
    Scan scan = scan_of(room.frame(delivery.image));
    scan.map_from_sensor = delivery.map_from_sensor;
    if (arrived++ % 2 == 0) {
      sequence.scans.push_back(std::move(scan));
      continue;
    }
    const Eigen::Isometry3d& truth =
        room.camera().map_from_sensor[delivery.image % room.camera().map_from_sensor.size()];
    for (std::size_t i = arrived % judged_every; i < scan.points.size(); i += judged_every) {
      const Eigen::Vector3d point = scan.points[i].cast<double>(), ray = point.normalized();
      const Hit hit = room.truth(delivery.image, ray);
      if (!std::isfinite(hit.along)) continue;
      HeldOutPoint held;
      held.measured = scan.map_from_sensor * point;
      held.exact = truth * (hit.along * ray);
      held.before = *held.exact + 0.05 * hit.normal;
      held.grazing = std::abs(hit.normal.dot(truth.linear() * ray)) < 0.5;
      sequence.held_out.push_back(held);
    }
  }
  return sequence;
}

HeldOutSequence hold_out(const std::filesystem::path& recording, std::size_t frames) {
  std::size_t clouds = 0;
  for (RecordingReader counter(recording); const auto frame = counter.next();) {
    clouds += std::holds_alternative<CloudFrame>(frame->content) ? 1 : 0;
  }
  if (clouds < 2) {
    throw std::invalid_argument(recording.string() + ": holds " + std::to_string(clouds) +
                                " clouds, expected at least two: one to integrate, one to hold out");
  }
  const std::size_t step = (clouds + frames - 1) / frames;
  HeldOutSequence sequence;
  sequence.source = recording.filename().string() + ", every " + std::to_string(step) +
                    ". cloud; normals: planes fitted to the neighbours in the field of view";
  RecordingReader reader(recording);
  std::size_t met = 0;
  while (const auto frame = reader.next()) {
    const auto* cloud = std::get_if<CloudFrame>(&frame->content);
    if (cloud == nullptr || met++ % step != 0) continue;
    sequence.max_range = cloud->kind == "depth" || cloud->kind == "points" ? 5.0 : cloud->max_range;
    if ((met - 1) / step % 2 == 0) {
      sequence.scans.push_back(scan_of(*cloud));
    } else {
      judge(*cloud, sequence);
    }
  }
  return sequence;
}

}  // namespace clearway::bench

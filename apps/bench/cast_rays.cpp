// Rays through the map: BlockedSpace::cast_ray against OctoMap's castRay, same map, same end voxels. Ours
// needs the distance field first; so many rays make up for that.

#include <cmath>
#include <optional>
#include <random>
#include <stdexcept>

#include "apps/bench/bench.hpp"
#include "apps/bench/worlds/room_scans.hpp"
#include "mapping/field/blocked_field.hpp"
#include "mapping/free_space_map.hpp"
#include "mapping/voxels/fused_tree.hpp"

namespace clearway::bench {
namespace {

struct Ray {
  Eigen::Vector3d origin, direction;
};

octomap::point3d to_octomap(const Eigen::Vector3d& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

/// Rays from seen free voxels in all directions.
std::vector<Ray> random_rays(const Snapshot& map, std::size_t count) {
  std::mt19937_64 engine(1);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::vector<Ray> rays;
  while (rays.size() < count) {
    const Eigen::Vector3d origin(2.2 * unit(engine), 1.8 * unit(engine), 1.3 + 1.2 * unit(engine));
    if (map.state(origin) != VoxelState::seen_free) continue;
    rays.push_back({origin, Eigen::Vector3d(normal(engine), normal(engine), normal(engine)).normalized()});
  }
  return rays;
}

constexpr double ray_range = 4.0;

/// Both cast the same rays; OctoMap calls unknown voxels free or blocked as the policy does.
class RayContest {
 public:
  RayContest(const Snapshot& map, const std::vector<Ray>& rays, Policy policy)
      : map_(map),
        rays_(rays),
        policy_(policy),
        region_(field_region(map.bounds(), map.resolution(), 0.5)),
        field_(std::in_place, map.tree(), Requirement{policy}, region_) {}

  /// CPU us to make the field from nothing.
  double build() const {
    std::optional<BlockedField> field;
    settle_heap();
    return 1e6 * cpu_seconds([&] { field.emplace(map_.tree(), Requirement{policy_}, region_); });
  }
  /// CPU us per ray.
  double ours() {
    return per_ray(
        [&](const Ray& ray) { return field_->cast_ray(ray.origin, ray.direction, ray_range).hit; });
  }
  double theirs() {
    return per_ray([&](const Ray& ray) {
      octomap::point3d end;
      return map_.tree().castRay(to_octomap(ray.origin), to_octomap(ray.direction), end, ignores_unknown(),
                                 ray_range);
    });
  }
  double share_stopped() const { return static_cast<double>(stopped_) / static_cast<double>(rays_.size()); }

  /// @throws std::runtime_error unless all rays end in the voxels in which OctoMap's end.
  void require_same_ends() const {
    std::size_t differ = 0;
    for (const Ray& ray : rays_) {
      octomap::point3d end;
      const bool stock = map_.tree().castRay(to_octomap(ray.origin), to_octomap(ray.direction), end,
                                             ignores_unknown(), ray_range);
      const RayHit ours = field_->cast_ray(ray.origin, ray.direction, ray_range);
      const bool occupied = ours.hit && map_.state(ours.voxel) == VoxelState::occupied;
      if (occupied != stock || (stock && to_octomap(ours.voxel) != end)) ++differ;
    }
    if (differ != 0)
      throw std::runtime_error(std::to_string(differ) + " rays end in other voxels than OctoMap's");
  }

 private:
  template <class Cast>
  double per_ray(const Cast& cast) {
    stopped_ = 0;
    return 1e6 * cpu_seconds([&] {
             for (const Ray& ray : rays_) stopped_ += cast(ray) ? 1 : 0;
           }) /
           static_cast<double>(rays_.size());
  }
  bool ignores_unknown() const { return policy_ == Policy::not_occupied; }

  const Snapshot& map_;
  const std::vector<Ray>& rays_;
  Policy policy_;
  FieldRegion region_;
  std::optional<BlockedField> field_;
  std::size_t stopped_ = 0;
};

/// So many rays take ours, its field included, as long as OctoMap.
double break_even(double build_us, const Pair& per_ray) {
  return std::ceil(build_us / std::max(per_ray.peer - per_ray.ours, 1e-9));
}

}  // namespace

BenchResult bench_cast_ray(const BenchOptions& options) {
  const double resolution = options.resolution > 0.0 ? options.resolution : 0.02;
  constexpr std::size_t frames = 24, count = 20000;
  FreeSpaceMap map({.resolution = resolution, .discretize = true});
  for (const Scan& scan : room_scans(frames)) map.insert(scan);
  const Snapshot snapshot = map.snapshot();
  const std::vector<Ray> rays = random_rays(snapshot, count);
  BenchResult result{0, 0, "OctoMap castRay", "CPU us per ray", true, options.runs, {}};
  result.detail = {{"resolution", resolution}, {"rays", count}, {"nodes", snapshot.tree().size()}};
  Table table{"",
              {"unknown voxels", "ours, us per ray", "OctoMap", "ratio", "our field, ms",
               "rays that make up for the field"},
              {}};
  for (const Policy policy : {Policy::known_free, Policy::not_occupied}) {
    RayContest contest(snapshot, rays, policy);
    contest.require_same_ends();
    std::vector<double> builds;
    const Pair pair = interleave(
        options,
        [&] {
          builds.push_back(contest.build());
          return contest.ours();
        },
        [&] { return contest.theirs(); });
    const double build = median(builds), even = break_even(build, pair);
    result.detail[std::string(to_string(policy))] = {
        {"ours", pair.ours},          {"peer", pair.peer},
        {"ratio", pair.ratio()},      {"field_cpu_ms", 1e-3 * build},
        {"rays_to_break_even", even}, {"share_stopped", contest.share_stopped()}};
    table.rows.push_back({policy == Policy::not_occupied ? "pass" : "block", figure(pair.ours),
                          figure(pair.peer), figure(pair.ratio()), figure(1e-3 * build), count_text(even)});
    result.ours = pair.ours;
    result.peer = pair.peer;
  }
  result.tables = {table};
  result.compared =
      "20,000 rays of at most 4 m in random directions through a room at " + length_text(resolution) +
      ": `cast_ray` on a field whose cells were read by the first ray, against OctoMap's `castRay` on the "
      "same map. All end in the same voxels. `our field` is what comes before that first ray. Below the last "
      "column's number of rays per map OctoMap is faster, that first ray left out.";
  return result;
}

}  // namespace clearway::bench

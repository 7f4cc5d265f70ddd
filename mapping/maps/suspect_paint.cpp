#include "mapping/maps/suspect_paint.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>

#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

/// Points or spheres by the cube of space that their middles lie in.
template <typename Item>
class Cubes {
 public:
  explicit Cubes(double edge) : edge_(edge) {}
  void add(const Eigen::Vector3d& at, const Item& item) { cubes_[key(cube_of(at))].push_back(item); }

  /// The first item in the cube about a point or one beside it that is found; null: none is.
  template <typename Is>
  const Item* find_near(const Eigen::Vector3d& at, Is is) const {
    const Eigen::Vector3i middle = cube_of(at);
    for (int i = 0; i < 27; ++i) {
      const Eigen::Vector3i cube = middle + Eigen::Vector3i(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
      const auto found = cubes_.find(key(cube));
      if (found == cubes_.end()) continue;
      const auto item = std::find_if(found->second.begin(), found->second.end(), is);
      if (item != found->second.end()) return &*item;
    }
    return nullptr;
  }

 private:
  Eigen::Vector3i cube_of(const Eigen::Vector3d& at) const {
    return (at / edge_).array().floor().max(-1e6).min(1e6).cast<int>();
  }
  static std::uint64_t key(const Eigen::Vector3i& cube) {
    std::uint64_t key = 0;
    for (int i = 0; i < 3; ++i) key = (key << 21U) | (static_cast<std::uint64_t>(cube[i]) & 0x1fffffU);
    return key;
  }
  double edge_;
  std::unordered_map<std::uint64_t, std::vector<Item>> cubes_;
};

struct PaintedBall {
  Sphere sphere;
  int volume = 0;
  std::size_t index = 0;  ///< in its volume
};

/// Of a leaf's voxels: their middles.
template <typename Visit>
void visit_voxels(const Voxel& leaf, double resolution, Visit visit) {
  const int edge = std::max(1, static_cast<int>(std::lround(leaf.size / resolution)));
  const Eigen::Vector3d low = leaf.center.array() - 0.5 * (edge - 1) * resolution;
  for (int z = 0; z < edge; ++z)
    for (int y = 0; y < edge; ++y)
      for (int x = 0; x < edge; ++x) visit(Eigen::Vector3d(low + resolution * Eigen::Vector3d(x, y, z)));
}

/// Balls of about a size, and the conflicts near them: cubes as large as the largest of these balls.
struct SizeOfBalls {
  explicit SizeOfBalls(double largest) : conflicts(largest), balls(largest) {}
  Cubes<Eigen::Vector3d> conflicts;
  Cubes<PaintedBall> balls;
};

int size_of(const Sphere& sphere) { return std::ilogb(sphere.radius) + 1; }

}  // namespace

SuspectPaint suspect_paint(const Snapshot& map) {
  SuspectPaint suspect;
  std::map<int, SizeOfBalls> sizes;  // by the power of two that none of its radii exceeds
  for (const PaintedVolume& volume : map.volumes())
    for (const Sphere& sphere : volume.spheres)
      if (sphere.radius > 0.0) sizes.try_emplace(size_of(sphere), std::ldexp(1.0, size_of(sphere)));
  if (sizes.empty() || !map.holds_any({VoxelState::conflict})) return suspect;
  map.visit_leaves([&](const Voxel& leaf) {
    if (leaf.state != VoxelState::conflict) return;
    visit_voxels(leaf, map.resolution(), [&](const Eigen::Vector3d& at) {
      for (auto& [power, size] : sizes) size.conflicts.add(at, at);
    });
  });

  Eigen::AlignedBox3d box;
  const std::vector<PaintedVolume>& volumes = map.volumes();
  for (std::size_t v = 0; v < volumes.size(); ++v)
    for (std::size_t i = 0; i < volumes[v].spheres.size(); ++i) {
      const Sphere& sphere = volumes[v].spheres[i];
      const auto is_inside = [&](const Eigen::Vector3d& at) {
        return (at - sphere.center).norm() <= sphere.radius;
      };
      if (sphere.radius <= 0.0) continue;
      SizeOfBalls& size = sizes.at(size_of(sphere));
      if (size.conflicts.find_near(sphere.center, is_inside) == nullptr) continue;
      size.balls.add(sphere.center, {sphere, static_cast<int>(v), i});
      box.extend((sphere.center.array() - sphere.radius).matrix());
      box.extend((sphere.center.array() + sphere.radius).matrix());
    }
  if (box.isEmpty()) return suspect;
  std::vector<std::vector<bool>> is_named(volumes.size());
  for (std::size_t v = 0; v < volumes.size(); ++v) is_named[v].resize(volumes[v].strokes.size());
  map.visit_leaves(box, [&](const Voxel& leaf) {
    if (leaf.state != VoxelState::painted || leaf.observed) return;
    visit_voxels(leaf, map.resolution(), [&](const Eigen::Vector3d& at) {
      const PaintedBall* ball = nullptr;
      for (auto size = sizes.rbegin(); ball == nullptr && size != sizes.rend(); ++size)
        ball = size->second.balls.find_near(at, [&](const PaintedBall& there) {
          return (at - there.sphere.center).norm() <= there.sphere.radius;
        });
      if (ball == nullptr) return;
      ++suspect.voxels;
      const PaintedVolume& volume = volumes[static_cast<std::size_t>(ball->volume)];
      const int stroke = volume.stroke_of.empty() ? -1 : volume.stroke_of[ball->index];
      if (stroke >= 0)
        is_named[static_cast<std::size_t>(ball->volume)][static_cast<std::size_t>(stroke)] = true;
    });
  });
  for (std::size_t v = 0; v < volumes.size(); ++v)
    for (std::size_t s = 0; s < is_named[v].size(); ++s)
      if (is_named[v][s]) suspect.strokes.push_back(volumes[v].strokes[s].label);
  return suspect;
}

std::string suspect_paint_caveat(const Snapshot& map) {
  const SuspectPaint suspect = suspect_paint(map);
  if (suspect.voxels == 0) return "";
  constexpr std::size_t most_named = 3;
  std::string strokes;
  for (std::size_t i = 0; i < std::min(most_named, suspect.strokes.size()); ++i)
    strokes += (i == 0 ? ", of " : ", ") + quote(suspect.strokes[i]);
  if (suspect.strokes.size() > most_named)
    strokes += " and " + std::to_string(suspect.strokes.size() - most_named) + " more";
  return std::to_string(suspect.voxels) + (suspect.voxels == 1 ? " painted voxel" : " painted voxels") +
         " that no scan has looked at " + (suspect.voxels == 1 ? "lies" : "lie") +
         " in balls that met what scans hit" + strokes +
         ": suspect, perhaps within or behind an obstacle; erase them, or let the sensor look there";
}

}  // namespace clearway

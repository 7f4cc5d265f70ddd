#include "mapping/scans/ray_cast.hpp"

#include <algorithm>
#include <atomic>
#include <mutex>

#include "mapping/scans/ray_window.hpp"
#include "mapping/system/parallel.hpp"

namespace clearway {

struct RayWorkspace::Windows {
  std::vector<RayWindow> of_thread;
};

RayWorkspace::RayWorkspace() : windows_(std::make_unique<Windows>()) {}
RayWorkspace::~RayWorkspace() = default;
RayWorkspace::RayWorkspace(RayWorkspace&&) noexcept = default;
RayWorkspace& RayWorkspace::operator=(RayWorkspace&&) noexcept = default;

namespace {

/// The cells that a window covers, and whether all rays stay in it.
struct Coverage {
  Eigen::AlignedBox3i box;
  bool whole;
};

/// The box of the origin and of all ends.
Eigen::AlignedBox3f box_of(const ScanRays& rays, std::size_t workers) {
  std::vector<Eigen::AlignedBox3f> boxes(workers, Eigen::AlignedBox3f(rays.origin));
  parallel(workers, [&](std::size_t worker) {
    Eigen::AlignedBox3f box = boxes[worker];
    const std::size_t count = rays.ends.size(), last = count * (worker + 1) / workers;
    for (std::size_t i = count * worker / workers; i < last; ++i) box.extend(rays.ends[i].point);
    boxes[worker] = box;
  });
  for (const Eigen::AlignedBox3f& box : boxes) boxes[0].extend(box);
  return boxes[0];
}

/// All cells that the rays cross, when that fits; else those of the rays that end near the origin.
Coverage choose_coverage(const RayStarter& starter, const Eigen::AlignedBox3f& points,
                         const std::vector<RayEnd>& ends) {
  const Eigen::AlignedBox3i all(starter.cell(points.min()),
                                starter.cell(points.max()));  // cells grow with coordinates
  if (RayWindow::bytes_of(all) <= RayWindow::most_cells) return {all, true};
  const Eigen::Vector3i& origin = starter.origin_cell();
  for (int reach = 32768;; reach /= 2) {
    const Eigen::AlignedBox3i near(origin.array() - reach, origin.array() + reach);
    Eigen::AlignedBox3i box(origin);
    for (const RayEnd& ray : ends) {
      const Eigen::Vector3i cell = starter.cell(ray.point);
      if (near.contains(cell)) box.extend(cell);
    }
    if (RayWindow::bytes_of(box) <= RayWindow::most_cells) return {box, false};
  }
}

/// Rays that leave the window, one by one into the grid.
void cast_far_rays(const RayStarter& starter, const std::vector<RayEnd>& ends, const Eigen::AlignedBox3i& box,
                   ScanGrid& grid) {
  for (const RayEnd& ray : ends) {
    if (box.contains(starter.cell(ray.point))) continue;
    grid.set_free(starter.origin_cell());
    walk_ray(starter.start(ray), [&](const Eigen::Vector3i& cell) { grid.set_free(cell); });
  }
}

/// Rays first..last of those that end in `box`, through the window.
void cast_near_rays(const RayStarter& starter, const RayEnd* first, const RayEnd* last,
                    const Coverage& coverage, InstructionSet set, RayWindow& window) {
  if (set == InstructionSet::portable) {
    for (; first != last; ++first) {
      const Eigen::Vector3i cell = starter.cell(first->point);
      if (cell == starter.origin_cell() || !coverage.box.contains(cell)) continue;
      window.cells()[window.index(starter.origin_cell())] = 1;
      walk_ray(starter.start(*first),
               [&](const Eigen::Vector3i& at) { window.cells()[window.index(at)] = 1; });
    }
    return;
  }
  RayPack pack;
  std::array<RayEnd, RayPack::size> batch;
  while (first != last) {
    std::size_t count = 0;
    for (; first != last && count < batch.size(); ++first)
      if (coverage.whole || coverage.box.contains(starter.cell(first->point))) batch[count++] = *first;
    std::fill(batch.begin() + static_cast<std::ptrdiff_t>(count), batch.end(), RayEnd{starter.origin()});
    fill_pack(starter, window, batch, set, pack);
    if (pack.active == 0) continue;
    window.cells()[pack.origin] = 1;
    walk_pack(pack, window.cells(), set);
  }
}

/// Moves the marks of one pair of tiles (64 x 32 x 32 cells from `corner`) from all windows to the grid.
void collect_tiles(std::vector<RayWindow>& windows, const Eigen::Vector3i& corner, InstructionSet set,
                   std::mutex& guard, ScanGrid& grid) {
  std::uint64_t words[2][ScanTile::words];
  bool any = false, fresh = true;
  for (int block = 0; block < 64; ++block) {  // 4 x 4 rows
    const Eigen::Vector3i cell = corner + 4 * Eigen::Vector3i(0, block % 8, block / 8);
    std::uint64_t row[16] = {};
    bool found = false;
    for (RayWindow& window : windows)
      found |=
          collect_words(window.cells() + window.index(cell), window.stride(1), window.stride(2), set, row);
    if (!found) continue;
    any = true;
    if (fresh) std::fill_n(words[0], 2 * ScanTile::words, 0U);
    fresh = false;
    for (int i = 0; i < 16; ++i)
      words[i / 8][ScanTile::bit_of(cell + Eigen::Vector3i(4 * i, 0, 0)) >> 6U] = row[i];
  }
  if (!any) return;
  for (int half = 0; half < 2; ++half) {
    if (std::all_of(words[half], words[half] + ScanTile::words, [](std::uint64_t w) { return w == 0; }))
      continue;
    ScanTile& tile = [&]() -> ScanTile& {
      const std::lock_guard lock(guard);
      return grid.tile(corner + Eigen::Vector3i(half * ScanTile::edge, 0, 0));
    }();
    for (std::size_t i = 0; i < ScanTile::words; ++i) tile.free[i] |= words[half][i];
  }
}

}  // namespace

void cast_rays(const ScanRays& rays, double resolution, int threads, InstructionSet set,
               RayWorkspace& workspace, ScanGrid& grid) {
  if (rays.ends.empty()) return;
  const RayStarter starter(rays.origin, resolution);
  const auto workers = static_cast<std::size_t>(threads);
  const Coverage coverage = choose_coverage(starter, box_of(rays, workers), rays.ends);
  std::vector<RayWindow>& windows = workspace.windows().of_thread;
  windows.resize(workers);
  constexpr std::size_t portion = 1024;  // rays
  std::atomic<std::size_t> next{0};
  parallel(workers, [&](std::size_t worker) {
    windows[worker].cover(coverage.box);
    const RayEnd* const ends = rays.ends.data();
    const std::size_t count = rays.ends.size();
    for (std::size_t i = next.fetch_add(portion); i < count; i = next.fetch_add(portion))
      cast_near_rays(starter, ends + i, ends + std::min(i + portion, count), coverage, set, windows[worker]);
  });
  std::mutex guard;
  const Eigen::Vector3i tiles = windows[0].size().array() / Eigen::Array3i(64, 32, 32);
  std::atomic<int> next_pair{0};
  parallel(workers, [&](std::size_t) {
    for (int i = next_pair++; i < tiles.prod(); i = next_pair++) {
      const Eigen::Vector3i place(i % tiles.x(), i / tiles.x() % tiles.y(), i / tiles.x() / tiles.y());
      collect_tiles(windows, windows[0].corner() + place.cwiseProduct(Eigen::Vector3i(64, 32, 32)), set,
                    guard, grid);
    }
  });
  if (!coverage.whole) cast_far_rays(starter, rays.ends, coverage.box, grid);
}

}  // namespace clearway

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

/// Rays whose cells, from the origin on, lie in one box; a window over it fits.
struct RayGroup {
  Eigen::AlignedBox3i box;
  std::vector<RayEnd> ends;
};

/// The rays in groups, each with a window that fits, and those too long for any.
struct RayGroups {
  std::vector<RayGroup> groups;
  std::vector<RayEnd> far;
};

/// The box of the origin and of all ends.
Eigen::AlignedBox3f box_of(const Eigen::Vector3f& origin, const std::vector<RayEnd>& ends,
                           std::size_t workers) {
  std::vector<Eigen::AlignedBox3f> boxes(workers, Eigen::AlignedBox3f(origin));
  parallel(workers, [&](std::size_t worker) {
    Eigen::AlignedBox3f box = boxes[worker];
    const std::size_t count = ends.size(), last = count * (worker + 1) / workers;
    for (std::size_t i = count * worker / workers; i < last; ++i) box.extend(ends[i].point);
    boxes[worker] = box;
  });
  for (const Eigen::AlignedBox3f& box : boxes) boxes[0].extend(box);
  return boxes[0];
}

Eigen::AlignedBox3i cells_of(const RayStarter& starter, const Eigen::AlignedBox3f& points) {
  return {starter.cell(points.min()), starter.cell(points.max())};  // cells grow with coordinates
}

/// Splits the rays until a window over each group fits: by the sides of the origin on which they end, widest
/// axis first; then into those that end within half the box's reach and those beyond.
void split(const RayStarter& starter, std::vector<RayEnd> ends, RayGroups& result) {
  if (ends.empty()) return;
  const Eigen::AlignedBox3i box = cells_of(starter, box_of(starter.origin(), ends, 1));
  if (RayWindow::bytes_of(box) <= RayWindow::most_cells) {
    result.groups.push_back({box, std::move(ends)});
    return;
  }
  const Eigen::Array3i before = (starter.origin_cell() - box.min()).array();
  const Eigen::Array3i behind = (box.max() - starter.origin_cell()).array();
  int axis = 0;
  const int narrower = before.min(behind).maxCoeff(&axis);
  const int reach = before.max(behind).maxCoeff();
  const auto is_first = [&](const RayEnd& ray) {
    if (narrower > RayWindow::margin) return ray.point[axis] < starter.origin()[axis];
    return ((starter.cell(ray.point) - starter.origin_cell()).array().abs() <= reach / 2).all();
  };
  const auto middle = std::stable_partition(ends.begin(), ends.end(), is_first);
  std::vector<RayEnd> rest(middle, ends.end());
  ends.erase(middle, ends.end());
  split(starter, std::move(ends), result);
  if (narrower > RayWindow::margin) return split(starter, std::move(rest), result);
  result.far.insert(result.far.end(), rest.begin(), rest.end());
}

/// Rays that fit in no window, one by one into the grid.
void cast_far_rays(const RayStarter& starter, const std::vector<RayEnd>& ends, ScanGrid& grid) {
  for (const RayEnd& ray : ends) {
    if (starter.cell(ray.point) == starter.origin_cell()) continue;
    grid.set_free(starter.origin_cell());
    walk_ray(starter.start(ray), [&](const Eigen::Vector3i& cell) { grid.set_free(cell); });
  }
}

/// Whether to look where rays pass is quicker than to read a whole window: a step of a block's thickness
/// takes as long as some 80 bytes.
bool are_few(const RayStarter& starter, const Eigen::AlignedBox3i& box, std::size_t rays) {
  const Eigen::Vector3i from = starter.origin_cell();
  const int reach = (from - box.min()).cwiseMax(box.max() - from).maxCoeff();
  const double steps = static_cast<double>(rays) * (reach / RayWindow::block_edge + 1);
  return 80.0 * steps < static_cast<double>(RayWindow::bytes_of(box));
}

/// Rays first..last, through a window that holds all of them.
void cast_near_rays(const RayStarter& starter, const RayEnd* first, const RayEnd* last, InstructionSet set,
                    RayWindow& window) {
  if (set == InstructionSet::portable) {
    for (; first != last; ++first) {
      const Eigen::Vector3i cell = starter.cell(first->point);
      if (cell == starter.origin_cell()) continue;
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
    for (; first != last && count < batch.size(); ++first) batch[count++] = *first;
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
      if (window.may_be_marked(cell))
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

/// All rays of one group into the grid.
void cast_group(const RayStarter& starter, const Eigen::AlignedBox3i& box, const std::vector<RayEnd>& ends,
                InstructionSet set, std::vector<RayWindow>& windows, ScanGrid& grid) {
  constexpr std::size_t portion = 1024;  // rays
  const bool few = are_few(starter, box, ends.size());
  std::atomic<std::size_t> next{0};
  parallel(windows.size(), [&](std::size_t worker) {
    windows[worker].cover(box, few);
    const std::size_t count = ends.size();
    for (std::size_t i = next.fetch_add(portion); i < count; i = next.fetch_add(portion)) {
      const RayEnd *const first = ends.data() + i, *const last = ends.data() + std::min(i + portion, count);
      for (const RayEnd* ray = first; few && ray != last; ++ray)
        windows[worker].expect_ray(starter.origin_cell(), starter.cell(ray->point));
      cast_near_rays(starter, first, last, set, windows[worker]);
    }
  });
  std::mutex guard;
  const Eigen::Vector3i tiles = windows[0].size().array() / Eigen::Array3i(64, 32, 32);
  std::atomic<int> next_pair{0};
  parallel(windows.size(), [&](std::size_t) {
    for (int i = next_pair++; i < tiles.prod(); i = next_pair++) {
      const Eigen::Vector3i place(i % tiles.x(), i / tiles.x() % tiles.y(), i / tiles.x() / tiles.y());
      collect_tiles(windows, windows[0].corner() + place.cwiseProduct(Eigen::Vector3i(64, 32, 32)), set,
                    guard, grid);
    }
  });
}

}  // namespace

void cast_rays(const ScanRays& rays, double resolution, int threads, InstructionSet set,
               RayWorkspace& workspace, ScanGrid& grid) {
  if (rays.ends.empty()) return;
  const RayStarter starter(rays.origin, resolution);
  const auto workers = static_cast<std::size_t>(threads);
  std::vector<RayWindow>& windows = workspace.windows().of_thread;
  windows.resize(workers);
  const Eigen::AlignedBox3i all = cells_of(starter, box_of(rays.origin, rays.ends, workers));
  if (RayWindow::bytes_of(all) <= RayWindow::most_cells)
    return cast_group(starter, all, rays.ends, set, windows, grid);
  RayGroups parts;
  split(starter, rays.ends, parts);
  for (const RayGroup& group : parts.groups) cast_group(starter, group.box, group.ends, set, windows, grid);
  cast_far_rays(starter, parts.far, grid);
}

}  // namespace clearway

#pragma once

#include <Eigen/Core>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mapping/stamps/seen_tile.hpp"

namespace clearway {

class ScanGrid;
struct CellCube;

/// When each voxel was last seen: hit by a ray, or passed by one that counts as a miss. Times are those of
/// the scans, seconds of the recording's own clock, kept in periods: of 1/64 s at first, doubled as often as
/// 65,535 periods do not span all scans. A stamp is the beginning of its period, so that it never claims a
/// voxel seen later than it was; a scan that comes out of order takes back nothing. Costs 2 bytes for each
/// voxel of a cube of 8 x 8 x 8 in which stamps differ, and 10 bytes for a cube in which they do not.
///
/// Persistent: a copy shares all tiles with the original and costs nothing; a writer copies the tiles that it
/// changes. So copies may be read by other threads while the original is written.
class SeenStamps {
 public:
  static constexpr double latest_time = 1e12;          ///< seconds, before and after 0
  static constexpr int finest_exponent = -6;           ///< of 2: the first period, seconds
  static constexpr std::int64_t most_periods = 65535;  ///< that stamps can distinguish

  SeenStamps();
  SeenStamps(const SeenStamps& other);
  SeenStamps& operator=(const SeenStamps&) = delete;

  /// Stamps the cells that `grid` calls free or occupied. A `time` that is not finite or beyond latest_time
  /// is none: then nothing is stamped. @param threads >= 1; the result does not depend on it.
  void see(ScanGrid& grid, double time, int threads = 1);

  bool empty() const { return !newest_; }                  ///< no scan had a time
  double newest() const { return newest_.value_or(0.0); }  ///< time of the newest look; 0 when empty
  /// When the voxel that was not looked at for longest was last seen; 0 when empty.
  double oldest() const;
  /// Seconds: last_seen is too early by less than this.
  double period() const;

  /// When a cell (as in ScanGrid) was last seen; none: never, or only by scans without a time.
  std::optional<double> last_seen(const Eigen::Vector3i& cell) const;

  /// Calls `visit` for cubes that together are the cells of first..last (inclusive) whose last_seen is
  /// `since` or later, in no fixed order. Each has an edge of 1 or 8 cells and is a cube of the octree.
  void visit_since(double since, const Eigen::Vector3i& first, const Eigen::Vector3i& last,
                   const std::function<void(const CellCube&)>& visit) const;

  std::size_t voxels() const;  ///< that have a stamp
  std::size_t bytes() const;   ///< of memory

  // Stamps made of stamps, as maps are made of maps (map_edit.hpp).

  /// For each voxel the later look. Precondition: the times of both are of one clock.
  static SeenStamps later(const SeenStamps& a, const SeenStamps& b);
  /// The cells first..last (inclusive) alone; the newest look stays that of all.
  SeenStamps cropped(const Eigen::Vector3i& first, const Eigen::Vector3i& last) const;
  /// For voxels of twice the edge: the earliest look at any of the eight in it; none, if one was never seen.
  SeenStamps halved() const;

 private:
  friend std::string format_seen(const SeenStamps& seen);
  friend SeenStamps parse_seen(std::string_view bytes, const std::filesystem::path& file);

  struct Entry {
    std::uint64_t key;               ///< of the tile
    std::shared_ptr<SeenTile> tile;  ///< null: nothing was seen there
  };
  using Table = std::vector<Entry>;  ///< by key, ascending

  static std::uint64_t key_of(const Eigen::Vector3i& cell);
  static Eigen::Vector3i corner_of(std::uint64_t key);
  const SeenTile* find(const Eigen::Vector3i& cell) const;
  Table& table_for_writing();
  void add_entries(std::vector<std::uint64_t> keys);
  Entry& entry(std::uint64_t key);  ///< which must be there
  SeenTile& tile_for_writing(Entry& entry, const Eigen::Vector3i& corner);

  std::int64_t index_of(double time) const;
  double time_of(std::uint16_t stamp) const;
  /// The least stamp of a look at `since` or later; 65536 when no stamp says so.
  std::uint32_t least_stamp(double since) const;
  void make_room(std::int64_t index);
  void rebase(int coarser, std::int64_t base);

  std::shared_ptr<Table> table_;
  std::uint64_t table_owner_ = 0;
  mutable std::atomic<std::uint64_t> self_;  ///< the owner whose tiles, and table, this object may write to
  int exponent_ = finest_exponent;           ///< a period is 2^exponent_ seconds
  std::int64_t base_ = 0;                    ///< stamp s is the period number base_ + s - 1 since time 0
  std::optional<double> newest_;
};

/// As bytes: the part of a map.ot behind its tree.
std::string format_seen(const SeenStamps& seen);

/// Reads what format_seen wrote, in memory of at most 20 times `bytes`.
/// @throws DamagedFile naming `file` and what is wrong.
SeenStamps parse_seen(std::string_view bytes, const std::filesystem::path& file);

}  // namespace clearway

#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mapping/history/conflict_log.hpp"
#include "mapping/history/paint_log.hpp"
#include "mapping/history/touched_cells.hpp"

namespace clearway {

/// One inserted scan, and the cells that it touched as far as they are kept.
struct ScanRecord {
  int number = 0;  ///< in order of insertion, from 0; scans that were refused count too
  std::string sensor;
  double time = 0.0;                                                                    ///< seconds
  Eigen::Vector3i low = Eigen::Vector3i::Zero(), high = Eigen::Vector3i::Constant(-1);  ///< cells touched
  TouchedCells hits{}, misses{};
  bool hits_kept = true, misses_kept = true;
};

/// Which scans touched which voxels, exactly, within a budget of memory. When it is used up, the misses of
/// the oldest scans go first (of old scans the surfaces matter most), then their hits; the records stay, so
/// that an answer says which scans it does not know of.
class ScanLog {
 public:
  static constexpr std::size_t default_budget = std::size_t{64} << 20U;
  static constexpr std::size_t scan_limit = 200000;  ///< scans beyond it are only counted

  explicit ScanLog(std::size_t budget = default_budget) : budget_(budget) {}

  /// Records a scan that was inserted; `grid` holds what it touched, occupied cells not among the free ones
  /// (FusedTree::update leaves it so).
  void add(int number, const std::string& sensor, double time, ScanGrid& grid);

  /// What is known of one voxel.
  struct Answer {
    std::vector<std::size_t> hits, misses;  ///< indices into `scans`, ascending
    std::vector<std::size_t> unknown;       ///< scans whose record is gone and that may have touched it
  };
  Answer touched(const Eigen::Vector3i& cell) const;

  const std::vector<ScanRecord>& scans() const { return scans_; }
  std::size_t not_recorded() const { return not_recorded_; }  ///< scans beyond scan_limit
  std::size_t bytes() const { return bytes_; }                ///< of the cells kept

  /// From a file.
  ScanLog(std::vector<ScanRecord> scans, std::size_t not_recorded);

 private:
  void keep_budget();

  std::vector<ScanRecord> scans_;
  std::size_t budget_ = default_budget, bytes_ = 0, not_recorded_ = 0;
  std::size_t first_misses_ = 0, first_hits_ = 0;  ///< the oldest scans that still have them
};

/// Why the voxels of a map are what they are: what was painted and erased, which scans came, which conflicts
/// appeared. Saved beside the map as provenance.bin.
struct Provenance {
  std::string map_sha256;  ///< of the map.ot that it belongs to
  double resolution = 0.0;
  std::vector<std::string> volumes;  ///< labels
  std::vector<Stroke> strokes;       ///< by number; without time spans
  std::vector<PaintEvent> events;
  ConflictLog conflicts;
  ScanLog scans;
};

/// What a stroke did to one voxel: how many of its spheres cover (or erased) it, first and last time.
struct StrokeTouch {
  int volume = 0, stroke = -1;
  bool erases = false;
  std::size_t spheres = 0;
  double first = 0.0, last = 0.0;  ///< seconds
};

/// The strokes that made the paint of a voxel what it is, in the order of their first sphere: those with
/// spheres that cover it still, and those that erased spheres that had covered it.
std::vector<StrokeTouch> strokes_at(const Provenance& provenance, const Eigen::Vector3i& cell);

/// As bytes, with a checksum.
std::string format_provenance(const Provenance& provenance);

/// Reads what format_provenance wrote. Memory is bounded by the size of `bytes`.
/// @throws DamagedFile naming `file` and what is wrong.
Provenance parse_provenance(std::string_view bytes, const std::filesystem::path& file);

/// Writes DIR/provenance.bin for the map.ot that lies there.
/// @throws std::runtime_error naming the file that could not be written.
void save_provenance(Provenance provenance, const std::filesystem::path& directory);

/// Reads DIR/provenance.bin; none when the map is a single file or has no such file.
/// @throws DamagedFile when it is damaged.
std::optional<Provenance> load_provenance(const std::filesystem::path& map);

}  // namespace clearway

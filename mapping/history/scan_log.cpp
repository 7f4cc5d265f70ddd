#include "mapping/history/provenance.hpp"

namespace clearway {
namespace {

/// Corners of the cells of all tiles that hold anything, exact to a tile.
void bound(const std::vector<ScanTile*>& tiles, ScanRecord& record) {
  bool first = true;
  for (const ScanTile* tile : tiles) {
    const Eigen::Vector3i last = tile->corner.array() + (ScanTile::edge - 1);
    record.low = first ? tile->corner : Eigen::Vector3i(record.low.cwiseMin(tile->corner));
    record.high = first ? last : Eigen::Vector3i(record.high.cwiseMax(last));
    first = false;
  }
}

std::size_t bytes_of(const ScanRecord& record) {
  return record.hits.packed().size() + record.misses.packed().size();
}

}  // namespace

ScanLog::ScanLog(std::vector<ScanRecord> scans, std::size_t not_recorded)
    : scans_(std::move(scans)), not_recorded_(not_recorded) {
  for (const ScanRecord& record : scans_) bytes_ += bytes_of(record);
}

void ScanLog::add(int number, const std::string& sensor, double time, ScanGrid& grid) {
  if (scans_.size() >= scan_limit) {
    ++not_recorded_;
    return;
  }
  const std::vector<ScanTile*> tiles = grid.tiles();
  ScanRecord record{number, sensor, time};
  bound(tiles, record);
  record.hits = TouchedCells(tiles, TouchedCells::Kind::occupied);
  record.misses = TouchedCells(tiles, TouchedCells::Kind::free);
  record.hits_kept = record.hits.is_complete();
  record.misses_kept = record.misses.is_complete();
  bytes_ += bytes_of(record);
  scans_.push_back(std::move(record));
  keep_budget();
}

void ScanLog::keep_budget() {
  const auto drop = [&](TouchedCells& cells, bool& kept) {
    bytes_ -= cells.packed().size();
    cells = {};
    kept = false;
  };
  while (bytes_ > budget_ && first_misses_ < scans_.size()) {
    ScanRecord& oldest = scans_[first_misses_++];
    drop(oldest.misses, oldest.misses_kept);
  }
  while (bytes_ > budget_ && first_hits_ < scans_.size()) {
    ScanRecord& oldest = scans_[first_hits_++];
    drop(oldest.hits, oldest.hits_kept);
  }
}

ScanLog::Answer ScanLog::touched(const Eigen::Vector3i& cell) const {
  Answer answer;
  for (std::size_t i = 0; i < scans_.size(); ++i) {
    const ScanRecord& scan = scans_[i];
    if ((cell.array() < scan.low.array()).any() || (cell.array() > scan.high.array()).any()) continue;
    if (scan.hits.contains(cell)) {
      answer.hits.push_back(i);
    } else if (scan.misses.contains(cell)) {
      answer.misses.push_back(i);
    } else if (!scan.hits_kept || !scan.misses_kept) {
      answer.unknown.push_back(i);
    }
  }
  return answer;
}

}  // namespace clearway

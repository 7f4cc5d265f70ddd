#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "mapping/history/provenance.hpp"
#include "mapping/scans/safe_margins.hpp"
#include "mapping/scans/scan.hpp"
#include "mapping/snapshot.hpp"
#include "mapping/voxels/integration.hpp"

namespace clearway {

/// How sensors and painting are fused. Probabilities are OctoMap's own by default.
struct MapOptions {
  double resolution = 0.02;           ///< edge of a voxel, metres, in [1e-4, 100]
  double hit_probability = 0.7;       ///< of a voxel in which a ray ends
  double miss_probability = 0.4;      ///< of a voxel that a ray passes
  double min_probability = 0.1192;    ///< clamping, as OctoMap
  double max_probability = 0.971;     ///< clamping, as OctoMap
  double occupied_probability = 0.5;  ///< at or over it a voxel is occupied
  bool discretize = false;            ///< one ray per end voxel and scan (OctoMap's "discretized" insertion)
  int threads = 1;                    ///< for inserting scans, in [1, 64]; results do not depend on it
  Integration integration = Integration::safe;  ///< what a scan frees
  SafeMargins margins{};                        ///< of safe integration
};

/// What one painted sphere did to the voxels.
struct PaintCounts {
  std::size_t painted = 0;    ///< voxels wholly inside the sphere
  std::size_t newly = 0;      ///< of these, voxels that this volume had not painted before
  std::size_t conflicts = 0;  ///< of these, voxels that sensors call occupied
};

/// What one eraser did to the spheres of a volume and to the voxels.
struct EraseCounts {
  std::size_t shrunk = 0;     ///< spheres that are smaller now
  std::size_t removed = 0;    ///< spheres of which nothing was left
  std::size_t unpainted = 0;  ///< voxels that this volume does not paint any more
};

/// The one map: fuses painted spheres and scans into one OctoMap tree. Written by one thread; read through
/// snapshots. Painting never changes a sensor's log-odds; sensing never erases paint: a voxel that is both
/// painted and occupied is a conflict, blocked and counted.
class FreeSpaceMap {
 public:
  /// @throws std::invalid_argument naming the option that is out of range.
  explicit FreeSpaceMap(const MapOptions& options = {});
  ~FreeSpaceMap();
  /// What was moved from can be assigned to and destroyed; all else throws std::logic_error.
  FreeSpaceMap(FreeSpaceMap&&) noexcept;
  FreeSpaceMap& operator=(FreeSpaceMap&&) noexcept;

  /// Adds an empty painted volume and returns its index (bit in Voxel::volumes).
  /// @throws std::invalid_argument when the label exists already or 15 volumes exist.
  int add_volume(const std::string& label, const std::vector<std::string>& critical_parts);

  /// Takes the last volume out of the map, as if it had never been added. False, and nothing is done, where
  /// there is none or something that is not undone was painted into it or erased from it.
  bool remove_last_volume();

  /// Paints the voxels that lie wholly inside `sphere` and keeps the sphere itself (Chong et al. 2008, eq.
  /// 2).
  /// @throws std::invalid_argument for an unknown volume, a non-finite sphere, and a radius <= 0 or of more
  /// than 1,000 voxels, which nobody means and no memory holds.
  PaintCounts paint(int volume, const Sphere& sphere, double time = 0.0);

  /// Erases what `volume` painted inside of `eraser`: shrinks each of its spheres that the eraser reaches to
  /// the radius at which the two only touch, and removes those whose centre it holds. So no painted voxel
  /// overlaps the eraser, and what is left is a union of spheres again; but a sphere that is large beside the
  /// eraser loses more than the eraser holds. What is painted later is not erased.
  /// @throws std::invalid_argument as `paint`; the radius may be of any size.
  EraseCounts erase(int volume, const Sphere& eraser, double time = 0.0);

  /// Starts a stroke: what is painted and erased until end_stroke (or the next begin_stroke) belongs to it
  /// and can be undone. Returns its number, 0, 1, 2 ...
  /// @param source who paints: a sensor label, a person; may be empty.
  /// @throws std::invalid_argument for names with control characters.
  int begin_stroke(const std::string& label, const std::string& source = "");
  void end_stroke();

  /// Undoes a stroke, or the last one that is not undone: spheres and voxels are afterwards as if it had
  /// never been, with all that was painted, erased and sensed since. Ends an open stroke. Returns the number
  /// of the stroke undone, -1 when there is none.
  /// @throws std::invalid_argument for a number that no stroke has.
  int undo_stroke();
  int undo_stroke(int stroke);

  /// From now on keeps which scan touched which voxel (see ScanLog), in at most `budget` bytes. Costs a few
  /// per cent of the time of inserting. Call it before the first scan.
  void keep_scans(std::size_t budget = ScanLog::default_budget);

  /// Conflicts as they appeared.
  const ConflictLog& conflicts() const;
  /// Why the map is what it is; without scans when keep_scans was not called.
  Provenance provenance() const;

  /// Says in the map that it is made from a damaged recording, of which so many records were read.
  void note_damaged_recording(std::size_t records);

  /// Integrates a scan by ray carving (OctoMap's traversal); in `safe` integration less is freed.
  /// @throws std::invalid_argument for a sensor's pose that is finite and not rigid: scaled or mirrored.
  ScanCounts insert(const Scan& scan, const ScanFilter& filter = {});

  const MapOptions& options() const;
  const std::vector<PaintedVolume>& volumes() const;

  /// An immutable copy of the present state.
  Snapshot snapshot() const;

 private:
  struct State;
  State& state() const;
  std::unique_ptr<State> state_;
};

}  // namespace clearway

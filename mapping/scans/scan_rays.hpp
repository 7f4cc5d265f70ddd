#pragma once

#include "mapping/scans/contested_cells.hpp"
#include "mapping/scans/grazed_surfaces.hpp"
#include "mapping/scans/ray_cast.hpp"
#include "mapping/scans/safe_margins.hpp"
#include "mapping/scans/scan.hpp"
#include "mapping/scans/surface_gaps.hpp"
#include "mapping/voxels/fused_tree.hpp"
#include "mapping/voxels/integration.hpp"
#include "mapping/voxels/scan_grid.hpp"

namespace clearway {

/// How one scan is integrated.
struct ScanInsertion {
  bool discretize = false;  ///< one ray per end voxel, to its centre (as computeDiscreteUpdate)
  int threads = 1;          ///< >= 1; the result does not depend on it
  Integration integration = Integration::compatible;
  SafeMargins margins{};  ///< of safe integration
  InstructionSet instructions = best_instruction_set();
};

/// Where the rays of a share of a scan's points end.
struct ChosenEnds {
  std::vector<RayEnd> ends;
  std::vector<Eigen::Vector3i> cells;  ///< discretized: the cell that each was chosen for
  ScanGrid hits;                       ///< occupied: voxels in which rays end as hits
  ScanGrid seen;                       ///< discretized with a maximum range: cells of all points so far
  ScanCounts counts;

  void clear() {
    ends.clear();
    cells.clear();
    hits.clear();
    seen.clear();
    counts = {};
  }
};

/// What insertion keeps from scan to scan: memory only, no evidence.
struct ScanWorkspace {
  RayWorkspace rays;
  ScanGrid grid;
  ScanGrid taken_out;  ///< occupied: voxels of points that are no hits, around which nothing is freed
  ScanRays chosen;
  SurfaceGaps surface;
  std::vector<Eigen::Vector3f> ways;              ///< of filtered points, sensor frame
  const std::vector<SurfaceGap>* gaps = nullptr;  ///< of the scan's surface; null: not asked for
  std::vector<ChosenEnds> shares;                 ///< one a thread
};

/// What the scans before say of voxels, beside the tree.
struct ScanEvidence {
  ContestedCells contested;
  GrazedSurfaces grazed;
};

/// Carves the rays of one scan into the tree as OctoMap does: within the scan every voxel is updated once,
/// and a voxel in which any ray ends is occupied even where others pass (as computeUpdate). A point beyond
/// max_range frees its ray up to that range and sets no hit. In safe integration the hits are the same (a
/// discretized one within range counts wherever its voxel's centre lies) and a subset is freed: rays that
/// hit end early by margins.trim(length), and nothing is freed within the band
/// around this scan's hits (see SafeMargins) and around what was taken out of it, or between neighbouring
/// hits (SurfaceGaps). The tree learns how far the scan agrees with it (FusedTree::agreement).
/// @param evidence of the scans before; null: none is weighed.
/// @throws std::invalid_argument for a filter that makes no sense (see filter_points); std::runtime_error,
/// and the tree is as before, when its voxels need more memory than the machine has left.
ScanCounts insert_scan(FusedTree& tree, const Scan& scan, const ScanFilter& filter,
                       const ScanInsertion& insertion, ScanWorkspace& workspace,
                       ScanEvidence* evidence = nullptr);

/// The first half of insert_scan: which rays to cast, and the end voxels, set occupied in `workspace.grid`
/// (cleared before). Then follow cast_rays, in safe integration spare_surfaces, and FusedTree::update.
ScanRays& choose_rays(const FusedTree& tree, const Scan& scan, const ScanFilter& filter,
                      const ScanInsertion& insertion, ScanWorkspace& workspace, ScanCounts& counts);

}  // namespace clearway

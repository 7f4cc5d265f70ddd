#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "mapping/scans/safe_margins.hpp"
#include "mapping/voxels/fused_tree.hpp"
#include "mapping/voxels/scan_grid.hpp"

namespace clearway {

/// A straight piece of surface between two neighbouring hits of a scan. Lengths in voxels of the map.
struct SurfaceGap {
  Eigen::Vector3d from, to;  ///< the hits, map frame
  Eigen::Vector3d side;      ///< across the line between them, a unit vector
  double before, behind;     ///< the surface reaches so far against and along `side`
};

/// How the rays of a scan lie in the map.
struct GapSearch {
  Eigen::Isometry3d map_from_sensor = Eigen::Isometry3d::Identity();
  double resolution = 0.0;  ///< edge of a voxel, metres
  SafeMargins margins{};    ///< nothing is looked for within what the trim of the rays spares
};

/// Where the rays of a scan meet a surface farther apart than a voxel is wide: the rings of a lidar on the
/// ground, a wall seen at a slant. The surface is taken to be straight from hit to hit, and to go on a little
/// where the hits of a column end towards the sensor: as far as the last ray stays within a voxel of it.
///
/// Neighbours are found in an image of the rays' directions, the first ray in each pixel: the next along its
/// rows and columns. A pixel is 0.18 degrees wide; columns are as wide as the rays of a ring usually lie
/// apart. Two hits are no neighbours when more than 5 degrees, or three times the usual step, lie between
/// them, when a ray does that hits nothing as far as the first of them is, or when the line from one to the
/// other runs within 0.8 degrees of a ray: then one is at an edge and the other behind it. Keeps its memory
/// from scan to scan.
class SurfaceGaps {
 public:
  /// @param hits ends of rays that hit something, sensor frame, metres; those that are not finite are left
  /// out. @param clear ends of rays that hit nothing.
  /// @return valid until the next call.
  const std::vector<SurfaceGap>& find(std::span<const Eigen::Vector3f> hits,
                                      std::span<const Eigen::Vector3f> clear, const GapSearch& search);

 private:
  static constexpr int none = -1;
  struct Ray {
    Eigen::Vector3f way;
    float squared;              ///< its length, m²
    std::uint16_t column, row;  ///< of the image
    bool is_hit;
  };
  /// What was found in a column so far.
  struct Column {
    int last = none;      ///< ray
    int gap = none;       ///< that ends at `last`, of gaps_
    bool begins = false;  ///< `last` has no neighbour before it
  };
  void choose_pole(std::span<const Eigen::Vector3f> ways);
  void add(std::span<const Eigen::Vector3f> ways, bool are_hits, float apart);
  void draw();
  int usual_step(bool along) const;
  template <typename Visit>
  void visit_row(int row, const Visit& visit) const;
  void gather_row(int row);
  bool parts(int last, int ray) const;
  int step_from(std::size_t i) const;
  void walk_rows(const GapSearch& search, int most);
  void walk_columns(const GapSearch& search, int along, int most);
  void add_to(Column& column, int ray, int most, const GapSearch& search, double before, double behind);
  bool are_neighbours(int a, int b) const;
  bool add_gap(int a, int b, const GapSearch& search, double before, double behind);
  void go_on(const SurfaceGap& gap, const Eigen::Vector3d& end, const GapSearch& search);

  std::array<int, 3> axes_{};  ///< of the sensor: where azimuth 0 and a quarter turn point, and the pole
  std::vector<Ray> rays_;
  Eigen::AlignedBox2i seen_;          ///< columns and rows of the image that rays fall in
  int pixel_ = 1;                     ///< columns that are one in the image
  int width_ = 0, height_ = 0;        ///< of that part of the image
  std::size_t words_ = 0;             ///< of a row of drawn_
  std::vector<std::uint64_t> drawn_;  ///< a bit for each pixel that a ray falls in
  std::vector<int> image_;            ///< the first ray in each of these
  std::vector<Column> columns_;
  std::vector<int> row_;  ///< the rays of a row
  std::vector<SurfaceGap> gaps_;
};

/// Takes the cells that these pieces of surface cross (but for corners: 2.5 samples a voxel) out of `grid`'s
/// free and clear cells, and adds them to the spared ones. Occupied cells stay as they are.
/// @param tree cells that it holds occupied stay free, though not clear: a look that counts; null: none does
void spare_gaps(std::span<const SurfaceGap> gaps, const FusedTree* tree, ScanGrid& grid);

}  // namespace clearway

#pragma once

namespace clearway {

/// How far from what a scan hits nothing is freed by that scan, in `safe` integration.
struct SafeMargins {
  /// A miss does not count within this distance of a voxel that the same scan hits, metres: the errors of
  /// pose and calibration, and what lies between two rays. Rounded to whole voxels, at most 4; a map too
  /// coarse for it keeps one voxel over each face.
  double band = 0.02;
  /// A ray frees nothing within `sigmas` * sigma(range) before its end, where
  /// sigma(range) = min(noise_constant + noise_quadratic * range^2, noise_limit).
  double sigmas = 2.0;
  double noise_constant = 0.0012;   ///< metres (structured light: Nguyen et al. 2012)
  double noise_quadratic = 0.0019;  ///< 1/m
  double noise_limit = 0.05;        ///< metres; a lidar's range does not make it as bad as a camera
  /// While the scans hit more than this share of voxels that the map called free (ScanAgreement), one look
  /// does not free a voxel beside which other scans hit something (ContestedCells). In [0, 1]; 1: never.
  double most_called_free = 0.01;

  /// How far before its end a ray of this length frees nothing, metres.
  double trim(double range) const {
    const double sigma = noise_constant + noise_quadratic * range * range;
    return sigmas * (sigma < noise_limit ? sigma : noise_limit);
  }
};

}  // namespace clearway

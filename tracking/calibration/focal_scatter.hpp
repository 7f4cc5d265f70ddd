#pragma once

#include <vector>

#include "tracking/calibration/bundle.hpp"

namespace clearway {

/// How much the focal length differs from view to view beyond what noise explains.
struct FocalScatter {
  double sigma = 0.0;       ///< of its logarithm (DerSimonian and Laird 1986)
  bool is_likely = false;   ///< chance alone makes such differences less often than once in 100 times
  bool is_certain = false;  ///< once in 10,000 times
};

/// None where chance alone makes such differences more often than once in 20 times (Cochran's Q).
FocalScatter focal_scatter(const std::vector<BundleFit::FocalStep>& steps);

}  // namespace clearway

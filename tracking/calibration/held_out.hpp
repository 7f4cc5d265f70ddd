#pragma once

#include "tracking/calibration/bundle.hpp"

namespace clearway {

/// Root mean squares over images that a calibration has not seen, their poses fitted; infinity where nothing
/// was explained.
struct HeldOut {
  double px, mm;  ///< in the image; at the board
};

/// What a fit explains of views that are held out, by `folds` further fits that begin at it.
/// @param fitted camera and views of the fit @param reported the flat board that `priors` are about
/// @param noise_px of a corner per axis
HeldOut test_held_out(const Bundle& fitted, const TagBody& reported, const BundlePriors& priors,
                      double noise_px, double edge_bias, int folds);

}  // namespace clearway

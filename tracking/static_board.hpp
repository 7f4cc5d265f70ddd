#pragma once

#include <optional>

#include "tracking/tag_body.hpp"

namespace clearway {

/// Memory and outlier gate of a StaticBoard.
struct StaticBoardOptions {
  int memory = 30;  ///< images that the mean remembers, 1 to 10,000; its error shrinks to 1/sqrt of it
  double gate_sigmas = 5.0;  ///< Mahalanobis distance beyond which an image disagrees
  int reset_after = 5;  ///< consecutive disagreeing images after which the board is believed to have moved
};

/// The mean pose of a board that stands still before a camera that stands still: a Kalman filter of a
/// constant pose with a forgetting factor, so that a slow drift is followed. Pixel noise averages out; a
/// wrong calibration does not, and the covariance does not know of it.
class StaticBoard {
 public:
  /// Throws std::invalid_argument naming the option that is out of its range.
  explicit StaticBoard(const StaticBoardOptions& options = {});

  /// Adds one image's pose and returns the mean. Empty when this image disagrees with the mean; after
  /// `reset_after` such images in a row the mean starts again from the latest.
  std::optional<UncertainPose> add(const UncertainPose& camera_from_board);

  bool has_mean() const { return mean_.has_value(); }

  /// How often the mean has started again, and the largest step from one to the next, metres: what was
  /// measured against it before and after may be that much apart.
  struct Moves {
    int count = 0;
    double farthest = 0.0;
  };
  const Moves& moves() const { return moves_; }

 private:
  StaticBoardOptions options_;
  std::optional<UncertainPose> mean_;
  int disagreeing_ = 0;
  Moves moves_;
};

}  // namespace clearway

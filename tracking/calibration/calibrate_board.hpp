#pragma once

#include <map>
#include <string>
#include <vector>

#include "tracking/calibration/bundle.hpp"

namespace clearway {

struct BoardCalibrationOptions {
  double edge_bias = 0.1;    ///< see BodyPoseOptions
  double pixel_noise = 0.3;  ///< of the poses to begin with, pixels
  std::size_t least_views = 10;
  double most_place_sigma = 0.0005;  ///< metres, of a tag's middle
};

/// What became of one tag.
struct TagChange {
  int id = 0;
  std::size_t views = 0;
  double size_ratio = 1.0;   ///< measured over stated
  double size_sigma = 0.0;   ///< relative
  double moved = 0.0;        ///< metres, from the place that was stated, less the common scale of places
  double place_sigma = 0.0;  ///< metres, worst axis
  double turned = 0.0;       ///< radians
  double turn_sigma = 0.0;   ///< radians, worst axis
  // Off by more than five times what is stated and measured:
  bool is_size_wrong = false, is_place_wrong = false, is_turn_wrong = false;
};

struct BoardCalibration {
  std::string refusal;  ///< one sentence; empty: the board is good
  TagBody board;        ///< as measured, in the frame that was stated; its errors are what is left
  std::vector<TagChange> tags;
  double places_scale = 1.0;     ///< distances between tags over stated ones, if most sizes are as stated
  double scale_tolerance = 0.0;  ///< relative: five times what stated and measured errors allow
  bool is_scale_contradicted = false;  ///< stated sizes and places cannot both be right: refused
  double noise_px = 0.0, rms_px = 0.0;
  std::size_t views = 0;
};

/// Sizes, places and turns of a board's tags from views by a known camera: bundle adjustment in which places
/// are hardly held and sizes are held by what is stated, one that the others contradict by less and less
/// (Cauchy weights): the stated sizes of the majority determine the scale. The board's frame stays where most
/// tags' stated places have it. The common scale of sizes and places cannot be seen: it stays as stated; a
/// scale of the places that is not that of the sizes is refused, and sizes of which no more than half agree.
/// How far stated places are off is taken from what is stated, or from how they scatter, where that is more.
/// @param camera its errors count
BoardCalibration calibrate_board(const Camera& camera, const TagBody& board, std::vector<BoardView> views,
                                 const BoardCalibrationOptions& options = {});

}  // namespace clearway

#pragma once

#include <string>

#include "datasets/pictures/depth_layout.hpp"
#include "datasets/sources/frame_source.hpp"

namespace clearway {

constexpr double usual_depth_scale = 0.001;  ///< m per step

/// What the stored numbers of a folder's depth pictures are.
struct DepthNumbers {
  bool is_real = false;  ///< else steps
  /// The bits of steps are rotated left by three, as SUN3D and SUN RGB-D store them.
  bool is_rotated = false;
  double background = 1e4;  ///< m: what is as far or farther is what pictures were rendered before, and none

  /// The steps, or the real number, that a stored number stands for.
  float value_of(float stored) const;
};

/// Whether nearly all steps in some pictures, spread over all, are multiples of 8, or one more, and many not
/// of 16: what rotated bits of millimetres give, and no sensor else. Arrays have no such bits.
bool are_steps_rotated(const DepthLayout& layout);

/// Why the pictures' steps are taken for TUM's, after "… are 0.0002 m, as"; empty: they are not. Who lists
/// pictures as TUM does (ETH3D, ICL-NUIM, Bonn) has its steps as well.
std::string why_of_tum(const DepthLayout& layout, const SourceOptions& options);

/// The setup's scale; else metres for real numbers, TUM's steps where the files look like theirs, else 0.001.
SourceOptions with_scale(SourceOptions options, const std::string& why_of_tum, bool is_real);

/// Tables as TUM's stand beside pictures in millimetres, too (OpenLORIS, what people record for ORB-SLAM),
/// which a map would show at a fifth of their size. They differ in what no millimetres say of a room: 10 m.
/// @throws std::invalid_argument where some pictures, spread over all, hold nothing that would be 2 m of
/// TUM's
void require_steps_of_tum(const std::string& name, const DepthLayout& layout);

/// Of pictures whose poses are TUM's own by their head, such as of what somebody recorded and called
/// rgbd_dataset_…: a sentence in that case; else empty, as some of TUM's hold nothing that far either.
std::string doubt_of_tum(const DepthLayout& layout);

/// Real numbers are metres in most files, and millimetres in others. @throws std::invalid_argument where half
/// of the depth in some pictures, spread over all, lies beyond 100 m, without what is background (1e6 and
/// more)
void require_metres(const std::string& name, const DepthLayout& layout);

}  // namespace clearway

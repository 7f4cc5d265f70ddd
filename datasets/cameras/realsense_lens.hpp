#pragma once

#include <span>
#include <string>

#include "datasets/sources/recording.hpp"

namespace clearway {

/// Whether librealsense calls a lens so, as words that nobody else has: "Brown Conrady", …
bool is_realsense_lens(const std::string& model);

/// Gives a camera the lens that librealsense names (rs2_distortion), as words or as its number: "Brown
/// Conrady", "distortion.brown_conrady", RS2_DISTORTION_BROWN_CONRADY or 4. Brown-Conrady is OpenCV's plumb
/// bob, Kannala-Brandt its fisheye. "Inverse Brown Conrady" is a formula from pixels to rays, "Modified Brown
/// Conrady" another one than OpenCV's, F-Theta a third: these are refused unless, for the first two, all
/// coefficients are 0.
/// @param model empty: not stated, and the coefficients have to be 0
/// @throws std::runtime_error with a clause of what was expected
void set_realsense_lens(CameraIntrinsics& camera, const std::string& model,
                        std::span<const double> coefficients);

}  // namespace clearway

#pragma once

#include <string>

#include "tracking/calibration/calibrate_camera.hpp"

// Why a calibration is not to be used: one sentence each, without a full stop; empty where it is good.

namespace clearway {

/// Whether the board was seen all over the image.
std::string judge_coverage(const CameraCalibration& c, const CameraCalibrationOptions& options);

/// Whether the focal length was the same in all images.
std::string judge_focus(const CameraCalibration& c, const CameraCalibrationOptions& options);

/// Coverage, how well the focal length is known, whether the distortion holds in the image's corners, the
/// board was flat and the focus stayed.
std::string judge(const CameraCalibration& c, const CameraCalibrationOptions& options);

/// Whether the views determine a rational lens. Where k4, k5 and k6 are not needed they trade against k1, k2
/// and k3 along a valley that may end far from 0: then held-out views tell, and the sentence names the lens
/// that does as well. @pre c.simpler holds a plumb bob, then others
std::string judge_rational(const CameraCalibration& c);

/// Whether the image's corners are known, but those of a fisheye: what is far from all that was seen may be
/// anywhere.
std::string judge_corners(const CameraCalibration& c);

/// Why no camera was found at all; never empty.
std::string judge_images(const CameraCalibration& c, const CameraCalibrationOptions& options);

/// The same where a fit did not end from an initial camera; c.widest_tilt is known.
std::string judge_failed_fit(const CameraCalibration& c, const CameraCalibrationOptions& options);

}  // namespace clearway

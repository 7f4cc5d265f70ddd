#include "tracking/calibration/camera_judgement.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tracking/calibration/words.hpp"
#include "tracking/dense.hpp"
#include "tracking/pose_errors.hpp"

namespace clearway {
namespace {

constexpr double kLeastTilt = 0.35;  // radians

/// What would make the focal length better known.
std::string advice(const CameraCalibration& c) {
  if (c.widest_tilt >= kLeastTilt)
    return ": take more images, nearer to the camera and to the image's corners";
  return words(": the board is tilted by at most ", std::lround(180.0 / M_PI * c.widest_tilt),
               " degrees in 9 of 10 images; tilt it by 20 to 45 degrees to all sides");
}

/// How far k4, k5 and k6 are from 0, squared, in standard deviations (Wald 1943).
double wald_of_divisor(const CameraCalibration& c) {
  const Eigen::VectorXd k = Eigen::Map<const Eigen::VectorXd>(c.camera.distortion.data() + 5, 3);
  return k.dot(solve_symmetric(c.covariance.block(9, 9, 3, 3), k).col(0));
}

std::string met_by(const OtherLens& lens) {
  return words("a ", lens.lens == LensDistortion::Model::fisheye ? "fisheye" : "plumb_bob", " lens to ",
               lens.held_out_px, " px; expected that lens, or a wider one seen up to its corners");
}

const OtherLens& best_of(const std::vector<OtherLens>& lenses) {
  return *std::min_element(lenses.begin(), lenses.end(), [](const OtherLens& a, const OtherLens& b) {
    return a.held_out_px < b.held_out_px;
  });
}

}  // namespace

std::string judge_coverage(const CameraCalibration& c, const CameraCalibrationOptions& options) {
  if (c.coverage < options.least_coverage)
    return words("the board was seen in ", std::lround(100.0 * c.coverage), " % of the image, expected ",
                 std::lround(100.0 * options.least_coverage), " % or more: hold it into the corners, too");
  return "";
}

std::string judge_focus(const CameraCalibration& c, const CameraCalibrationOptions& options) {
  if (!c.focal_scatter.is_certain || c.focal_scatter.sigma <= options.most_focal_scatter) return "";
  return words(
      "the focal length changes from image to image by ", 100.0 * c.focal_scatter.sigma, " %, expected ",
      100.0 * options.most_focal_scatter,
      " % or less: does the camera focus, zoom or steady its pictures by itself? Switch that off; or was it "
      "moved while it took them, or the board's print stretched along one side?");
}

std::string judge(const CameraCalibration& c, const CameraCalibrationOptions& options) {
  const std::string refocused = judge_focus(c, options);
  if (refocused.empty() && !(c.camera.errors.focal <= options.most_focal_sigma))
    return words("the focal length is known to ", 100.0 * c.camera.errors.focal, " % only, expected ",
                 100.0 * options.most_focal_sigma, " % or better", advice(c));
  if (const std::string unseen = judge_coverage(c, options); !unseen.empty()) return unseen;
  try {
    c.camera.validate();
  } catch (const std::invalid_argument&) {
    const std::string wide = c.camera.lens == LensDistortion::Model::plumb_bob
                                 ? ", or take a rational or fisheye lens, if it is a wide one"
                                 : "";
    return "the distortion that fits the images does not hold in the image's corners, where the board was "
           "not seen: hold it into the corners, too" +
           wide;
  }
  if (c.sag > options.most_sag * c.width)
    return words("the board is bent by ", 1e3 * c.sag, " mm over its ", std::lround(1e3 * c.width),
                 " mm, expected ", 1e3 * options.most_sag * c.width,
                 " mm or less: glue it on something stiff and flat");
  return refocused;
}

std::string judge_rational(const CameraCalibration& c) {
  constexpr double much_better = 1.01;
  const OtherLens& plumb_bob = c.simpler.at(0);
  const bool is_needed = plumb_bob.held_out_px > much_better * c.held_out_px;
  if (is_needed && wald_of_divisor(c) > chi_square_limit(3)) return "";
  const auto pm = [&c](int i) {
    return words(c.camera.distortion[static_cast<std::size_t>(i)], " +- ",
                 std::sqrt(c.covariance(4 + i, 4 + i)));
  };
  return words("the images do not determine a rational lens (k4, k5, k6 are ", pm(5), ", ", pm(6), ", ",
               pm(7), "): it meets held-out images to ", c.held_out_px, " px, ",
               met_by(is_needed ? best_of(c.simpler) : plumb_bob));
}

std::string judge_corners(const CameraCalibration& c) {
  const double most = 0.005 * std::hypot(c.camera.width, c.camera.height);  // of a lens that is not known
  if (c.camera.lens == LensDistortion::Model::fisheye || *c.camera.errors.distortion <= most) return "";
  const auto worst = std::max_element(c.corner_errors.begin(), c.corner_errors.end());
  const char* const names[] = {"upper left", "upper right", "lower right", "lower left"};
  return words("the lens is known to +- ", *c.camera.errors.distortion,
               " px in the image's corners only, expected ", most,
               " px or better: hold the board into the corners, too, above all into the ",
               names[worst - c.corner_errors.begin()], " one");
}

std::string judge_images(const CameraCalibration& c, const CameraCalibrationOptions& options) {
  if (const std::string unseen = judge_coverage(c, options); !unseen.empty()) return unseen;
  return "no camera explains the images: expected 8 or more sharp images of the board, tilted to all sides";
}

std::string judge_failed_fit(const CameraCalibration& c, const CameraCalibrationOptions& options) {
  if (c.widest_tilt < kLeastTilt) return "the focal length cannot be determined" + advice(c);
  if (!c.simpler.empty() && std::isfinite(best_of(c.simpler).held_out_px))
    return "the images do not determine a rational lens: its fit does not end; held-out images are met by " +
           met_by(best_of(c.simpler));
  return judge_images(c, options);
}

}  // namespace clearway

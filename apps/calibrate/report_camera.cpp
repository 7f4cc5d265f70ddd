#include <cmath>
#include <stdexcept>

#include "apps/calibrate/calibrations.hpp"
#include "apps/console/parse.hpp"
#include "apps/console/table.hpp"
#include "apps/fusion/painter.hpp"
#include "datasets/descriptions/setup_blocks.hpp"
#include "tracking/calibration/calibrate_camera.hpp"

namespace clearway {
namespace {

std::string plus_minus(double value, double sigma, const std::string& unit) {
  return significant(value, 6) + " +- " + significant(sigma, 2) + " " + unit;
}

/// "k4 0.3 +- 0.1, …" of those that only a rational lens has.
std::string divisor(const CameraCalibration& found) {
  std::string text;
  for (int i = 5; i < 8; ++i)
    text += (i == 5 ? "k" : ", k") + std::to_string(i - 1) + " " +
            significant(found.camera.distortion[static_cast<std::size_t>(i)], 3) + " +- " +
            significant(std::sqrt(found.covariance(4 + i, 4 + i)), 2);
  return text;
}

std::string name_of(LensDistortion::Model lens) {
  return lens == LensDistortion::Model::fisheye ? "fisheye" : "plumb_bob";
}

/// What simpler lenses do on the same images, beside a rational one.
void describe_simpler(const CameraCalibration& found, CalibrationReport& report) {
  std::string text;
  for (const OtherLens& other : found.simpler) {
    text += (text.empty() ? "" : ", ") + name_of(other.lens) + " ";
    if (!std::isfinite(other.held_out_px)) {
      text += "none of it";
      continue;
    }
    text += significant(other.held_out_px, 3) + " px";
    if (other.held_out_px < 1.01 * found.held_out_px) text += " (does as well)";
    report.figures.push_back({"held_out_" + name_of(other.lens) + "_px", other.held_out_px});
  }
  report.rows.insert(report.rows.end(), {{"divisor", divisor(found)}, {"other lenses", "held out: " + text}});
}

void describe_camera(const CameraCalibration& found, CalibrationReport& report) {
  const Camera& camera = found.camera;
  const double f = std::sqrt(camera.fx * camera.fy);
  report.rows.insert(
      report.rows.end(),
      {{"focal length", plus_minus(f, f * camera.errors.focal, "px") + " (" +
                            significant(100.0 * camera.errors.focal, 2) + " %)"},
       {"centre", significant(camera.cx, 5) + ", " + plus_minus(camera.cy, camera.errors.center, "px")},
       {"distortion", "+- " + significant(*camera.errors.distortion, 2) + " px in the image's corner"},
       {"aspect", "fx / fy " + plus_minus(camera.fx / camera.fy, camera.errors.aspect, "")},
       {"covered", std::to_string(std::lround(100.0 * found.coverage)) + " % of the image"},
       {"tilt", "up to " + std::to_string(std::lround(180.0 / M_PI * found.widest_tilt)) + " degrees"},
       {"roll", "up to " + std::to_string(std::lround(180.0 / M_PI * found.widest_roll)) +
                    " degrees from image to image, of at most 90"},
       {"bend", significant(1e3 * found.sag, 2) + " mm of the board's " +
                    std::to_string(std::lround(1e3 * found.width)) + " mm"},
       {"residuals", significant(found.rms_px, 3) + " px rms"}});
  constexpr double enough_roll = M_PI / 4.0;
  if (found.widest_roll < enough_roll)
    report.rows.push_back({"note",
                           "the board was never turned on its side: a print stretched along one side looks "
                           "much like a camera whose fx is not fy, and the error of the aspect counts that; "
                           "turn it on its side in half of the images"});
  constexpr double square = 0.003;  // few sensors' pixels are less so
  if (const double aspect = camera.fx / camera.fy - 1.0; std::abs(aspect) > square)
    report.rows.push_back({"note", "fx is " + significant(100.0 * std::abs(aspect), 2) + " % " +
                                       (aspect > 0.0 ? "above" : "below") +
                                       " fy, where most cameras' pixels are square: is the board printed to "
                                       "scale along both sides, and no picture stretched? A board that was "
                                       "never turned on its side cannot tell"});
  if (found.focal_scatter.is_likely)
    report.rows.push_back({"focus", "the focal length changes by " +
                                        significant(100.0 * found.focal_scatter.sigma, 2) +
                                        " % from image to image"});
  if (found.held_out_px > 0.0)
    report.rows.push_back({"held out", significant(found.held_out_px, 3) + " px, " +
                                           significant(found.held_out_mm, 3) +
                                           " mm at the board (rms of images not used)"});
  report.figures = {{"focal_px", f},
                    {"focal_sigma", camera.errors.focal},
                    {"aspect_sigma", camera.errors.aspect},
                    {"center_sigma_px", camera.errors.center},
                    {"distortion_sigma_px", *camera.errors.distortion},
                    {"coverage", found.coverage},
                    {"tilt_rad", found.widest_tilt},
                    {"roll_rad", found.widest_roll},
                    {"print_stretch", found.stretch},
                    {"noise_px", found.noise_px},
                    {"rms_px", found.rms_px},
                    {"held_out_px", found.held_out_px},
                    {"held_out_m", 1e-3 * found.held_out_mm},
                    {"sag_m", found.sag},
                    {"focal_scatter", found.focal_scatter.sigma},
                    {"views", static_cast<double>(found.views)}};
  if (!found.simpler.empty()) describe_simpler(found, report);
}

}  // namespace

CalibrationReport report_camera(const CalibrateOptions& options, const Setup& setup,
                                const SearchedImages& images) {
  const BoardSetup& board = seen_board(setup, images, options.body);
  const ChosenViews chosen = choose_views(images, board);
  CameraCalibrationOptions how;
  LensModel lens = LensModel::plumb_bob;
  if (options.lens == "fisheye") {
    lens = LensModel::fisheye;
    how.lens = LensDistortion::Model::fisheye;
  } else if (options.lens == "rational") {
    lens = LensModel::rational;
    how.lens = LensDistortion::Model::rational;
  }
  how.edge_bias = tracking_options(setup).pose.edge_bias;
  const CameraCalibration found =
      calibrate_camera(images.width, images.height, tag_body(board), chosen.views, how);
  CalibrationReport report;
  report.rows = {{"board", board.name},
                 {"images", grouped(chosen.seen) + " show it; " + grouped(found.views) + " used, " +
                                grouped(chosen.moving) + " moving, " + grouped(chosen.alike) + " alike, " +
                                grouped(found.refused.size()) + " contradicted"}};
  for (const RefusedView& view : found.refused)
    report.rows.push_back({"left out", view.name + ": " + view.reason});
  report.refusal = found.refusal;
  const bool are_few = chosen.views.size() < how.least_views || chosen.moving > chosen.views.size();
  if (are_few && !report.refusal.empty()) report.refusal += chosen.left_out();
  if (chosen.seen < how.least_views && !report.refusal.empty())
    report.refusal += seen_instead(setup, images, board);
  constexpr double clearly_wrong = 3.0;  // px: corners are found to some tenths of one
  if (!report.refusal.empty() && found.rms_px > clearly_wrong)
    report.refusal = "the corners miss the board as the setup has it by " + significant(found.rms_px, 2) +
                     " px rms: are its tags where the setup says, and as large? If so, " + report.refusal;
  if (found.covariance.size() == 0) return report;
  if (found.camera.errors.distortion) describe_camera(found, report);
  if (!report.refusal.empty()) return report;
  const Camera& camera = found.camera;
  ErrorsSetup errors = setup.errors;
  errors.camera = {camera.errors.focal, camera.errors.aspect, camera.errors.center, camera.errors.distortion};
  report.blocks = {camera_block({camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy,
                                 camera.distortion, lens}),
                   errors_block(errors)};
  report.next = "Put these blocks into the setup of this camera, in place of its `camera` and `errors`.";
  return report;
}

}  // namespace clearway

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

void describe_camera(const CameraCalibration& found, CalibrationReport& report) {
  const Camera& camera = found.camera;
  const double f = std::sqrt(camera.fx * camera.fy);
  report.rows.insert(
      report.rows.end(),
      {{"focal length", plus_minus(f, f * camera.errors.focal, "px") + " (" +
                            significant(100.0 * camera.errors.focal, 2) + " %)"},
       {"centre", significant(camera.cx, 5) + ", " + plus_minus(camera.cy, camera.errors.center, "px")},
       {"distortion", "+- " + significant(*camera.errors.distortion, 2) + " px in the image's corner"},
       {"covered", std::to_string(std::lround(16.0 * found.coverage)) + " of 16 parts of the image"},
       {"tilt", "up to " + std::to_string(std::lround(180.0 / M_PI * found.widest_tilt)) + " degrees"},
       {"residuals", significant(found.rms_px, 3) + " px rms"},
       {"held out", significant(found.held_out_px, 3) + " px, " + significant(found.held_out_mm, 3) +
                        " mm at the board (rms of images not used)"}});
  report.figures = {{"focal_px", f},
                    {"focal_sigma", camera.errors.focal},
                    {"center_sigma_px", camera.errors.center},
                    {"distortion_sigma_px", *camera.errors.distortion},
                    {"coverage", found.coverage},
                    {"tilt_rad", found.widest_tilt},
                    {"noise_px", found.noise_px},
                    {"rms_px", found.rms_px},
                    {"held_out_px", found.held_out_px},
                    {"held_out_m", 1e-3 * found.held_out_mm},
                    {"views", static_cast<double>(found.views)}};
}

}  // namespace

CalibrationReport report_camera(const CalibrateOptions& options, const Setup& setup,
                                const SearchedImages& images) {
  const BoardSetup& board = seen_board(setup, images, options.body);
  const ChosenViews chosen = choose_views(images, board);
  CameraCalibrationOptions how;
  const bool is_fisheye = options.lens == "fisheye";
  if (is_fisheye) how.lens = LensDistortion::Model::fisheye;
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
  if (!report.refusal.empty() && chosen.moving > chosen.views.size())
    report.refusal += "; " + grouped(chosen.moving) + " of " + grouped(chosen.seen) +
                      " images were taken while the board moved: hold it still for a moment in each place";
  if (found.covariance.size() == 0) return report;
  if (found.camera.errors.distortion) describe_camera(found, report);
  if (!report.refusal.empty()) return report;
  const Camera& camera = found.camera;
  ErrorsSetup errors = setup.errors;
  errors.camera = {camera.errors.focal, camera.errors.aspect, camera.errors.center, camera.errors.distortion};
  report.blocks = {camera_block({camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy,
                                 camera.distortion, is_fisheye ? LensModel::fisheye : LensModel::plumb_bob}),
                   errors_block(errors)};
  report.next = "Put these blocks into the setup of this camera, in place of its `camera` and `errors`.";
  return report;
}

}  // namespace clearway

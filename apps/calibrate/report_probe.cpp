#include <cmath>
#include <stdexcept>

#include "apps/calibrate/calibrations.hpp"
#include "apps/console/parse.hpp"
#include "apps/fusion/painter.hpp"
#include "datasets/descriptions/setup_blocks.hpp"
#include "tracking/calibration/pivot.hpp"

namespace clearway {
namespace {

/// One standard deviation in the worst direction, millimetres.
std::string mm(const Eigen::Matrix3d& covariance) {
  return significant(1e3 * UncertainPoint{Eigen::Vector3d::Zero(), covariance}.largest_sigma(), 2);
}

}  // namespace

CalibrationReport report_probe(const CalibrateOptions& options, const Setup& setup,
                               const SearchedImages& images) {
  if (!setup.probe)
    throw std::invalid_argument("calibrate probe: the setup has no probe, expected `probe` with its board");
  ProbeSetup probe = *setup.probe;
  if (!options.body.empty()) probe.board = seen_board(setup, images, options.body).name;
  const SurePoses poses(setup, images);
  const BoardSetup& body = *setup.board(probe.board);
  const BoardSetup* fixed = nullptr;
  for (const BoardSetup& board : setup.boards)
    if (fixed == nullptr && board.map_from_board && board.name != probe.board) fixed = &board;
  std::vector<PivotLook> with_base, alone;
  for (const SearchedImage& image : images.images) {
    const auto found = poses.of(body, image);
    if (!found) continue;
    alone.push_back({*found, {}});
    if (fixed == nullptr) continue;
    if (auto base = poses.of(*fixed, image)) with_base.push_back({*found, base});
  }
  const PivotRig rig{known_camera(setup, images), tag_body(body), fixed ? tag_body(*fixed) : TagBody{}};
  const bool has_base = with_base.size() >= 15 && 2 * with_base.size() >= alone.size();
  const PivotCalibration found = calibrate_pivot(has_base ? with_base : alone, rig);
  const double sigma = UncertainPoint{found.ball, found.covariance}.largest_sigma();
  CalibrationReport report;
  report.refusal = found.refusal;
  if (const std::size_t unsure = images.images.size() - alone.size();
      unsure > 0 && found.covariance.isZero() && !report.refusal.empty())
    report.refusal += "; " + grouped(unsure) + " of " + grouped(images.images.size()) +
                      " images show no sure pose of the probe";
  report.rows = {
      {"probe", probe.board},
      {"against", has_base ? "board " + fixed->name : "the camera, which has to stand still"},
      {"images", grouped(images.images.size()) + ", " + grouped(found.looks) + " used, " +
                     grouped(found.left_out) + " contradicted"},
      {"turned", "by up to " + std::to_string(std::lround(180.0 / M_PI * found.turn)) + " degrees"}};
  if (found.covariance.isZero()) return report;
  report.rows.insert(
      report.rows.end(),
      {{"ball", significant(1e3 * found.ball.x()) + ", " + significant(1e3 * found.ball.y()) + ", " +
                    significant(1e3 * found.ball.z()) + " mm in the probe"},
       {"known to", significant(1e3 * sigma, 2) + " mm (one standard deviation, worst direction)"},
       {"of it", "noise " + mm(found.parts.noise) + ", camera " + mm(found.parts.camera) +
                     ", the probe's tags " + mm(found.parts.probe) +
                     (has_base ? ", the board's " + mm(found.parts.base) : "") + " mm"},
       {"residuals", significant(1e3 * found.rms, 3) + " mm rms"},
       {"moved by", significant(1e3 * (found.ball - probe.ball_center).norm(), 3) + " mm from the setup's"}});
  report.figures = {{"ball_x_m", found.ball.x()},
                    {"ball_y_m", found.ball.y()},
                    {"ball_z_m", found.ball.z()},
                    {"sigma_m", sigma},
                    {"rms_m", found.rms},
                    {"turn_rad", found.turn},
                    {"images", static_cast<double>(found.looks)}};
  if (!report.refusal.empty()) return report;
  probe.ball_center = found.ball;
  const double own = confidence_factor(1000000) * sigma;
  probe.modelling_error = std::max(probe.modelling_error, own);
  if (probe.painted_radius() <= 0.0)
    report.refusal = "the ball's centre is not known well enough for a ball of " +
                     significant(1e3 * probe.ball_radius) + " mm";
  else
    report.blocks = {probe_block(probe)};
  report.next = "Put this block into the setup, in place of its `probe`.";
  return report;
}

}  // namespace clearway

#include "tracking/calibration/calibrate_camera.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>

#include "tracking/calibration/camera_errors.hpp"
#include "tracking/calibration/camera_judgement.hpp"
#include "tracking/calibration/held_out.hpp"
#include "tracking/calibration/initial_camera.hpp"
#include "tracking/calibration/upper_median.hpp"
#include "tracking/calibration/view_spread.hpp"
#include "tracking/calibration/words.hpp"
#include "tracking/dense.hpp"
#include "tracking/pose_errors.hpp"
#include "tracking/tag_pose.hpp"

namespace clearway {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

using Lens = LensDistortion::Model;

/// For each coefficient of a rational lens, what of it shifts the image's corner by so many pixels.
void free_rational(const Camera& camera, double pixels, BundlePriors& priors) {
  const double f = std::sqrt(camera.fx * camera.fy);
  const auto corner = camera.undistort({-0.5, -0.5});
  const bool is_seen = corner && corner->norm() < 2.0;
  const auto by = seen_by_coefficients(camera, is_seen ? *corner : Eigen::Vector2d(2.0, 0.0));
  for (int i = 0; i < kLensUnknowns; ++i)
    priors.shared[static_cast<std::size_t>(4 + i)] = pixels / (f * by.col(i).norm());
}

/// The camera as free as lenses differ, so that it decides only what the images leave entirely open; k3 of a
/// plumb bob as asked; the board as well known as it says.
BundlePriors priors_of(Camera camera, const TagBody& board, bool with_k3, double growth) {
  BundlePriors priors;
  const double diagonal = std::hypot(camera.width, camera.height);
  camera.errors = {0.5, 0.5, 0.5 * camera.width, 0.5 * diagonal};
  priors.shared = camera_priors(camera);
  if (camera.lens == Lens::rational) free_rational(camera, 0.5 * diagonal, priors);
  if (camera.lens == Lens::plumb_bob && with_k3) priors.shared[8] = priors.shared[5];
  // Measured of rendered boards: blur of a pixel moves edges out by 0.06 px at 18 px of side, 0.005 above 60;
  // a gamma of 0.45 moves all in by 0.04 px.
  constexpr double side_of_small = 20.0;  // px
  if (camera.lens != Lens::rational) {    // whose many coefficients take it for their own
    priors.shared[kFirstOfGrowth] = growth;
    priors.shared[kFirstOfGrowth + 1] = side_of_small * growth;
  }
  constexpr double usual_sag = 0.01;  // of paper on a clipboard, over its width
  for (int i = 0; i < kBendUnknowns; ++i)
    priors.shared[static_cast<std::size_t>(kFirstOfBend + i)] = 4.0 * usual_sag / plane_of(board).reach;
  constexpr double usual_stretch = 0.005;  // of a print along one side
  priors.shared[kStretchUnknown] = usual_stretch;
  const TagErrors& e = board.errors;
  priors.tags.assign(board.tags.size(), {e.size, e.place, e.place, e.place, e.turn, e.turn, e.turn});
  return priors;
}

bool has_sight(const Bundle& bundle, const BoardView& view) {
  for (const TagDetection& tag : view.tags)
    for (const Eigen::Vector3d& corner : corners_on_board(bundle.board.tags.at(tag.id), bundle.bend))
      if (!bundle.camera.project(view.camera_from_board * corner)) return false;
  return true;
}

/// Takes views and tags out that stand out of the others, worst first. True when it found any.
bool leave_out(Bundle& bundle, const BundleFit& fit, std::size_t& may, std::vector<RefusedView>& refused) {
  std::vector<double> shares;
  for (std::size_t v = 0; v < bundle.views.size(); ++v) {
    double sum = 0.0;
    for (const double squares : fit.tag_squares[v]) sum += squares / 8.0;
    shares.push_back(sum / static_cast<double>(fit.tag_squares[v].size()));
  }
  const double usual = upper_median(shares);
  constexpr double times = 6.0;  // squares of a view's corners over the usual ones
  const double limit = 4.0 * usual * std::max(times, chi_square_limit(8) / 8.0);
  bool found = false;
  for (std::size_t v = bundle.views.size(); v-- > 0;) {
    BoardView& view = bundle.views[v];
    std::vector<TagDetection> kept;
    double sum = 0.0;
    for (std::size_t t = 0; t < view.tags.size(); ++t) {
      if (fit.tag_squares[v][t] / 8.0 > limit) continue;
      kept.push_back(view.tags[t]);
      sum += fit.tag_squares[v][t] / 8.0;
    }
    // Where a tag goes, the others are asked again without it.
    const bool is_whole = kept.size() == view.tags.size();
    const bool is_bad = (is_whole && sum > times * usual * static_cast<double>(kept.size())) ||
                        kept.size() < std::max<std::size_t>(2, (view.tags.size() + 1) / 2);
    if (is_bad && may > 0) {
      refused.push_back({view.name, "its corners contradict those of the other images (moved, blurred)"});
      bundle.views.erase(bundle.views.begin() + static_cast<std::ptrdiff_t>(v));
      --may;
      found = true;
    } else if (!is_bad && kept.size() < view.tags.size()) {
      view.tags = kept;
      found = true;
    }
  }
  return found;
}

/// Takes views out that one which contradicts has pushed to where the lens sees nothing.
void leave_out_unseen(Bundle& bundle, std::vector<RefusedView>& refused) {
  std::erase_if(bundle.views, [&](const BoardView& view) {
    if (has_sight(bundle, view)) return false;
    refused.push_back({view.name, "no pose of the board that the lens sees meets its corners"});
    return true;
  });
}

/// Bundle adjustment that leaves out what contradicts. The board given stays what priors are about.
BundleFit fit_all(Bundle& bundle, const BundlePriors& priors, const CameraCalibrationOptions& options,
                  std::size_t may, std::vector<RefusedView>& refused) {
  for (int round = 0;; ++round) {
    Bundle again = bundle;
    BundleFit fit = adjust_with_noise(again, priors, options.edge_bias);
    if (!fit.is_converged) return fit;
    Bundle less = again;
    less.board = bundle.board;
    less.bend = bundle.bend;
    std::vector<RefusedView> more;
    const bool is_less = round < 4 && leave_out(less, fit, may, more);
    if (is_less) leave_out_unseen(less, more);
    if (!is_less || less.views.size() < options.least_views) {
      bundle = again;
      return fit;
    }
    refused.insert(refused.end(), more.begin(), more.end());
    bundle = less;
  }
}

/// How far the bend takes corners of the board apart, along its normal.
double sag_of(const Bundle& bundle) {
  double least = kInfinity, most = -kInfinity;
  for (const auto& [id, tag] : bundle.board.tags)
    for (const Eigen::Vector3d& corner : tag_corners(tag.size)) {
      const Eigen::Vector3d flat = tag.body_from_tag * corner, by_bend = bundle.bend.bent(flat) - flat;
      const double height = bundle.bend.board_from_plane.linear().col(2).dot(by_bend);
      least = std::min(least, height);
      most = std::max(most, height);
    }
  return most - least;
}

struct Fitted {
  Bundle bundle;
  BundlePriors priors;
  BundleFit fit;
};

/// The camera's unknowns, for differences.
Eigen::VectorXd unknowns_of(const Camera& camera) {
  Eigen::VectorXd unknowns(4 + kLensUnknowns);
  unknowns << 0.5 * std::log(camera.fx * camera.fy), std::log(camera.fx / camera.fy), camera.cx, camera.cy,
      Eigen::Map<const Eigen::VectorXd>(camera.distortion.data(), kLensUnknowns);
  return unknowns;
}

/// The covariance of a camera whose k3 is taken as 0, of what it may be instead.
Eigen::MatrixXd covariance_without_k3(const Fitted& without, const Fitted& with) {
  if (!with.fit.is_converged) {
    Eigen::MatrixXd covariance = without.fit.covariance;
    covariance(8, 8) = with.priors.shared[8] * with.priors.shared[8];
    return covariance;
  }
  Eigen::MatrixXd covariance = with.fit.covariance;
  const Eigen::VectorXd off = unknowns_of(with.bundle.camera) - unknowns_of(without.bundle.camera);
  covariance.topLeftCorner(off.size(), off.size()) += off * off.transpose();
  return covariance;
}

/// The same with k3 as one more unknown, where the images show that it is not 0; else k3 stays 0, and the
/// covariance counts what it may be.
void free_k3_where_it_shows(const TagBody& board, double edge_bias, Fitted& fitted) {
  Fitted freed{fitted.bundle, {}, {}};
  freed.bundle.board = board;
  freed.bundle.bend = {fitted.bundle.bend.board_from_plane};
  freed.priors = priors_of(freed.bundle.camera, board, true, fitted.priors.shared[kFirstOfGrowth]);
  freed.fit = adjust(freed.bundle, freed.priors, fitted.fit.noise_px, edge_bias);
  const double sigma = freed.fit.is_converged ? std::sqrt(freed.fit.covariance(8, 8)) : kInfinity;
  if (std::abs(freed.bundle.camera.distortion[4]) > 4.0 * sigma)
    fitted = std::move(freed);
  else
    fitted.fit.covariance = covariance_without_k3(fitted, freed);
}

/// Where a bundle adjustment begins.
bool find_initial(Bundle& bundle, const BoardPlane& plane) {
  switch (bundle.camera.lens) {
    case Lens::fisheye:
      return find_initial_fisheye(bundle, plane);
    case Lens::rational:
      return find_initial_rational(bundle, plane);
    case Lens::plumb_bob:
      break;
  }
  return find_initial_camera(bundle, plane, false) || find_initial_camera(bundle, plane, true);
}

HeldOut held_out(const Fitted& fitted, const TagBody& board, const CameraCalibrationOptions& options) {
  return test_held_out(fitted.bundle, board, fitted.priors, fitted.fit.noise_px, options.edge_bias,
                       options.folds);
}

/// What another lens explains of the very views that `fitted` explains; infinity where it does not see all.
double held_out_by(Lens lens, const Fitted& fitted, const TagBody& board, const BoardPlane& plane,
                   const CameraCalibrationOptions& options) {
  Fitted other{fitted.bundle, {}, {}};
  Bundle& bundle = other.bundle;
  bundle.camera.lens = lens;
  bundle.camera.distortion = {};
  bundle.board = board;
  bundle.bend = {plane.board_from_plane};
  if (!find_initial(bundle, plane)) return kInfinity;
  std::erase_if(bundle.views, [&](const BoardView& view) { return !has_sight(bundle, view); });
  if (tags_of(bundle.views) < tags_of(fitted.bundle.views)) return kInfinity;
  other.priors = priors_of(bundle.camera, board, false, 0.0);  // as of the rational lens
  other.fit = adjust_with_noise(bundle, other.priors, options.edge_bias);
  if (!other.fit.is_converged) return kInfinity;
  if (lens == Lens::plumb_bob) free_k3_where_it_shows(board, options.edge_bias, other);
  return held_out(other, board, options).px;
}

void note_held_out(const Fitted& fitted, const TagBody& board, const CameraCalibrationOptions& options,
                   CameraCalibration& c) {
  const HeldOut unseen = held_out(fitted, board, options);
  c.held_out_px = unseen.px;
  c.held_out_mm = unseen.mm;
}

void add_simpler(const Fitted& fitted, const TagBody& board, const BoardPlane& plane,
                 const CameraCalibrationOptions& options, CameraCalibration& c) {
  for (const Lens simpler : {Lens::plumb_bob, Lens::fisheye})
    c.simpler.push_back({simpler, held_out_by(simpler, fitted, board, plane, options)});
}

CameraCalibration refused(CameraCalibration c, const std::string& reason) {
  c.refusal = reason;
  return c;
}

void note_fit(const Fitted& fitted, const BoardPlane& plane, CameraCalibration& c) {
  const auto& [bundle, priors, fit] = fitted;
  c.camera = bundle.camera;
  c.focal_scatter = focal_scatter(fit.focal_steps);
  c.covariance = fit.covariance.topLeftCorner<kSharedUnknowns, kSharedUnknowns>() +
                 squared(c.focal_scatter.sigma * fit.by_own_focal.topRows(kSharedUnknowns));
  c.noise_px = fit.noise_px;
  c.rms_px = fit.rms_px;
  c.views = bundle.views.size();
  c.coverage = coverage_of(bundle.camera, bundle.views);
  c.widest_tilt = widest_tilt(bundle.views, plane);
  c.widest_roll = widest_roll(bundle.views, plane);
  c.stretch = bundle.bend.stretch;
  c.camera.errors = errors_of(c.camera, c.covariance);
  c.corner_errors = corner_errors(c.camera, c.covariance);
  c.sag = sag_of(bundle);
  c.width = 2.0 * plane.reach;
}

void require_flat(const TagBody& board, const BoardPlane& plane) {
  if (plane.thickness > 0.005)
    throw std::invalid_argument("board '" + board.name + "': its tags are up to " +
                                words(1e3 * plane.thickness) +
                                " mm off a plane; expected a flat board to calibrate a camera with");
}

}  // namespace

CameraCalibration calibrate_camera(int width, int height, const TagBody& board, std::vector<BoardView> views,
                                   const CameraCalibrationOptions& options) {
  if (width < 32 || height < 32) throw std::invalid_argument("camera: expected images of 32 pixels or more");
  board.validate();
  const BoardPlane plane = plane_of(board);
  require_flat(board, plane);
  CameraCalibration calibration;
  calibration.camera.width = width;
  calibration.camera.height = height;
  calibration.camera.lens = options.lens;
  std::erase_if(views, [&](const BoardView& view) { return view.tags.size() < 2; });
  if (views.size() < options.least_views) {
    return refused(calibration, words(views.size(), " images show two tags of the board or more, expected ",
                                      options.least_views, " or more"));
  }
  const std::size_t may = views.size() / 3;
  Fitted fitted{{calibration.camera, board, std::move(views), {plane.board_from_plane}}, {}, {}};
  Bundle& bundle = fitted.bundle;
  calibration.coverage = coverage_of(bundle.camera, bundle.views);
  if (!find_initial(bundle, plane)) return refused(calibration, judge_images(calibration, options));
  std::erase_if(bundle.views, [&](const BoardView& view) { return !has_sight(bundle, view); });
  fitted.priors = priors_of(bundle.camera, board, false, options.edge_bias);
  fitted.fit = fit_all(bundle, fitted.priors, options, may, calibration.refused);
  if (!fitted.fit.is_converged || bundle.views.size() < options.least_views) {
    if (bundle.views.empty()) return refused(calibration, judge_images(calibration, options));
    calibration.widest_tilt = widest_tilt(bundle.views, plane);
    if (options.lens == Lens::rational) add_simpler(fitted, board, plane, options, calibration);
    return refused(calibration, judge_failed_fit(calibration, options));
  }
  if (options.lens == Lens::plumb_bob) free_k3_where_it_shows(board, options.edge_bias, fitted);
  note_fit(fitted, plane, calibration);
  const bool is_rational = options.lens == Lens::rational;
  if (is_rational && judge_coverage(calibration, options).empty()) {
    note_held_out(fitted, board, options, calibration);
    add_simpler(fitted, board, plane, options, calibration);
    // A focus that moves blurs k4, k5 and k6.
    calibration.refusal = judge_focus(calibration, options);
    if (calibration.refusal.empty()) calibration.refusal = judge_rational(calibration);
  }
  if (calibration.refusal.empty()) calibration.refusal = judge(calibration, options);
  if (calibration.refusal.empty()) calibration.refusal = judge_corners(calibration);
  if (calibration.focal_scatter.is_likely) {  // the next image has a focal length of its own
    double& focal = calibration.camera.errors.focal;
    focal = std::hypot(focal, calibration.focal_scatter.sigma);
  }
  if (calibration.refusal.empty() && !is_rational) note_held_out(fitted, board, options, calibration);
  return calibration;
}

}  // namespace clearway

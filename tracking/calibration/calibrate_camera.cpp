#include "tracking/calibration/calibrate_camera.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <stdexcept>

#include "tracking/calibration/initial_camera.hpp"
#include "tracking/calibration/words.hpp"
#include "tracking/dense.hpp"
#include "tracking/pose_errors.hpp"
#include "tracking/pose_refinement.hpp"
#include "tracking/tag_pose.hpp"

namespace clearway {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kCells = 4;

/// The camera as free as lenses differ, so that it decides only what the images leave entirely open; k3 as
/// asked; the board as well known as it says.
BundlePriors priors_of(Camera camera, const TagBody& board, bool with_k3) {
  BundlePriors priors;
  camera.errors = {0.5, 0.5, 0.5 * camera.width, 0.5 * std::hypot(camera.width, camera.height)};
  priors.camera = camera_priors(camera);
  const bool is_fisheye = camera.lens == LensDistortion::Model::fisheye;
  priors.camera.back() = with_k3 && !is_fisheye ? priors.camera[5] : 0.0;
  const TagErrors& e = board.errors;
  priors.tags.assign(board.tags.size(), {e.size, e.place, e.place, e.place, e.turn, e.turn, e.turn});
  return priors;
}

bool has_sight(const Bundle& bundle, const BoardView& view) {
  for (const TagDetection& tag : view.tags)
    for (const Eigen::Vector3d& corner : tag_corners(bundle.board.tags.at(tag.id).size))
      if (!bundle.camera.project(view.camera_from_board *
                                 (bundle.board.tags.at(tag.id).body_from_tag * corner)))
        return false;
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
  std::vector<double> sorted = shares;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2),
                   sorted.end());
  const double usual = sorted[sorted.size() / 2];
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

/// Bundle adjustment that leaves out what contradicts. The board given stays what priors are about.
BundleFit fit_all(Bundle& bundle, const BundlePriors& priors, const CameraCalibrationOptions& options,
                  std::size_t may, std::vector<RefusedView>& refused) {
  for (int round = 0;; ++round) {
    Bundle again = bundle;
    BundleFit fit = adjust_with_noise(again, priors, options.edge_bias);
    if (!fit.is_converged) return fit;
    Bundle less = again;
    less.board = bundle.board;
    if (round == 4 || !leave_out(less, fit, may, refused) || less.views.size() < options.least_views) {
      bundle = again;
      return fit;
    }
    bundle = less;
  }
}

double coverage_of(const Bundle& bundle) {
  std::set<int> cells;
  const Camera& camera = bundle.camera;
  for (const BoardView& view : bundle.views)
    for (const TagDetection& tag : view.tags)
      for (const Eigen::Vector2d& corner : tag.corners) {
        const int column =
            std::clamp(static_cast<int>(kCells * (corner.x() + 0.5) / camera.width), 0, kCells - 1);
        const int row =
            std::clamp(static_cast<int>(kCells * (corner.y() + 0.5) / camera.height), 0, kCells - 1);
        cells.insert(kCells * row + column);
      }
  return static_cast<double>(cells.size()) / (kCells * kCells);
}

/// The tilt against the image that one in ten views exceeds.
double widest_tilt(const Bundle& bundle, const BoardPlane& plane) {
  std::vector<double> tilts;
  for (const BoardView& view : bundle.views) {
    const Eigen::Vector3d normal = view.camera_from_board.linear() * plane.board_from_plane.linear().col(2);
    tilts.push_back(std::acos(std::clamp(std::abs(normal.z()), 0.0, 1.0)));
  }
  std::sort(tilts.begin(), tilts.end());
  return tilts[tilts.size() * 9 / 10];
}

/// Errors of the camera that move the image as the covariance does, or more.
CameraErrors errors_of(const Camera& camera, const Eigen::MatrixXd& covariance) {
  CameraErrors errors;
  errors.focal = std::sqrt(covariance(0, 0));
  errors.aspect = std::sqrt(covariance(1, 1));
  errors.center = std::sqrt(std::max(covariance(2, 2), covariance(3, 3)));
  // Distortion: its covariance alone, what centre and focal length explain of it taken away (Schur).
  const Eigen::MatrixXd own = covariance.bottomRightCorner(5, 5), cross = covariance.block(4, 0, 5, 4);
  const Eigen::MatrixXd known = solve_symmetric(covariance.topLeftCorner(4, 4), cross.transpose());
  const Eigen::MatrixXd left = own - product(cross, known);
  errors.distortion = 1.0;
  Camera unit = camera;
  unit.errors = {0.0, 0.0, 0.0, 1.0};
  double most = 0.0;
  const double f = std::sqrt(camera.fx * camera.fy);
  for (int i = 0; i <= 12; ++i)
    for (int j = 0; j <= 12; ++j) {
      const Eigen::Vector2d pixel(camera.width * i / 12.0 - 0.5, camera.height * j / 12.0 - 0.5);
      const auto ray = camera.undistort(pixel);
      if (!ray || ray->norm() < 1e-3) continue;
      const double x = ray->x(), y = ray->y(), r2 = ray->squaredNorm();
      Eigen::Matrix<double, 2, 5> by;
      if (camera.lens == LensDistortion::Model::fisheye)
        by = seen_by_coefficients(camera, *ray);
      else
        by << x * r2, x * r2 * r2, 2 * x * y, r2 + 2 * x * x, x * r2 * r2 * r2,  //
            y * r2, y * r2 * r2, r2 + 2 * y * y, 2 * x * y, y * r2 * r2 * r2;
      const double actual = f * f * sandwich(by, left).trace();
      const double stated = unit.shift_by_errors(pixel).squaredNorm();
      if (stated > 1e-4) most = std::max(most, actual / stated);
    }
  errors.distortion = std::sqrt(most);
  return errors;
}

std::vector<CornerMatch> matches(const TagBody& board, const BoardView& view) {
  std::vector<CornerMatch> corners;
  for (const TagDetection& tag : view.tags) {
    const auto points = tag_corners(board.tags.at(tag.id).size);
    for (std::size_t i = 0; i < 4; ++i)
      corners.push_back({board.tags.at(tag.id).body_from_tag * points[i], tag.corners[i]});
  }
  return corners;
}

/// Sums over views that a calibration has not seen.
struct HeldOut {
  double squared_px = 0.0, squared_mm = 0.0, freedom = 0.0;

  void add(const Camera& camera, const TagBody& board, const BoardView& view) {
    const std::vector<CornerMatch> corners = matches(board, view);
    const auto pose = refine_pose(camera, corners, view.camera_from_board);
    if (!pose || corners.size() < 4) return;
    for (const CornerMatch& corner : corners) {
      const Eigen::Vector3d at = pose->camera_from_body * corner.in_body;
      const auto pixel = camera.project(at);
      if (!pixel) return;
      const double squared = (*pixel - corner.pixel).squaredNorm();
      squared_px += squared;
      const double distance = camera.lens == LensDistortion::Model::fisheye ? at.norm() : at.z();
      squared_mm += squared * std::pow(1e3 * distance / std::sqrt(camera.fx * camera.fy), 2);
    }
    freedom += static_cast<double>(corners.size()) - 3.0;  // corners, less half the pose's unknowns
  }
};

void test_held_out(const Bundle& fitted, const TagBody& reported, const BundlePriors& priors,
                   const CameraCalibrationOptions& options, CameraCalibration& calibration) {
  HeldOut sums;
  const std::size_t folds = static_cast<std::size_t>(std::max(2, options.folds));
  for (std::size_t fold = 0; fold < folds; ++fold) {
    Bundle others = fitted;
    others.board = reported;
    others.views.clear();
    for (std::size_t v = 0; v < fitted.views.size(); ++v)
      if (v % folds != fold) others.views.push_back(fitted.views[v]);
    if (!adjust(others, priors, calibration.noise_px, options.edge_bias).is_converged) continue;
    for (std::size_t v = fold; v < fitted.views.size(); v += folds)
      sums.add(others.camera, others.board, fitted.views[v]);
  }
  if (sums.freedom <= 0.0) return;
  calibration.held_out_px = std::sqrt(sums.squared_px / sums.freedom);
  calibration.held_out_mm = std::sqrt(sums.squared_mm / sums.freedom);
}

constexpr double kLeastTilt = 0.35;  // radians

/// What would make the focal length better known.
std::string advice(const CameraCalibration& c) {
  if (c.widest_tilt >= kLeastTilt)
    return ": take more images, nearer to the camera and to the image's corners";
  return words(": the board is tilted by at most ", std::lround(180.0 / M_PI * c.widest_tilt),
               " degrees in 9 of 10 images; tilt it by 20 to 45 degrees to all sides");
}

std::string judge_coverage(const CameraCalibration& c, const CameraCalibrationOptions& options) {
  if (c.coverage < options.least_coverage)
    return words("the board was seen in ", std::lround(kCells * kCells * c.coverage), " of ", kCells * kCells,
                 " parts of the image, expected ", std::ceil(kCells * kCells * options.least_coverage),
                 " or more: hold it into the corners, too");
  return "";
}

std::string judge(const CameraCalibration& c, const CameraCalibrationOptions& options) {
  if (!(c.camera.errors.focal <= options.most_focal_sigma))
    return words("the focal length is known to ", 100.0 * c.camera.errors.focal, " % only, expected ",
                 100.0 * options.most_focal_sigma, " % or better", advice(c));
  if (const std::string unseen = judge_coverage(c, options); !unseen.empty()) return unseen;
  try {
    c.camera.validate();
  } catch (const std::invalid_argument&) {
    return "the distortion that fits the images does not hold in the image's corners, where the board was "
           "not seen: hold it into the corners, too";
  }
  return "";
}

struct Fitted {
  Bundle bundle;
  BundlePriors priors;
  BundleFit fit;
};

/// The same with k3 as one more unknown, where the images show that it is not 0.
void free_k3_where_it_shows(const TagBody& board, double edge_bias, Fitted& fitted) {
  Fitted freed{fitted.bundle, {}, {}};
  freed.bundle.board = board;
  freed.priors = priors_of(freed.bundle.camera, board, true);
  freed.fit = adjust(freed.bundle, freed.priors, fitted.fit.noise_px, edge_bias);
  const double sigma = freed.fit.is_converged ? std::sqrt(freed.fit.covariance(8, 8)) : kInfinity;
  if (std::abs(freed.bundle.camera.distortion[4]) > 4.0 * sigma) fitted = std::move(freed);
}

/// Why no camera was found at all.
std::string judge_images(const CameraCalibration& c, const CameraCalibrationOptions& options) {
  if (const std::string unseen = judge_coverage(c, options); !unseen.empty()) return unseen;
  return "no camera explains the images: expected 8 or more sharp images of the board, tilted to all sides";
}

/// Why a camera was not found from its initial one. @param bundle what is left of the images
std::string judge_failure(const Bundle& bundle, const BoardPlane& plane, CameraCalibration& c,
                          const CameraCalibrationOptions& options) {
  if (bundle.views.empty()) return judge_images(c, options);
  c.widest_tilt = widest_tilt(bundle, plane);
  const bool is_frontal = c.widest_tilt < kLeastTilt;
  return is_frontal ? "the focal length cannot be determined" + advice(c) : judge_images(c, options);
}

void note_fit(const Fitted& fitted, const BoardPlane& plane, CameraCalibration& c) {
  const auto& [bundle, priors, fit] = fitted;
  c.camera = bundle.camera;
  c.covariance = fit.covariance.topLeftCorner<kCameraUnknowns, kCameraUnknowns>();
  c.noise_px = fit.noise_px;
  c.rms_px = fit.rms_px;
  c.views = bundle.views.size();
  c.coverage = coverage_of(bundle);
  c.widest_tilt = widest_tilt(bundle, plane);
  c.camera.errors = errors_of(c.camera, c.covariance);
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
  if (options.lens == LensDistortion::Model::rational)
    throw std::invalid_argument("camera: rational lenses are not calibrated, expected plumb_bob or fisheye");
  board.validate();
  const BoardPlane plane = plane_of(board);
  require_flat(board, plane);
  CameraCalibration calibration;
  calibration.camera.width = width;
  calibration.camera.height = height;
  calibration.camera.lens = options.lens;
  const bool is_fisheye = options.lens == LensDistortion::Model::fisheye;
  std::erase_if(views, [&](const BoardView& view) { return view.tags.size() < 2; });
  if (views.size() < options.least_views) {
    calibration.refusal = words(views.size(), " images show two tags of the board or more, expected ",
                                options.least_views, " or more");
    return calibration;
  }
  const std::size_t may = views.size() / 3;
  Fitted fitted{{calibration.camera, board, std::move(views)}, {}, {}};
  Bundle& bundle = fitted.bundle;
  calibration.coverage = coverage_of(bundle);
  const bool is_found =
      is_fisheye ? find_initial_fisheye(bundle, plane)
                 : find_initial_camera(bundle, plane, false) || find_initial_camera(bundle, plane, true);
  if (!is_found) {
    calibration.refusal = judge_images(calibration, options);
    return calibration;
  }
  std::erase_if(bundle.views, [&](const BoardView& view) { return !has_sight(bundle, view); });
  fitted.priors = priors_of(bundle.camera, board, false);
  fitted.fit = fit_all(bundle, fitted.priors, options, may, calibration.refused);
  if (!fitted.fit.is_converged || bundle.views.size() < options.least_views) {
    calibration.refusal = judge_failure(bundle, plane, calibration, options);
    return calibration;
  }
  if (!is_fisheye) free_k3_where_it_shows(board, options.edge_bias, fitted);
  note_fit(fitted, plane, calibration);
  calibration.refusal = judge(calibration, options);
  if (calibration.refusal.empty()) test_held_out(bundle, board, fitted.priors, options, calibration);
  return calibration;
}

}  // namespace clearway

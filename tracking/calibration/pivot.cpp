#include "tracking/calibration/pivot.hpp"

#include <algorithm>
#include <cmath>

#include "tracking/calibration/words.hpp"
#include "tracking/dense.hpp"

namespace clearway {
namespace {

using Matrix38d = Eigen::Matrix<double, 3, kCameraModes>;

Eigen::Isometry3d reference_from_probe(const PivotLook& look) {
  const Eigen::Isometry3d& probe = look.probe.camera_from_body.pose;
  return look.base ? look.base->camera_from_body.pose.inverse() * probe : probe;
}

/// The ball of one look in the reference, and what moves it.
struct BallPlace {
  Eigen::Vector3d place;
  Eigen::Matrix3d noise, tags;
  Matrix38d by_camera;
};

BallPlace place_of(const PivotLook& look, const Eigen::Vector3d& ball) {
  const Eigen::Isometry3d pose = reference_from_probe(look);
  BallPlace at{pose * ball, {}, {}, {}};
  const Matrix36d by_probe = product(pose.linear(), point_by_motion(ball));
  const PoseErrors& probe = look.probe.errors;
  at.noise = sandwich(by_probe, probe.noise + probe.edges);
  at.tags = sandwich(by_probe, probe.tags);
  at.by_camera = product(by_probe, probe.by_camera);
  if (look.base) {
    const Matrix36d by_base = -point_by_motion(at.place);
    const PoseErrors& base = look.base->errors;
    at.noise += sandwich(by_base, base.noise + base.edges);
    at.tags += sandwich(by_base, base.tags);
    at.by_camera += product(by_base, base.by_camera);
  }
  return at;
}

/// Normal equations of (ball, pivot) at `ball`.
struct PivotFit {
  Vector6d found = Vector6d::Zero();  ///< ball, pivot
  Matrix6d inverse = Matrix6d::Zero();
  std::vector<double> squares;  ///< of each look, 3 expected
  double rms = 0.0;
  bool is_solved = false;
};

PivotFit fit_pivot(const std::vector<PivotLook>& looks, Eigen::Vector3d ball) {
  PivotFit fit;
  for (int round = 0; round < 4; ++round) {
    Matrix6d normal = Matrix6d::Zero();
    Vector6d pull = Vector6d::Zero();
    for (const PivotLook& look : looks) {
      const Eigen::Isometry3d pose = reference_from_probe(look);
      Matrix36d by;
      by << pose.linear(), -Eigen::Matrix3d::Identity();
      const Cholesky noise(place_of(look, ball).noise);
      normal += transposed_product(by, noise.solve(by));
      pull -= transposed_product(by, noise.solve(pose.translation()));
    }
    const Cholesky solver(normal);
    if (!solver.is_positive()) return fit;
    fit.found = solver.solve(pull);
    fit.inverse = solver.inverse();
    ball = fit.found.head<3>();
  }
  double sum = 0.0;
  for (const PivotLook& look : looks) {
    const BallPlace at = place_of(look, ball);
    const Eigen::Vector3d off = at.place - fit.found.tail<3>();
    fit.squares.push_back(Cholesky(at.noise).squared(off));
    sum += off.squaredNorm();
  }
  fit.rms = std::sqrt(sum / static_cast<double>(looks.size()));
  fit.is_solved = fit.found.allFinite() && fit.inverse.allFinite();
  return fit;
}

/// Takes out looks whose squares are far above the usual ones. True when it found any.
bool leave_out_looks(std::vector<PivotLook>& looks, const PivotFit& fit, std::size_t& may) {
  std::vector<double> sorted = fit.squares;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2),
                   sorted.end());
  const double limit = 20.0 * sorted[sorted.size() / 2] / 2.37;  // 2.37: the median of chi-square(3)
  bool found = false;
  for (std::size_t i = looks.size(); i-- > 0 && may > 0;) {
    if (fit.squares[i] <= limit) continue;
    looks.erase(looks.begin() + static_cast<std::ptrdiff_t>(i));
    --may;
    found = true;
  }
  return found;
}

double widest_turn(const std::vector<PivotLook>& looks) {
  double widest = 0.0;
  for (std::size_t i = 0; i < looks.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      widest = std::max(widest, Eigen::AngleAxisd(reference_from_probe(looks[i]).linear().transpose() *
                                                  reference_from_probe(looks[j]).linear())
                                    .angle());
  return widest;
}

/// Noise as the residuals show it, and what all looks share.
Eigen::Matrix3d covariance_of(const std::vector<PivotLook>& looks, const PivotFit& fit) {
  double squares = 0.0;
  for (const double of_look : fit.squares) squares += of_look;
  const double freedom = std::max(1.0, 3.0 * static_cast<double>(looks.size()) - 6.0);
  Eigen::Matrix<double, 6, kCameraModes> by_camera = Eigen::Matrix<double, 6, kCameraModes>::Zero();
  Eigen::Matrix3d tags = Eigen::Matrix3d::Zero();
  for (const PivotLook& look : looks) {
    const BallPlace at = place_of(look, fit.found.head<3>());
    const Eigen::Matrix3d turn = reference_from_probe(look).linear();
    Matrix36d by;
    by << turn, -Eigen::Matrix3d::Identity();
    by_camera -= transposed_product(by, Cholesky(at.noise).solve(at.by_camera));
    tags += sandwich(turn.transpose(), at.tags) / static_cast<double>(looks.size());
  }
  const Matrix38d camera = product(fit.inverse.topRows<3>(), by_camera);
  return std::max(1.0, squares / freedom) * fit.inverse.topLeftCorner<3, 3>() + squared(camera) + tags;
}

}  // namespace

PivotCalibration calibrate_pivot(const std::vector<PivotLook>& given, const PivotOptions& options) {
  PivotCalibration found;
  std::vector<PivotLook> looks = given;
  found.looks = looks.size();
  if (looks.size() < options.least_looks) {
    found.refusal = std::to_string(looks.size()) + " images show the probe's pose, expected " +
                    std::to_string(options.least_looks) + " or more";
    return found;
  }
  found.turn = widest_turn(looks);
  const std::string turn_more = "turn the probe to all sides by 30 degrees or more, its ball in a cup";
  if (found.turn < options.least_turn) {
    found.refusal =
        "the probe turned by at most " + words(180.0 / M_PI * found.turn, " degrees: ") + turn_more;
    return found;
  }
  std::size_t may = looks.size() / 3;
  PivotFit fit = fit_pivot(looks, Eigen::Vector3d::Zero());
  for (int round = 0; round < 5 && fit.is_solved && leave_out_looks(looks, fit, may); ++round)
    fit = fit_pivot(looks, fit.found.head<3>());
  if (!fit.is_solved) {
    found.refusal = "the images do not determine the ball's centre: " + turn_more;
    return found;
  }
  found.left_out = found.looks - looks.size();
  found.looks = looks.size();
  found.ball = fit.found.head<3>();
  found.rms = fit.rms;
  found.covariance = covariance_of(looks, fit);
  const double sigma = UncertainPoint{found.ball, found.covariance}.largest_sigma();
  if (!(sigma <= options.most_sigma))
    found.refusal = "the ball's centre is known to " + words(1e3 * sigma, " mm only, expected ") +
                    words(1e3 * options.most_sigma, " mm or better: ") + turn_more;
  return found;
}

}  // namespace clearway

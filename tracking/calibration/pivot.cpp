#include "tracking/calibration/pivot.hpp"

#include <algorithm>
#include <cmath>

#include "tracking/calibration/upper_median.hpp"
#include "tracking/calibration/words.hpp"
#include "tracking/dense.hpp"

namespace clearway {
namespace {

Eigen::Isometry3d reference_from_probe(const PivotLook& look) {
  const Eigen::Isometry3d& probe = look.probe.camera_from_body.pose;
  return look.base ? look.base->camera_from_body.pose.inverse() * probe : probe;
}

/// The ball of one look in the reference, and what moves it: columns are scaled to one standard deviation.
struct BallPlace {
  Eigen::Vector3d place;
  Eigen::Matrix3d noise;
  Eigen::MatrixXd by_camera;
};

BallPlace place_of(const PivotLook& look, const Eigen::Vector3d& ball) {
  const Eigen::Isometry3d pose = reference_from_probe(look);
  BallPlace at{pose * ball, {}, {}};
  const Matrix36d by_probe = product(pose.linear(), point_by_motion(ball));
  const PoseErrors& probe = look.probe.errors;
  at.noise = sandwich(by_probe, probe.noise + probe.edges);
  at.by_camera = product(by_probe, probe.by_camera);
  if (look.base) {
    const Matrix36d by_base = -point_by_motion(at.place);
    const PoseErrors& base = look.base->errors;
    at.noise += sandwich(by_base, base.noise + base.edges);
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
  const double limit = 20.0 * upper_median(fit.squares) / 2.37;  // 2.37: the median of chi-square(3)
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

/// How a body's pose moves with errors of its tags: their common scale, then seven of each, seen or not.
Eigen::MatrixXd motion_by_tags(const TagBody& body, const Camera& camera, const BodyPose& pose) {
  constexpr int own = 7;
  Eigen::MatrixXd by = Eigen::MatrixXd::Zero(6, 1 + own * static_cast<int>(body.tags.size()));
  std::vector<std::pair<int, TagView>> views;
  Matrix6d information = Matrix6d::Zero();
  int column = 1;
  for (const auto& [id, tag] : body.tags) {
    const std::array<Eigen::Vector2d, 4> unseen{Eigen::Vector2d(0, 0), {1, 0}, {1, 1}, {0, 1}};
    const bool is_used = std::find(pose.tags.begin(), pose.tags.end(), id) != pose.tags.end();
    const auto view = is_used ? view_tag(camera, tag.size, tag.body_from_tag, body.errors, 0.0, unseen,
                                         pose.camera_from_body.pose)
                              : std::nullopt;
    if (view) views.emplace_back(column, *view);
    if (view) information += transposed_product(view->by_motion, view->by_motion);
    column += own;
  }
  const Cholesky solver(information);
  if (!solver.is_positive()) return by;
  for (const auto& [at, view] : views) {
    const Eigen::MatrixXd by_pixels = -solver.solve(view.by_motion.transpose());
    by.col(0) += product(by_pixels, view.by_shared.rightCols(1));
    by.middleCols(at, own) = product(by_pixels, view.by_own.leftCols(own));
  }
  return by;
}

/// Errors that move the ball of each look by columns of `by`.
class SharedPart {
 public:
  void add(const Eigen::MatrixXd& by_found, const Cholesky& noise, const Eigen::MatrixXd& by) {
    const Eigen::MatrixXd weighed = noise.solve(by);
    if (pull_.size() == 0) pull_ = Eigen::MatrixXd::Zero(6, by.cols());
    pull_ += transposed_product(by_found, weighed);
    squares_ += by.cwiseProduct(weighed).sum();
  }

  Eigen::Matrix3d of_ball(const PivotFit& fit) const {
    if (pull_.size() == 0) return Eigen::Matrix3d::Zero();
    return squared(product(fit.inverse.topRows<3>(), pull_));
  }

  /// What of the looks' squares these errors make one expect: those that the fit does not follow.
  double expected(const PivotFit& fit) const {
    if (pull_.size() == 0) return 0.0;
    return std::max(0.0, squares_ - pull_.cwiseProduct(product(fit.inverse, pull_)).sum());
  }

 private:
  Eigen::MatrixXd pull_;
  double squares_ = 0.0;
};

/// How the poses of a look move with errors of their tags.
struct TagMotions {
  Eigen::MatrixXd probe, base;
};

std::vector<TagMotions> motions_of(const std::vector<PivotLook>& looks, const PivotRig& rig) {
  std::vector<TagMotions> motions;
  for (const PivotLook& look : looks)
    motions.push_back({motion_by_tags(rig.probe, rig.camera, look.probe),
                       look.base ? motion_by_tags(rig.base, rig.camera, *look.base) : Eigen::MatrixXd()});
  return motions;
}

struct PivotErrors {
  PivotCalibration::Parts parts;
  double freedom = 1.0;
  double excess = 1.0;  ///< the looks' squares over those that all stated errors make one expect
};

/// Noise as the residuals show it, and what all looks share.
PivotErrors pivot_errors(const std::vector<PivotLook>& looks, const std::vector<TagMotions>& motions,
                         const PivotFit& fit) {
  const Eigen::Vector3d ball = fit.found.head<3>();
  const Matrix36d by_motion = point_by_motion(ball);
  SharedPart camera, probe, base;
  for (std::size_t i = 0; i < looks.size(); ++i) {
    const BallPlace at = place_of(looks[i], ball);
    const Cholesky noise(at.noise);
    const Eigen::Matrix3d turn = reference_from_probe(looks[i]).linear();
    Matrix36d by;
    by << turn, -Eigen::Matrix3d::Identity();
    camera.add(by, noise, at.by_camera);
    probe.add(by, noise, product(product(turn, by_motion), motions[i].probe));
    if (looks[i].base) base.add(by, noise, product(-point_by_motion(at.place), motions[i].base));
  }
  double squares = 0.0;
  for (const double of_look : fit.squares) squares += of_look;
  PivotErrors errors;
  errors.freedom = std::max(1.0, 3.0 * static_cast<double>(looks.size()) - 6.0);
  errors.excess =
      squares / (errors.freedom + camera.expected(fit) + probe.expected(fit) + base.expected(fit));
  errors.parts = {std::max(1.0, errors.excess) * fit.inverse.topLeftCorner<3, 3>(), camera.of_ball(fit),
                  probe.of_ball(fit), base.of_ball(fit)};
  return errors;
}

/// Looks whose ball slips by so much along each axis, one standard deviation.
std::vector<PivotLook> slipping(std::vector<PivotLook> looks, double slip) {
  for (PivotLook& look : looks)
    look.probe.errors.noise.topLeftCorner<3, 3>() += slip * slip * Eigen::Matrix3d::Identity();
  return looks;
}

/// Lets the ball slip as much as the looks show beyond chance (Paule and Mandel 1982): by bisection.
PivotErrors find_slip(std::vector<PivotLook>& looks, const PivotRig& rig, PivotFit& fit) {
  const std::vector<TagMotions> motions = motions_of(looks, rig);
  const PivotErrors steady = pivot_errors(looks, motions, fit);
  if (steady.excess <= 1.0 + 2.0 * std::sqrt(2.0 / steady.freedom)) return steady;
  double least = 0.0, most = fit.rms;
  for (int round = 0; round < 8; ++round) {
    const double slip = 0.5 * (least + most);
    const auto tried = slipping(looks, slip);
    const PivotFit next = fit_pivot(tried, fit.found.head<3>());
    (next.is_solved && pivot_errors(tried, motions, next).excess > 1.0 ? least : most) = slip;
  }
  looks = slipping(looks, most);
  fit = fit_pivot(looks, fit.found.head<3>());
  return pivot_errors(looks, motions, fit);
}

double widest_sigma(const Eigen::Matrix3d& covariance) {
  return UncertainPoint{Eigen::Vector3d::Zero(), covariance}.largest_sigma();
}

/// What makes the ball known better, by the part that is the largest.
std::string cure(const PivotCalibration::Parts& parts, const PivotRig& rig, const std::string& turn_more) {
  const auto measure = [](const TagBody& body) {
    return "tags: measure them with `calibrate board --body " + body.name + "`";
  };
  const std::pair<Eigen::Matrix3d, std::string> named[] = {
      {parts.noise, "noise and slips: " + turn_more + ", near to the camera, in more images"},
      {parts.camera, "what is not known of the camera: calibrate it, and state its `errors`"},
      {parts.probe, "what is not known of the probe's " + measure(rig.probe)},
      {parts.base, "what is not known of the fixed board's " + measure(rig.base) +
                       ", or show the probe alone to a camera that stands still"}};
  const auto* most = std::max_element(std::begin(named), std::end(named), [](const auto& a, const auto& b) {
    return widest_sigma(a.first) < widest_sigma(b.first);
  });
  return words(1e3 * widest_sigma(most->first), " mm of it by ") + most->second;
}

}  // namespace

PivotCalibration calibrate_pivot(const std::vector<PivotLook>& given, const PivotRig& rig,
                                 const PivotOptions& options) {
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
  found.parts = find_slip(looks, rig, fit).parts;
  found.left_out = found.looks - looks.size();
  found.looks = looks.size();
  found.ball = fit.found.head<3>();
  found.rms = fit.rms;
  found.covariance = found.parts.noise + found.parts.camera + found.parts.probe + found.parts.base;
  const double sigma = widest_sigma(found.covariance);
  if (!(sigma <= options.most_sigma))
    found.refusal = words("the ball's centre is known to ", 1e3 * sigma, " mm only, expected ",
                          1e3 * options.most_sigma, " mm or better; ", cure(found.parts, rig, turn_more));
  return found;
}

}  // namespace clearway

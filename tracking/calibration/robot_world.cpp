#include "tracking/calibration/robot_world.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <tuple>

#include "tracking/calibration/upper_median.hpp"
#include "tracking/calibration/words.hpp"
#include "tracking/dense.hpp"

namespace clearway {
namespace {

constexpr double kUsualSquares = 5.35;  // the median of chi-square(6)

Matrix6d of_corners(const BodyPose& body) { return body.errors.noise + body.errors.edges; }

/// Both poses that are looked for.
struct Answer {
  Eigen::Isometry3d world_from_base = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d tip_from_rider = Eigen::Isometry3d::Identity();

  Eigen::Isometry3d rider(const RobotLook& look) const {
    return world_from_base * look.base_from_tip * tip_from_rider;
  }
};

/// Normal equations over the motions of the base and of the rider, twelve numbers; dynamic sizes compile
/// fast.
struct Equations {
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(12, 12), by_camera = Eigen::MatrixXd::Zero(12, kCameraModes);
  Eigen::VectorXd pull = Eigen::VectorXd::Zero(12), by_scale = Eigen::VectorXd::Zero(12);
  double scale_normal = 0.0, scale_pull = 0.0;
  Eigen::MatrixXd by_joints, joints_normal;  ///< 12 x joints, joints x joints
  Eigen::VectorXd joints_pull, joints_by_scale;
  std::vector<double> squares;  ///< of each look, 6 expected

  explicit Equations(Eigen::Index joints = 0)
      : by_joints(Eigen::MatrixXd::Zero(12, joints)),
        joints_normal(Eigen::MatrixXd::Zero(joints, joints)),
        joints_pull(Eigen::VectorXd::Zero(joints)),
        joints_by_scale(Eigen::VectorXd::Zero(joints)) {}

  void add(const Equations& one, double weight) {
    normal += weight * one.normal;
    pull += weight * one.pull;
    by_camera += weight * one.by_camera;
    by_scale += weight * one.by_scale;
    scale_normal += weight * one.scale_normal;
    scale_pull += weight * one.scale_pull;
    by_joints += weight * one.by_joints;
    joints_normal += weight * one.joints_normal;
    joints_pull += weight * one.joints_pull;
    joints_by_scale += weight * one.joints_by_scale;
    squares.insert(squares.end(), one.squares.begin(), one.squares.end());
  }

  /// The sum without one of the looks.
  Equations without(const Equations& one) const {
    Equations rest = *this;
    rest.normal -= one.normal;
    rest.pull -= one.pull;
    return rest;
  }
};

class Fit {
 public:
  Fit(const std::vector<RobotLook>& looks, const RobotWorldOptions& options)
      : looks_(looks), joints_(static_cast<Eigen::Index>(options.joints.size())) {
    tip_.setZero();
    tip_.diagonal().head<3>().setConstant(options.tip_error * options.tip_error);
    tip_.diagonal().tail<3>().setConstant(options.tip_turn * options.tip_turn);
  }

  /// One look's share of the equations at an answer.
  Equations of_look(const RobotLook& look, const Answer& at) const {
    const Matrix6d covariance = look.world_from_rider.covariance + carried(at.tip_from_rider.inverse(), tip_);
    const Vector6d off = difference(look.world_from_rider.pose, at.rider(look));
    Eigen::MatrixXd by(6, 12);
    by << adjoint((look.base_from_tip * at.tip_from_rider).inverse()), Matrix6d::Identity();
    // Tags s times as far: the world's rider moves by (s - 1) times its place, seen in itself.
    Vector6d scale = Vector6d::Zero();
    scale.head<3>() =
        -(look.world_from_rider.pose.linear().transpose() * look.world_from_rider.pose.translation());
    const Cholesky solver(covariance);
    const Eigen::MatrixXd weighed = solver.solve(by);
    Equations one(joints_);
    if (joints_ > 0) {
      const Eigen::MatrixXd by_joints = product(adjoint(at.tip_from_rider.inverse()), look.by_joints);
      const Eigen::MatrixXd weighed_joints = solver.solve(by_joints);
      one.by_joints = transposed_product(by, weighed_joints);
      one.joints_normal = transposed_product(by_joints, weighed_joints);
      one.joints_pull = transposed_product(weighed_joints, off);
      one.joints_by_scale = transposed_product(weighed_joints, scale);
    }
    one.normal = transposed_product(by, weighed);
    one.pull = transposed_product(weighed, off);
    one.by_camera = transposed_product(weighed, look.by_camera);
    one.by_scale = transposed_product(weighed, scale);
    one.scale_normal = solver.squared(scale);
    one.scale_pull = transposed_product(scale, solver.solve(off))(0, 0);
    one.squares = {solver.squared(off)};
    return one;
  }

  std::vector<Equations> each(const Answer& at) const {
    std::vector<Equations> parts;
    for (const RobotLook& look : looks_) parts.push_back(of_look(look, at));
    return parts;
  }

  Equations all(const Answer& at) const {
    Equations sum(joints_);
    for (const Equations& one : each(at)) sum.add(one, 1.0);
    return sum;
  }

  /// Gauss-Newton in which looks that fit badly count less (Cauchy's weights about their median): a start
  /// that a third of wrong looks does not spoil.
  bool settle(Answer& answer) const {
    for (int round = 0; round < 30; ++round) {
      const std::vector<Equations> parts = each(answer);
      std::vector<double> squares;
      for (const Equations& one : parts) squares.push_back(one.squares.front());
      const double usual = std::max(kUsualSquares, upper_median(squares));
      Equations sum(joints_);
      for (const Equations& one : parts) sum.add(one, 1.0 / (1.0 + one.squares.front() / usual));
      const auto step = solved(sum);
      if (!step) return false;
      moved_by(answer, *step);
    }
    return true;
  }

  /// Gauss-Newton until nothing moves. False when the looks do not determine both poses.
  bool refine(Answer& answer) const {
    for (int round = 0; round < 20; ++round) {
      const Equations at = all(answer);
      const auto step = solved(at);
      if (!step) return false;
      moved_by(answer, *step);
      if (step->norm() < 1e-10) break;
    }
    return true;
  }

  static std::optional<Eigen::VectorXd> solved(const Equations& at) {
    const Cholesky solver(at.normal);
    if (!solver.is_positive()) return std::nullopt;
    Eigen::VectorXd step = -solver.solve(at.pull);
    if (!step.allFinite()) return std::nullopt;
    return step;
  }

  static void moved_by(Answer& answer, const Eigen::VectorXd& step) {
    answer.world_from_base = moved(answer.world_from_base, step.head(6));
    answer.tip_from_rider = moved(answer.tip_from_rider, step.tail(6));
  }

 private:
  const std::vector<RobotLook>& looks_;
  Eigen::Index joints_;
  Matrix6d tip_;
};

void append(std::vector<cv::Mat>& turns, std::vector<cv::Mat>& places, const Eigen::Isometry3d& pose) {
  cv::Mat turn, place;
  cv::eigen2cv(Eigen::Matrix3d(pose.linear()), turn);
  cv::eigen2cv(Eigen::Vector3d(pose.translation()), place);
  turns.push_back(turn);
  places.push_back(place);
}

Eigen::Isometry3d pose_of(const cv::Mat& turn, const cv::Mat& place) {
  Eigen::Matrix3d r;
  Eigen::Vector3d t;
  cv::cv2eigen(turn, r);
  cv::cv2eigen(place, t);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::Quaterniond(r).normalized().toRotationMatrix();
  pose.translation() = t;
  return pose;
}

/// OpenCV's answer; empty where it has none.
std::optional<Answer> first_answer(const std::vector<RobotLook>& looks) {
  std::vector<cv::Mat> turns, places, base_turns, base_places;
  for (const RobotLook& look : looks) {
    append(turns, places, look.world_from_rider.pose.inverse());
    append(base_turns, base_places, look.base_from_tip.inverse());
  }
  try {
    cv::Mat world_turn, world_place, rider_turn, rider_place;
    cv::calibrateRobotWorldHandEye(turns, places, base_turns, base_places, world_turn, world_place,
                                   rider_turn, rider_place);
    const Answer answer{pose_of(world_turn, world_place), pose_of(rider_turn, rider_place).inverse()};
    if (answer.world_from_base.matrix().allFinite() && answer.tip_from_rider.matrix().allFinite())
      return answer;
  } catch (const cv::Exception&) {
  }
  return std::nullopt;
}

/// Takes out looks whose squares are far above the usual ones. True when it found any.
bool leave_out_looks(std::vector<RobotLook>& looks, const std::vector<double>& squares, std::size_t& may) {
  const double limit = 10.0 * std::max(kUsualSquares, upper_median(squares));
  bool found = false;
  for (std::size_t i = looks.size(); i-- > 0 && may > 0;) {
    if (squares[i] <= limit) continue;
    looks.erase(looks.begin() + static_cast<std::ptrdiff_t>(i));
    --may;
    found = true;
  }
  return found;
}

/// The widest turn between two tips, and the widest about an axis across it.
std::pair<double, double> turns_of(const std::vector<RobotLook>& looks) {
  std::vector<Eigen::Vector3d> turns;
  for (std::size_t i = 0; i < looks.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      turns.push_back(difference(looks[i].base_from_tip, looks[j].base_from_tip).tail<3>());
  const auto widest = std::max_element(turns.begin(), turns.end(),
                                       [](const auto& a, const auto& b) { return a.norm() < b.norm(); });
  if (widest == turns.end() || widest->norm() == 0.0) return {0.0, 0.0};
  const Eigen::Vector3d axis = widest->normalized();
  double second = 0.0;
  for (const Eigen::Vector3d& turn : turns) second = std::max(second, (turn - axis.dot(turn) * axis).norm());
  return {widest->norm(), second};
}

/// Residuals of all looks, and of each one by a fit from the others.
void judge(const std::vector<RobotLook>& looks, const Fit& fit, const Answer& answer,
           RobotWorldCalibration& found) {
  const Equations all = fit.all(answer);
  const double count = static_cast<double>(looks.size());
  for (const RobotLook& look : looks) {
    const Vector6d off = difference(look.world_from_rider.pose, answer.rider(look));
    found.rms += off.head<3>().squaredNorm() / count;
    found.rms_turn += off.tail<3>().squaredNorm() / count;
    Answer others = answer;
    if (const auto step = Fit::solved(all.without(fit.of_look(look, answer)))) Fit::moved_by(others, *step);
    const Vector6d held_out = difference(look.world_from_rider.pose, others.rider(look));
    found.left_out += held_out.head<3>().squaredNorm() / count;
    found.left_out_turn += held_out.tail<3>().squaredNorm() / count;
  }
  for (double* mean : {&found.rms, &found.rms_turn, &found.left_out, &found.left_out_turn})
    *mean = std::sqrt(*mean);
}

/// Joints' offsets, the same in all looks, beside both poses: what explains the residuals best, held by what
/// is known of the offsets.
class JointOffsets {
 public:
  JointOffsets(const Equations& at, const Cholesky& poses, double joint_error, double factor)
      : at_(at),
        poses_(poses),
        factor_(factor),
        poses_by_(poses.solve(at.by_joints)),
        solver_(normal(joint_error)),
        shown_(-solver_.solve(without_poses(at.joints_pull, at.pull))) {}

  const Eigen::VectorXd& shown() const { return shown_; }
  Eigen::MatrixXd open() const { return solver_.inverse(); }

  /// Squares that the offsets shown take away.
  double explained() const {
    return -factor_ * transposed_product(without_poses(at_.joints_pull, at_.pull), shown_)(0, 0);
  }

  /// 12 x 12, of what they move: as shown, and as left open.
  Eigen::MatrixXd moments() const {
    return product(poses_by_, product(open() + product(shown_, shown_.transpose()), poses_by_.transpose()));
  }

  /// What of the scale's normal equations, and of its pull, the poses explain, or these.
  std::pair<double, double> of_scale() const {
    const Eigen::VectorXd scale = without_poses(at_.joints_by_scale, at_.by_scale);
    return {factor_ * solver_.squared(scale), -factor_ * transposed_product(scale, shown_)(0, 0)};
  }

 private:
  Eigen::MatrixXd normal(double joint_error) const {
    Eigen::MatrixXd normal = (at_.joints_normal - transposed_product(at_.by_joints, poses_by_)) / factor_;
    normal.diagonal().array() += 1.0 / (joint_error * joint_error);
    return normal;
  }
  Eigen::VectorXd without_poses(const Eigen::VectorXd& of_joints, const Eigen::VectorXd& of_poses) const {
    return (of_joints - transposed_product(poses_by_, of_poses)) / factor_;
  }

  const Equations& at_;
  const Cholesky& poses_;
  double factor_;
  Eigen::MatrixXd poses_by_;
  Cholesky solver_;
  Eigen::VectorXd shown_;
};

/// Noise as the residuals show it, what all looks share, and the tags' scale against the robot's.
void report_covariances(const std::vector<RobotLook>& looks, const Equations& at, double joint_error,
                        RobotWorldCalibration& found) {
  double squares = 0.0;
  for (const double one : at.squares) squares += one;
  const double freedom = std::max(1.0, 6.0 * static_cast<double>(looks.size()) - 12.0);
  double factor = std::max(1.0, squares / freedom);
  const Cholesky solver(at.normal);
  std::optional<JointOffsets> offsets;
  if (at.joints_pull.size() > 0) {
    factor = std::max(1.0, (squares - JointOffsets(at, solver, joint_error, 1.0).explained()) / freedom);
    offsets.emplace(at, solver, joint_error, factor);
    const Eigen::VectorXd sigmas = offsets->open().diagonal().cwiseSqrt();
    found.offsets.assign(offsets->shown().begin(), offsets->shown().end());
    found.offset_sigmas.assign(sigmas.begin(), sigmas.end());
  }
  const Eigen::MatrixXd used = factor * solver.inverse() + squared(solver.solve(at.by_camera));
  const Eigen::MatrixXd whole = offsets ? Eigen::MatrixXd(used + offsets->moments()) : used;
  Matrix6d of_world = Matrix6d::Zero(), of_rider = Matrix6d::Zero();
  for (const RobotLook& look : looks) {
    of_world += look.tags_of_world / static_cast<double>(looks.size());
    of_rider += look.tags_of_rider / static_cast<double>(looks.size());
  }
  const Matrix6d of_base = carried(found.world_from_base.pose.inverse(), of_world);
  found.base_as_used = {found.world_from_base.pose, used.topLeftCorner(6, 6) + of_base};
  found.rider_as_used = {found.tip_from_rider.pose, used.bottomRightCorner(6, 6) + of_rider};
  found.world_from_base.covariance = whole.topLeftCorner(6, 6) + of_base;
  found.tip_from_rider.covariance = whole.bottomRightCorner(6, 6) + of_rider;
  double rest = at.scale_normal - solver.squared(at.by_scale);
  double pull = transposed_product(at.by_scale, solver.solve(at.pull))(0, 0) - at.scale_pull;
  if (offsets) {
    const auto [explained, pulled] = offsets->of_scale();
    rest -= explained;
    pull += pulled;
  }
  if (!(rest > 0.0)) return;
  found.scale = 1.0 + pull / rest;
  found.scale_sigma = std::sqrt(factor / rest);
}

double worst_sigma(const RobotWorldCalibration& found, const std::vector<RobotLook>& looks) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const RobotLook& look : looks)
    middle += look.base_from_tip.translation() / static_cast<double>(looks.size());
  return std::max(transform(found.base_as_used, middle).largest_sigma(),
                  transform(found.rider_as_used, Eigen::Vector3d::Zero()).largest_sigma());
}

std::string millimetres(double metres) { return words(1e3 * metres, " mm"); }

/// A joint that reads as no joint of the stated error does; empty: none.
std::string joint_off(const RobotWorldCalibration& found, const RobotWorldOptions& options) {
  std::size_t worst = found.offsets.size();
  for (std::size_t j = 0; j < found.offsets.size(); ++j) {
    const double off = std::abs(found.offsets[j]);
    if (off <= 3.0 * options.joint_error || off <= 4.0 * found.offset_sigmas[j]) continue;
    if (worst == found.offsets.size() || off > std::abs(found.offsets[worst])) worst = j;
  }
  if (worst == found.offsets.size()) return "";
  return "joint '" + options.joints[worst] + "' reads as if its zero were off by " +
         words(std::abs(found.offsets[worst])) + " rad or m, expected " + words(3.0 * options.joint_error) +
         " or less, three times `joint_error`: set the zeros of its joints, or say how far they may be off";
}

}  // namespace

RobotLook look_at_tip(const Eigen::Isometry3d& base_from_tip, const BodyPose& on_tip,
                      const std::optional<BodyPose>& fixed, const Eigen::Isometry3d& world_from_board) {
  RobotLook look;
  look.base_from_tip = base_from_tip;
  look.world_from_rider = {on_tip.camera_from_body.pose, of_corners(on_tip)};
  look.by_camera = on_tip.errors.by_camera;
  look.tags_of_rider = on_tip.errors.tags;
  if (!fixed) return look;
  const Eigen::Isometry3d board_from_rider =
      fixed->camera_from_body.pose.inverse() * on_tip.camera_from_body.pose;
  look.world_from_rider.pose = world_from_board * board_from_rider;
  look.world_from_rider.covariance += carried(board_from_rider.inverse(), of_corners(*fixed));
  look.by_camera -= product(adjoint(board_from_rider.inverse()), fixed->errors.by_camera);
  look.tags_of_world = carried(world_from_board, fixed->errors.tags);
  return look;
}

RobotLook look_from_tip(const Eigen::Isometry3d& base_from_tip, const BodyPose& fixed,
                        const Eigen::Isometry3d& world_from_board) {
  const Eigen::Isometry3d& camera_from_board = fixed.camera_from_body.pose;
  RobotLook look;
  look.base_from_tip = base_from_tip;
  look.world_from_rider = {world_from_board * camera_from_board.inverse(),
                           carried(camera_from_board, of_corners(fixed))};
  look.by_camera = -product(adjoint(camera_from_board), fixed.errors.by_camera);
  look.tags_of_world = carried(world_from_board, fixed.errors.tags);
  return look;
}

RobotWorldCalibration calibrate_robot_world(const std::vector<RobotLook>& given,
                                            const RobotWorldOptions& options) {
  RobotWorldCalibration found;
  std::vector<RobotLook> looks = given;
  found.looks = looks.size();
  if (looks.size() < options.least_looks) {
    found.refusal = std::to_string(looks.size()) + " images show where board and robot are, expected " +
                    std::to_string(options.least_looks) + " or more";
    return found;
  }
  std::tie(found.turn, found.second_turn) = turns_of(looks);
  const std::string turn_more = "turn the tip by 30 degrees or more about two axes or more between images";
  if (found.second_turn < options.least_turn) {
    found.refusal = "the tip turned about one axis only, by at most " +
                    words(180.0 / M_PI * found.second_turn) + " degrees about a second one: " + turn_more;
    return found;
  }
  auto answer = first_answer(looks);
  const Fit fit(looks, options);
  bool is_solved = answer && fit.settle(*answer);
  std::size_t may = looks.size() / 3;
  for (int round = 0; round < 5 && is_solved && leave_out_looks(looks, fit.all(*answer).squares, may);
       ++round)
    is_solved = fit.refine(*answer);
  if (!is_solved || !fit.refine(*answer)) {
    found.refusal = "the images do not determine where the robot stands: " + turn_more;
    return found;
  }
  found.contradicted = found.looks - looks.size();
  found.looks = looks.size();
  found.world_from_base.pose = answer->world_from_base;
  found.tip_from_rider.pose = answer->tip_from_rider;
  judge(looks, fit, *answer, found);
  report_covariances(looks, fit.all(*answer), options.joint_error, found);
  const double sigma = worst_sigma(found, looks);
  const std::string off = joint_off(found, options);
  if (std::abs(found.scale - 1.0) > 0.02 && std::abs(found.scale - 1.0) > 5.0 * found.scale_sigma)
    found.refusal = "by the robot's motion the tags are " + words(found.scale) +
                    " times as large as the setup says: measure them";
  else if (!off.empty())
    found.refusal = off;
  else if (!(found.left_out <= options.most_residual))
    found.refusal = "an image that took no part is off by " + millimetres(found.left_out) + ", expected " +
                    millimetres(options.most_residual) +
                    " or less: are the joints those of the images, the robot the right one, the board fixed?";
  else if (!(sigma <= options.most_sigma))
    found.refusal = "the places are known to " + millimetres(sigma) + " only, expected " +
                    millimetres(options.most_sigma) + " or better: calibrate the camera first, and " +
                    turn_more;
  return found;
}

}  // namespace clearway

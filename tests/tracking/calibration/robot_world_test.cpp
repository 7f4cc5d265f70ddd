#include "tracking/calibration/robot_world.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/worlds/calibration_views.hpp"
#include "tests/worlds/trials.hpp"
#include "tracking/dense.hpp"

namespace clearway {
namespace robot_world_test {

Eigen::Isometry3d drawn_pose(std::mt19937& random, double reach) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Eigen::Isometry3d pose(Eigen::Quaterniond::UnitRandom());
  pose.linear() = Eigen::AngleAxisd(M_PI * unit(random),
                                    Eigen::Vector3d(unit(random), unit(random), unit(random)).normalized())
                      .toRotationMatrix();
  pose.translation() = reach * Eigen::Vector3d(unit(random), unit(random), unit(random));
  return pose;
}

/// How the tip of an upright arm moves, in its own frame, for an offset of its shoulder and of its elbow,
/// whose axes lie across the way to the tip.
Eigen::Matrix<double, 6, Eigen::Dynamic> by_inner_joints(const Eigen::Isometry3d& base_from_tip) {
  const Eigen::Vector3d at = base_from_tip.translation(), shoulder(0.0, 0.0, 0.4);
  const Eigen::Vector3d axis = Eigen::Vector3d::UnitZ().cross(at).normalized();
  const Eigen::Vector3d elbow = 0.5 * (shoulder + at) + 0.15 * Eigen::Vector3d::UnitZ();
  Eigen::Matrix<double, 6, Eigen::Dynamic> by(6, 2);
  by.col(0) << axis.cross(at - shoulder), axis;
  by.col(1) << axis.cross(at - elbow), axis;
  for (Eigen::Index j = 0; j < 2; ++j) {
    by.col(j).head<3>() = base_from_tip.linear().transpose() * by.col(j).head<3>().eval();
    by.col(j).tail<3>() = base_from_tip.linear().transpose() * by.col(j).tail<3>().eval();
  }
  return by;
}

/// A robot whose tip carries the camera, or a board before a camera that stands still.
struct Cell {
  Camera camera = scene::plain_camera();
  TagBody stated_board = scene::board("base", 0, 3, 2, 0.05, 0.07), fixed = stated_board;
  TagBody stated_on_tip = scene::board("tip", 30, 3, 2, 0.03, 0.042), on_tip = stated_on_tip;
  Eigen::Isometry3d world_from_board, world_from_base, tip_from_rider;
  bool carries_camera = true;
  bool turns_about_one_axis = false;
  double tilt = 0.7;
  double slips = 0.0;  ///< share of looks whose joints are those of another moment
  double tip_error = 0.001, tip_turn = 0.002;
  Eigen::Vector2d offsets = Eigen::Vector2d::Zero();  ///< of shoulder and elbow, which the readings lack

  explicit Cell(std::mt19937& random)
      : world_from_board(drawn_pose(random, 0.5)),
        world_from_base(drawn_pose(random, 0.8)),
        tip_from_rider(drawn_pose(random, 0.1)) {}

  std::optional<BodyPose> see(const TagBody& stated, const TagBody& body, const Eigen::Isometry3d& pose,
                              std::mt19937& random) const {
    const auto seen = scene::look_at_body(camera, body, pose, 0.2, random);
    if (seen.size() < 4) return std::nullopt;
    auto found = estimate_body_pose(stated, seen, camera, {.pixel_noise = 0.2});
    return found && found->separation > 36.0 ? found : std::nullopt;
  }

  /// What the joints say of a tip that is elsewhere by the robot's own error.
  Eigen::Isometry3d measured_tip(const Eigen::Isometry3d& world_from_rider, std::mt19937& random) const {
    std::normal_distribution<double> normal;
    Vector6d error;
    for (int i = 0; i < 6; ++i) error[i] = (i < 3 ? tip_error : tip_turn) * normal(random);
    const Eigen::Isometry3d tip =
        moved(world_from_base.inverse() * world_from_rider * tip_from_rider.inverse(), error);
    return moved(tip, -Vector6d(by_inner_joints(tip) * offsets));
  }

  std::vector<RobotLook> looks(int count, std::mt19937& random) const {
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    std::vector<RobotLook> looks;
    const Eigen::Isometry3d still = scene::tag_before_camera(0.8, 0.6, 1.2, 0.0, -0.15, 0.05);
    for (int i = 0; i < 40 * count && static_cast<int>(looks.size()) < count; ++i) {
      const Eigen::Isometry3d before =
          turns_about_one_axis
              ? scene::tag_before_camera(0.55, tilt, 0.4, M_PI * unit(random), 0.05 * unit(random),
                                         0.05 * unit(random))
              : scene::tag_before_camera(0.55 + 0.1 * unit(random), tilt * std::abs(unit(random)),
                                         M_PI * unit(random), M_PI * unit(random),
                                         0.08 * unit(random) + (carries_camera ? 0.0 : 0.12),
                                         0.06 * unit(random));
      const bool has_slipped = unit(random) < 2.0 * slips - 1.0;
      const auto add = [&](const Eigen::Isometry3d& world_from_rider, auto&& look_of) {
        Eigen::Isometry3d tip = measured_tip(world_from_rider, random);
        if (has_slipped) tip.translation() += Eigen::Vector3d(0.05, -0.04, 0.02);
        looks.push_back(look_of(tip));
        looks.back().by_joints = by_inner_joints(tip);
      };
      if (carries_camera) {
        if (const auto base = see(stated_board, fixed, before, random))
          add(world_from_board * before.inverse(),
              [&](const auto& tip) { return look_from_tip(tip, *base, world_from_board); });
        continue;
      }
      const auto base = see(stated_board, fixed, still, random);
      const auto rider = see(stated_on_tip, on_tip, before, random);
      if (base && rider)
        add(world_from_board * still.inverse() * before,
            [&](const auto& tip) { return look_at_tip(tip, *rider, *base, world_from_board); });
    }
    return looks;
  }
};

double squares(const UncertainPose& found, const Eigen::Isometry3d& truth) {
  const Vector6d off = difference(found.pose, truth);
  return Cholesky(found.covariance).squared(off);
}

TEST(RobotWorld, covariances_cover_the_true_errors_of_drawn_cells) {
  const int cells = trials(12, 40);
  double base = 0.0, rider = 0.0, worst = 0.0;
  for (int seed = 1; seed <= cells; ++seed) {
    std::mt19937 random(static_cast<unsigned>(seed));
    Cell cell(random);
    cell.carries_camera = seed % 2 == 0;
    cell.stated_board.errors = cell.stated_on_tip.errors = {0.0, 0.001, 0.0002, 0.002};
    cell.fixed = scene::true_body(cell.stated_board, random);
    cell.on_tip = scene::true_body(cell.stated_on_tip, random);
    const RobotWorldCalibration found = calibrate_robot_world(cell.looks(30, random), {.most_sigma = 0.03});
    ASSERT_EQ(found.refusal, "") << seed;
    base += squares(found.world_from_base, cell.world_from_base);
    rider += squares(found.tip_from_rider, cell.tip_from_rider);
    worst =
        std::max(worst, (found.tip_from_rider.pose.translation() - cell.tip_from_rider.translation()).norm());
    EXPECT_LT(std::abs(found.scale - 1.0), 5.0 * found.scale_sigma + 0.005) << seed;
    EXPECT_GT(found.left_out, found.rms);
  }
  for (const double sum : {base, rider}) {
    EXPECT_LT(sum, chi_square_of_a_thousand(6 * cells));
    EXPECT_GT(sum, 0.6 * cells);  // and the claim is not ten times too careful
  }
  EXPECT_LT(worst, 0.01);
}

TEST(RobotWorld, covariances_cover_offsets_of_joints_that_all_looks_share) {
  const int cells = trials(12, 60);
  const RobotWorldOptions options{
      .joints = {"shoulder", "elbow"}, .joint_error = 0.01, .most_sigma = 0.05, .most_residual = 0.05};
  double base = 0.0, rider = 0.0, without = 0.0, offset = 0.0;
  for (int seed = 1; seed <= cells; ++seed) {
    std::mt19937 random(static_cast<unsigned>(seed));
    std::normal_distribution<double> normal;
    Cell cell(random);
    cell.offsets = options.joint_error * Eigen::Vector2d(normal(random), normal(random));
    const std::vector<RobotLook> looks = cell.looks(30, random);
    const RobotWorldCalibration found = calibrate_robot_world(looks, options);
    ASSERT_EQ(found.refusal, "") << seed;
    base += squares(found.world_from_base, cell.world_from_base);
    rider += squares(found.tip_from_rider, cell.tip_from_rider);
    for (int j = 0; j < 2; ++j) {
      const auto i = static_cast<std::size_t>(j);
      offset += std::pow((found.offsets[i] - cell.offsets[j]) / found.offset_sigmas[i], 2);
    }
    RobotWorldOptions blind = options;
    blind.joints.clear();
    without += squares(calibrate_robot_world(looks, blind).world_from_base, cell.world_from_base);
  }
  EXPECT_LT(base, 1.5 * 6.0 * cells);
  EXPECT_LT(rider, 1.5 * 6.0 * cells);
  EXPECT_LT(offset, 2.0 * 2.0 * cells);
  EXPECT_GT(without, 4.0 * 6.0 * cells);  // so that the above says something
}

TEST(RobotWorld, a_joint_whose_zero_is_off_is_named) {
  const RobotWorldOptions options{.joints = {"shoulder", "elbow"}, .joint_error = 0.01, .most_sigma = 0.05};
  std::mt19937 random(4);
  Cell cell(random);
  cell.offsets = {0.0, 0.05};
  const RobotWorldCalibration found = calibrate_robot_world(cell.looks(30, random), options);
  EXPECT_NE(found.refusal.find("joint 'elbow' reads as if its zero were off by 0.0"), std::string::npos)
      << found.refusal;
  cell.offsets = {0.0, 0.0};
  EXPECT_EQ(calibrate_robot_world(cell.looks(30, random), options).refusal, "");
}

TEST(RobotWorld, exact_input_gives_the_exact_answer) {
  std::mt19937 random(8);
  Cell cell(random);
  cell.tip_error = cell.tip_turn = 0.0;
  std::vector<RobotLook> looks = cell.looks(12, random);
  for (RobotLook& look : looks)
    look.world_from_rider.pose = cell.world_from_base * look.base_from_tip * cell.tip_from_rider;
  const RobotWorldCalibration found = calibrate_robot_world(looks, {.most_sigma = 1.0});
  ASSERT_EQ(found.refusal, "");
  EXPECT_LT(difference(found.world_from_base.pose, cell.world_from_base).norm(), 1e-8);
  EXPECT_LT(difference(found.tip_from_rider.pose, cell.tip_from_rider).norm(), 1e-8);
  EXPECT_NEAR(found.scale, 1.0, 1e-8);
}

TEST(RobotWorld, a_fit_from_the_others_is_what_left_out_says) {
  std::mt19937 random(9);
  Cell cell(random);
  const std::vector<RobotLook> looks = cell.looks(14, random);
  const RobotWorldOptions loose{.most_sigma = 1.0};
  const RobotWorldCalibration found = calibrate_robot_world(looks, loose);
  ASSERT_EQ(found.contradicted, 0U);
  double sum = 0.0;
  for (std::size_t i = 0; i < looks.size(); ++i) {
    std::vector<RobotLook> others = looks;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    const RobotWorldCalibration without = calibrate_robot_world(others, loose);
    const Eigen::Isometry3d rider =
        without.world_from_base.pose * looks[i].base_from_tip * without.tip_from_rider.pose;
    sum += difference(looks[i].world_from_rider.pose, rider).head<3>().squaredNorm();
  }
  EXPECT_NEAR(std::sqrt(sum / static_cast<double>(looks.size())), found.left_out, 0.02 * found.left_out);
}

TEST(RobotWorld, looks_with_the_joints_of_another_moment_are_left_out) {
  std::mt19937 random(4);
  Cell cell(random);
  cell.slips = 0.15;
  const RobotWorldCalibration found = calibrate_robot_world(cell.looks(40, random), {.most_sigma = 0.01});
  ASSERT_EQ(found.refusal, "");
  EXPECT_GT(found.contradicted, 2U);
  EXPECT_LT((found.tip_from_rider.pose.translation() - cell.tip_from_rider.translation()).norm(), 0.004);
}

TEST(RobotWorld, the_motion_reveals_tags_of_another_size) {
  std::mt19937 random(6);
  Cell cell(random);
  for (auto& [id, tag] : cell.stated_board.tags) {
    tag.size *= 0.95;
    tag.body_from_tag.translation() *= 0.95;
  }
  const RobotWorldCalibration found =
      calibrate_robot_world(cell.looks(30, random), {.most_sigma = 0.05, .most_residual = 0.05});
  EXPECT_NEAR(found.scale, 1.0 / 0.95, 0.01);
  EXPECT_NE(found.refusal.find("times as large as the setup says"), std::string::npos) << found.refusal;
  for (const double measured : {0.92, 1.05, 1.1}) {  // not taken for a joint whose zero is off
    Cell other(random);
    for (auto& [id, tag] : other.stated_board.tags) {
      tag.size *= measured;
      tag.body_from_tag.translation() *= measured;
    }
    const std::string refusal =
        calibrate_robot_world(other.looks(30, random), {.joints = {"shoulder", "elbow"}, .most_sigma = 0.05})
            .refusal;
    EXPECT_NE(refusal.find("times as large as the setup says"), std::string::npos) << refusal;
  }
}

TEST(RobotWorld, one_axis_few_looks_and_foreign_joints_are_refused_with_the_reason) {
  std::mt19937 random(5);
  Cell cell(random);
  std::vector<RobotLook> looks = cell.looks(30, random);
  std::vector<RobotLook> few(looks.begin(), looks.begin() + 5);
  EXPECT_NE(calibrate_robot_world(few).refusal.find("5 images"), std::string::npos);
  cell.turns_about_one_axis = true;
  const RobotWorldCalibration axis = calibrate_robot_world(cell.looks(20, random));
  EXPECT_NE(axis.refusal.find("about one axis only"), std::string::npos) << axis.refusal;
  const Eigen::Isometry3d first = looks.front().base_from_tip;
  for (std::size_t i = 0; i + 1 < looks.size(); ++i) looks[i].base_from_tip = looks[i + 1].base_from_tip;
  looks.back().base_from_tip = first;
  EXPECT_NE(calibrate_robot_world(looks).refusal, "");
}

/// Where the tip is off by three times what is stated, the places are three times less sure, with offsets of
/// joints, too.
TEST(RobotWorld, residuals_beyond_the_stated_ones_count_with_offsets_too) {
  const auto covariance = [](double times, bool with_joints) {
    std::mt19937 random(12);
    Cell cell(random);
    std::vector<RobotLook> looks = cell.looks(30, random);
    std::normal_distribution<double> normal;
    for (RobotLook& look : looks) {
      Vector6d error;
      for (int i = 0; i < 6; ++i) error[i] = times * (i < 3 ? 0.001 : 0.002) * normal(random);
      look.by_camera.setZero(), look.tags_of_world.setZero(), look.tags_of_rider.setZero();
      look.world_from_rider = {cell.world_from_base * moved(look.base_from_tip, error) * cell.tip_from_rider,
                               1e-10 * Matrix6d::Identity()};
    }
    RobotWorldOptions options{.most_sigma = 1.0, .most_residual = 1.0};
    if (with_joints) options.joints = {"shoulder", "elbow"};
    return Matrix6d(calibrate_robot_world(looks, options).base_as_used.covariance);
  };
  for (const bool with_joints : {false, true}) {
    const double ratio = covariance(3.0, with_joints).trace() / covariance(0.01, with_joints).trace();
    EXPECT_GT(ratio, 6.0) << with_joints;
    EXPECT_LT(ratio, 12.0) << with_joints;
  }
}

/// An error of the camera that moves both boards alike, in the camera's axes, moves neither on the other.
TEST(RobotWorld, an_error_of_the_camera_that_both_boards_share_cancels_out) {
  std::mt19937 random(4);
  for (int i = 0; i < 10; ++i) {
    BodyPose on_tip, fixed;
    on_tip.camera_from_body.pose = drawn_pose(random, 0.5);
    fixed.camera_from_body.pose = drawn_pose(random, 0.5);
    Vector6d shift;
    for (double& one : shift) one = std::normal_distribution<double>(0.0, 1e-3)(random);
    for (BodyPose* body : {&on_tip, &fixed})
      body->errors.by_camera.col(2) = adjoint(body->camera_from_body.pose.inverse()) * shift;
    const Eigen::Isometry3d any = drawn_pose(random, 1.0);
    EXPECT_LT(look_at_tip(any, on_tip, fixed, any).by_camera.cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_GT(look_at_tip(any, on_tip, std::nullopt, any).by_camera.cwiseAbs().maxCoeff(), 1e-5);
  }
}

/// Errors of tags enlarge the covariance of the frame that they are in, as that frame has them, and are
/// refused of either where they leave it too uncertain.
TEST(RobotWorld, errors_of_tags_count_of_the_world_and_of_the_rider) {
  std::mt19937 random(9);
  const Eigen::Isometry3d world_from_base = drawn_pose(random, 1.0), tip_from_rider = drawn_pose(random, 0.1);
  std::vector<RobotLook> looks(20);
  for (RobotLook& look : looks) {
    look.base_from_tip = drawn_pose(random, 0.5);
    look.world_from_rider.pose = world_from_base * look.base_from_tip * tip_from_rider;
    look.world_from_rider.covariance = 1e-8 * Matrix6d::Identity();
  }
  const auto found = [&](double of_world, double of_rider) {
    for (RobotLook& look : looks) {
      look.tags_of_world = look.tags_of_rider = Matrix6d::Zero();
      look.tags_of_world.topLeftCorner<3, 3>().diagonal().setConstant(of_world * of_world);
      look.tags_of_rider.topLeftCorner<3, 3>().diagonal().setConstant(of_rider * of_rider);
    }
    return calibrate_robot_world(looks);
  };
  const RobotWorldCalibration sure = found(0.0, 0.0), world = found(0.02, 0.0), rider = found(0.0, 0.02);
  EXPECT_EQ(sure.refusal, "");
  for (const RobotWorldCalibration* one : {&world, &rider})
    EXPECT_NE(one->refusal.find("the places are known to"), std::string::npos) << one->refusal;
  const auto grown = [&](const UncertainPose& pose, const UncertainPose& from) {
    return Eigen::Matrix3d((pose.covariance - from.covariance).topLeftCorner<3, 3>());
  };
  const Eigen::Matrix3d expected = 0.02 * 0.02 * Eigen::Matrix3d::Identity();
  EXPECT_LT((grown(world.world_from_base, sure.world_from_base) - expected).norm(), 1e-9);
  EXPECT_LT((grown(world.base_as_used, sure.base_as_used) - expected).norm(), 1e-9);
  EXPECT_LT((grown(rider.tip_from_rider, sure.tip_from_rider) - expected).norm(), 1e-9);
  EXPECT_LT((grown(rider.rider_as_used, sure.rider_as_used) - expected).norm(), 1e-9);
  EXPECT_LT(grown(world.tip_from_rider, sure.tip_from_rider).norm(), 1e-9);
  EXPECT_LT(grown(rider.world_from_base, sure.world_from_base).norm(), 1e-9);
}

}  // namespace robot_world_test
}  // namespace clearway

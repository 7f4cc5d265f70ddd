#include "tracking/calibration/pivot.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/worlds/calibration_views.hpp"
#include "tests/worlds/trials.hpp"
#include "tracking/dense.hpp"

namespace clearway {
namespace pivot_test {

/// A cube on a stick that turns about its ball, before a camera that stands still or with a board.
struct Turning {
  Camera camera = scene::plain_camera();
  TagBody probe = scene::cube("probe", 30, 0.03, 0.042), base = scene::board("base", 0, 3, 2, 0.05, 0.07);
  TagBody true_probe = probe, true_base = base;
  Eigen::Vector3d ball{0.0, 0.0, -0.1};
  double tilt = 0.6;
  bool with_base = true;
  double slips = 0.0;  ///< share of looks in which the ball has moved

  PivotCalibration found(int count, std::mt19937& random, const PivotOptions& options = {}) const {
    return calibrate_pivot(looks(count, random), {camera, probe, base}, options);
  }

  std::vector<PivotLook> looks(int count, std::mt19937& random) const {
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    std::vector<PivotLook> looks;
    const Eigen::Vector3d place(0.03, 0.05, 0.0);
    for (int i = 0; i < 20 * count && static_cast<int>(looks.size()) < count; ++i) {
      const Eigen::Isometry3d camera_from_base =
          scene::tag_before_camera(0.6 + 0.05 * unit(random), 0.75, 1.2 + 0.2 * unit(random));
      const Eigen::Vector3d axis(unit(random), unit(random), unit(random));
      Eigen::Isometry3d base_from_probe(Eigen::AngleAxisd(tilt * unit(random), axis.normalized()));
      const Eigen::Vector3d slip =
          unit(random) < 2.0 * slips - 1.0 ? Eigen::Vector3d(0.03, -0.02, 0.0) : Eigen::Vector3d::Zero();
      base_from_probe.translation() = place + slip - base_from_probe.linear() * ball;
      const auto see = [&](const TagBody& stated, const TagBody& body, const Eigen::Isometry3d& pose) {
        const auto seen = scene::look_at_body(camera, body, pose, 0.2, random);
        return seen.size() < 2 ? std::nullopt
                               : estimate_body_pose(stated, seen, camera, {.pixel_noise = 0.2});
      };
      const auto base_pose = see(base, true_base, camera_from_base);
      const Eigen::Isometry3d fixed = scene::tag_before_camera(0.6, 0.75, 1.2);
      const auto probe_pose =
          see(probe, true_probe, (with_base ? camera_from_base : fixed) * base_from_probe);
      if (!base_pose || !probe_pose || probe_pose->separation < 36.0) continue;
      looks.push_back({*probe_pose, with_base ? base_pose : std::nullopt});
    }
    return looks;
  }
};

TEST(Pivot, covariance_covers_the_true_error_of_drawn_motions) {
  const int motions = trials(20, 60);
  double joint = 0.0, worst = 0.0;
  for (int seed = 1; seed <= motions; ++seed) {
    std::mt19937 random(static_cast<unsigned>(seed));
    Turning turning;
    turning.with_base = seed % 2 == 0;
    turning.probe.errors = {0.0, 0.001, 0.0002, 0.003};
    turning.true_probe = scene::true_body(turning.probe, random);
    const PivotCalibration found = turning.found(40, random, {.most_sigma = 0.01});
    ASSERT_EQ(found.refusal, "") << seed;
    const Eigen::Vector3d off = found.ball - turning.ball;
    joint += Cholesky(found.covariance).squared(off);
    worst = std::max(worst, off.norm());
  }
  EXPECT_LT(joint, chi_square_of_a_thousand(3 * motions));
  EXPECT_GT(joint, 0.3 * motions);  // and the claim is not ten times too careful
  EXPECT_LT(worst, 0.006);
}

/// What is not known of the base's tags moves the place of the ball, which all looks share.
TEST(Pivot, errors_of_the_base_move_the_place_and_hardly_the_ball) {
  const int motions = trials(10, 60);
  double joint = 0.0, claimed = 0.0;
  for (int seed = 1; seed <= motions; ++seed) {
    std::mt19937 random(static_cast<unsigned>(seed));
    Turning turning;
    turning.probe.errors = {0.0, 0.001, 0.0001, 0.001};
    turning.true_probe = scene::true_body(turning.probe, random);
    turning.base.errors = {0.002, 0.005, 0.001, 0.01};
    turning.true_base = scene::true_body(turning.base, random);
    const PivotCalibration found = turning.found(40, random);
    ASSERT_EQ(found.refusal, "") << seed;
    joint += Cholesky(found.covariance).squared(found.ball - turning.ball);
    claimed = std::max(claimed, UncertainPoint{found.ball, found.covariance}.largest_sigma());
  }
  EXPECT_LT(joint, chi_square_of_a_thousand(3 * motions));
  EXPECT_GT(joint, 0.3 * motions);
  EXPECT_LT(claimed, 0.001);
}

/// Slips along all axes alike, where the noise of poses is many times larger along the camera's view.
TEST(Pivot, covariance_covers_balls_that_slip_in_their_cup) {
  const int motions = trials(20, 60);
  double joint = 0.0;
  for (int seed = 1; seed <= motions; ++seed) {
    std::mt19937 random(static_cast<unsigned>(seed));
    std::normal_distribution<double> slip(0.0, 0.003);
    Turning turning;
    turning.probe.errors = turning.base.errors = {0.0, 0.0005, 0.00005, 0.0005};
    std::vector<PivotLook> looks = turning.looks(30, random);
    for (PivotLook& look : looks)
      look.probe.camera_from_body.pose.pretranslate(
          Eigen::Vector3d(slip(random), slip(random), slip(random)));
    const PivotCalibration found =
        calibrate_pivot(looks, {turning.camera, turning.probe, turning.base}, {.most_sigma = 0.1});
    ASSERT_EQ(found.refusal, "") << seed;
    joint += Cholesky(found.covariance).squared(found.ball - turning.ball);
  }
  EXPECT_LT(joint, chi_square_of_a_thousand(3 * motions));
  EXPECT_GT(joint, 0.3 * 3 * motions);
}

/// Looks without an image. Each body's pose is off by its noise, which here is a third of what is stated.
std::vector<PivotLook> stated_looks(int count, const Eigen::Vector3d& ball, bool with_base,
                                    std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  std::normal_distribution<double> normal;
  const auto drawn = [&](double scale) {
    Vector6d motion;
    for (double& one : motion) one = scale * normal(random);
    return motion;
  };
  const auto seen_at = [&](const Eigen::Isometry3d& pose) {
    BodyPose seen;
    for (Eigen::Index k = 0; k < kCameraModes; ++k) seen.errors.by_camera.col(k) = drawn(0.0005);
    const Vector6d one = drawn(0.0004), other = drawn(0.0004);
    seen.errors.noise = 1e-7 * Matrix6d::Identity() + one * one.transpose() + other * other.transpose();
    const Eigen::Matrix<double, 6, 6> root = seen.errors.noise.llt().matrixL();
    seen.camera_from_body.pose = moved(pose, Vector6d(root * drawn(0.3)));
    return seen;
  };
  std::vector<PivotLook> looks;
  for (int i = 0; i < count; ++i) {
    Eigen::Isometry3d camera_from_base = scene::tag_before_camera(0.6, 0.75, 1.2);
    if (with_base) camera_from_base = moved(camera_from_base, drawn(0.1));
    Eigen::Isometry3d base_from_probe(Eigen::AngleAxisd(
        0.8 * unit(random), Eigen::Vector3d(unit(random), unit(random), unit(random)).normalized()));
    base_from_probe.translation() = Eigen::Vector3d(0.1, 0.05, 0.02) - base_from_probe.linear() * ball;
    PivotLook look{seen_at(camera_from_base * base_from_probe), {}};
    if (with_base) look.base = seen_at(camera_from_base);
    looks.push_back(look);
  }
  return looks;
}

/// Rigs whose tags are known exactly, so that looks are all that counts.
PivotRig exact_rig() {
  Turning turning;
  turning.probe.errors = turning.base.errors = {0.0, 0.0, 0.0, 0.0};
  return {turning.camera, turning.probe, turning.base};
}

/// By difference quotients of the answer itself: each look moved by itself, and all by the camera's modes.
TEST(Pivot, parts_are_what_noise_and_camera_move_the_ball_by) {
  const PivotOptions loose{.most_sigma = 1.0};
  for (const bool with_base : {false, true}) {
    std::mt19937 random(3);
    const std::vector<PivotLook> looks = stated_looks(20, {0.02, 0.01, -0.1}, with_base, random);
    const PivotCalibration found = calibrate_pivot(looks, exact_rig(), loose);
    ASSERT_EQ(found.refusal, "");
    ASSERT_EQ(found.left_out, 0U);
    const auto move_by = [&](const std::vector<PivotLook>& pushed, double step) {
      const Eigen::Vector3d move = (calibrate_pivot(pushed, exact_rig(), loose).ball - found.ball) / step;
      return Eigen::Matrix3d(move * move.transpose());
    };
    const auto push = [](BodyPose& body, const Vector6d& motion) {
      body.camera_from_body.pose = moved(body.camera_from_body.pose, motion);
    };
    constexpr double step = 0.02;
    Eigen::Matrix3d noise = Eigen::Matrix3d::Zero(), camera = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < looks.size(); ++i) {
      for (Eigen::Index k = 0; k < 12; ++k) {
        std::vector<PivotLook> pushed = looks;
        if (k >= 6 && !with_base) continue;
        BodyPose& body = k < 6 ? pushed[i].probe : *pushed[i].base;
        const Eigen::Matrix<double, 6, 6> root = body.errors.noise.llt().matrixL();
        push(body, step * root.col(k % 6));
        noise += move_by(pushed, step);
      }
    }
    for (Eigen::Index k = 0; k < kCameraModes; ++k) {
      std::vector<PivotLook> pushed = looks;
      for (PivotLook& look : pushed) {
        push(look.probe, step * look.probe.errors.by_camera.col(k));
        if (look.base) push(*look.base, step * look.base->errors.by_camera.col(k));
      }
      camera += move_by(pushed, step);
    }
    EXPECT_LT((found.parts.noise - noise).norm(), 0.05 * noise.norm()) << found.parts.noise << "\n" << noise;
    EXPECT_LT((found.parts.camera - camera).norm(), 0.05 * camera.norm()) << found.parts.camera << "\n"
                                                                          << camera;
    EXPECT_EQ(found.parts.base.norm() + found.parts.probe.norm(), 0.0);
  }
}

/// Beyond its stated noise, yet not so far that the ball must have slipped, the noise counts as it shows.
TEST(Pivot, noise_counts_as_large_as_the_residuals_show_it) {
  std::mt19937 random(6);
  const Eigen::Vector3d ball(0.02, 0.01, -0.1);
  std::vector<PivotLook> looks = stated_looks(40, ball, false, random);
  constexpr double sigma = 0.001;
  std::normal_distribution<double> normal(0.0, sigma);
  std::vector<Eigen::Vector3d> slips;
  for (PivotLook& look : looks) {
    look.probe.errors = {};
    look.probe.errors.noise.topLeftCorner<3, 3>().diagonal().setConstant(sigma * sigma);
    look.probe.errors.noise.bottomRightCorner<3, 3>().diagonal().setConstant(1e-14);
    Eigen::Isometry3d& pose = look.probe.camera_from_body.pose;
    pose.translation() = Eigen::Vector3d(0.0, 0.1, 0.6) - pose.linear() * ball;
    slips.push_back({normal(random), normal(random), normal(random)});
  }
  const auto found = [&](double scale) {
    std::vector<PivotLook> moved_looks = looks;
    for (std::size_t i = 0; i < looks.size(); ++i)
      moved_looks[i].probe.camera_from_body.pose.pretranslate(scale * slips[i]);
    return calibrate_pivot(moved_looks, exact_rig(), {.most_sigma = 1.0});
  };
  const PivotCalibration small = found(0.1), usual = found(1.0);
  const auto excess = [&](const PivotCalibration& of) {  // chi-square over its freedom
    const double n = static_cast<double>(looks.size());
    return n * of.rms * of.rms / (sigma * sigma) / (3.0 * n - 6.0);
  };
  const PivotCalibration grown = found(std::sqrt(1.18 / excess(usual)));
  ASSERT_NEAR(excess(grown), 1.18, 0.02);
  EXPECT_LT((grown.parts.noise - 1.18 * small.parts.noise).norm(), 0.02 * small.parts.noise.norm());
}

TEST(Pivot, the_covariance_is_the_sum_of_all_its_parts) {
  std::mt19937 random(7);
  Turning turning;
  turning.probe.errors = turning.base.errors = {0.002, 0.005, 0.001, 0.01};
  const PivotCalibration found = turning.found(25, random, {.most_sigma = 0.1});
  ASSERT_EQ(found.refusal, "");
  const Eigen::Matrix3d parts[] = {found.parts.noise, found.parts.camera, found.parts.probe,
                                   found.parts.base};
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const Eigen::Matrix3d& part : parts) {
    EXPECT_GT(part.trace(), 1e-12);
    sum += part;
  }
  EXPECT_LT((found.covariance - sum).norm(), 1e-9 * sum.norm());
}

TEST(Pivot, refusal_names_the_largest_part_and_its_cure) {
  const auto refusal = [](auto change) {
    std::mt19937 random(9);
    Turning turning;
    change(turning);
    return turning.found(25, random, {.most_sigma = 1e-4}).refusal;
  };
  const std::string tags = refusal([](Turning& t) { t.probe.errors = {0.0, 0.01, 0.002, 0.02}; });
  EXPECT_NE(tags.find("by what is not known of the probe's tags: measure them with "
                      "`calibrate board --body probe`"),
            std::string::npos)
      << tags;
  const std::string camera = refusal([](Turning& t) { t.camera.errors = {0.05, 0.01, 20.0, 10.0}; });
  EXPECT_NE(camera.find("by what is not known of the camera: calibrate it"), std::string::npos) << camera;
  const std::string noise = refusal([](Turning& t) {
    t.probe.errors = t.base.errors = {0.0, 0.0, 0.0, 0.0};
    t.camera.errors = {0.0, 0.0, 0.0, 0.0};
  });
  EXPECT_NE(noise.find("by noise and slips: turn the probe to all sides"), std::string::npos) << noise;
}

TEST(Pivot, looks_in_which_the_ball_slipped_are_left_out) {
  std::mt19937 random(4);
  Turning turning;
  turning.slips = 0.15;
  const PivotCalibration found = turning.found(60, random, {.most_sigma = 0.01});
  ASSERT_EQ(found.refusal, "");
  EXPECT_GT(found.left_out, 3U);
  EXPECT_LT((found.ball - turning.ball).norm(), 0.002);
}

TEST(Pivot, small_turns_one_axis_and_few_looks_are_refused_with_the_reason) {
  std::mt19937 random(5);
  Turning still;
  still.tilt = 0.1;
  const PivotCalibration small = still.found(30, random);
  EXPECT_NE(small.refusal.find("turned by at most"), std::string::npos) << small.refusal;
  Turning turning;
  const PivotRig rig{turning.camera, turning.probe, turning.base};
  std::vector<PivotLook> looks = turning.looks(1, random);
  const PivotLook first = looks.front();
  for (int i = 1; i < 30; ++i) {  // about the probe's own z alone: how far the ball is down it, nobody sees
    PivotLook next = first;
    next.probe.camera_from_body.pose.rotate(Eigen::AngleAxisd(0.05 * i, Eigen::Vector3d::UnitZ()));
    looks.push_back(next);
  }
  const PivotCalibration axis = calibrate_pivot(looks, rig);
  EXPECT_NE(axis.refusal.find("turn the probe to all sides"), std::string::npos) << axis.refusal;
  looks.resize(5);
  EXPECT_NE(calibrate_pivot(looks, rig).refusal.find("5 images"), std::string::npos);
}

}  // namespace pivot_test
}  // namespace clearway

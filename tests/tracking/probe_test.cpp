#include "tracking/probe.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <random>
#include <stdexcept>

#include "tests/worlds/probe_stage.hpp"
#include "tests/worlds/trials.hpp"

namespace clearway {
namespace probe_test {

using scene::tag_before_camera, scene::Stage, scene::expect_refused, scene::without;

constexpr double kDegree = M_PI / 180.0;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(Probe, paints_the_sphere_of_equations_1_and_3_where_the_truth_has_it) {
  Stage stage;
  Probe probe = stage.made();
  for (int i = 0; i < 50; ++i) {
    stage.camera_from_probe.translation().x() += 0.002;
    const PaintingSample sample = probe.sample(stage.seen(), 0.1 * i);
    ASSERT_TRUE(sample.accepted) << sample.reason;
    const Eigen::Vector3d truth =
        stage.camera_from_base.inverse() * (stage.camera_from_probe * stage.probe.ball_in_probe);
    EXPECT_LT((sample.sphere.center - truth).norm(), 5 * sample.center_sigma);
    EXPECT_LT((sample.sphere.center - truth).norm(), stage.budget.tracking);
    EXPECT_LT((sample.sphere.center - truth).norm(), sample.bound.total);
    EXPECT_NEAR(sample.sphere.radius, 0.04 - 0.001 - sample.bound.total - 0.001, 1e-15);
    EXPECT_EQ(sample.reason, "");
  }
  EXPECT_EQ(probe.count(Refusal::none), 50);
}

TEST(Probe, its_center_uncertainty_is_calibrated) {
  Stage stage;
  stage.noise = stage.pose.pixel_noise = 0.2;
  stage.budget = {0.0, 0.03, 0.0};
  Probe probe = stage.made();
  const UncertainPose nothing;
  double sum = 0;
  const int n = 800;
  for (int i = 0; i < n; ++i) {
    const PaintingSample sample = probe.sample(stage.seen(), i);
    ASSERT_TRUE(sample.accepted) << sample.reason;
    const UncertainPoint center = transform(sample.base_from_probe, stage.probe.ball_in_probe);
    const Eigen::Vector3d error = center.point - stage.camera_from_base.inverse() *
                                                     (stage.camera_from_probe * stage.probe.ball_in_probe);
    sum += error.dot(center.covariance.inverse() * error) / n;
    EXPECT_LT(error.norm(), 4.5 * sample.center_sigma);
  }
  EXPECT_NEAR(sum, 3.0, 0.35);  // chi-square(3): standard deviation of the mean 0.087
}

TEST(Probe, refuses_for_each_reason_with_a_sentence_and_counts_it) {
  Stage stage;
  Probe probe = stage.made();
  double time = 0;
  EXPECT_TRUE(probe.sample(stage.seen(), ++time).accepted);
  expect_refused(probe.sample(stage.seen(), time), Refusal::time_not_rising);
  expect_refused(probe.sample(stage.seen(), time - 5), Refusal::time_not_rising);
  expect_refused(probe.sample(stage.seen(), kNan), Refusal::time_not_rising);
  expect_refused(probe.sample({}, ++time), Refusal::base_not_seen);
  expect_refused(probe.sample(without(stage.seen(), 0, 5), ++time), Refusal::base_not_seen);
  expect_refused(probe.sample(without(stage.seen(), 20, 29), ++time), Refusal::probe_not_seen);
  auto bent = stage.seen();
  for (int i = 0; i < 3; ++i) bent[i].corners[i].x() += 8.0;  // too many to be left out
  expect_refused(probe.sample(bent, ++time), Refusal::reprojection_error);
  expect_refused(probe.refuse_image("the image is empty", ++time), Refusal::image_refused);
  EXPECT_TRUE(probe.sample(stage.seen(), ++time).accepted);
  stage.camera_from_probe.translation().x() -= 0.15;
  expect_refused(probe.sample(stage.seen(), time += 0.1), Refusal::too_fast);
  EXPECT_EQ(probe.count(Refusal::none), 2);
  EXPECT_EQ(probe.count(Refusal::time_not_rising), 3);
  EXPECT_EQ(probe.count(Refusal::base_not_seen), 2);
  EXPECT_EQ(probe.counts().at("reprojection_error"), 1);
  EXPECT_EQ(probe.counts().size(), static_cast<std::size_t>(kRefusals));
  std::int64_t sum = 0;
  for (const auto& [name, count] : probe.counts()) sum += count;
  EXPECT_EQ(sum, 11);
}

TEST(Probe, refuses_bodies_that_show_too_few_tags) {
  Stage stage;
  stage.acceptance.min_base_tags = 4;
  Probe probe = stage.made();
  EXPECT_TRUE(probe.sample(stage.seen(), 1).accepted);
  expect_refused(probe.sample(without(stage.seen(), 0, 2), 2), Refusal::too_few_tags);
  stage.acceptance.min_probe_tags = 6;
  Probe stricter = stage.made();
  expect_refused(stricter.sample(stage.seen(), 1), Refusal::too_few_tags);
}

TEST(Probe, refuses_a_small_far_tag_that_two_poses_explain) {
  Stage stage;
  stage.probe.body = scene::board("far", 20, 1, 1, 0.06, 0.1);
  stage.camera_from_probe = tag_before_camera(1.5, 0.2, 1.0);
  stage.budget = {0.0, 0.03, 0.0};
  stage.noise = 0.3;
  Probe probe = stage.made();
  int ambiguous = 0;
  for (int i = 0; i < 50; ++i) ambiguous += probe.sample(stage.seen(), i).refusal == Refusal::ambiguous_pose;
  EXPECT_GT(ambiguous, 40);
}

TEST(Probe, takes_the_papers_constant_from_the_ball_and_refuses_a_center_less_sure) {
  Stage stage;
  stage.budget.constant_tracking = true;
  stage.budget.tracking = 0.0005;
  Probe probe = stage.made();
  expect_refused(probe.sample(stage.seen(), 1), Refusal::uncertain_center);
  stage.budget.tracking = 0.03;
  const PaintingSample sample = stage.made().sample(stage.seen(), 1);
  EXPECT_TRUE(sample.accepted);
  EXPECT_NEAR(sample.sphere.radius, 0.04 - 0.001 - 0.03 - 0.001, 1e-15);
}

TEST(Probe, refuses_a_center_whose_bound_leaves_nothing_of_the_ball) {
  Stage stage;
  const double bound = stage.made().sample(stage.seen(), 1).bound.total;
  stage.probe.ball_radius = 0.002 + 0.9 * bound;
  expect_refused(stage.made().sample(stage.seen(), 1), Refusal::uncertain_center);
  stage.probe.ball_radius = 0.002 + 1.2 * bound;
  EXPECT_TRUE(stage.made().sample(stage.seen(), 1).accepted);
}

TEST(Probe, takes_its_noise_from_earlier_images_but_never_more_than_is_stated) {
  Stage stage;
  stage.pose.pixel_noise = 0.4;
  Probe learns = stage.made();
  stage.acceptance.least_noise = 1.0;  // off
  Probe believes = stage.made();
  PaintingSample learnt, believed;
  for (int i = 0; i < 20; ++i) {
    const auto seen = stage.seen();
    learnt = learns.sample(seen, i);
    believed = believes.sample(seen, i);
  }
  EXPECT_LT(learnt.bound.noise, 0.4 * believed.bound.noise);
  stage.noise = 0.8;
  for (int i = 20; i < 60; ++i) {
    const auto seen = stage.seen();
    learnt = learns.sample(seen, i);
    believed = believes.sample(seen, i);
  }
  EXPECT_EQ(learnt.bound.noise, believed.bound.noise);
}

TEST(Probe, a_tag_that_others_contradict_over_time_is_not_believed_when_it_is_seen_with_few) {
  Stage stage;
  PaintingProbe bent = stage.probe;
  Probe probe = stage.made();
  const int loose = 22;
  bent.body.tags.at(loose).body_from_tag.translation() += Eigen::Vector3d(0.004, 0.004, 0.0);
  Stage truth = stage;
  truth.probe = bent;
  // Turned so that three faces show, the loose one among them.
  double time = 0.0;
  const auto shows = [](const std::vector<TagDetection>& seen, int id) {
    return std::any_of(seen.begin(), seen.end(), [&](const TagDetection& tag) { return tag.id == id; });
  };
  for (double azimuth = 0.0; azimuth < 6.3; azimuth += 0.2) {
    truth.camera_from_probe = tag_before_camera(0.45, 0.8, azimuth, 0.3, 0.08, -0.04);
    if (const auto seen = truth.seen(); shows(seen, loose)) break;
  }
  ASSERT_TRUE(shows(truth.seen(), loose));
  PaintingSample sample;
  for (int i = 0; i < 10; ++i) sample = probe.sample(truth.seen(), time += 0.1);
  ASSERT_TRUE(sample.probe);
  EXPECT_EQ(std::count(sample.probe->tags.begin(), sample.probe->tags.end(), loose), 0);
  auto few = truth.seen();
  std::erase_if(few, [&](const TagDetection& tag) { return tag.id > 20 && tag.id != loose; });
  ASSERT_TRUE(shows(few, loose) && shows(few, 20));
  sample = probe.sample(few, time += 0.1);
  ASSERT_TRUE(sample.probe);
  EXPECT_EQ(sample.probe->tags, std::vector<int>{20});
}

TEST(Probe, cannot_be_made_of_parts_that_do_not_fit) {
  const auto refuses = [](auto spoil) {
    Stage stage;
    spoil(stage);
    EXPECT_THROW(stage.made(), std::invalid_argument);
  };
  refuses([](Stage& s) { s.probe.body.tags[2] = s.base.tags[2]; });
  refuses([](Stage& s) { s.probe.ball_radius = 0.002; });
  refuses([](Stage& s) { s.camera.fx = 0; });
  refuses([](Stage& s) { s.base.tags.clear(); });
  refuses([](Stage& s) { s.probe.body.tags.clear(); });
  refuses([](Stage& s) { s.pose.pixel_noise = kNan; });
  refuses([](Stage& s) { s.acceptance.min_base_tags = 0; });
  refuses([](Stage& s) { s.acceptance.min_probe_tags = 0; });
  refuses([](Stage& s) { s.acceptance.max_rms_px = kNan; });
  refuses([](Stage& s) { s.acceptance.min_ambiguity_ratio = 0.5; });
  refuses([](Stage& s) { s.acceptance.min_separation = kNan; });
  refuses([](Stage& s) { s.acceptance.max_noise = 0.5; });
  refuses([](Stage& s) { s.acceptance.least_noise = 0; });
  refuses([](Stage& s) { s.acceptance.max_turn_speed = 0; });
  refuses([](Stage& s) { s.acceptance.max_pause = 0; });
  refuses([](Stage& s) { s.camera.errors.focal = -1; });
  refuses([](Stage& s) { s.base.errors.place = kNan; });
  refuses([](Stage& s) { s.acceptance.max_speed = -1; });
  refuses([](Stage& s) { s.acceptance.static_board.memory = 0; });
}

struct FlipCount {
  int accepted = 0, flipped = 0, off = 0;
};

// One 6 cm tag at `distance`, tilted 0 to 60 degrees any way, with `actual` pixels of noise; counts the
// accepted poses, those of them turned by more than 20 degrees, and those whose ball is off by more than eq.
// 3 pays for.
FlipCount count_flips(double distance, double actual, const Stage& rules, int poses) {
  Stage stage = rules;
  stage.acceptance.max_speed = 1e9;
  Probe probe = stage.made();
  std::uniform_real_distribution<double> unit(0, 1);
  FlipCount count;
  for (int i = 0; i < poses; ++i) {
    const double tilt = 60 * kDegree * unit(stage.random), azimuth = 2 * M_PI * unit(stage.random);
    const double roll = 2 * M_PI * unit(stage.random), x = unit(stage.random) - 0.5,
                 y = unit(stage.random) - 0.5;
    stage.camera_from_probe = tag_before_camera(distance, tilt, azimuth, roll, 0.2 * x, 0.2 * y);
    auto seen = scene::noisy_detections(stage.camera, scene::placed(stage.base, stage.camera_from_base), 0.02,
                                        stage.random);
    const auto tag = scene::noisy_detections(
        stage.camera, scene::placed(stage.probe.body, stage.camera_from_probe), actual, stage.random);
    seen.insert(seen.end(), tag.begin(), tag.end());
    const PaintingSample sample = probe.sample(seen, i);
    if (!sample.accepted) continue;
    ++count.accepted;
    count.flipped +=
        scene::angle(sample.probe->camera_from_body.pose, stage.camera_from_probe) > 20 * kDegree;
    const Eigen::Vector3d truth =
        stage.camera_from_base.inverse() * (stage.camera_from_probe * stage.probe.ball_in_probe);
    count.off += (sample.sphere.center - truth).norm() > stage.budget.tracking;
  }
  return count;
}

Stage single_tag_stage(double stated_noise, double lever, double tracking_error) {
  Stage stage;
  stage.base = scene::board("base", 0, 1, 1, 0.2, 0.2);
  stage.probe = {scene::board("single", 20, 1, 1, 0.06, 0.1), {0.0, -lever, 0.0}, 0.05};
  stage.budget = {0.0, tracking_error, 0.0};
  stage.camera.errors = {0.0, 0.0, 0.0, 0.0};  // all is as stated but the corners
  stage.base.errors = stage.probe.body.errors = {0.0, 0.0, 0.0, 0.0};
  stage.pose.edge_bias = 0.0;
  stage.acceptance.max_turn_speed = 1e9;
  stage.pose.pixel_noise = stated_noise;
  return stage;
}

TEST(Probe, accepts_no_flipped_pose_of_a_single_small_tag_even_when_any_uncertainty_is_allowed) {
  Stage stage = single_tag_stage(0.5, 0.2, 0.02);
  stage.probe.ball_radius = 100.0;
  for (const auto& [distance, poses] :
       {std::pair(0.4, trials(1000, 2000)), std::pair(0.6, trials(1000, 2000)),
        std::pair(0.8, trials(2000, 8000))}) {
    const FlipCount count = count_flips(distance, 0.5, stage, poses);
    EXPECT_EQ(count.flipped, 0) << distance;
    EXPECT_GT(count.accepted, 0) << distance;
    RecordProperty("accepted_per_mille_at_" + std::to_string(int(1000 * distance)) + "_mm",
                   1000 * count.accepted / poses);
  }
}

TEST(Probe, accepts_no_flipped_pose_when_the_noise_is_two_thirds_more_than_stated) {
  Stage stage = single_tag_stage(0.3, 0.2, 0.02);
  stage.probe.ball_radius = 100.0;
  const int poses = trials(2000, 8000);
  const FlipCount count = count_flips(0.8, 0.5, stage, poses);
  EXPECT_EQ(count.flipped, 0);
  RecordProperty("accepted_per_mille", 1000 * count.accepted / poses);
}

TEST(Probe, accepted_spheres_of_a_single_tag_keep_within_the_tracking_error) {
  Stage stage = single_tag_stage(0.2, 0.1, 0.01);
  stage.budget.constant_tracking = true;
  int accepted = 0, off = 0;
  for (double distance : {0.3, 0.4, 0.5, 0.6}) {
    const FlipCount count = count_flips(distance, 0.2, stage, 1500);
    accepted += count.accepted;
    off += count.off;
  }
  EXPECT_GT(accepted, 1000);
  EXPECT_LE(off, accepted / 500);
  RecordProperty("accepted", accepted);
  RecordProperty("off", off);
}

}  // namespace probe_test
}  // namespace clearway

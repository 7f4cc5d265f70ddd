// What one image leaves to the next: speeds, jumps, tags that confirm each other, a base that rests.
#include <gtest/gtest.h>

#include "tests/worlds/probe_stage.hpp"
#include "tracking/probe.hpp"

namespace clearway {
namespace probe_over_time_test {

using scene::tag_before_camera, scene::Stage, scene::expect_refused, scene::without;

TEST(Probe, refuses_a_probe_that_turns_at_once) {
  Stage stage;
  Probe probe = stage.made();
  EXPECT_TRUE(probe.sample(stage.seen(), 0.0).accepted);
  const Eigen::Vector3d ball = stage.camera_from_probe * stage.probe.ball_in_probe;
  stage.camera_from_probe = Eigen::Translation3d(ball) * Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitX()) *
                            Eigen::Translation3d(-ball) * stage.camera_from_probe;
  expect_refused(probe.sample(stage.seen(), 0.05), Refusal::too_fast);  // 10 rad/s, the ball at rest
  EXPECT_TRUE(probe.sample(stage.seen(), 0.15).accepted);
}

TEST(Probe, a_jump_stays_refused_until_time_makes_it_slow_and_the_ball_rests) {
  Stage stage;
  Probe probe = stage.made();
  EXPECT_TRUE(probe.sample(stage.seen(), 0.0).accepted);
  stage.camera_from_probe.translation().x() -= 0.15;  // 0.3 s at 0.5 m/s
  for (double time : {0.1, 0.2, 0.28}) expect_refused(probe.sample(stage.seen(), time), Refusal::too_fast);
  EXPECT_TRUE(probe.sample(stage.seen(), 0.4).accepted);
  stage.camera_from_probe.translation().x() += 0.2;  // slow since the last accepted, but a jump in one image
  EXPECT_TRUE(probe.sample(without(stage.seen(), 20, 29), 10.0).refusal == Refusal::probe_not_seen);
  EXPECT_TRUE(probe.sample(stage.seen(), 10.1).accepted);
}

TEST(Probe, an_outlier_between_two_good_images_leaves_its_speed_to_the_image_after_it) {
  Stage stage;
  Probe probe = stage.made();
  const auto at = [&](double x, double time) {  // metres along the image from where it began
    Stage moved = stage;
    moved.camera_from_probe.translation().x() -= x;
    return probe.sample(moved.seen(), time);
  };
  EXPECT_TRUE(at(0.0, 0.0).accepted);
  expect_refused(at(0.15, 0.1), Refusal::too_fast);  // 1.5 m/s, at most 0.5
  // 0.1 m/s from the last accepted, but 1.3 m/s from where it was measured 0.1 s ago: which of the two is
  // wrong nobody knows.
  const PaintingSample back = at(0.02, 0.2);
  expect_refused(back, Refusal::too_fast);
  EXPECT_NEAR(back.speed, 1.3, 0.1);
  EXPECT_TRUE(at(0.02, 0.3).accepted);  // it rests: slow from both
}

TEST(Probe, ATagAloneNeedsTheImageBefore) {
  Stage stage;
  stage.probe.ball_radius = 0.08;
  stage.acceptance.max_pause = 0.5;
  Probe probe = stage.made();
  const auto alone = [&] { return without(stage.seen(), 1, 5); };
  expect_refused(probe.sample(alone(), 0.0), Refusal::unconfirmed);
  EXPECT_TRUE(probe.sample(alone(), 0.1).accepted);
  EXPECT_TRUE(probe.sample(alone(), 0.6).accepted);
  expect_refused(probe.sample(alone(), 1.2), Refusal::unconfirmed);  // too long ago
  EXPECT_TRUE(probe.sample(alone(), 1.3).accepted);
  expect_refused(probe.sample({}, 1.4), Refusal::base_not_seen);
  expect_refused(probe.sample(alone(), 1.5), Refusal::unconfirmed);  // not by the image before
  EXPECT_TRUE(probe.sample(alone(), 1.6).accepted);
  probe.refuse_image("the image is empty", 1.7);
  expect_refused(probe.sample(alone(), 1.8), Refusal::unconfirmed);
}

TEST(Probe, TwoTagsOfEachConfirmEachOther) {
  Stage stage;
  stage.probe.ball_radius = 0.08;
  stage.acceptance.max_pause = 0.5;
  bool was_seen = false;
  for (double azimuth = 0.0; azimuth < 6.3 && !was_seen; azimuth += 0.2) {
    stage.camera_from_probe = tag_before_camera(0.45, 0.8, azimuth, 0.3, 0.08, -0.04);
    const auto two = without(stage.seen(), 2, 5);
    const PaintingSample sample = stage.made().sample(two, 0.0);
    if (!sample.probe || sample.probe->tags.size() < 2) continue;
    was_seen = true;
    EXPECT_TRUE(sample.accepted) << sample.reason;
    expect_refused(stage.made().sample(without(two, 1, 1), 0.0), Refusal::unconfirmed);
  }
  EXPECT_TRUE(was_seen);
}

TEST(Probe, ABaseThatStaysWhereItWasNeedsNoSecondTag) {
  Stage stage;
  stage.acceptance.max_pause = 0.5;
  stage.probe.ball_radius = 0.08;
  stage.camera_from_probe = tag_before_camera(0.45, 0.8, 0.8, 0.3, 0.08, -0.04);
  for (const bool is_fixed : {true, false}) {
    stage.acceptance.fixed_camera = is_fixed;
    Probe probe = stage.made();
    expect_refused(probe.sample(without(stage.seen(), 1, 5), 0.0), Refusal::unconfirmed);
    const PaintingSample later = probe.sample(without(stage.seen(), 1, 5), 2.0);  // long after
    ASSERT_TRUE(later.probe);
    ASSERT_GE(later.probe->tags.size(), 2U);
    EXPECT_EQ(later.accepted, is_fixed) << later.reason;
  }
}

// One of a probe's two tags has come loose. Which one, no image can tell; what was painted by one of them
// alone before they were seen together is told.
TEST(Probe, OfTwoTagsThatContradictEachOtherNeitherPaintsAlone) {
  Stage stage;
  stage.acceptance.max_pause = 1.0;
  stage.probe = {scene::board("pair", 20, 2, 1, 0.06, 0.1), {0.0, -0.1, 0.0}, 0.06};
  stage.camera_from_probe = tag_before_camera(0.45, 0.6, 1.0, 0.3, 0.08, -0.04);
  for (const bool is_loose : {true, false}) {
    Probe probe = stage.made();
    Stage truth = stage;
    if (is_loose) truth.probe.body.tags.at(20).body_from_tag.translation().y() += 0.015;
    double time = 0.0;
    const auto see_without = [&](int id) { return probe.sample(without(truth.seen(), id, id), time += 0.1); };
    expect_refused(see_without(21), Refusal::unconfirmed);
    for (int i = 0; i < 4; ++i) EXPECT_TRUE(see_without(21).accepted);
    EXPECT_EQ(probe.doubts().samples, 0);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(see_without(30).accepted, !is_loose);
    for (const int hidden : {20, 21}) {
      const PaintingSample alone = see_without(hidden);
      if (!is_loose) continue;
      expect_refused(alone, Refusal::unconfirmed);
      const std::string only = "only tag " + std::to_string(41 - hidden) + " of 'pair'";
      EXPECT_NE(alone.reason.find(only), std::string::npos) << alone.reason;
    }
    EXPECT_EQ(probe.doubts().samples, is_loose ? 4 : 0);
    EXPECT_EQ(probe.doubts().tags, is_loose ? std::set<int>{20} : std::set<int>{});
  }
}

// A tag alone on its body, found 30 pixels off: its residuals show nothing.
TEST(Probe, AWrongFirstImagePaintsNothing) {
  Stage stage;
  stage.base = scene::board("base", 0, 3, 1, 0.06, 0.09);
  stage.probe = {scene::board("single", 20, 1, 1, 0.06, 0.1), {0.0, -0.1, 0.0}, 0.05};
  stage.camera_from_probe = tag_before_camera(0.45, 0.6, 1.0, 0.3, 0.08, -0.04);
  const auto wrong = [&] {
    auto seen = stage.seen();
    for (TagDetection& tag : seen)
      if (tag.id == 20)
        for (auto& corner : tag.corners) corner.x() += 30.0;
    return seen;
  };
  const auto error = [&](const PaintingSample& sample) {
    return (sample.sphere.center -
            stage.camera_from_base.inverse() * (stage.camera_from_probe * stage.probe.ball_in_probe))
        .norm();
  };
  const PaintingSample believed = stage.made().sample(wrong(), 0.0);
  EXPECT_TRUE(believed.accepted);
  EXPECT_GT(error(believed), believed.bound.total);
  stage.acceptance.max_pause = AcceptanceOptions{}.max_pause;
  Probe probe = stage.made();
  expect_refused(probe.sample(wrong(), 0.0), Refusal::unconfirmed);
  expect_refused(probe.sample(stage.seen(), 0.03), Refusal::too_fast);
  const PaintingSample right = probe.sample(stage.seen(), 0.06);
  EXPECT_TRUE(right.accepted) << right.reason;
  EXPECT_LT(error(right), right.bound.total);
}

TEST(Probe, with_a_fixed_camera_averages_the_base_and_refuses_while_it_is_elsewhere) {
  Stage stage;
  stage.acceptance.fixed_camera = true;
  stage.noise = stage.pose.pixel_noise = 0.2;
  stage.budget = {0.0, 0.03, 0.0};
  Probe fixed = stage.made();
  stage.acceptance.fixed_camera = false;
  Probe moving = stage.made();
  PaintingSample last_fixed, last_moving;
  for (int i = 0; i < 40; ++i) {
    const auto seen = stage.seen();
    last_fixed = fixed.sample(seen, i);
    last_moving = moving.sample(seen, i);
    ASSERT_TRUE(last_fixed.accepted) << last_fixed.reason;
  }
  EXPECT_LT(last_fixed.center_sigma, last_moving.center_sigma);
  stage.camera_from_base.translation().x() += 0.03;  // somebody moved the board
  for (int i = 0; i < 5; ++i) expect_refused(fixed.sample(stage.seen(), 40 + i), Refusal::base_moved);
  EXPECT_TRUE(fixed.sample(stage.seen(), 46).accepted);
}

/// A base that is refused says nothing of where it stands.
TEST(Probe, a_base_that_is_refused_does_not_enter_its_mean) {
  Stage stage;
  stage.acceptance.fixed_camera = true;
  stage.acceptance.min_base_tags = 4;
  Probe probe = stage.made();
  scene::expect_refused(probe.sample(scene::without(stage.seen(), 1, 5), 1.0), Refusal::too_few_tags);
  const PaintingSample first = probe.sample(stage.seen(), 1.1), second = probe.sample(stage.seen(), 1.2);
  EXPECT_TRUE(first.accepted && second.accepted) << first.reason << second.reason;
  EXPECT_FALSE(first.base_agrees);
  EXPECT_TRUE(second.base_agrees);
}

/// Where it was measured in between, though it was refused, counts as well as where it was accepted.
TEST(Probe, a_turn_to_and_fro_is_as_fast_as_its_faster_half) {
  Stage stage;
  stage.acceptance.max_speed = 100.0;
  stage.acceptance.max_turn_speed = 3.0;
  const Eigen::Isometry3d at_rest = stage.camera_from_probe;
  const auto turned = [&](double angle) {
    stage.camera_from_probe = at_rest;
    stage.camera_from_probe.rotate(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()));
    return stage.seen();
  };
  Probe probe = stage.made();
  EXPECT_TRUE(probe.sample(turned(0.0), 1.0).accepted);
  scene::expect_refused(probe.sample(turned(-0.4), 1.1), Refusal::too_fast);
  scene::expect_refused(probe.sample(turned(0.0), 1.2), Refusal::too_fast);
  EXPECT_TRUE(probe.sample(turned(0.0), 1.3).accepted);
}

}  // namespace probe_over_time_test
}  // namespace clearway

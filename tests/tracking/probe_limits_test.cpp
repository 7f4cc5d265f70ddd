// Where the rules of a probe begin to refuse, to the last bit, and the numbers that their sentences name.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <limits>

#include "tests/planning/check/comma_locale.hpp"
#include "tests/worlds/probe_stage.hpp"
#include "tracking/pose_errors.hpp"
#include "tracking/probe.hpp"

namespace clearway {
namespace probe_limits_test {

using scene::expect_refused, scene::Stage, scene::without;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double below(double value) { return std::nextafter(value, -kInfinity); }
double above(double value) { return std::nextafter(value, kInfinity); }

/// As sentences write it: four digits.
std::string text(double value) {
  char buffer[40];
  std::snprintf(buffer, sizeof buffer, "%.4g", value);
  return buffer;
}

void expect_says(const PaintingSample& sample, Refusal refusal, const std::vector<std::string>& parts) {
  expect_refused(sample, refusal);
  std::size_t at = 0;
  for (const std::string& part : parts) {
    at = sample.reason.find(part, at);
    ASSERT_NE(at, std::string::npos) << "'" << part << "' in: " << sample.reason;
    at += part.size();
  }
}

TEST(ProbeLimits, options_begin_where_their_words_say_and_are_named_when_they_do_not) {
  const auto expect = [](auto set, double least, double refused, const std::string& name) {
    Stage stage;
    set(stage.acceptance, least);
    EXPECT_NO_THROW(stage.made()) << name;
    for (const double bad : {refused, -1.0, std::nan("")}) {
      if (std::isnan(bad) && name.ends_with("_tags")) continue;
      set(stage.acceptance, bad);
      try {
        stage.made();
        ADD_FAILURE() << name << " " << bad;
      } catch (const std::invalid_argument& error) {
        EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
      }
    }
  };
  using Options = AcceptanceOptions;
  expect([](Options& o, double v) { o.min_base_tags = static_cast<int>(v); }, 1, 0, "min_base_tags");
  expect([](Options& o, double v) { o.min_probe_tags = static_cast<int>(v); }, 1, 0, "min_probe_tags");
  expect([](Options& o, double v) { o.max_noise = v; }, 1.0, below(1.0), "max_noise");
  expect([](Options& o, double v) { o.max_rms_px = v; }, 1e-9, 0.0, "max_rms_px");
  expect([](Options& o, double v) { o.min_ambiguity_ratio = v; }, 1.0, below(1.0), "min_ambiguity_ratio");
  expect([](Options& o, double v) { o.min_separation = v; }, 0.0, below(0.0), "min_separation");
  expect([](Options& o, double v) { o.least_noise = v; }, 1e-9, 0.0, "least_noise");
  expect([](Options& o, double v) { o.max_speed = v; }, 1e-9, 0.0, "max_speed");
  expect([](Options& o, double v) { o.max_turn_speed = v; }, 1e-9, 0.0, "max_turn_speed");
  expect([](Options& o, double v) { o.max_pause = v; }, 1e-9, 0.0, "max_pause");
}

TEST(ProbeLimits, a_pose_is_explained_up_to_its_rms_and_its_chi_square_at_the_noise_allowed) {
  AcceptanceOptions acceptance;
  acceptance.max_rms_px = 1.5;
  for (const double noise : {1.0, 1.5, 3.0}) {
    for (const int freedom : {2, 10, 42}) {
      acceptance.max_noise = noise;
      BodyPose pose;
      pose.freedom = freedom;
      const auto holds = [&](double rms, double chi_square) {
        pose.rms_px = rms;
        pose.chi_square = chi_square;
        return is_explained(pose, acceptance);
      };
      const double most = noise * noise * chi_square_limit(freedom), rms = acceptance.max_rms_px;
      EXPECT_TRUE(holds(0.0, 0.0));
      EXPECT_TRUE(holds(rms, most));
      EXPECT_FALSE(holds(above(rms), 0.0));
      EXPECT_FALSE(holds(0.0, above(most)));
      EXPECT_FALSE(holds(std::nan(""), 0.0));
      EXPECT_FALSE(holds(0.0, std::nan("")));
    }
  }
}

/// The same image is accepted at a limit that it just keeps and refused, with both numbers, at the next one.
TEST(ProbeLimits, an_image_is_accepted_at_each_limit_that_it_just_keeps_and_refused_beyond) {
  Stage stage;
  stage.noise = 0.2;
  const auto seen = stage.seen();
  const PaintingSample usual = stage.made().sample(seen, 1.0);
  ASSERT_TRUE(usual.accepted) << usual.reason;
  const BodyPose &base = *usual.base, &probe = *usual.probe;
  const auto judged = [&](auto set) {
    Stage other = stage;
    set(other);
    return other.made().sample(seen, 1.0);
  };
  const double rms = std::max(base.rms_px, probe.rms_px);
  const auto with_rms = [&](double most) {
    return judged([&](Stage& s) { s.acceptance.max_rms_px = most; });
  };
  EXPECT_TRUE(with_rms(rms).accepted);
  expect_says(with_rms(below(rms)), Refusal::reprojection_error,
              {"rms error of ", text(rms), " px, at most ", text(rms)});

  const double ratio = std::min(base.ambiguity_ratio, probe.ambiguity_ratio);
  ASSERT_TRUE(std::isfinite(ratio));
  const auto with_ratio = [&](double least) {
    return judged([&](Stage& s) { s.acceptance.min_ambiguity_ratio = least; });
  };
  EXPECT_TRUE(with_ratio(ratio).accepted) << with_ratio(ratio).reason;
  expect_says(with_ratio(above(ratio)), Refusal::ambiguous_pose,
              {"another pose with only ", text(ratio), " times the error, at least ", text(ratio)});

  const double separation = std::min(base.separation, probe.separation);
  ASSERT_TRUE(std::isfinite(separation));
  const auto with_separation = [&](double least) {
    return judged([&](Stage& s) { s.acceptance.min_separation = least; });
  };
  EXPECT_TRUE(with_separation(separation).accepted);
  expect_says(with_separation(above(separation)), Refusal::ambiguous_pose,
              {"worse by ", text(separation), "at least ", text(separation)});

  const auto with_tags = [&](int least) {
    return judged([&](Stage& s) { s.acceptance.min_base_tags = least; });
  };
  const int tags = static_cast<int>(base.tags.size());
  EXPECT_TRUE(with_tags(tags).accepted);
  expect_says(with_tags(tags + 1), Refusal::too_few_tags,
              {"'base' shows ", std::to_string(tags), "at least ", std::to_string(tags + 1)});

  const auto with_constant = [&](double tracking) {
    return judged([&](Stage& s) { s.budget.tracking = tracking, s.budget.constant_tracking = true; });
  };
  const double bound = usual.bound.total;
  EXPECT_TRUE(with_constant(bound).accepted);
  expect_says(with_constant(below(bound)), Refusal::uncertain_center,
              {"off by ", text(1e3 * bound), " mm, at most ", text(1e3 * bound)});
  const PaintingSample nothing_left =
      judged([&](Stage& s) { s.probe.ball_radius = s.budget.robot + s.budget.modelling + 0.7 * bound; });
  expect_says(nothing_left, Refusal::uncertain_center,
              {"off by ", text(1e3 * bound), " mm, which leaves nothing of a ball of ",
               text(1e3 * (0.002 + 0.7 * bound)), " mm"});
}

TEST(ProbeLimits, a_chi_square_beyond_what_the_noise_allows_is_named_with_its_limit) {
  Stage stage;
  stage.pose.pixel_noise = 0.01;  // stated far too small, and no other errors to explain what is seen
  stage.camera.errors = {0.0, 0.0, 0.0, 0.0};
  stage.base.errors = stage.probe.body.errors = {0.0, 0.0, 0.0, 0.0};
  stage.pose.edge_bias = 0.0;
  stage.noise = 0.3;
  const PaintingSample sample = stage.made().sample(stage.seen(), 1.0);
  ASSERT_TRUE(sample.base);
  const double noise = stage.acceptance.max_noise;
  expect_says(sample, Refusal::reprojection_error,
              {"chi-square of ", text(sample.base->chi_square), "at most ",
               text(noise * noise * chi_square_limit(sample.base->freedom))});
}

TEST(ProbeLimits, a_move_or_turn_is_accepted_at_the_speed_that_it_has_and_refused_below) {
  Stage stage;
  const auto first = stage.seen();
  stage.camera_from_probe.translation().x() += 0.03;
  stage.camera_from_probe.rotate(Eigen::AngleAxisd(-0.4, Eigen::Vector3d::UnitY()));
  const auto second = stage.seen();
  const auto judged = [&](double max_speed, double max_turn_speed) {
    Stage other = stage;
    other.acceptance.max_speed = max_speed;
    other.acceptance.max_turn_speed = max_turn_speed;
    Probe probe = other.made();
    EXPECT_TRUE(probe.sample(first, 1.0).accepted);
    return probe.sample(second, 1.25);
  };
  Probe before = stage.made();
  const PaintingSample from = before.sample(first, 1.0), to = judged(10.0, 100.0);
  const double speed = (to.sphere.center - from.sphere.center).norm() / 0.25;
  const Eigen::Quaterniond turn_from(from.base_from_probe.pose.linear()),
      turn_to(to.base_from_probe.pose.linear());
  const double turning = turn_from.angularDistance(turn_to) / 0.25;
  EXPECT_GT(speed, 0.05);
  EXPECT_NEAR(turning, 1.6, 0.1);
  EXPECT_NEAR(to.speed, speed, 1e-12);
  EXPECT_EQ(from.speed, 0.0);
  EXPECT_TRUE(judged(to.speed, 100.0).accepted);
  expect_says(judged(below(to.speed), 100.0), Refusal::too_fast,
              {"the ball moved at ", text(speed), " m/s, at most ", text(speed)});
  EXPECT_TRUE(judged(10.0, turning * (1.0 + 1e-9)).accepted);
  expect_says(judged(10.0, turning * (1.0 - 1e-9)), Refusal::too_fast,
              {"the probe turned at ", text(turning), " rad/s, at most ", text(turning)});
}

TEST(ProbeLimits, a_probe_at_rest_is_accepted_however_slow_it_has_to_be) {
  Stage stage;
  stage.acceptance.max_speed = 1e-6;
  stage.acceptance.max_turn_speed = 1e-6;
  Probe probe = stage.made();
  const auto seen = stage.seen();
  EXPECT_TRUE(probe.sample(seen, 1.0).accepted);
  const PaintingSample again = probe.sample(seen, 2.0);
  EXPECT_TRUE(again.accepted) << again.reason;
}

TEST(ProbeLimits, a_tag_alone_is_confirmed_by_an_image_as_long_ago_as_max_pause) {
  Stage stage;
  stage.probe.ball_radius = 0.08;
  const auto judged = [&](double max_pause) {
    Stage other = stage;
    other.acceptance.max_pause = max_pause;
    Probe probe = other.made();
    expect_says(probe.sample(without(other.seen(), 1, 5), 1.0), Refusal::unconfirmed,
                {"only one tag of 'base' is visible", "did not measure the ball"});
    return probe.sample(without(other.seen(), 1, 5), 1.5);
  };
  EXPECT_TRUE(judged(0.5).accepted);
  expect_says(judged(below(0.5)), Refusal::unconfirmed,
              {"only one tag of 'base'", "taken 0.5 s earlier, at most 0.5"});
}

/// By what is refused next to an image of which reason the ball counts as measured.
TEST(ProbeLimits, what_was_refused_for_the_probe_confirms_no_tag_alone) {
  Stage stage;
  stage.probe.ball_radius = 0.08;
  stage.acceptance.max_pause = 5.0;
  const auto alone = [&] { return without(stage.seen(), 1, 5); };
  Probe probe = stage.made();
  EXPECT_TRUE(probe.sample(stage.seen(), 1.0).accepted);
  EXPECT_TRUE(probe.sample(alone(), 1.1).accepted);
  expect_refused(probe.sample(without(stage.seen(), 20, 29), 1.2), Refusal::probe_not_seen);
  expect_refused(probe.sample(alone(), 1.3), Refusal::unconfirmed);
  EXPECT_TRUE(probe.sample(alone(), 1.4).accepted);
  const PaintingSample late = probe.sample(alone(), 1.4);
  expect_says(late, Refusal::time_not_rising, {"the image's time is 0 s before the image before it"});
  EXPECT_EQ(late.time, 1.4);
  expect_says(probe.sample(alone(), 0.9), Refusal::time_not_rising, {"the image's time is 0.5 s before"});
  const PaintingSample empty = probe.refuse_image("the image is empty", 1.5);
  EXPECT_EQ(empty.time, 1.5);
  EXPECT_EQ(empty.reason, "the image is empty");
  expect_refused(probe.sample(alone(), 1.6), Refusal::unconfirmed);
}

TEST(ProbeLimits, sentences_are_the_same_in_every_locale) {
  expect_same_in_every_locale(
      [] {
        Stage stage;
        stage.acceptance.max_rms_px = 0.001;
        return stage.made().sample(stage.seen(), 1.0).reason;
      },
      "at most 0.001");
  expect_same_in_every_locale(
      [] {
        Stage stage;
        stage.probe.ball_radius = 0.0015;
        try {
          stage.made();
        } catch (const std::invalid_argument& error) {
          return std::string(error.what());
        }
        return std::string();
      },
      "0.0015 m");
}

}  // namespace probe_limits_test
}  // namespace clearway

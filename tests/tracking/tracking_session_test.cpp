#include "tracking/tracking_session.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "tests/worlds/tag_scene.hpp"

namespace clearway {
namespace tracking_session_test {

using scene::tag_before_camera;

TrackingSetup desk() {
  return {scene::distorted_camera(),
          scene::board("base", 0, 2, 2, 0.06, 0.09),
          {scene::cube("probe", 20, 0.045, 0.06), {0.0, 0.0, 0.07}, 0.035},
          {0.001, 0.006, 0.001}};
}

const Eigen::Isometry3d kCameraFromBase = tag_before_camera(0.55, 0.7, 0.2, 0.0, -0.13, 0.05);

Eigen::Isometry3d camera_from_probe(int image) {
  return tag_before_camera(0.42, 0.75, 2.5 + 0.02 * image, 0.3, 0.06 + 0.004 * image, -0.05 + 0.003 * image);
}

cv::Mat image_of(const TrackingSetup& setup, int image, const scene::Look& look = {}) {
  auto tags = scene::placed(setup.base, kCameraFromBase);
  for (const auto& tag : scene::placed(setup.probe.body, camera_from_probe(image))) tags.push_back(tag);
  return scene::render(setup.camera, tags, look);
}

TEST(TrackingSession, paints_a_rendered_stroke_within_its_bounds) {
  const TrackingSetup setup = desk();
  TrackingSession session(setup);
  double worst = 0;
  for (int i = 0; i < 12; ++i) {
    scene::Look look;
    look.seed = static_cast<unsigned>(100 + i);
    const TrackedImage image = session.step(image_of(setup, i, look), 0.1 * i);
    ASSERT_TRUE(image.sample.accepted) << image.sample.reason;
    EXPECT_GE(image.detections.size(), 6u);
    const Eigen::Vector3d truth =
        kCameraFromBase.inverse() * (camera_from_probe(i) * setup.probe.ball_in_probe);
    EXPECT_LT((image.sample.sphere.center - truth).norm(), image.sample.bound.total);
    worst = std::max(worst, (image.sample.sphere.center - truth).norm());
    EXPECT_NEAR(image.sample.sphere.radius, 0.033 - image.sample.bound.total, 1e-12);
  }
  EXPECT_LT(worst, 0.003);
  RecordProperty("worst_center_error_um", static_cast<int>(1e6 * worst));
  EXPECT_EQ(session.probe().count(Refusal::none), 12);
}

TEST(TrackingSession, gives_the_same_bits_for_the_same_images_whatever_the_threads) {
  const TrackingSetup setup = desk();
  TrackingOptions four;
  four.detector.threads = 4;
  TrackingSession a(setup), b(setup), c(setup, four);
  for (int i = 0; i < 3; ++i) {
    const cv::Mat image = image_of(setup, i);
    const PaintingSample first = a.step(image, i).sample;
    for (TrackingSession* other : {&b, &c}) {
      const PaintingSample again = other->step(image, i).sample;
      EXPECT_EQ(first.sphere.center, again.sphere.center);
      EXPECT_EQ(first.base_from_probe.covariance, again.base_from_probe.covariance);
    }
  }
}

TEST(TrackingSession, refuses_malformed_images_as_samples_and_goes_on) {
  const TrackingSetup setup = desk();
  TrackingSession session(setup);
  const cv::Mat good = image_of(setup, 0);
  cv::Mat color, deep;
  cv::cvtColor(good, color, cv::COLOR_GRAY2BGR);
  good.convertTo(deep, CV_16U, 256);
  double time = 0;
  for (const cv::Mat& bad :
       {cv::Mat(), color, deep, cv::Mat(good(cv::Rect(0, 0, 320, 240))),
        cv::Mat(1, 1, CV_8UC1, cv::Scalar(0)), cv::Mat(640, 480, CV_8UC1, cv::Scalar(0))}) {
    const TrackedImage image = session.step(bad, time++);
    EXPECT_EQ(to_string(image.sample.refusal), "image_refused");
    EXPECT_NE(image.sample.reason.find("640 x 480"), std::string::npos) << image.sample.reason;
    EXPECT_TRUE(image.detections.empty());
  }
  EXPECT_TRUE(session.step(good, time).sample.accepted);
  EXPECT_EQ(session.probe().count(Refusal::image_refused), 6);
}

TEST(TrackingSession, paints_nothing_from_noise_from_darkness_or_from_a_hidden_base) {
  const TrackingSetup setup = desk();
  TrackingSession session(setup);
  cv::RNG random(3);
  for (int i = 0; i < 10; ++i) {
    cv::Mat noise(480, 640, CV_8UC1);
    random.fill(noise, cv::RNG::UNIFORM, 0, 256);
    EXPECT_EQ(session.step(noise, i).sample.refusal, Refusal::base_not_seen);
  }
  EXPECT_EQ(session.step(cv::Mat::zeros(480, 640, CV_8UC1), 10).sample.refusal, Refusal::base_not_seen);
  const cv::Mat probe_only =
      scene::render(setup.camera, scene::placed(setup.probe.body, camera_from_probe(0)));
  EXPECT_EQ(session.step(probe_only, 11).sample.refusal, Refusal::base_not_seen);
  EXPECT_EQ(session.probe().count(Refusal::none), 0);
}

TEST(TrackingSession, a_moving_probe_that_smears_the_image_never_paints_beyond_its_bound) {
  const TrackingSetup setup = desk();
  TrackingSession session(setup);
  int accepted = 0;
  for (int i = 0; i < 10; ++i) {
    cv::Mat image = image_of(setup, i);
    cv::Mat smear = cv::Mat::ones(1, 2 * i + 1, CV_32F) / (2 * i + 1);  // up to 19 pixels along the row
    cv::filter2D(image, image, -1, smear);
    const PaintingSample sample = session.step(image, i).sample;
    if (!sample.accepted) continue;
    ++accepted;
    const Eigen::Vector3d truth =
        kCameraFromBase.inverse() * (camera_from_probe(i) * setup.probe.ball_in_probe);
    EXPECT_LT((sample.sphere.center - truth).norm(), sample.bound.total) << i;
  }
  EXPECT_GE(accepted, 1);
  RecordProperty("accepted_of_10", accepted);
}

TEST(TrackingSession, cannot_be_made_of_a_setup_that_is_wrong) {
  TrackingSetup setup = desk();
  setup.camera.height = 0;
  EXPECT_THROW(TrackingSession{setup}, std::invalid_argument);
  TrackingOptions options;
  options.detector.decimate = 7;
  EXPECT_THROW((TrackingSession{desk(), options}), std::invalid_argument);
}

}  // namespace tracking_session_test
}  // namespace clearway

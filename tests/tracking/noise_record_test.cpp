#include "tracking/noise_record.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/worlds/tag_scene.hpp"

namespace clearway {
namespace noise_record_test {

double noise_after(int images, double actual, double stated, double least) {
  std::mt19937 random(8);
  const TagBody body = scene::board("board", 0, 2, 1, 0.06, 0.1);
  NoiseRecord record;
  for (int i = 0; i < images; ++i) {
    const auto seen = scene::noisy_detections(
        scene::plain_camera(), scene::placed(body, scene::tag_before_camera(0.5, 0.6, 0.1 * i)), actual,
        random);
    record.note(*estimate_body_pose(body, seen, scene::plain_camera()));
  }
  return record.noise(stated, least);
}

TEST(NoiseRecord, approaches_the_true_noise_from_above) {
  EXPECT_GT(noise_after(100, 0.15, 0.3, 0.01), 0.15);
  EXPECT_LT(noise_after(100, 0.15, 0.3, 0.01), 0.18);
  EXPECT_GT(noise_after(5, 0.15, 1.0, 0.01), noise_after(100, 0.15, 1.0, 0.01));
}

TEST(NoiseRecord, says_what_was_stated_until_it_knows_better_and_never_more_or_too_little) {
  EXPECT_EQ(noise_after(0, 0.1, 0.3, 0.05), 0.3);
  EXPECT_EQ(noise_after(1, 0.1, 0.3, 0.05), 0.3);
  EXPECT_EQ(noise_after(100, 0.9, 0.3, 0.05), 0.3);
  EXPECT_EQ(noise_after(100, 0.02, 0.3, 0.05), 0.05);
}

}  // namespace noise_record_test
}  // namespace clearway

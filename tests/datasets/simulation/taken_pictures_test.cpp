#include "datasets/simulation/taken_pictures.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace clearway {
namespace taken_pictures_test {

Scene long_scene() {
  Scene scene;
  scene.setup.probe.emplace();
  scene.camera.emplace();
  scene.camera->rate_hz = 20;
  scene.stroke.emplace();
  for (const double x : {0.0, 1.0})
    scene.stroke->waypoints.push_back({{x, 0, 0}, Eigen::Quaterniond::Identity()});
  scene.stroke->duration = 100.0;
  return scene;
}

TEST(TakenPictures, WithoutErrorsEachArrivesOnceAtItsTime) {
  const auto pictures = take_pictures(long_scene());
  ASSERT_EQ(pictures.size(), 2001U);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    EXPECT_EQ(pictures[i].number, i);
    EXPECT_DOUBLE_EQ(pictures[i].taken, 0.05 * static_cast<double>(i));
    EXPECT_EQ(pictures[i].stamp, pictures[i].taken);
  }
}

TEST(TakenPictures, AreDroppedAndRepeatedAsOftenAsStatedInRisingOrder) {
  Scene scene = long_scene();
  scene.camera->errors.dropped = 0.2;
  scene.camera->errors.repeated = 0.1;
  const auto pictures = take_pictures(scene);
  std::set<std::size_t> arrived;
  std::size_t again = 0;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    if (i > 0) {
      EXPECT_GT(pictures[i].stamp, pictures[i - 1].stamp);
    }
    again += pictures[i].stamp > pictures[i].taken;
    arrived.insert(pictures[i].number);
  }
  // Within three standard deviations of a binomial count.
  EXPECT_NEAR(static_cast<double>(arrived.size()), 0.8 * 2001, 3 * std::sqrt(2001 * 0.2 * 0.8));
  EXPECT_NEAR(static_cast<double>(again), 0.1 * 2001, 3 * std::sqrt(2001 * 0.1 * 0.9));
}

TEST(TakenPictures, BrightnessChangesSlowlyAndByTheStatedStops) {
  Scene scene = long_scene();
  EXPECT_EQ(exposure_at(scene, 3.0).gain, 1.0);
  scene.camera->errors.brightness = 0.5;
  scene.camera->errors.noise = 1.0;
  double gains = 0.0, noises = 0.0, step = 0.0;
  constexpr int count = 4000;
  for (int i = 0; i < count; ++i) {
    const Exposure now = exposure_at(scene, 0.1 * i), next = exposure_at(scene, 0.1 * i + 1.0 / 15);
    gains += std::pow(std::log2(now.gain), 2);
    noises += std::pow(std::log2(now.noise), 2);
    step = std::max(step, std::abs(std::log2(next.gain / now.gain)));
  }
  EXPECT_NEAR(std::sqrt(gains / count), 0.5, 0.05);
  EXPECT_NEAR(std::sqrt(noises / count), 1.0, 0.1);
  EXPECT_LT(step, 0.3);  // stops from one picture to the next
}

}  // namespace taken_pictures_test
}  // namespace clearway

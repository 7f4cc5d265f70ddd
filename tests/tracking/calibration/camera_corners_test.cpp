#include <gtest/gtest.h>

#include <cmath>

#include "tests/worlds/calibration_views.hpp"
#include "tests/worlds/trials.hpp"
#include "tracking/calibration/calibrate_camera.hpp"
#include "tracking/calibration/camera_judgement.hpp"

/// What a calibration says of what its views did not show: corners of the image, a stretched print.
namespace clearway {
namespace camera_corners_test {

using scene::DrawnViews;
using scene::look_anew;
using scene::Moves;

CameraCalibration found_of(const DrawnViews& drawn) {
  CameraCalibrationOptions options;
  options.folds = 2;
  return calibrate_camera(drawn.camera.width, drawn.camera.height, drawn.stated_board, drawn.views, options);
}

/// Also where the board never was, and whatever the lens has of k3.
TEST(CameraCorners, stated_errors_cover_how_corners_move_in_which_the_board_was_not_seen) {
  const auto drawn_cameras = static_cast<unsigned>(trials(8, 60));
  Moves moves;
  for (const double spread : {0.1, 0.3}) {
    for (unsigned seed = 1; seed <= drawn_cameras; ++seed) {
      DrawnViews drawn = scene::draw_views(seed, 20, {.spread = spread});
      drawn.camera.distortion[4] = -0.1;
      look_anew(
          drawn, seed, [](const Eigen::Vector3d& flat) { return flat; },
          [&](std::size_t) { return drawn.camera; });
      const CameraCalibration found = found_of(drawn);
      ASSERT_TRUE(found.camera.errors.distortion) << seed << found.refusal;
      moves.add(found.camera, drawn.camera, 0.0);
    }
  }
  EXPECT_LE(moves.outside, moves.asked / 100);
}

TEST(CameraCorners, lens_whose_corners_are_not_known_is_refused_and_the_worst_corner_named) {
  CameraCalibration found;
  found.camera.width = 640;
  found.camera.height = 480;
  found.camera.errors.distortion = 5.0;
  found.corner_errors = {6.0, 9.0, 7.0, 6.0};
  EXPECT_EQ(
      judge_corners(found),
      "the lens is known to +- 5 px in the image's corners only, expected 4 px or better: hold the board "
      "into the corners, too, above all into the upper right one");
  found.camera.errors.distortion = 3.9;
  EXPECT_EQ(judge_corners(found), "");
}

/// The print is longer along one side.
void stretch_print(DrawnViews& drawn, unsigned seed, double stretch) {
  const Eigen::Vector3d longer(1.0 + 0.5 * stretch, 1.0 - 0.5 * stretch, 1.0);
  look_anew(
      drawn, seed, [&](const Eigen::Vector3d& flat) -> Eigen::Vector3d { return longer.cwiseProduct(flat); },
      [&](std::size_t) { return drawn.camera; });
}

TEST(CameraCorners, aspect_counts_a_stretched_print_more_where_the_board_was_never_turned_on_its_side) {
  const auto drawn_cameras = static_cast<unsigned>(trials(4, 30));
  for (unsigned seed = 1; seed <= drawn_cameras; ++seed)
    for (const double stretch : {0.01, 0.03})
      for (const bool is_turned : {false, true}) {
        DrawnViews drawn = scene::draw_views(seed, 20, {.roll = is_turned ? M_PI : 0.02});
        stretch_print(drawn, seed, stretch);
        const CameraCalibration found = found_of(drawn);
        ASSERT_TRUE(found.camera.errors.distortion) << seed << found.refusal;
        const double off = std::log(found.camera.fx / found.camera.fy * drawn.camera.fy / drawn.camera.fx);
        EXPECT_LT(std::abs(off), 4.0 * found.camera.errors.aspect) << seed;
        EXPECT_EQ(found.camera.errors.aspect < 0.0005, is_turned) << seed;
        EXPECT_EQ(found.widest_roll > M_PI / 4.0, is_turned) << seed;
        EXPECT_NEAR(found.stretch, stretch, is_turned ? 0.001 : 0.008) << seed;
      }
}

}  // namespace camera_corners_test
}  // namespace clearway

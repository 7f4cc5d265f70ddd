#include "tracking/calibration/view_spread.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace clearway {
namespace view_spread_test {

Camera camera() {
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  return camera;
}

BoardView view_of(const std::array<Eigen::Vector2d, 4>& corners) { return {"view", {{0, 0, 50.0, corners}}}; }

TEST(ViewSpread, coverage_is_the_share_of_the_image_in_which_the_board_was_seen) {
  const BoardView left = view_of({Eigen::Vector2d(0, 0), {319.5, 0}, {319.5, 479}, {0, 479}});
  const BoardView corner = view_of({Eigen::Vector2d(-0.5, -0.5), {100, 0}, {100, 100}, {0, 100}});
  EXPECT_EQ(coverage_of(camera(), {}), 0.0);
  EXPECT_NEAR(coverage_of(camera(), {left}), 0.5, 0.005);
  EXPECT_NEAR(coverage_of(camera(), {left, corner, left}), 0.5, 0.005);
  EXPECT_NEAR(coverage_of(camera(), {corner}), 100.0 * 100.0 / (640.0 * 480.0), 0.001);
}

TEST(ViewSpread, roll_is_a_quarter_turn_at_most_and_upside_down_is_none) {
  const auto rolled = [](double angle) {
    BoardView view;
    view.camera_from_board.linear() = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix() *
                                      Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()).toRotationMatrix();
    return view;
  };
  EXPECT_NEAR(widest_roll({rolled(0.1), rolled(0.3)}, {}), 0.2, 1e-9);
  EXPECT_NEAR(widest_roll({rolled(0.1), rolled(0.1 + M_PI)}, {}), 0.0, 1e-9);
  EXPECT_NEAR(widest_roll({rolled(0.0), rolled(M_PI / 2.0), rolled(3.0)}, {}), M_PI / 2.0, 1e-9);
  EXPECT_NEAR(widest_tilt({rolled(0.0), rolled(1.0)}, {}), 0.0, 1e-6);
}

}  // namespace view_spread_test
}  // namespace clearway

#include "tracking/calibration/calibrate_camera.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/worlds/calibration_views.hpp"
#include "tests/worlds/trials.hpp"
#include "tracking/dense.hpp"

namespace clearway {
namespace calibrate_camera_test {

using scene::DrawnViews;
using scene::look_anew;
using scene::Moves;

TEST(CalibrateCamera, sigmas_cover_the_true_errors_of_drawn_cameras_boards_and_noise) {
  const int drawn_cameras = trials(10, 50);
  double focal = 0.0, centre = 0.0, aspect = 0.0, joint = 0.0, claimed = 0.0, actual = 0.0;
  for (int seed = 1; seed <= drawn_cameras; ++seed) {
    const DrawnViews drawn = scene::draw_views(static_cast<unsigned>(seed), 16);
    const Camera& truth = drawn.camera;
    CameraCalibrationOptions options;
    options.folds = 2;
    const CameraCalibration found =
        calibrate_camera(truth.width, truth.height, drawn.stated_board, drawn.views, options);
    ASSERT_EQ(found.refusal, "") << seed;
    EXPECT_FALSE(found.focal_scatter.is_certain) << seed;
    EXPECT_LT(found.sag, 0.0005) << seed;
    Eigen::Vector4d off(std::log(found.camera.fx * found.camera.fy / (truth.fx * truth.fy)) / 2.0,
                        std::log(found.camera.fx / found.camera.fy * truth.fy / truth.fx),
                        found.camera.cx - truth.cx, found.camera.cy - truth.cy);
    const Eigen::Matrix4d covariance = found.covariance.topLeftCorner<4, 4>();
    focal += off[0] * off[0] / covariance(0, 0);
    aspect += off[1] * off[1] / covariance(1, 1);
    centre += 0.5 * (off[2] * off[2] / covariance(2, 2) + off[3] * off[3] / covariance(3, 3));
    joint += Cholesky(covariance).squared(off);
    claimed += covariance(0, 0);
    actual += off[0] * off[0];
    EXPECT_NEAR(found.held_out_px / std::sqrt(2.0), drawn.noise, 0.35 * drawn.noise + 0.08) << seed;
  }
  EXPECT_LT(focal, chi_square_of_a_thousand(drawn_cameras));
  EXPECT_LT(aspect, chi_square_of_a_thousand(drawn_cameras));
  EXPECT_LT(centre, chi_square_of_a_thousand(drawn_cameras));
  EXPECT_LT(joint, chi_square_of_a_thousand(4 * drawn_cameras));
  EXPECT_GT(joint, drawn_cameras);  // not many times too careful
  EXPECT_LT(claimed, 4.0 * actual);
}

/// On a cylinder of that radius, whose bent way is `way`.
void bend_board(DrawnViews& drawn, unsigned seed, double radius, double way) {
  const Eigen::Vector3d along(std::cos(way), std::sin(way), 0.0), across(-along.y(), along.x(), 0.0);
  const auto on_cylinder = [&](const Eigen::Vector3d& flat) -> Eigen::Vector3d {
    const double angle = along.dot(flat) / radius, inner = radius - flat.z();
    return inner * std::sin(angle) * along + across.dot(flat) * across +
           Eigen::Vector3d(0.0, 0.0, radius - inner * std::cos(angle));
  };
  look_anew(drawn, seed, on_cylinder, [&](std::size_t) { return drawn.camera; });
}

CameraCalibration found_of(const DrawnViews& drawn) {
  CameraCalibrationOptions options;
  options.folds = 2;
  return calibrate_camera(drawn.camera.width, drawn.camera.height, drawn.stated_board, drawn.views, options);
}

/// Logarithm of the focal length found over the true one.
double focal_off(const CameraCalibration& found, const Camera& truth) {
  return std::log(found.camera.fx * found.camera.fy / (truth.fx * truth.fy)) / 2.0;
}

TEST(CalibrateCamera, sigmas_cover_the_true_errors_by_boards_bent_on_a_cylinder) {
  const int drawn_cameras = trials(4, 30);
  double focal = 0.0, centre = 0.0, actual = 0.0;
  for (int seed = 1; seed <= drawn_cameras; ++seed) {
    DrawnViews drawn = scene::draw_views(static_cast<unsigned>(seed), 16, {.spread = 0.7});
    const double radius = seed % 2 == 0 ? 1.5 : -1.5;  // metres: 2 mm over its 0.2 m
    bend_board(drawn, static_cast<unsigned>(seed), radius, 0.6 * seed);
    const CameraCalibration found = found_of(drawn);
    ASSERT_EQ(found.refusal, "") << seed;
    const double off = focal_off(found, drawn.camera);
    focal += off * off / found.covariance(0, 0);
    actual += off * off;
    centre += std::pow(found.camera.cx - drawn.camera.cx, 2) / found.covariance(2, 2) +
              std::pow(found.camera.cy - drawn.camera.cy, 2) / found.covariance(3, 3);
    EXPECT_GT(found.sag, 0.001) << seed;
    EXPECT_NEAR(found.held_out_px / std::sqrt(2.0), drawn.noise, 0.35 * drawn.noise + 0.08) << seed;
  }
  EXPECT_LT(focal, chi_square_of_a_thousand(drawn_cameras));
  EXPECT_LT(centre, chi_square_of_a_thousand(2 * drawn_cameras));
  EXPECT_LT(std::sqrt(actual / drawn_cameras), 0.003);
}

TEST(CalibrateCamera, board_bent_more_than_paper_on_a_clipboard_is_refused) {
  DrawnViews drawn = scene::draw_views(3, 16, {.spread = 0.7});
  bend_board(drawn, 3, 0.5, 0.3);
  const CameraCalibration found = found_of(drawn);
  EXPECT_NE(found.refusal.find("the board is bent by"), std::string::npos) << found.refusal;
  EXPECT_NE(found.refusal.find("glue it on something stiff"), std::string::npos) << found.refusal;
}

/// The focal length of each view differs by so much, at random.
void vary_focus(DrawnViews& drawn, unsigned seed, double scatter) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto camera_of = [&](std::size_t) {
    Camera camera = drawn.camera;
    const double factor = std::exp(scatter * normal(random));
    camera.fx *= factor;
    camera.fy *= factor;
    return camera;
  };
  look_anew(
      drawn, seed, [](const Eigen::Vector3d& flat) { return flat; }, camera_of);
}

TEST(CalibrateCamera, camera_that_focuses_by_itself_is_refused) {
  const auto drawn_cameras = static_cast<unsigned>(trials(3, 20));
  unsigned refused = 0;
  for (unsigned seed = 1; seed <= drawn_cameras; ++seed) {
    DrawnViews drawn = scene::draw_views(seed, 25, {.spread = 0.7});
    vary_focus(drawn, seed, 0.01);
    const CameraCalibration found = found_of(drawn);
    if (found.refusal.empty()) continue;  // of 20 cameras one, whose views hardly tell
    ++refused;
    EXPECT_NE(found.refusal.find("the focal length changes from image to image by"), std::string::npos)
        << seed << found.refusal;
    EXPECT_NEAR(found.focal_scatter.sigma, 0.01, 0.006) << seed;
  }
  EXPECT_GE(refused, drawn_cameras - drawn_cameras / 10);
}

TEST(CalibrateCamera, stated_focal_error_covers_a_focus_that_hardly_moves) {
  const int drawn_cameras = trials(6, 40);
  double focal = 0.0;
  int accepted = 0;
  for (int seed = 1; seed <= drawn_cameras; ++seed) {
    DrawnViews drawn = scene::draw_views(static_cast<unsigned>(seed), 25, {.spread = 0.7});
    vary_focus(drawn, static_cast<unsigned>(seed), 0.003);
    const CameraCalibration found = found_of(drawn);
    if (!found.refusal.empty()) continue;
    ++accepted;
    focal += std::pow(focal_off(found, drawn.camera) / found.camera.errors.focal, 2);
  }
  EXPECT_GE(accepted, drawn_cameras / 4);
  EXPECT_LT(focal, chi_square_of_a_thousand(std::max(1, accepted)));
}

/// All edges seen outside of where they are, those of small tags more, as blur does it, or inside (a bent
/// grey scale): the focal length does not follow.
TEST(CalibrateCamera, sigmas_cover_edges_that_are_moved_alike) {
  const int drawn_cameras = trials(2, 15);
  for (const auto& [out, of_small] : {std::pair(0.0, 1.1), std::pair(-0.04, 0.0), std::pair(0.02, 2.0)}) {
    double focal = 0.0;
    for (int seed = 1; seed <= drawn_cameras; ++seed) {
      DrawnViews drawn = scene::draw_views(static_cast<unsigned>(seed), 30);
      for (BoardView& view : drawn.views)
        for (TagDetection& tag : view.tags) {
          double side = 0.0;
          for (std::size_t i = 0; i < 4; ++i)
            side += (tag.corners[(i + 1) % 4] - tag.corners[i]).norm() / 4.0;
          const Eigen::Vector2d middle =
              (tag.corners[0] + tag.corners[1] + tag.corners[2] + tag.corners[3]) / 4.0;
          const double share =
              2.0 * (out + of_small / side) / side;  // of a square that grows by that at each edge
          for (Eigen::Vector2d& corner : tag.corners) corner += share * (corner - middle);
        }
      CameraCalibrationOptions options;
      options.folds = 2;
      const Camera& truth = drawn.camera;
      const CameraCalibration found =
          calibrate_camera(truth.width, truth.height, drawn.stated_board, drawn.views, options);
      ASSERT_EQ(found.refusal, "") << seed;
      const double off = std::log(found.camera.fx * found.camera.fy / (truth.fx * truth.fy)) / 2.0;
      focal += off * off / found.covariance(0, 0);
    }
    EXPECT_LT(focal, chi_square_of_a_thousand(drawn_cameras)) << out << " " << of_small;
  }
}

TEST(CalibrateCamera, stated_errors_cover_how_the_image_moves) {
  Moves moves;
  for (unsigned seed = 101; seed <= 110; ++seed) {
    const DrawnViews drawn = scene::draw_views(seed, 16);
    const CameraCalibration found =
        calibrate_camera(drawn.camera.width, drawn.camera.height, drawn.stated_board, drawn.views);
    ASSERT_EQ(found.refusal, "") << seed;
    moves.add(found.camera, drawn.camera);
  }
  EXPECT_LE(moves.outside, moves.asked / 100);
}

/// One view of this draw begins at a wrong pose and pushes others beyond what the lens sees.
TEST(CalibrateCamera, a_fisheye_is_found_though_a_view_of_it_is_lost) {
  const DrawnViews drawn = scene::draw_wide_views(scene::drawn_fisheye, 28, 20);
  CameraCalibrationOptions options;
  options.folds = 2;
  options.lens = LensDistortion::Model::fisheye;
  const CameraCalibration found =
      calibrate_camera(drawn.camera.width, drawn.camera.height, drawn.stated_board, drawn.views, options);
  ASSERT_EQ(found.refusal, "");
  EXPECT_EQ(found.views + found.refused.size(), drawn.views.size());
  const double off = std::log(found.camera.fx * found.camera.fy / (drawn.camera.fx * drawn.camera.fy)) / 2.0;
  EXPECT_LT(std::abs(off), 4.0 * found.camera.errors.focal);
}

TEST(CalibrateCamera, sigmas_cover_the_true_errors_of_drawn_fisheyes) {
  const int drawn_cameras = trials(5, 50);
  double joint = 0.0, focal = 0.0;
  Moves moves;
  for (int seed = 1; seed <= drawn_cameras; ++seed) {
    const DrawnViews drawn = scene::draw_wide_views(scene::drawn_fisheye, static_cast<unsigned>(seed), 20);
    const Camera& truth = drawn.camera;
    CameraCalibrationOptions options;
    options.folds = 2;
    options.lens = LensDistortion::Model::fisheye;
    const CameraCalibration found =
        calibrate_camera(truth.width, truth.height, drawn.stated_board, drawn.views, options);
    ASSERT_EQ(found.refusal, "") << seed;
    EXPECT_EQ(found.camera.lens, LensDistortion::Model::fisheye);
    EXPECT_GE(found.views, 18U);
    Eigen::Matrix<double, 8, 1> off;
    off << std::log(found.camera.fx * found.camera.fy / (truth.fx * truth.fy)) / 2.0,
        std::log(found.camera.fx / found.camera.fy * truth.fy / truth.fx), found.camera.cx - truth.cx,
        found.camera.cy - truth.cy, 0, 0, 0, 0;
    for (std::size_t k = 0; k < 4; ++k)
      off[4 + static_cast<int>(k)] = found.camera.distortion[k] - truth.distortion[k];
    const Eigen::Matrix<double, 8, 8> covariance = found.covariance.topLeftCorner<8, 8>();
    joint += Cholesky(covariance).squared(off);
    focal += off[0] / std::sqrt(covariance(0, 0));
    EXPECT_NEAR(found.held_out_px / std::sqrt(2.0), drawn.noise, 0.35 * drawn.noise + 0.08) << seed;
    moves.add(found.camera, truth);
  }
  EXPECT_LT(joint, chi_square_of_a_thousand(8 * drawn_cameras));
  EXPECT_GT(joint, 2 * drawn_cameras);                         // not many times too careful
  EXPECT_LT(std::abs(focal), 3.5 * std::sqrt(drawn_cameras));  // no bias, whatever edges the lens bends
  EXPECT_LE(moves.outside, moves.asked / 100);
}

CameraCalibration rational_of(const DrawnViews& drawn) {
  CameraCalibrationOptions options;
  options.folds = 3;
  options.lens = LensDistortion::Model::rational;
  return calibrate_camera(drawn.camera.width, drawn.camera.height, drawn.stated_board, drawn.views, options);
}

TEST(CalibrateCamera, rational_lenses_of_100_to_120_degrees_are_found_where_a_plumb_bob_fits_worse) {
  const int drawn_cameras = trials(2, 40);
  int found_ones = 0;
  Moves moves;
  double focal = 0.0, centre = 0.0;
  for (int seed = 1; seed <= drawn_cameras; ++seed) {
    const DrawnViews drawn =
        scene::draw_wide_views(scene::drawn_rational, static_cast<unsigned>(seed), 24, {.spread = 1.0});
    const Camera& truth = drawn.camera;
    const CameraCalibration found = rational_of(drawn);
    ASSERT_EQ(found.simpler.size(), 2U) << seed;
    if (!found.refusal.empty()) continue;
    ++found_ones;
    EXPECT_EQ(found.camera.lens, LensDistortion::Model::rational);
    EXPECT_GT(found.simpler[0].held_out_px, 1.01 * found.held_out_px) << seed;
    EXPECT_NEAR(found.held_out_px / std::sqrt(2.0), drawn.noise, 0.35 * drawn.noise + 0.08) << seed;
    const double off = std::log(found.camera.fx * found.camera.fy / (truth.fx * truth.fy)) / 2.0;
    focal += off * off / found.covariance(0, 0);
    centre += std::pow(found.camera.cx - truth.cx, 2) / found.covariance(2, 2) +
              std::pow(found.camera.cy - truth.cy, 2) / found.covariance(3, 3);
    moves.add(found.camera, truth);
  }
  EXPECT_GE(found_ones, 3 * drawn_cameras / 4);
  EXPECT_LT(focal, chi_square_of_a_thousand(found_ones));
  EXPECT_LT(centre, chi_square_of_a_thousand(2 * found_ones));
  EXPECT_GT(focal + centre, found_ones);  // not many times too careful
  EXPECT_LE(moves.outside, moves.asked / 100);
}

TEST(CalibrateCamera, rational_lens_that_narrow_views_do_not_determine_is_refused_and_a_plumb_bob_named) {
  const auto drawn_cameras = static_cast<unsigned>(trials(1, 4));
  for (unsigned seed = 1; seed <= drawn_cameras; ++seed) {
    const CameraCalibration found = rational_of(scene::draw_views(seed, 20));
    EXPECT_NE(found.refusal.find("do not determine a rational lens"), std::string::npos)
        << seed << found.refusal;
    EXPECT_NE(found.refusal.find("a plumb_bob lens to"), std::string::npos) << seed << found.refusal;
    ASSERT_EQ(found.simpler.size(), 2U) << seed;
    if (found.held_out_px == 0.0) continue;  // its fit did not end
    EXPECT_LT(found.simpler[0].held_out_px, 1.01 * found.held_out_px) << seed;
  }
}

TEST(CalibrateCamera, rational_lens_whose_corners_were_not_seen_is_refused) {
  const CameraCalibration found =
      rational_of(scene::draw_wide_views(scene::drawn_rational, 7, 24, {.spread = 0.75}));
  EXPECT_NE(found.refusal.find("px in the image's corners only"), std::string::npos) << found.refusal;
}

TEST(CalibrateCamera, moved_images_and_wrong_tags_are_left_out_and_named) {
  DrawnViews drawn = scene::draw_views(7, 30);
  std::mt19937 random(3);
  std::normal_distribution<double> smear(0.0, 4.0);
  for (const std::size_t v : {3, 11, 19})
    for (TagDetection& tag : drawn.views[v].tags)
      for (Eigen::Vector2d& corner : tag.corners) corner += Eigen::Vector2d(smear(random), smear(random));
  drawn.views[5].tags[1].corners[2].x() += 25.0;
  const CameraCalibration found =
      calibrate_camera(drawn.camera.width, drawn.camera.height, drawn.stated_board, drawn.views);
  ASSERT_EQ(found.refusal, "");
  std::set<std::string> names;
  for (const RefusedView& view : found.refused) names.insert(view.name);
  EXPECT_EQ(names, (std::set<std::string>{"view 3", "view 11", "view 19"}));
  EXPECT_LT(std::abs(found.camera.fx / drawn.camera.fx - 1.0), 4.0 * found.camera.errors.focal);
  EXPECT_LT(found.rms_px, 3.0 * drawn.noise + 0.2);
}

TEST(CalibrateCamera, frontal_views_few_views_one_corner_and_cubes_are_refused_with_the_reason) {
  const DrawnViews frontal = scene::draw_views(9, 24, {.tilt = 0.02});
  const auto refusal = [](const DrawnViews& drawn) {
    return calibrate_camera(drawn.camera.width, drawn.camera.height, drawn.stated_board, drawn.views).refusal;
  };
  EXPECT_NE(refusal(frontal).find("focal length"), std::string::npos) << refusal(frontal);
  EXPECT_NE(refusal(frontal).find("tilt it by 20 to 45 degrees"), std::string::npos) << refusal(frontal);
  EXPECT_NE(refusal(scene::draw_views(9, 5)).find("5 images show two tags"), std::string::npos);
  const std::string cornered = refusal(scene::draw_views(9, 40, {.spread = 0.05, .share = 0.25}));
  EXPECT_NE(cornered.find("% of the image"), std::string::npos) << cornered;
  EXPECT_THROW(calibrate_camera(640, 480, scene::cube("cube", 0, 0.04, 0.06), {}), std::invalid_argument);
}

}  // namespace calibrate_camera_test
}  // namespace clearway

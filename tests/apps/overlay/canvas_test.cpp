#include "apps/overlay/canvas.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <random>

#include "tests/worlds/tag_scene.hpp"

namespace canvas_test {

using namespace clearway;
using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr Colour red{255, 0, 0}, green{0, 255, 0}, blue{0, 0, 255};
const Paint flat_red{red, 1.0}, flat_green{green, 1.0}, flat_blue{blue, 1.0};

/// 160 x 120 pixels with a strong lens: ray casting per pixel stays fast.
Camera small_camera() { return {160, 120, 110.0, 112.0, 78.0, 61.0, {-0.25, 0.06, 0.001, -0.001, 0.0}}; }

cv::Mat grey_image(const Camera& camera, int grey = 90) {
  return cv::Mat(camera.height, camera.width, CV_8UC1, cv::Scalar(grey));
}

/// A triangle that is seen from both sides.
Mesh sheet(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  Mesh mesh;
  const Vector3d normal = (b - a).cross(c - a).normalized();
  mesh.corners = {a, b, c};
  mesh.normals = {normal, normal, normal};
  mesh.triangles = {{0, 1, 2}, {0, 2, 1}};
  return mesh;
}

Vector3d drawn_point(std::mt19937& random) {
  std::uniform_real_distribution<double> aside(-1.2, 1.2), ahead(-0.1, 2.0);
  return {aside(random), aside(random), ahead(random)};
}

/// Moeller and Trumbore 1997: z at which a pixel's ray meets the triangle, none where it does not.
std::optional<double> cast(const Vector2d& ray, const std::array<Vector3d, 3>& t) {
  const Vector3d way(ray.x(), ray.y(), 1.0), e1 = t[1] - t[0], e2 = t[2] - t[0];
  const Vector3d p = way.cross(e2);
  const double det = e1.dot(p);
  if (det == 0.0) return std::nullopt;
  const Vector3d s = -t[0], q = s.cross(e1);
  const double u = s.dot(p) / det, v = way.dot(q) / det, z = e2.dot(q) / det;
  return u >= 0.0 && v >= 0.0 && u + v <= 1.0 && z >= 0.005 ? std::optional(z) : std::nullopt;
}

struct Cast {
  int nearest = -1;        ///< triangle
  bool is_certain = true;  ///< the same all over the pixel and half a pixel around it
};

Cast cast_pixel(const Camera& camera, double x, double y,
                const std::vector<std::array<Vector3d, 3>>& triangles, int rays = 25) {
  Cast middle;
  for (int i = 0; i < rays; ++i) {
    const Vector2d pixel(x + 0.45 * ((i + 12) % 25 % 5 - 2), y + 0.45 * ((i + 12) % 25 / 5 - 2));
    const auto ray = camera.undistort(pixel);
    if (!ray) continue;
    int nearest = -1;
    double least = 1e9;
    for (std::size_t t = 0; t < triangles.size(); ++t)
      if (const auto z = cast(*ray, triangles[t]); z && *z < least) {
        least = *z;
        nearest = static_cast<int>(t);
      }
    if (i == 0) middle.nearest = nearest;
    middle.is_certain = middle.is_certain && nearest == middle.nearest;
  }
  return middle;
}

/// The same with 1,089 rays: no sliver of a triangle lies between them.
bool is_alike(const Camera& camera, int x, int y, const std::vector<std::array<Vector3d, 3>>& triangles) {
  const Cast middle = cast_pixel(camera, x, y, triangles, 1);
  for (int i = -16; i <= 16; ++i)
    for (int j = -16; j <= 16; ++j)
      if (cast_pixel(camera, x + i / 16.0, y + j / 16.0, triangles, 1).nearest != middle.nearest)
        return false;
  return true;
}

Colour numbered(int i) {
  return {static_cast<std::uint8_t>(20 + 9 * i), static_cast<std::uint8_t>(250 - 11 * i), 30};
}

TEST(Canvas, random_triangles_are_seen_where_rays_meet_them_first) {
  std::mt19937 random(1);
  const Camera camera = small_camera();
  int certain = 0, covered = 0, wrong = 0;
  for (int scene = 0; scene < 12; ++scene) {
    std::vector<std::array<Vector3d, 3>> triangles;
    Canvas canvas(camera, Isometry3d::Identity());
    for (int i = 0; i < 12; ++i) {
      triangles.push_back({drawn_point(random), drawn_point(random), drawn_point(random)});
      canvas.add(sheet(triangles.back()[0], triangles.back()[1], triangles.back()[2]), Isometry3d::Identity(),
                 {numbered(i), 1.0});
    }
    const cv::Mat picture = canvas.draw(grey_image(camera));
    for (int y = 0; y < camera.height; y += 2)
      for (int x = 0; x < camera.width; x += 2) {
        const Cast truth = cast_pixel(camera, x, y, triangles);
        if (!truth.is_certain) continue;
        ++certain;
        covered += truth.nearest >= 0 ? 1 : 0;
        const Colour colour = truth.nearest >= 0 ? numbered(truth.nearest) : Colour{90, 90, 90};
        const auto seen = picture.at<cv::Vec3b>(y, x);
        if (seen == cv::Vec3b(colour.blue, colour.green, colour.red)) continue;
        if (is_alike(camera, x, y, triangles)) ++wrong;
      }
  }
  EXPECT_GT(certain, 20000);
  EXPECT_GT(covered, 5000);
  EXPECT_EQ(wrong, 0);
}

/// The mean of a pixel's samples is the share of it that is covered, within what four samples can resolve.
TEST(Canvas, edges_are_smooth) {
  const Camera camera{200, 150, 150.0, 150.0, 99.5, 74.5, {}};
  std::mt19937 random(2);
  std::uniform_real_distribution<double> angle(0.0, 2.0 * M_PI), shift(-5.0, 5.0);
  double worst_mean = 0.0;
  for (int i = 0; i < 40; ++i) {
    const double turn = angle(random), off = shift(random);
    const Vector2d normal(std::cos(turn), std::sin(turn)), along(-normal.y(), normal.x());
    const auto at = [&](const Vector2d& p) { return Vector3d(p.x() / 150.0, p.y() / 150.0, 1.0); };
    Canvas canvas(camera, Isometry3d::Identity());  // half plane: normal * p <= off, p from the middle
    canvas.add(sheet(at(off * normal + 400.0 * along), at(off * normal - 400.0 * along), at(-800.0 * normal)),
               Isometry3d::Identity(), {{255, 255, 255}, 1.0});
    const cv::Mat picture = canvas.draw(grey_image(camera, 0));
    double drawn = 0.0, exact = 0.0;
    for (int y = 40; y < 110; ++y)
      for (int x = 60; x < 140; ++x) {
        const double seen = picture.at<cv::Vec3b>(y, x)[0] / 255.0;
        int inside = 0;
        for (int s = 0; s < 64; ++s) {
          const Vector2d p(x - 99.5 + (s % 8 - 3.5) / 8.0, y - 74.5 + (s / 8 - 3.5) / 8.0);
          inside += normal.dot(p) <= off ? 1 : 0;
        }
        EXPECT_NEAR(seen, inside / 64.0, 0.4) << x << " " << y;
        drawn += seen;
        exact += inside / 64.0;
      }
    worst_mean = std::max(worst_mean, std::abs(drawn - exact));
  }
  EXPECT_LT(worst_mean, 0.125 * 107.0);  // an eighth of a pixel, along the longest edge in view
}

TEST(Canvas, a_surface_cut_into_triangles_has_no_cracks) {
  const Camera camera = small_camera();
  std::mt19937 random(3);
  std::uniform_real_distribution<double> jitter(-0.02, 0.02);
  for (const double alpha : {1.0, 0.5}) {
    Canvas canvas(camera, Isometry3d::Identity());
    const int layer = alpha < 1.0 ? canvas.add_layer(alpha) : 0;
    constexpr int cells = 24;
    std::vector<Vector3d> grid;
    for (int i = 0; i <= cells; ++i)
      for (int j = 0; j <= cells; ++j)
        grid.emplace_back(-2.0 + 4.0 * i / cells + jitter(random), -2.0 + 4.0 * j / cells + jitter(random),
                          1.0 + jitter(random));
    for (int i = 0; i < cells; ++i)
      for (int j = 0; j < cells; ++j) {
        const auto corner = [&](int a, int b) {
          return grid[static_cast<std::size_t>((i + a) * (cells + 1) + j + b)];
        };
        canvas.add(sheet(corner(0, 0), corner(1, 0), corner(1, 1)), Isometry3d::Identity(), flat_red, layer);
        canvas.add(sheet(corner(0, 0), corner(1, 1), corner(0, 1)), Isometry3d::Identity(), flat_red, layer);
      }
    const cv::Mat picture = canvas.draw(grey_image(camera, 0));
    double low = 0.0, high = 0.0;
    cv::Mat channel;
    cv::extractChannel(picture, channel, 2);
    cv::minMaxLoc(channel, &low, &high);
    EXPECT_EQ(low, high) << alpha;  // each sample once, and all of them
    EXPECT_EQ(high, alpha < 1.0 ? 128.0 : 255.0);
  }
}

TEST(Canvas, what_is_nearer_hides_whatever_the_order) {
  const Camera camera = small_camera();
  std::mt19937 random(4);
  std::vector<Mesh> sheets;
  for (int i = 0; i < 20; ++i)
    sheets.push_back(sheet(drawn_point(random), drawn_point(random), drawn_point(random)));
  std::vector<int> order(20);
  for (int i = 0; i < 20; ++i) order[static_cast<std::size_t>(i)] = i;
  cv::Mat first;
  for (int round = 0; round < 5; ++round) {
    Canvas canvas(camera, Isometry3d::Identity());
    canvas.add_layer(0.5);
    canvas.add_layer(0.3);
    for (const int i : order)
      if (i == 7)
        canvas.add_occluder(sheets[7]);
      else
        canvas.add(sheets[static_cast<std::size_t>(i)], Isometry3d::Identity(), {numbered(i), 1.0}, i % 3);
    const cv::Mat picture = canvas.draw(grey_image(camera));
    if (round == 0) first = picture;
    EXPECT_EQ(cv::norm(first, picture, cv::NORM_INF), 0.0);
    std::shuffle(order.begin(), order.end(), random);
  }
  EXPECT_GT(cv::norm(first, cv::Mat(first.size(), CV_8UC3, cv::Scalar(90, 90, 90)), cv::NORM_INF), 50.0);
}

/// The pixel in the middle of walls before and behind each other.
cv::Vec3b middle_of(Canvas& canvas, const Camera& camera, int grey = 100) {
  return canvas.draw(grey_image(camera, grey)).at<cv::Vec3b>(61, 78);
}

Mesh wall(double z) { return sheet({-50, -50, z}, {50, -50, z}, {0, 80, z}); }

TEST(Canvas, blends_layers_from_far_to_near) {
  const Camera camera = small_camera();
  Canvas canvas(camera, Isometry3d::Identity());
  const int half = canvas.add_layer(0.5), quarter = canvas.add_layer(0.25);
  canvas.add(wall(1.0), Isometry3d::Identity(), flat_red, half);
  canvas.add(wall(2.0), Isometry3d::Identity(), flat_blue, quarter);
  canvas.add(wall(3.0), Isometry3d::Identity(), flat_green);
  // blue over green: (64, 191, 0); red over that
  const cv::Vec3b seen = middle_of(canvas, camera);
  EXPECT_NEAR(seen[0], 32, 1);
  EXPECT_NEAR(seen[1], 96, 1);
  EXPECT_NEAR(seen[2], 128, 1);
}

TEST(Canvas, a_layer_over_the_others_is_hidden_by_what_is_solid_alone) {
  const Camera camera = small_camera();
  Canvas canvas(camera, Isometry3d::Identity());
  const int over = canvas.add_layer(1.0, true), half = canvas.add_layer(0.5);
  canvas.add(wall(2.0), Isometry3d::Identity(), flat_red, over);
  canvas.add(wall(1.0), Isometry3d::Identity(), flat_green, half);
  EXPECT_EQ(middle_of(canvas, camera), cv::Vec3b(0, 0, 255));
  canvas.add_occluder(wall(1.5));
  EXPECT_EQ(middle_of(canvas, camera), cv::Vec3b(50, 178, 50));
}

TEST(Canvas, occluders_and_depth_images_show_the_image_and_hide_what_is_behind) {
  const Camera camera = small_camera();
  for (const bool by_depth_image : {false, true}) {
    Canvas canvas(camera, Isometry3d::Identity());
    const int half = canvas.add_layer(0.5);
    if (by_depth_image)
      canvas.set_depth(std::vector<float>(160 * 120, 2.0F));
    else
      canvas.add_occluder(wall(2.0));
    canvas.add(wall(2.1), Isometry3d::Identity(), flat_green);
    canvas.add(wall(2.2), Isometry3d::Identity(), flat_red, half);
    EXPECT_EQ(middle_of(canvas, camera), cv::Vec3b(100, 100, 100));
    canvas.add(wall(1.9), Isometry3d::Identity(), flat_red, half);
    EXPECT_NEAR(middle_of(canvas, camera)[2], 178, 1);
    canvas.add(wall(1.8), Isometry3d::Identity(), flat_green);
    EXPECT_EQ(middle_of(canvas, camera), cv::Vec3b(0, 255, 0));
  }
}

TEST(Canvas, depth_images_without_a_depth_hide_nothing) {
  const Camera camera = small_camera();
  Canvas canvas(camera, Isometry3d::Identity());
  canvas.set_depth(std::vector<float>(160 * 120, 0.0F));
  canvas.add(wall(5.0), Isometry3d::Identity(), flat_green);
  EXPECT_EQ(middle_of(canvas, camera), cv::Vec3b(0, 255, 0));
  EXPECT_THROW(canvas.set_depth({1.0F, 2.0F}), std::invalid_argument);
}

TEST(Canvas, nothing_behind_the_camera_is_drawn) {
  const Camera camera = small_camera();
  Canvas canvas(camera, Isometry3d::Identity());
  canvas.add(wall(-1.0), Isometry3d::Identity(), flat_red);
  canvas.add_line({{-1, 0, -1}, {1, 0, -0.5}}, 9.0, red);
  canvas.add_disc({0, 0, -1}, 0.3, red);
  canvas.add_point({0, 0, -1}, 9.0, red);
  canvas.add_disc({0, 0, 0.1}, 0.3, red);  // the camera is in it
  EXPECT_EQ(canvas.triangles(), 0U);
}

TEST(Canvas, the_camera_pose_moves_the_map) {
  const Camera camera = small_camera();
  Isometry3d camera_from_map = Isometry3d::Identity();
  camera_from_map.translation() = Vector3d(0.1, -0.05, 0.8);
  camera_from_map.linear() = Eigen::AngleAxisd(0.4, Vector3d(0.2, 1.0, -0.3).normalized()).toRotationMatrix();
  Canvas canvas(camera, camera_from_map);
  const Vector3d point(0.05, 0.02, 0.1);
  canvas.add_point(point, 4.0, red);
  const cv::Mat picture = canvas.draw(grey_image(camera));
  const Vector2d pixel = scene::pixel_by_opencv(camera, camera_from_map * point);
  Vector2d mean = Vector2d::Zero();
  double weight = 0.0;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x)
      if (const double share = (picture.at<cv::Vec3b>(y, x)[2] - 90) / 165.0; share > 0.0) {
        mean += share * Vector2d(x, y);
        weight += share;
      }
  EXPECT_LT((mean / weight - pixel).norm(), 0.1);
  EXPECT_NEAR(weight, M_PI * 16.0, 2.0);
}

TEST(Canvas, lines_are_as_wide_as_asked) {
  const Camera camera{200, 150, 150.0, 150.0, 99.5, 74.5, {}};
  for (const double width : {1.5, 4.0, 7.0}) {
    Canvas canvas(camera, Isometry3d::Identity());
    canvas.add_line({{-0.3, -0.1, 1.0}, {0.3, 0.15, 1.0}}, width, {255, 255, 255});
    const cv::Mat picture = canvas.draw(grey_image(camera, 0));
    const double length = 150.0 * std::hypot(0.6, 0.25);
    const double area = length * width + M_PI * width * width / 4.0;
    EXPECT_NEAR(cv::sum(picture)[0] / 255.0, area, 0.04 * area);
  }
}

/// The outline of a ball is seen where rays touch it.
TEST(Canvas, discs_are_the_outline_of_a_ball) {
  const Camera camera = small_camera();
  const Vector3d center(0.25, -0.15, 0.7);
  const double radius = 0.12;
  Canvas canvas(camera, Isometry3d::Identity());
  canvas.add_disc(center, radius, red);
  const cv::Mat picture = canvas.draw(grey_image(camera, 0));
  int inside = 0;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const auto ray = camera.undistort({static_cast<double>(x), static_cast<double>(y)});
      ASSERT_TRUE(ray);
      const Vector3d way = Vector3d(ray->x(), ray->y(), 1.0).normalized();
      const double off = way.cross(center).norm();
      if (std::abs(off - radius) < 0.008) continue;  // a pixel or so
      inside += off < radius ? 1 : 0;
      EXPECT_EQ(picture.at<cv::Vec3b>(y, x)[2], off < radius ? 255 : 0) << x << " " << y;
    }
  EXPECT_GT(inside, 800);
}

TEST(Canvas, the_picture_does_not_depend_on_threads) {
  const Camera camera = scene::distorted_camera();
  std::mt19937 random(5);
  Canvas canvas(camera, Isometry3d::Identity());
  const int half = canvas.add_layer(0.5);
  for (int i = 0; i < 200; ++i)
    canvas.add(sheet(drawn_point(random), drawn_point(random), drawn_point(random)), Isometry3d::Identity(),
               {numbered(i % 20), 0.3}, i % 2 == 0 ? half : 0);
  const cv::Mat one = canvas.draw(grey_image(camera), 1);
  for (const std::size_t threads : {2U, 5U})
    EXPECT_EQ(cv::norm(one, canvas.draw(grey_image(camera), threads), cv::NORM_INF), 0.0);
}

TEST(Canvas, refuses_other_images_and_layers) {
  const Camera camera = small_camera();
  Canvas canvas(camera, Isometry3d::Identity());
  EXPECT_THROW(canvas.draw(cv::Mat(120, 161, CV_8UC1)), std::invalid_argument);
  EXPECT_THROW(canvas.draw(cv::Mat(120, 160, CV_32FC1)), std::invalid_argument);
  EXPECT_THROW(canvas.add(wall(1.0), Isometry3d::Identity(), flat_red, 1), std::out_of_range);
  EXPECT_THROW(canvas.add_layer(1.5), std::invalid_argument);
}

TEST(Canvas, closed_meshes_show_their_outside_only) {
  const Camera camera{200, 150, 150.0, 150.0, 99.5, 74.5, {}};
  Canvas canvas(camera, Isometry3d::Identity());
  Isometry3d pose = Isometry3d::Identity();
  pose.translation().z() = 1.0;
  canvas.add(mesh_of(Shape::box({0.2, 0.2, 0.2})), pose, flat_red);
  EXPECT_EQ(canvas.triangles(), 2U);  // of its six faces one looks at the camera
}

}  // namespace canvas_test

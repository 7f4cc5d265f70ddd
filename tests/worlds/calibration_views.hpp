#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "planning/geometry/turn_between.hpp"
#include "tests/worlds/tag_scene.hpp"
#include "tracking/calibration/bundle.hpp"
#include "tracking/dense.hpp"
#include "tracking/tag_pose.hpp"

/// Views of a flat board for calibrations, drawn from a seed: camera, board, its errors, poses and noise.
namespace clearway::scene {

struct DrawnViews {
  Camera camera;  ///< the true one
  TagBody stated_board, true_board;
  std::vector<BoardView> views;
  std::vector<Eigen::Isometry3d> true_poses;
  double noise = 0.2;
};

struct ViewsLook {
  double tilt = 0.7;     ///< radians, at most
  double roll = M_PI;    ///< radians about the line of sight, at most
  double spread = 0.85;  ///< of the image that the board's middle may be in
  double share = 0.7;    ///< of the image's width that the board takes, at most
};

inline Camera drawn_camera(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Camera camera;
  const int widths[] = {640, 800, 1280}, heights[] = {480, 600, 720};
  const std::size_t size = random() % 3;
  camera.width = widths[size];
  camera.height = heights[size];
  camera.fx = camera.width * (0.95 + 0.25 * unit(random));
  camera.fy = camera.fx * (1.0 + 0.01 * unit(random));
  camera.cx = 0.5 * camera.width + 0.02 * camera.width * unit(random);
  camera.cy = 0.5 * camera.height + 0.02 * camera.height * unit(random);
  camera.distortion = {-0.12 + 0.12 * unit(random), 0.04 + 0.04 * unit(random), 0.001 * unit(random),
                       0.001 * unit(random), 0.0};
  return camera;
}

/// Sees 70 to 105 degrees from its axis in the corners.
inline Camera drawn_fisheye(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Camera camera = drawn_camera(random);
  camera.lens = LensDistortion::Model::fisheye;
  camera.fx = 0.5 * std::hypot(camera.width, camera.height) / (1.5 + 0.3 * unit(random));
  camera.fy = camera.fx * (1.0 + 0.01 * unit(random));
  camera.distortion = {0.03 * unit(random), 0.03 * unit(random), 0.02 * unit(random), 0.005 * unit(random)};
  return camera;
}

/// 100 to 120 degrees wide: bends as atan(g r) / g, g from 0.6 to 1 (by Pade's approximant), and each
/// coefficient is off by up to 3 %.
inline Camera drawn_rational(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Camera camera = drawn_camera(random);
  camera.lens = LensDistortion::Model::rational;
  const double g = 0.8 + 0.2 * unit(random), s = g * g;
  camera.distortion = {1.28205 * s,           0.395804 * s * s, 0.001 * unit(random), 0.001 * unit(random),
                       0.0170496 * s * s * s, 1.61538 * s,      0.734266 * s * s,     0.0815851 * s * s * s};
  for (const std::size_t i : {0, 1, 4, 5, 6, 7}) camera.distortion[i] *= 1.0 + 0.03 * unit(random);
  const double half = M_PI / 180.0 * (55.0 + 5.0 * unit(random));
  camera.fx = 0.5 * camera.width / (std::atan(g * std::tan(half)) / g);
  camera.fy = camera.fx * (1.0 + 0.01 * unit(random));
  return camera;
}

/// `stated` with errors of the size that it states.
inline TagBody true_body(const TagBody& stated, std::mt19937& random) {
  std::normal_distribution<double> normal;
  TagBody body = stated;
  for (auto& [id, tag] : body.tags) {
    tag.size *= 1.0 + stated.errors.size * normal(random);
    Eigen::Vector3d turn;
    for (int i = 0; i < 3; ++i) {
      tag.body_from_tag.translation()[i] += stated.errors.place * normal(random);
      turn[i] = stated.errors.turn * normal(random);
    }
    if (turn.norm() > 0.0) tag.body_from_tag.rotate(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
  }
  return body;
}

/// All tags of `body` whose corners are in the image.
inline std::vector<TagDetection> look_at_body(const Camera& camera, const TagBody& body,
                                              const Eigen::Isometry3d& camera_from_body, double noise,
                                              std::mt19937& random) {
  std::vector<PlacedTag> seen;
  for (const PlacedTag& tag : placed(body, camera_from_body)) {
    bool is_inside = true;
    const double h = 0.5 * tag.size;
    for (const auto& [x, y] : {std::pair{-h, h}, {h, h}, {h, -h}, {-h, -h}}) {
      const auto pixel = camera.project(tag.camera_from_tag * Eigen::Vector3d(x, y, 0.0));
      is_inside = is_inside && pixel && camera.sees(*pixel, 3.0);
    }
    if (is_inside) seen.push_back(tag);
  }
  return noisy_detections(camera, seen, noise, random);
}

/// Where the straight lines meet that fit a tag's edges best: a lens bends these. @param seen where a point
/// of the tag is in the image
template <typename Seen>
std::array<Eigen::Vector2d, 4> corners_of_lines(const MountedTag& tag, const Seen& seen) {
  const auto corners = tag_corners(tag.size);
  std::array<Eigen::Vector2d, 4> middles, normals, found;
  for (std::size_t i = 0; i < 4; ++i) {
    constexpr int count = 16;
    std::vector<Eigen::Vector2d> points;
    middles[i].setZero();
    for (int k = 1; k <= count; ++k) {
      const double share = k / (count + 1.0);
      points.push_back(seen((1.0 - share) * corners[i] + share * corners[(i + 1) % 4]));
      middles[i] += points.back() / count;
    }
    double xx = 0.0, xy = 0.0, yy = 0.0;
    for (const Eigen::Vector2d& point : points) {
      const Eigen::Vector2d off = point - middles[i];
      xx += off.x() * off.x(), xy += off.x() * off.y(), yy += off.y() * off.y();
    }
    const double along = 0.5 * std::atan2(2.0 * xy, xx - yy);
    normals[i] = {-std::sin(along), std::cos(along)};
  }
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t before = (i + 3) % 4;
    const Eigen::Vector2d &a = normals[before], &b = normals[i];
    const double to_a = a.dot(middles[before]), to_b = b.dot(middles[i]);
    found[i] = Eigen::Vector2d(to_a * b.y() - to_b * a.y(), to_b * a.x() - to_a * b.x()) /
               (a.x() * b.y() - a.y() * b.x());
  }
  return found;
}

/// Moves corners from where they are to where a detector finds them, by straight lines.
inline void find_by_lines(const Camera& camera, const TagBody& body,
                          const Eigen::Isometry3d& camera_from_body, std::vector<TagDetection>& tags) {
  for (TagDetection& tag : tags) {
    const MountedTag& mounted = body.tags.at(tag.id);
    const auto seen = [&](const Eigen::Vector3d& point) {
      return *camera.project(camera_from_body * mounted.body_from_tag * point);
    };
    const auto corners = tag_corners(mounted.size);
    const auto found = corners_of_lines(mounted, seen);
    for (std::size_t i = 0; i < 4; ++i) tag.corners[i] += found[i] - seen(corners[i]);
  }
}

/// Views all over the image of a wide lens. @param draw_camera such as drawn_fisheye
inline DrawnViews draw_wide_views(Camera (*draw_camera)(std::mt19937&), unsigned seed, std::size_t count,
                                  const ViewsLook& look = {}) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  DrawnViews drawn;
  drawn.camera = draw_camera(random);
  drawn.noise = 0.15 + 0.1 * unit(random);
  drawn.stated_board = board("calibration", 0, 4, 5, 0.024, 0.034);
  drawn.stated_board.errors = {0.0, 0.003, 0.0001, 0.002};
  drawn.true_board = true_body(drawn.stated_board, random);
  while (drawn.views.size() < count) {
    const Eigen::Vector2d middle(0.5 * drawn.camera.width * (1.0 + look.spread * unit(random)),
                                 0.5 * drawn.camera.height * (1.0 + look.spread * unit(random)));
    const auto ray = drawn.camera.undistort(middle);
    if (!ray) continue;
    const double distance = 0.2 + 0.05 * unit(random);
    const Eigen::Isometry3d ahead =
        tag_before_camera(distance, look.tilt * std::abs(unit(random)), M_PI * unit(random),
                          look.roll * unit(random), 0.0, 0.0);
    const Eigen::Isometry3d pose = turn_between(Eigen::Vector3d::UnitZ(), ray->homogeneous()) * ahead;
    auto tags = look_at_body(drawn.camera, drawn.true_board, pose, drawn.noise, random);
    if (tags.size() < 4) continue;
    find_by_lines(drawn.camera, drawn.true_board, pose, tags);
    drawn.views.push_back({"view " + std::to_string(drawn.views.size()), tags});
    drawn.true_poses.push_back(pose);
  }
  return drawn;
}

inline DrawnViews draw_views(unsigned seed, std::size_t count, const ViewsLook& look = {}) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  DrawnViews drawn;
  do drawn.camera = drawn_camera(random);
  while ([&] {
    try {
      drawn.camera.validate();
      return false;
    } catch (const std::invalid_argument&) {
      return true;
    }
  }());
  drawn.noise = 0.15 + 0.1 * unit(random);
  drawn.stated_board = board("calibration", 0, 4, 5, 0.024, 0.034);
  drawn.stated_board.errors = {0.0, 0.003, 0.0001, 0.002};
  drawn.true_board = true_body(drawn.stated_board, random);
  const double width = 5 * 0.034;
  while (drawn.views.size() < count) {
    const double share = look.share * (0.8 + 0.2 * unit(random));
    const double distance = width * drawn.camera.fx / (share * drawn.camera.width);
    const double x = 0.5 * look.spread * unit(random) * drawn.camera.width / drawn.camera.fx * distance;
    const double y = 0.5 * look.spread * unit(random) * drawn.camera.height / drawn.camera.fy * distance;
    const Eigen::Isometry3d pose = tag_before_camera(distance, look.tilt * std::abs(unit(random)),
                                                     M_PI * unit(random), look.roll * unit(random), x, y);
    auto tags = look_at_body(drawn.camera, drawn.true_board, pose, drawn.noise, random);
    if (tags.size() < 4) continue;
    find_by_lines(drawn.camera, drawn.true_board, pose, tags);
    drawn.views.push_back({"view " + std::to_string(drawn.views.size()), tags});
    drawn.true_poses.push_back(pose);
  }
  return drawn;
}

/// How the image moves from the true camera to the one found, and where that is more than it states.
struct Moves {
  int outside = 0, asked = 0;

  /// @param border share of the image's sides that is not asked
  void add(const Camera& found, const Camera& truth, double border = 0.08) {
    const double step = (1.0 - 2.0 * border) / 6.0;
    for (int i = 0; i < 49; ++i) {
      const Eigen::Vector2d pixel(truth.width * (border + step * (i % 7)),
                                  truth.height * (border + step * (i / 7)));
      const auto ray = truth.undistort(pixel);
      if (!ray) continue;
      const auto seen = found.project(ray->homogeneous());
      ASSERT_TRUE(seen);
      const auto shifts = found.shift_by_errors(pixel);
      const Eigen::Matrix2d stated = shifts * shifts.transpose();
      ++asked;
      outside += Cholesky(stated).squared(*seen - pixel) > 11.8;  // 3 sigma of two
    }
  }
};

/// The same views of other corners: each is seen where `place` has it, by the camera of `camera_of(view)`.
template <typename Place, typename CameraOf>
void look_anew(DrawnViews& drawn, unsigned seed, const Place& place, const CameraOf& camera_of) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0.0, drawn.noise);
  for (std::size_t v = 0; v < drawn.views.size(); ++v) {
    const Camera camera = camera_of(v);
    for (TagDetection& tag : drawn.views[v].tags) {
      const MountedTag& mounted = drawn.true_board.tags.at(tag.id);
      tag.corners = corners_of_lines(mounted, [&](const Eigen::Vector3d& point) {
        return camera.project(drawn.true_poses[v] * place(mounted.body_from_tag * point)).value();
      });
      for (Eigen::Vector2d& corner : tag.corners) corner += Eigen::Vector2d(noise(random), noise(random));
    }
  }
}

}  // namespace clearway::scene

#include "apps/track/pose_marks.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace clearway {
namespace {

using Colour = std::array<std::uint8_t, 3>;
constexpr Colour green{0, 200, 0}, red{230, 0, 0}, grey{150, 150, 150}, blue{40, 80, 255},
    yellow{255, 200, 0};

Colour colour_of_tag(const ImagePoses& poses, const Setup& setup, int id) {
  for (const BoardSetup& board : setup.boards) {
    const bool has_it =
        std::any_of(board.tags.begin(), board.tags.end(), [&](const TagSetup& tag) { return tag.id == id; });
    if (!has_it) continue;
    const ImagePose* pose = poses.find("body", board.name, "camera");
    return pose != nullptr && pose->is_accepted() ? green : red;
  }
  return grey;
}

void add_axes(const ImagePose& body, const BoardSetup& board, const Camera& camera,
              std::vector<ImageMark>& marks) {
  double largest = 0.0;
  for (const TagSetup& tag : board.tags) largest = std::max(largest, tag.size);
  const Eigen::Isometry3d& camera_from_body = body.pose->pose;
  const auto origin = camera.project(camera_from_body.translation());
  for (int axis = 0; axis < 3 && origin; ++axis) {
    const auto end = camera.project(camera_from_body * (largest * Eigen::Vector3d::Unit(axis)));
    const Colour colour = axis == 0 ? red : axis == 1 ? green : blue;
    if (end) marks.push_back({{*origin, *end}, false, colour, ""});
  }
  if (origin) marks.push_back({{*origin, *origin}, false, body.is_accepted() ? green : red, board.name});
}

/// The circle in which the ball ends for the eye: across the way to its centre.
void add_ball(const Eigen::Vector3d& center, double radius, const Camera& camera,
              std::vector<ImageMark>& marks) {
  const Eigen::Vector3d way = center.normalized();
  const Eigen::Vector3d across = way.unitOrthogonal(), up = way.cross(across);
  ImageMark outline{{}, true, yellow, ""};
  for (int i = 0; i < 48; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 48;
    const auto pixel = camera.project(center + radius * (std::cos(angle) * across + std::sin(angle) * up));
    if (!pixel) return;
    outline.line.push_back(*pixel);
  }
  marks.push_back(std::move(outline));
}

}  // namespace

std::vector<ImageMark> marks_of(const ImagePoses& poses, const Setup& setup, const Camera& camera) {
  std::vector<ImageMark> marks;
  for (const TagDetection& tag : poses.tags)
    marks.push_back({{tag.corners.begin(), tag.corners.end()},
                     true,
                     colour_of_tag(poses, setup, tag.id),
                     std::to_string(tag.id)});
  for (const BoardSetup& board : setup.boards) {
    const ImagePose* body = poses.find("body", board.name, "camera");
    if (body == nullptr || !body->pose) continue;
    add_axes(*body, board, camera, marks);
    if (setup.probe && setup.probe->board == board.name)
      add_ball(body->pose->pose * setup.probe->ball_center, setup.probe->ball_radius, camera, marks);
  }
  return marks;
}

}  // namespace clearway

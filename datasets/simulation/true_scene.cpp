#include "datasets/simulation/true_scene.hpp"

#include <algorithm>
#include <cmath>

#include "datasets/descriptions/random_numbers.hpp"

namespace clearway {
namespace {

/// Streams of one scene's boards, fingers and camera; the other streams of its seed have other numbers.
constexpr std::uint64_t board_stream = 7'300'000'000, finger_stream = 7'310'000'000,
                        sway_stream = 7'320'000'000;

CameraIntrinsics true_camera(CameraIntrinsics camera, const PictureErrors& errors) {
  camera.fx /= 1.0 + errors.focal_error;
  camera.fy /= 1.0 + errors.focal_error;
  camera.cx -= errors.centre_error;
  camera.cy -= errors.centre_error;
  const double corner = std::hypot(0.5 * camera.width / camera.fx, 0.5 * camera.height / camera.fy);
  double shift = errors.distortion_error / (camera.fx * corner * corner * corner);  // of k1
  if (camera.lens == LensModel::rational) {
    const double s = corner * corner;
    shift *= 1.0 + s * (camera.distortion[5] + s * (camera.distortion[6] + s * camera.distortion[7]));
  }
  camera.distortion[0] -= shift;
  return camera;
}

void shift_tags(BoardSetup& board, const PictureErrors& errors, const RandomNumbers& numbers) {
  for (TagSetup& tag : board.tags) {
    const std::uint64_t own = 4 * static_cast<std::uint64_t>(tag.id);
    const auto a = numbers.gaussian(own), b = numbers.gaussian(own + 1), c = numbers.gaussian(own + 2),
               d = numbers.gaussian(own + 3);
    tag.size *= (1.0 + errors.board_scale) * (1.0 + errors.tag_size * d.first);
    tag.board_from_tag.translation() *= 1.0 + errors.board_scale;
    tag.board_from_tag.translation() += errors.tag_place * Eigen::Vector3d(a.first, a.second, b.first);
    const Eigen::Vector3d turn = errors.tag_turn * Eigen::Vector3d(b.second, c.first, c.second);
    if (turn.norm() > 0.0) tag.board_from_tag.rotate(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
  }
}

/// Fingers lie on tags for 0.3 to 1 s each, and between them as long as their share asks for.
void draw_covers(SceneHands& hands, const BoardSetup& probe, double duration, const RandomNumbers& numbers) {
  if (hands.cover_share <= 0.0) return;
  std::uint64_t next = 0;
  const auto between = [&](double low, double high) { return low + (high - low) * numbers.uniform(next++); };
  for (double time = 0.0; time < duration;) {
    const double covered = between(0.3, 1.0);
    const double pause = covered * (1.0 - hands.cover_share) / hands.cover_share * between(0.5, 1.5);
    const auto tag = static_cast<std::size_t>(between(0.0, static_cast<double>(probe.tags.size())));
    hands.covers.push_back({time + pause, time + pause + covered, probe.tags[tag].id});
    time += pause + covered;
  }
}

}  // namespace

Scene true_scene(const Scene& scene) {
  Scene result = scene;
  if (scene.camera && scene.camera->errors.has_wrong_setup()) {
    const PictureErrors& errors = scene.camera->errors;
    *result.setup.camera = true_camera(*scene.setup.camera, errors);
    const RandomNumbers numbers(scene.seed, board_stream);
    for (BoardSetup& board : result.setup.boards) shift_tags(board, errors, numbers);
  }
  if (scene.hands)
    draw_covers(*result.hands, *scene.setup.board(scene.setup.probe->board), duration_of_pictures(scene),
                RandomNumbers(scene.seed, finger_stream));
  return result;
}

Eigen::Isometry3d camera_at(const Scene& scene, double time) {
  const SceneCamera& camera = *scene.camera;
  Eigen::Isometry3d pose = camera.map_from_camera;
  if (!camera.path.empty()) {
    const auto after = std::find_if(camera.path.begin(), camera.path.end(),
                                    [&](const auto& waypoint) { return waypoint.time >= time; });
    if (after == camera.path.end()) {
      pose = camera.path.back().map_from_camera;
    } else if (after != camera.path.begin()) {
      const auto before = after - 1;
      pose = pose_between(before->map_from_camera, after->map_from_camera,
                          (time - before->time) / (after->time - before->time));
    }
  }
  if (camera.sway.shift == 0.0 && camera.sway.turn == 0.0) return pose;
  const ShakeMotion sway(camera.sway, scene.seed, sway_stream);
  const Eigen::Vector3d turn = sway.turn(time);
  if (turn.norm() > 0.0) pose.rotate(Eigen::AngleAxisd(turn.norm(), turn.normalized()));
  pose.pretranslate(sway.shift(time));
  return pose;
}

}  // namespace clearway

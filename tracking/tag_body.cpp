#include "tracking/tag_body.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "tracking/dense.hpp"
#include "tracking/pose_refinement.hpp"
#include "tracking/tag_pose.hpp"
#include "tracking/validation.hpp"

namespace clearway {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct SeenTag {
  int id = 0;
  const MountedTag* mounted = nullptr;
  const TagDetection* detection = nullptr;
};

// Cosine of the angle under which a square is seen, from its picture alone: area over the longest side
// squared (exact for a square turned about one of its sides far from the camera).
double facing(const TagDetection& tag) {
  double twice_area = 0.0, longest = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d& a = tag.corners[i];
    const Eigen::Vector2d& b = tag.corners[(i + 1) % 4];
    twice_area += a.x() * b.y() - a.y() * b.x();
    longest = std::max(longest, (b - a).squaredNorm());
  }
  return longest > 0.0 ? 0.5 * std::abs(twice_area) / longest : 0.0;
}

std::vector<SeenTag> seen_tags(const TagBody& body, const std::vector<TagDetection>& detections,
                               double min_facing) {
  std::vector<SeenTag> seen;
  for (const auto& [id, mounted] : body.tags) {
    const auto found = std::find_if(detections.begin(), detections.end(),
                                    [wanted = id](const TagDetection& tag) { return tag.id == wanted; });
    if (found != detections.end()) seen.push_back({id, &mounted, &*found});
  }
  const auto is_oblique = [&](const SeenTag& tag) { return facing(*tag.detection) < min_facing; };
  if (!std::all_of(seen.begin(), seen.end(), is_oblique)) std::erase_if(seen, is_oblique);
  return seen;
}

std::vector<CornerMatch> all_corners(const std::vector<SeenTag>& seen) {
  std::vector<CornerMatch> corners;
  for (const SeenTag& tag : seen) {
    const auto points = tag_corners(tag.mounted->size);
    for (int i = 0; i < 4; ++i)
      corners.push_back({tag.mounted->body_from_tag * points[i], tag.detection->corners[i]});
  }
  return corners;
}

bool all_face_camera(const std::vector<SeenTag>& seen, const Eigen::Isometry3d& camera_from_body) {
  return std::all_of(seen.begin(), seen.end(), [&](const SeenTag& tag) {
    return faces_camera(camera_from_body * tag.mounted->body_from_tag);
  });
}

// Whether a tag would be smaller than a pixel there: refinement that runs away ends so, and shows no pose.
bool is_out_of_sight(const std::vector<SeenTag>& seen, const Camera& camera,
                     const Eigen::Isometry3d& camera_from_body) {
  return std::any_of(seen.begin(), seen.end(), [&](const SeenTag& tag) {
    const double away = (camera_from_body * tag.mounted->body_from_tag).translation().norm();
    return away > std::max(camera.fx, camera.fy) * tag.mounted->size;
  });
}

// The reprojection error's minima over `corners` that the tags' IPPE solutions lead to, and those solutions
// themselves: two of them may slide into one minimum, and the valley between them is then an open question.
struct Answers {
  std::vector<RefinedPose> minima;                        // best first
  std::vector<std::pair<double, Eigen::Isometry3d>> any;  // squared error, camera_from_body; best first
};

Answers find_answers(const std::vector<SeenTag>& seen, const std::vector<CornerMatch>& corners,
                     const Camera& camera) {
  Answers found;
  const auto add = [&](const std::optional<RefinedPose>& pose, bool is_minimum) {
    if (!pose || !all_face_camera(seen, pose->camera_from_body)) return;
    if (is_out_of_sight(seen, camera, pose->camera_from_body)) return;
    found.any.emplace_back(pose->squared_error, pose->camera_from_body);
    if (is_minimum) found.minima.push_back(*pose);
  };
  for (const SeenTag& tag : seen) {
    for (const TagPoseSolution& solution :
         estimate_tag_pose(tag.detection->corners, tag.mounted->size, camera).solutions) {
      const Eigen::Isometry3d start = solution.camera_from_tag * tag.mounted->body_from_tag.inverse();
      add(refine_pose(camera, corners, start, 0), false);
      add(refine_pose(camera, corners, start), true);
    }
  }
  std::stable_sort(found.minima.begin(), found.minima.end(), [](const RefinedPose& a, const RefinedPose& b) {
    return a.squared_error < b.squared_error;
  });
  std::stable_sort(found.any.begin(), found.any.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  return found;
}

double angle_between(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  return difference(a, b).tail<3>().norm();
}

// The variance of a corner: as stated, or as the residuals show where they exceed it by three sigma.
double corner_variance(double squared_error, std::size_t corners, double stated_sigma) {
  const double freedom = 2.0 * static_cast<double>(corners) - 6.0;
  const double stated = stated_sigma * stated_sigma;
  const double excess = squared_error / (stated * freedom);
  return excess > 1.0 + 3.0 * std::sqrt(2.0 / freedom) ? stated * excess : stated;
}

// All views, or none when a corner cannot be projected.
std::vector<TagView> view_all(const std::vector<SeenTag>& seen, const TagBody& body, const Camera& camera,
                              double edge_bias, const Eigen::Isometry3d& camera_from_body) {
  std::vector<TagView> views;
  for (const SeenTag& tag : seen) {
    const auto view = view_tag(camera, tag.mounted->size, tag.mounted->body_from_tag, body.errors, edge_bias,
                               tag.detection->corners, camera_from_body);
    if (!view) return {};
    views.push_back(*view);
  }
  return views;
}

// The best other answer, and how much worse the best explained of the few best others is.
void find_alternative(const std::vector<SeenTag>& seen, const TagBody& body, const Camera& camera,
                      const BodyPoseOptions& options, const Answers& answers, BodyPose& pose) {
  constexpr int compared = 4;
  const RefinedPose& best = answers.minima.front();
  const double noise = options.pixel_noise * pose.noise_factor;
  const double own =
      unexplained(view_all(seen, body, camera, options.edge_bias, best.camera_from_body), noise);
  int count = 0;
  for (const auto& [squared_error, other] : answers.any) {
    if (count == compared) break;
    if (angle_between(other, best.camera_from_body) <= options.distinct_angle) continue;
    const std::vector<TagView> views = view_all(seen, body, camera, options.edge_bias, other);
    if (views.empty()) continue;
    ++count;
    pose.separation = std::min(pose.separation, unexplained(views, noise) - own);
    if (pose.alternative) continue;
    pose.alternative = other;
    if (best.squared_error > 0.0) pose.ambiguity_ratio = std::sqrt(squared_error / best.squared_error);
  }
}

std::optional<BodyPose> fit(const std::vector<SeenTag>& seen, const TagBody& body, const Camera& camera,
                            const BodyPoseOptions& options) {
  const std::vector<CornerMatch> corners = all_corners(seen);
  const Answers answers = find_answers(seen, corners, camera);
  if (answers.minima.empty()) return std::nullopt;
  const RefinedPose& best = answers.minima.front();
  const Cholesky information(best.information);
  const std::vector<TagView> views = view_all(seen, body, camera, options.edge_bias, best.camera_from_body);
  if (!information.is_positive() || views.empty()) return std::nullopt;

  BodyPose pose;
  const double variance = corner_variance(best.squared_error, corners.size(), options.pixel_noise);
  pose.camera_from_body = {best.camera_from_body, variance * information.inverse()};
  if (!pose.camera_from_body.covariance.allFinite()) return std::nullopt;
  pose.rms_px = std::sqrt(best.squared_error / static_cast<double>(corners.size()));
  for (const SeenTag& tag : seen) pose.tags.push_back(tag.id);
  pose.freedom = static_cast<int>(2 * corners.size()) - 6;
  pose.chi_square = unexplained(views, options.pixel_noise);
  pose.noise_factor = std::sqrt(
      std::max(1.0, (options.noise_freedom + pose.chi_square) / (options.noise_freedom + pose.freedom)));
  const auto errors = carry_errors(views, options.pixel_noise * pose.noise_factor);
  if (!errors) return std::nullopt;
  pose.errors = *errors;
  find_alternative(seen, body, camera, options, answers, pose);
  return pose;
}

// Leaves out of `seen` the one tag that the others contradict most, and returns their pose; nothing when they
// contradict none. `all` is the pose of all of them, if they have one.
std::optional<BodyPose> without_worst(std::vector<SeenTag>& seen, const std::optional<BodyPose>& all,
                                      const TagBody& body, const Camera& camera,
                                      const BodyPoseOptions& options) {
  constexpr double limit = 9.2;  // F(8, 10) exceeds it once in 1,000 times
  std::optional<BodyPose> best;
  std::size_t worst = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    std::vector<SeenTag> others = seen;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    const auto pose = fit(others, body, camera, options);
    if (!pose || (best && pose->chi_square >= best->chi_square)) continue;
    best = pose;
    worst = i;
  }
  if (!best) return std::nullopt;
  const double of_others = std::max(1.0, best->chi_square / best->freedom);
  const double of_tag = all ? (all->chi_square - best->chi_square) / 8.0 : kInfinity;
  if (!(of_tag > limit * of_others)) return std::nullopt;
  if (all) best->rejected = all->rejected;
  best->rejected.push_back(seen[worst].id);
  seen.erase(seen.begin() + static_cast<std::ptrdiff_t>(worst));
  return best;
}

}  // namespace

void TagBody::validate() const {
  const std::string where = "tag body '" + name + "': ";
  require(!tags.empty(), where + "tags", "at least one");
  errors.validate(name);
  for (const auto& [id, tag] : tags) {
    const std::string which = where + "tag " + std::to_string(id);
    const Eigen::Matrix3d r = tag.body_from_tag.linear();
    require(id >= 0, which, "an id of 0 or more");
    require(std::isfinite(tag.size) && tag.size > 0.0, which + " size", "> 0 metres");
    require(tag.body_from_tag.matrix().allFinite() &&
                (r * r.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-6 && r.determinant() > 0.0,
            which + " body_from_tag", "a rotation and a translation, all finite");
  }
}

void BodyPoseOptions::validate() const {
  require(std::isfinite(pixel_noise) && pixel_noise > 0.0, "body pose: pixel_noise", "> 0 pixels");
  require(min_facing >= 0.0 && min_facing < 1.0, "body pose: min_facing", "at least 0 and below 1");
  require(distinct_angle > 0.0 && distinct_angle < 1.0, "body pose: distinct_angle",
          "between 0 and 1 radian");
  require(std::isfinite(edge_bias) && edge_bias >= 0.0, "body pose: edge_bias", "0 pixels or more");
  require(noise_freedom >= 6, "body pose: noise_freedom", "6 or more");
}

std::optional<BodyPose> estimate_body_pose(const TagBody& body, const std::vector<TagDetection>& detections,
                                           const Camera& camera, const BodyPoseOptions& options) {
  options.validate();
  std::vector<SeenTag> seen = seen_tags(body, detections, options.min_facing);
  std::optional<BodyPose> pose = fit(seen, body, camera, options);
  const std::size_t least = std::max<std::size_t>(2, seen.size() - seen.size() / 3);
  while (options.reject_tags && seen.size() > least &&
         !(pose && pose->chi_square <= chi_square_limit(pose->freedom))) {
    const auto better = without_worst(seen, pose, body, camera, options);
    if (!better) break;
    pose = better;
  }
  if (!pose) return std::nullopt;
  std::sort(pose->rejected.begin(), pose->rejected.end());
  for (const SeenTag& tag : seen_tags(body, detections, 0.0))
    if (!std::ranges::count(pose->tags, tag.id) && !std::ranges::count(pose->rejected, tag.id))
      pose->oblique.push_back(tag.id);
  const double noise = std::hypot(options.pixel_noise * pose->noise_factor, options.edge_bias);
  pose->limits = tilt_limits(camera, all_corners(seen), pose->camera_from_body.pose, noise,
                             confidence_factor(options.noise_freedom + pose->freedom));
  return pose;
}

}  // namespace clearway

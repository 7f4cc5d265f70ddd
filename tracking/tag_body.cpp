#include "tracking/tag_body.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "tracking/pose_refinement.hpp"
#include "tracking/tag_pose.hpp"
#include "tracking/validation.hpp"

namespace clearway {
namespace {

constexpr int kLastId = 586;  // of tag36h11

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

}  // namespace

void TagBody::validate() const {
  const std::string where = "tag body '" + name + "': ";
  require(!tags.empty(), where + "tags", "at least one");
  for (const auto& [id, tag] : tags) {
    const std::string which = where + "tag " + std::to_string(id);
    const Eigen::Matrix3d r = tag.body_from_tag.linear();
    require(id >= 0 && id <= kLastId, which, "an id of tag36h11, 0 to 586");
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
}

std::optional<BodyPose> estimate_body_pose(const TagBody& body, const std::vector<TagDetection>& detections,
                                           const Camera& camera, const BodyPoseOptions& options) {
  options.validate();
  const std::vector<SeenTag> seen = seen_tags(body, detections, options.min_facing);
  const std::vector<CornerMatch> corners = all_corners(seen);
  const Answers answers = find_answers(seen, corners, camera);
  if (answers.minima.empty()) return std::nullopt;
  const RefinedPose& best = answers.minima.front();
  const Eigen::LLT<Matrix6d> information(best.information);
  if (information.info() != Eigen::Success) return std::nullopt;

  BodyPose pose;
  const double variance = corner_variance(best.squared_error, corners.size(), options.pixel_noise);
  pose.camera_from_body = {best.camera_from_body, variance * information.solve(Matrix6d::Identity())};
  if (!pose.camera_from_body.covariance.allFinite()) return std::nullopt;
  pose.rms_px = std::sqrt(best.squared_error / static_cast<double>(corners.size()));
  for (const SeenTag& tag : seen) pose.tags.push_back(tag.id);
  const auto other = std::find_if(answers.any.begin(), answers.any.end(), [&](const auto& answer) {
    return angle_between(answer.second, best.camera_from_body) > options.distinct_angle;
  });
  if (other != answers.any.end()) {
    pose.alternative = other->second;
    pose.separation = (other->first - best.squared_error) / variance;
    if (best.squared_error > 0.0) pose.ambiguity_ratio = std::sqrt(other->first / best.squared_error);
  }
  return pose;
}

}  // namespace clearway

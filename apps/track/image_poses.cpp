#include "apps/track/image_poses.hpp"

#include <algorithm>
#include <opencv2/core.hpp>
#include <set>

#include "apps/console/parse.hpp"
#include "apps/fusion/emptiness.hpp"
#include "apps/fusion/painter.hpp"

namespace clearway {
namespace {

/// A body of that tag alone, with the errors that its board states; empty when no board of the setup has it.
std::optional<TagBody> body_of_tag(const Setup& setup, int id) {
  for (const BoardSetup& board : setup.boards) {
    for (const TagSetup& tag : board.tags) {
      if (tag.id != id) continue;
      TagBody body = tag_body(board);
      body.name = std::to_string(id);
      body.tags = {{id, {tag.size, Eigen::Isometry3d::Identity()}}};
      return body;
    }
  }
  return std::nullopt;
}

/// Those of an id that is seen once: of others, nobody knows which is the body's. @param tags sorted by id
std::vector<TagDetection> single_tags(const std::vector<TagDetection>& tags) {
  std::vector<TagDetection> single;
  for (std::size_t i = 0; i < tags.size(); ++i) {
    const bool as_before = i > 0 && tags[i - 1].id == tags[i].id;
    const bool as_next = i + 1 < tags.size() && tags[i + 1].id == tags[i].id;
    if (!as_before && !as_next) single.push_back(tags[i]);
  }
  return single;
}

/// ", but tags 3, 7 are": which tags there are where those of a body are not seen; "" without any.
std::string others_of(const std::vector<TagDetection>& seen) {
  std::set<int> ids;
  for (const TagDetection& tag : seen) ids.insert(tag.id);
  if (ids.empty()) return "";
  return ids.size() == 1 ? ", but tag " + list_of_ids(ids) + " is"
                         : ", but tags " + list_of_ids(ids) + " are";
}

bool has(const std::vector<int>& ids, int id) { return std::find(ids.begin(), ids.end(), id) != ids.end(); }

/// The tags of `body` among `seen` that are not in its pose, and why. @param single those seen once
std::vector<LeftOutTag> left_out(const TagBody& body, const BodyPose& pose,
                                 const std::vector<TagDetection>& seen,
                                 const std::vector<TagDetection>& single) {
  std::vector<LeftOutTag> tags;
  for (const TagDetection& tag : seen) {
    if (!body.tags.contains(tag.id) || has(pose.tags, tag.id)) continue;
    if (!tags.empty() && tags.back().id == tag.id) continue;  // a second of it
    const bool is_single =
        std::any_of(single.begin(), single.end(), [&](const TagDetection& one) { return one.id == tag.id; });
    tags.push_back({tag.id, !is_single                   ? "seen_twice"
                            : has(pose.rejected, tag.id) ? "contradicted"
                            : has(pose.oblique, tag.id)  ? "oblique"
                                                         : "contradicted_before"});
  }
  return tags;
}

ImagePose refused(ImagePose pose, const std::string& word, const std::string& reason) {
  pose.refusal = word;
  pose.reason = reason;
  return pose;
}

/// What becomes of a pose in the camera when it is seen from the map.
ImagePose in_map(const ImagePose& in_camera, const UncertainPose& map_from_it) {
  ImagePose pose = in_camera;
  pose.frame = "map";
  pose.pose = map_from_it;
  return pose;
}

}  // namespace

const ImagePose* ImagePoses::find(const std::string& kind, const std::string& name,
                                  const std::string& frame) const {
  const auto found = std::find_if(poses.begin(), poses.end(), [&](const ImagePose& pose) {
    return pose.kind == kind && pose.name == name && pose.frame == frame;
  });
  return found == poses.end() ? nullptr : &*found;
}

ImagePoseFinder::ImagePoseFinder(const Setup& setup) : setup_(setup), options_(tracking_options(setup)) {
  for (const BoardSetup& board : setup.boards) {
    if (setup.probe && setup.probe->board == board.name) probe_ = bodies_.size();
    bodies_.push_back(tag_body(board));
    if (base_ == nullptr && board.map_from_board) base_ = &board;
  }
  if (setup.probe) base_ = &fixed_board(setup, "a probe");
}

ImagePoses ImagePoseFinder::find(const Frame& frame, const ImageFrame& image,
                                 const std::vector<TagDetection>& tags) {
  const Camera camera = camera_of(setup_, image);
  camera.validate();
  ImagePoses poses{frame.time, frame.file, image.image.width, image.image.height, "", tags, {}};
  if (camera.width != poses.width || camera.height != poses.height) {
    poses.refusal = "the image has " + std::to_string(poses.width) + " x " + std::to_string(poses.height) +
                    " pixels, expected the camera's " + std::to_string(camera.width) + " x " +
                    std::to_string(camera.height);
    return poses;
  }
  add_tags(poses, camera);
  const std::vector<TagDetection> single = single_tags(tags);
  add_bodies(poses, single, camera);
  if (base_ != nullptr) add_map_poses(poses);
  if (setup_.probe) {
    if (!session_) session_.emplace(tracking_setup(setup_, image), options_);
    const cv::Mat gray(poses.height, poses.width, CV_8UC1,
                       const_cast<std::uint8_t*>(image.image.pixels.data()));
    add_ball(poses, single, session_->step(gray, single, frame.time).sample);
  }
  return poses;
}

/// The setup's acceptance of one body's pose.
ImagePose ImagePoseFinder::judged(const BodyPose& found, const std::string& kind,
                                  const std::string& name) const {
  const AcceptanceOptions& acceptance = options_.acceptance;
  ImagePose pose{
      kind, name, "camera", "", "", found.camera_from_body, found.rms_px, found.ambiguity_ratio, found.tags};
  pose.bound = bound_point(found, Eigen::Vector3d::Zero(), options_.pose.noise_freedom);
  if (!is_explained(found, acceptance))
    return refused(std::move(pose), "reprojection_error",
                   "it reprojects with an rms error of " + significant(found.rms_px) +
                       " px, more than the errors that are stated explain");
  if (!(found.ambiguity_ratio >= acceptance.min_ambiguity_ratio))
    return refused(std::move(pose), "ambiguous_pose",
                   "another pose has only " + significant(found.ambiguity_ratio) +
                       " times the error, at least " + significant(acceptance.min_ambiguity_ratio));
  if (!(found.separation >= acceptance.min_separation))
    return refused(std::move(pose), "ambiguous_pose",
                   "another pose is worse by " + significant(found.separation) +
                       " only (chi-square), at least " + significant(acceptance.min_separation));
  return pose;
}

void ImagePoseFinder::add_tags(ImagePoses& poses, const Camera& camera) const {
  for (const TagDetection& tag : poses.tags) {
    const std::string name = std::to_string(tag.id);
    const ImagePose none{"tag", name, "camera", "", "", {}, {}, 0.0, {}};
    const auto alone = body_of_tag(setup_, tag.id);
    if (!alone) {
      poses.poses.push_back(refused(none, "unknown_tag", "no board of the setup has this tag"));
      continue;
    }
    const auto found = estimate_body_pose(*alone, {tag}, camera, options_.pose);
    poses.poses.push_back(found ? judged(*found, "tag", name)
                                : refused(none, "no_pose", "no pose explains its corners"));
  }
}

void ImagePoseFinder::add_bodies(ImagePoses& poses, const std::vector<TagDetection>& single,
                                 const Camera& camera) {
  found_.clear();
  for (const TagBody& body : bodies_) {
    const ImagePose none{"body", body.name, "camera", "", "", {}, {}, 0.0, {}};
    const auto found = estimate_body_pose(body, single, camera, options_.pose);
    const auto has = [&](const TagDetection& tag) { return body.tags.contains(tag.id); };
    const bool is_seen = std::any_of(single.begin(), single.end(), has);
    if (found) {
      poses.poses.push_back(judged(*found, "body", body.name));
      poses.poses.back().left_out = left_out(body, *found, poses.tags, single);
      found_.emplace(body.name, *found);
    } else if (is_seen) {
      poses.poses.push_back(refused(none, "no_pose", "no pose explains the corners of its tags"));
    } else if (std::any_of(poses.tags.begin(), poses.tags.end(), has)) {
      poses.poses.push_back(refused(none, "seen_twice", "its tags are seen more than once each"));
    } else {
      poses.poses.push_back(refused(none, "not_seen", "none of its tags is seen" + others_of(poses.tags)));
    }
  }
}

/// The camera by the board that is fixed, and all other boards by the camera. Chong 2008, eq. 1.
void ImagePoseFinder::add_map_poses(ImagePoses& poses) const {
  const ImagePose* base = poses.find("body", base_->name, "camera");
  if (base == nullptr || !base->pose) return;
  const ImagePose seen_base = *base;  // the list grows below
  const UncertainPose map_from_base{*base_->map_from_board, Matrix6d::Zero()};
  ImagePose camera = in_map(seen_base, compose(map_from_base, inverse(*seen_base.pose)));
  camera.kind = camera.name = "camera";
  const BodyPose& of_base = found_.at(base_->name);
  const int freedom = options_.pose.noise_freedom;
  camera.bound = bound_camera(of_base, freedom);
  std::vector<ImagePose> found{camera};
  for (const ImagePose& body : poses.poses) {
    if (body.kind != "body" || body.name == base_->name || !body.pose) continue;
    const UncertainPose base_from_body = base_from_probe(*seen_base.pose, *body.pose);
    found.push_back(in_map(body, compose(map_from_base, base_from_body)));
    found.back().bound =
        bound_center(of_base, *seen_base.pose, false, found_.at(body.name), Eigen::Vector3d::Zero(), freedom);
    if (!seen_base.is_accepted() && body.is_accepted())
      found.back() = refused(found.back(), "base_refused",
                             "the board '" + base_->name + "' is refused: " + seen_base.reason);
  }
  poses.poses.insert(poses.poses.end(), found.begin(), found.end());
}

void ImagePoseFinder::add_ball(ImagePoses& poses, const std::vector<TagDetection>& single,
                               const PaintingSample& sample) const {
  ImagePose ball{"ball", "ball", "map", "", sample.reason, {}, {}, 0.0, {}};
  if (!sample.accepted) ball.refusal = to_string(sample.refusal);
  if (sample.refusal == Refusal::base_not_seen || sample.refusal == Refusal::probe_not_seen)
    ball.reason += others_of(poses.tags);
  if (sample.base && sample.probe) {
    Eigen::Isometry3d probe_from_ball = Eigen::Isometry3d::Identity();
    probe_from_ball.translation() = setup_.probe->ball_center;
    const UncertainPose map_from_base{*base_->map_from_board, Matrix6d::Zero()};
    ball.pose = compose(compose(map_from_base, sample.base_from_probe), {probe_from_ball, Matrix6d::Zero()});
    ball.rms_px = sample.probe->rms_px;
    ball.ambiguity = sample.probe->ambiguity_ratio;
    ball.tags = sample.probe->tags;
    ball.bound = sample.bound;
    ball.left_out = left_out(bodies_[probe_], *sample.probe, poses.tags, single);
  }
  poses.poses.push_back(std::move(ball));
}

}  // namespace clearway

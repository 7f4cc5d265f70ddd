#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "datasets/descriptions/setup.hpp"
#include "tracking/tracking_session.hpp"

namespace clearway {

/// A tag of a body that was seen and that its pose does without.
struct LeftOutTag {
  int id = 0;
  std::string reason;  ///< contradicted, contradicted_before, oblique or seen_twice
};

/// Where something is by one image, or why that is not known or not to be trusted.
struct ImagePose {
  std::string kind;                   ///< "tag", "body", "ball" or "camera"
  std::string name;                   ///< the tag's id, the board's name, "ball", "camera"
  std::string frame;                  ///< "camera" or "map": what the pose is in
  std::string refusal;                ///< one word; empty: the pose passes the setup's acceptance
  std::string reason;                 ///< one sentence, when refused
  std::optional<UncertainPose> pose;  ///< frame_from_it; also of what is refused, where there is one
  std::optional<double> rms_px;       ///< reprojection error of its corners
  double ambiguity = 0.0;             ///< BodyPose::ambiguity_ratio
  std::vector<int> tags;              ///< that the pose is made of
  std::vector<LeftOutTag> left_out{};
  std::optional<CenterBound> bound{};  ///< of the place: how far it may be off

  bool is_accepted() const { return refusal.empty(); }
};

/// All that one image says.
struct ImagePoses {
  double time = 0.0;  ///< s
  std::string file;   ///< of the picture; empty: one file holds them all
  int width = 0, height = 0;
  std::string refusal;  ///< one sentence when the image is not one of the camera's
  std::vector<TagDetection> tags;
  std::vector<ImagePose> poses;

  const ImagePose* find(const std::string& kind, const std::string& name, const std::string& frame) const;
};

/// Images -> poses: of each tag seen and of each board in the camera; where a board is fixed, of the camera
/// and of the other boards in the map; with a probe, of its ball in the map, by the rules of painting
/// (tracking's Probe). A tag's pose is that of its four corners alone. Images come in the order of their
/// times.
class ImagePoseFinder {
 public:
  /// @throws std::invalid_argument for a probe without a fixed board
  explicit ImagePoseFinder(const Setup& setup);

  /// @param tags sorted by id, also those of an id that is seen twice: each has a pose, and no body uses them
  /// @throws std::invalid_argument when neither setup nor image has the camera, or it is no camera
  ImagePoses find(const Frame& frame, const ImageFrame& image, const std::vector<TagDetection>& tags);

 private:
  ImagePose judged(const BodyPose& pose, const std::string& kind, const std::string& name) const;
  void add_tags(ImagePoses& poses, const Camera& camera) const;
  void add_bodies(ImagePoses& poses, const std::vector<TagDetection>& single, const Camera& camera);
  void add_map_poses(ImagePoses& poses) const;
  void add_ball(ImagePoses& poses, const std::vector<TagDetection>& single,
                const PaintingSample& sample) const;

  const Setup& setup_;
  TrackingOptions options_;
  const BoardSetup* base_ = nullptr;  ///< the board that anchors the map; null without one
  std::vector<TagBody> bodies_;
  std::size_t probe_ = 0;                  ///< which of them, where the setup has one
  std::map<std::string, BodyPose> found_;  ///< of the image at hand, by the body's name
  std::optional<TrackingSession> session_;
};

}  // namespace clearway

#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tracking/camera.hpp"
#include "tracking/pose_errors.hpp"
#include "tracking/tag_detector.hpp"
#include "tracking/uncertain_pose.hpp"

namespace clearway {

/// One tag glued to a body.
struct MountedTag {
  double size = 0.0;  ///< side of the black square, metres
  Eigen::Isometry3d body_from_tag = Eigen::Isometry3d::Identity();
};

/// A rigid body that carries tags: the base board, the probe.
struct TagBody {
  std::string name;
  std::map<int, MountedTag> tags;  ///< by id
  TagErrors errors{};

  /// Throws std::invalid_argument naming the body, the tag and what was expected: at least one tag, ids of 0
  /// or more, finite sizes > 0, rigid transforms, errors of 0 or more.
  void validate() const;
};

/// Pixel noise and selection of tags for the pose of a body.
struct BodyPoseOptions {
  double pixel_noise = 0.3;     ///< standard deviation of a corner per axis, pixels, > 0: state it honestly
  double distinct_angle = 0.1;  ///< radians: poses that differ by more are two answers
  /// A tag seen under a smaller cosine than this (0.34: 70 degrees) is left out while another tag of the body
  /// is seen better: the detector's edge fit is biased there by many times the pixel noise.
  double min_facing = 0.34;
  double edge_bias = 0.1;  ///< standard deviation by which the detector shifts an edge of a tag, pixels, >= 0
  /// How firmly `pixel_noise` is believed: as if estimated with so many degrees of freedom, at least 6. The
  /// residuals of the image add theirs.
  int noise_freedom = 8;
  bool reject_tags = true;  ///< leave out a tag that two or more others contradict

  void validate() const;  ///< throws std::invalid_argument naming the option and its range
};

/// Where a body is, how well that is known, and how sure it is that no other answer fits.
struct BodyPose {
  UncertainPose camera_from_body;
  double rms_px = 0.0;        ///< root mean square reprojection error over all corners used
  std::vector<int> tags;      ///< ids used, rising
  std::vector<int> rejected;  ///< ids left out because the others contradict them, rising
  std::vector<int> oblique;   ///< ids left out by `min_facing`, rising

  double chi_square = 0.0;    ///< the squared residuals that no stated error explains, over the stated noise
  int freedom = 0;            ///< its degrees of freedom: 2 for each corner used, less 6
  double noise_factor = 1.0;  ///< how much more noise than stated the residuals show, at least 1
  PoseErrors errors;          ///< by source, the noise with its factor
  /// The farthest poses to each side along the two weakest turns that the noise may still hide (see
  /// confidence_factor), all else fitted anew: where a small tilt hardly changes the picture they lie much
  /// farther off than the covariance says.
  std::vector<Eigen::Isometry3d> limits;

  /// The best answer that is another one (see distinct_angle), when there is one.
  std::optional<Eigen::Isometry3d> alternative;
  /// rms of that answer over rms_px; infinity without one.
  double ambiguity_ratio = std::numeric_limits<double>::infinity();
  /// How much worse that answer explains the image: difference of what stays `unexplained`, that is twice the
  /// log likelihood ratio when the stated errors may take any value; infinity without one. If the errors are
  /// what was stated, the wrong answer wins by s or more with a probability below Q(sqrt(s)): 3e-7 for s
  /// = 25.
  double separation = std::numeric_limits<double>::infinity();
};

/// The pose of `body` from its tags among `detections` (see min_facing); empty when none is seen or no pose
/// explains them with all tags facing the camera. At most one detection per id is expected; further ones of
/// an id are ignored.
///
/// Each tag's two IPPE-square poses start a refinement over all corners of the body; the best minimum is the
/// answer, the best other one is kept for the ambiguity, be it a minimum or one of the IPPE poses itself
/// (near a frontal view both slide into one minimum, on either side). No prediction from earlier frames takes
/// part: it would decide silently what the image leaves open. Covariance = s^2 (J^T J)^-1 with s the stated
/// pixel noise, or the noise seen in the residuals where that is larger beyond chance (3 sigma of its
/// chi-square); it knows of noise alone, `errors` of the rest.
///
/// With three tags or more, one whose corners the others contradict is left out: when the residuals exceed
/// chance, and those without it are smaller by a ratio that F(8, 10) exceeds once in 1,000 times. At most a
/// third of the tags is left out so.
std::optional<BodyPose> estimate_body_pose(const TagBody& body, const std::vector<TagDetection>& detections,
                                           const Camera& camera, const BodyPoseOptions& options = {});

}  // namespace clearway

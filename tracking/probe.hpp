#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tracking/center_bound.hpp"
#include "tracking/noise_record.hpp"
#include "tracking/painting_probe.hpp"
#include "tracking/static_board.hpp"
#include "tracking/tag_body.hpp"
#include "tracking/tag_record.hpp"

namespace clearway {

/// Why an image painted nothing, in the order in which the rules are asked.
enum class Refusal {
  none,                ///< accepted
  image_refused,       ///< not 8-bit grey, or not of the camera's size
  time_not_rising,     ///< not later than the image before, or not finite
  base_not_seen,       ///< no pose of the base board
  probe_not_seen,      ///< no pose of the probe
  too_few_tags,        ///< of the base board or of the probe
  reprojection_error,  ///< a pose does not explain its corners by the errors stated: moved or bent tags, blur
  ambiguous_pose,      ///< another pose explains the corners nearly as well
  base_moved,          ///< fixed camera only: the base board is not where it was
  uncertain_center,    ///< the ball's centre may be off by more than Chong 2008, eq. 3, can pay
  unconfirmed,  ///< only one tag of base or probe visible: the ball not measured in the previous image,
                ///< or another tag contradicts it
  too_fast      ///< the ball moved or the probe turned too fast: blur, or a jump
};
constexpr int kRefusals = 12;

/// The word used in reports: the enumerator's name, "accepted" for `none`.
std::string to_string(Refusal refusal);

/// When an image's poses are good enough to call space free.
struct AcceptanceOptions {
  int min_base_tags = 1;   ///< 1 or more
  int min_probe_tags = 1;  ///< 1 or more; a single tag passes only near the camera, see `separation`
  double max_noise = 1.5;  ///< BodyPose::chi_square may exceed chance by the square of it; 1 or more
  double max_rms_px = std::numeric_limits<double>::infinity();  ///< also: reprojection error, pixels
  double min_ambiguity_ratio = 2.0;  ///< rms of the next best pose over that of the best
  double min_separation = 36.0;  ///< see BodyPose::separation; 36 leaves room for 1.4 times the noise stated
  double max_speed = 0.5;        ///< of the ball's centre, metres per second
  double max_turn_speed = 6.0;   ///< of the probe, radians per second: a flipped pose turns at once
  /// Seconds. If only one tag of the base or the probe is visible, its misdetection shows only as a jump
  /// faster than max_speed: an image is not accepted unless the previous one measured the ball, too, at most
  /// this long ago; it then confirms the next. A base that agrees with its mean over earlier images needs no
  /// second tag. Infinity: each image stands alone.
  double max_pause = 1.0;
  /// The corners' noise is taken from the residuals of earlier images where these are below the noise that
  /// is stated, but never below this, pixels. A value of the stated noise or more switches it off.
  double least_noise = 0.1;
  bool fixed_camera = false;        ///< camera and base board stand still: average the board's pose over time
  StaticBoardOptions static_board;  ///< how, when fixed_camera
};

/// What one image said about the probe.
struct PaintingSample {
  bool accepted = false;
  Refusal refusal = Refusal::none;
  std::string reason;             ///< one sentence with the figures; empty when accepted
  double time = 0.0;              ///< seconds, of the image
  PaintedSphere sphere;           ///< base frame; meaningful when base and probe were seen
  double center_sigma = 0.0;      ///< standard deviation by noise alone in the worst direction, metres
  CenterBound bound;              ///< how far the centre may be from the truth, metres
  double speed = 0.0;             ///< of the centre since the last trusted image, m/s; 0 without one
  UncertainPose base_from_probe;  ///< Chong 2008, eq. 1
  bool base_agrees = false;       ///< fixed camera: with its mean over earlier images
  std::optional<BodyPose> base;   ///< as seen in this image
  std::optional<BodyPose> probe;  ///< as seen in this image
};

/// Whether the errors that are stated explain a pose's corners: the chi-square and rms rules of acceptance.
bool is_explained(const BodyPose& pose, const AcceptanceOptions& acceptance);

/// Turns detections into spheres of free space: eq. 1 and 3 of Chong et al. 2008 and the rules of acceptance.
/// One accepted image gives one sphere where the ball was. Nothing is interpolated between images: space
/// between two samples was never shown to be free. Deterministic; not to be shared between threads.
class Probe {
 public:
  /// Throws std::invalid_argument when a part is invalid, base and probe share a tag id, or Chong 2008, eq. 3
  /// leaves no ball.
  Probe(const Camera& camera, const TagBody& base, const PaintingProbe& probe, const ErrorBudget& budget,
        const AcceptanceOptions& acceptance = {}, const BodyPoseOptions& pose = {});

  /// The sample of one image, taken at `time` (seconds, must rise). Never throws for what an image shows.
  PaintingSample sample(const std::vector<TagDetection>& detections, double time);

  /// Counts an image that could not be searched for tags.
  PaintingSample refuse_image(const std::string& reason, double time);

  /// Of the base board before a fixed camera.
  const StaticBoard::Moves& base_moves() const { return board_.moves(); }

  /// Accepted samples that rest on a tag alone, of its body, that others contradict by now: it may have come
  /// loose, and the samples may be off by more than their bound.
  struct Doubts {
    std::set<int> tags;  ///< their ids
    std::int64_t samples = 0;
  };
  Doubts doubts() const;

  std::int64_t count(Refusal refusal) const { return counts_[static_cast<std::size_t>(refusal)]; }
  /// Counts by `to_string`, every reason present: what a report prints.
  std::map<std::string, std::int64_t> counts() const;

 private:
  struct Verdict {
    Refusal refusal = Refusal::none;
    std::string reason;
  };
  Verdict judge_time(double time) const;
  Verdict judge_body(const BodyPose& pose, const TagBody& body, int min_tags) const;
  Verdict judge_poses(PaintingSample& sample);
  Verdict judge_center(const PaintingSample& sample) const;
  Verdict judge_history(const PaintingSample& sample) const;
  Verdict judge_speed(PaintingSample& sample) const;
  void remember(const PaintingSample& sample, Refusal refusal);
  PaintingSample finish(PaintingSample sample, const Verdict& verdict);

  struct Place {
    double time = 0.0;
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();  ///< of the probe in the base
  };
  /// What earlier images said about a body.
  struct Record {
    TagRecord tags;
    NoiseRecord noise;
  };
  std::optional<BodyPose> pose_of(const TagBody& body, const std::vector<TagDetection>& detections,
                                  Record& record) const;

  Camera camera_;
  TagBody base_;
  PaintingProbe probe_;
  ErrorBudget budget_;
  AcceptanceOptions acceptance_;
  BodyPoseOptions pose_;
  StaticBoard board_;
  Record base_record_, probe_record_;
  std::optional<double> last_time_;
  bool measured_before_ = false;        // the image before this one measured the ball
  std::optional<Place> last_measured_;  // all rules held but perhaps the speed
  std::optional<Place> last_accepted_;
  std::array<std::int64_t, kRefusals> counts_{};
  // By the tags of base and probe that each showed alone, -1 where it showed more.
  std::map<std::pair<int, int>, std::int64_t> accepted_alone_;
};

}  // namespace clearway

#include "tracking/probe.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <locale>
#include <sstream>
#include <stdexcept>

#include "tracking/validation.hpp"

namespace clearway {
namespace {

constexpr const char* kNames[kRefusals] = {"accepted",           "image_refused",  "time_not_rising",
                                           "base_not_seen",      "probe_not_seen", "too_few_tags",
                                           "reprojection_error", "ambiguous_pose", "base_moved",
                                           "uncertain_center",   "unconfirmed",    "too_fast"};

template <typename... Parts>
std::string sentence(const Parts&... parts) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << std::setprecision(4);
  (text << ... << parts);
  return text.str();
}

void validate(const AcceptanceOptions& o) {
  require(o.min_base_tags >= 1, "acceptance: min_base_tags", "1 or more");
  require(o.min_probe_tags >= 1, "acceptance: min_probe_tags", "1 or more");
  require(o.max_noise >= 1.0, "acceptance: max_noise", "1 or more");
  require(o.max_rms_px > 0.0, "acceptance: max_rms_px", "> 0 pixels");
  require(o.min_ambiguity_ratio >= 1.0, "acceptance: min_ambiguity_ratio", "1 or more");
  require(o.min_separation >= 0.0, "acceptance: min_separation", "0 or more");
  require(o.least_noise > 0.0, "acceptance: least_noise", "> 0 pixels");
  require(o.max_speed > 0.0, "acceptance: max_speed", "> 0 metres per second");
  require(o.max_turn_speed > 0.0, "acceptance: max_turn_speed", "> 0 radians per second");
  require(o.max_pause > 0.0, "acceptance: max_pause", "> 0 seconds");
}

constexpr int kNoTag = -1;  // ids are 0 or more

double chi_square_allowed(const BodyPose& pose, const AcceptanceOptions& acceptance) {
  return acceptance.max_noise * acceptance.max_noise * chi_square_limit(pose.freedom);
}

}  // namespace

bool is_explained(const BodyPose& pose, const AcceptanceOptions& acceptance) {
  return pose.rms_px <= acceptance.max_rms_px && pose.chi_square <= chi_square_allowed(pose, acceptance);
}

std::string to_string(Refusal refusal) { return kNames[static_cast<std::size_t>(refusal)]; }

Probe::Probe(const Camera& camera, const TagBody& base, const PaintingProbe& probe, const ErrorBudget& budget,
             const AcceptanceOptions& acceptance, const BodyPoseOptions& pose)
    : camera_(camera),
      base_(base),
      probe_(probe),
      budget_(budget),
      acceptance_(acceptance),
      pose_(pose),
      board_(acceptance.static_board) {
  validate(budget, probe.ball_radius);
  camera.validate();
  base.validate();
  probe.validate();
  validate(acceptance);
  pose.validate();
  for (const auto& [id, tag] : base.tags)
    if (probe.body.tags.count(id))
      throw std::invalid_argument("tag " + std::to_string(id) + " is on the base '" + base.name +
                                  "' and on the probe '" + probe.body.name + "', expected each tag on one");
}

PaintingSample Probe::sample(const std::vector<TagDetection>& detections, double time) {
  PaintingSample sample;
  sample.time = time;
  if (const Verdict verdict = judge_time(time); verdict.refusal != Refusal::none)
    return finish(std::move(sample), verdict);
  last_time_ = time;
  sample.base = pose_of(base_, detections, base_record_);
  sample.probe = pose_of(probe_.body, detections, probe_record_);
  Verdict verdict = judge_poses(sample);
  if (verdict.refusal == Refusal::none) verdict = judge_center(sample);
  if (verdict.refusal == Refusal::none) verdict = judge_history(sample);
  if (verdict.refusal == Refusal::none) verdict = judge_speed(sample);
  remember(sample, verdict.refusal);
  return finish(std::move(sample), verdict);
}

std::optional<BodyPose> Probe::pose_of(const TagBody& body, const std::vector<TagDetection>& detections,
                                       Record& record) const {
  BodyPoseOptions options = pose_;
  options.pixel_noise = record.noise.noise(pose_.pixel_noise, acceptance_.least_noise);
  auto pose = estimate_body_pose(body, detections, camera_, options);
  if (!pose) return std::nullopt;
  record.tags.note(*pose, is_explained(*pose, acceptance_));
  const bool is_doubtful =
      std::any_of(pose->tags.begin(), pose->tags.end(), [&](int id) { return !record.tags.is_trusted(id); });
  if (is_doubtful) pose = estimate_body_pose(body, record.tags.trusted(detections), camera_, options);
  if (pose) record.noise.note(*pose);
  return pose;
}

PaintingSample Probe::refuse_image(const std::string& reason, double time) {
  PaintingSample sample;
  sample.time = time;
  measured_before_ = false;
  return finish(std::move(sample), {Refusal::image_refused, reason});
}

std::map<std::string, std::int64_t> Probe::counts() const {
  std::map<std::string, std::int64_t> by_name;
  for (int i = 0; i < kRefusals; ++i) by_name[kNames[i]] = counts_[i];
  return by_name;
}

Probe::Verdict Probe::judge_time(double time) const {
  if (!std::isfinite(time)) return {Refusal::time_not_rising, "the image's time is not finite"};
  if (last_time_ && time <= *last_time_)
    return {Refusal::time_not_rising,
            sentence("the image's time is ", *last_time_ - time, " s before the image before it")};
  return {};
}

Probe::Verdict Probe::judge_body(const BodyPose& pose, const TagBody& body, int min_tags) const {
  const std::string who = "'" + body.name + "' ";
  if (static_cast<int>(pose.tags.size()) < min_tags)
    return {Refusal::too_few_tags, sentence(who, "shows ", pose.tags.size(), " tags, at least ", min_tags)};
  if (!(pose.rms_px <= acceptance_.max_rms_px))
    return {Refusal::reprojection_error, sentence(who, "reprojects with an rms error of ", pose.rms_px,
                                                  " px, at most ", acceptance_.max_rms_px)};
  if (!is_explained(pose, acceptance_))
    return {Refusal::reprojection_error, sentence(who, "reprojects with a chi-square of ", pose.chi_square,
                                                  ", at most ", chi_square_allowed(pose, acceptance_))};
  if (!(pose.ambiguity_ratio >= acceptance_.min_ambiguity_ratio))
    return {Refusal::ambiguous_pose,
            sentence(who, "has another pose with only ", pose.ambiguity_ratio, " times the error, at least ",
                     acceptance_.min_ambiguity_ratio)};
  if (!(pose.separation >= acceptance_.min_separation))
    return {Refusal::ambiguous_pose, sentence(who, "has another pose that is worse by ", pose.separation,
                                              " only (chi-square), at least ", acceptance_.min_separation)};
  return {};
}

// Chong 2008, eq. 1, and whether its two poses may be trusted.
Probe::Verdict Probe::judge_poses(PaintingSample& sample) {
  if (!sample.base) return {Refusal::base_not_seen, "base '" + base_.name + "' is not seen"};
  const Verdict base = judge_body(*sample.base, base_, acceptance_.min_base_tags);
  UncertainPose camera_from_base = sample.base->camera_from_body;
  bool base_moved = false, is_mean = false;
  if (acceptance_.fixed_camera && base.refusal == Refusal::none) {
    const bool is_known = board_.has_mean();
    const auto mean = board_.add(camera_from_base);
    base_moved = !mean;
    is_mean = mean.has_value();
    sample.base_agrees = is_mean && is_known;
    if (mean) camera_from_base = *mean;
  }
  if (!sample.probe) return {Refusal::probe_not_seen, "probe '" + probe_.body.name + "' is not seen"};
  sample.base_from_probe = clearway::base_from_probe(camera_from_base, sample.probe->camera_from_body);
  const UncertainPoint center = transform(sample.base_from_probe, probe_.ball_in_probe);
  sample.center_sigma = center.largest_sigma();
  sample.bound = bound_center(*sample.base, camera_from_base, is_mean, *sample.probe, probe_.ball_in_probe,
                              pose_.noise_freedom);
  sample.sphere = {center.point, painted_radius(probe_.ball_radius, budget_, sample.bound.total)};
  if (base.refusal != Refusal::none) return base;
  const Verdict probe = judge_body(*sample.probe, probe_.body, acceptance_.min_probe_tags);
  if (probe.refusal != Refusal::none) return probe;
  if (base_moved) return {Refusal::base_moved, "base '" + base_.name + "' is not where it was"};
  return {};
}

Probe::Verdict Probe::judge_center(const PaintingSample& sample) const {
  const double bound = sample.bound.total;
  if (budget_.constant_tracking && !(bound <= budget_.tracking))
    return {Refusal::uncertain_center, sentence("the ball's centre may be off by ", 1e3 * bound,
                                                " mm, at most ", 1e3 * budget_.tracking)};
  if (!(sample.sphere.radius > 0.0))
    return {Refusal::uncertain_center,
            sentence("the ball's centre may be off by ", 1e3 * bound,
                     " mm, which leaves nothing of a ball of ", 1e3 * probe_.ball_radius, " mm")};
  return {};
}

// Two tags of a body contradict each other when one is misdetected. A single one needs earlier images.
Probe::Verdict Probe::judge_history(const PaintingSample& sample) const {
  const auto judge_alone = [](const BodyPose& pose, const TagBody& body, const TagRecord& record) -> Verdict {
    const int id = pose.tags.front();
    if (pose.tags.size() > 1 || !record.is_disputed(id)) return {};
    return {Refusal::unconfirmed, sentence("only tag ", id, " of '", body.name,
                                           "' is visible, which another tag of it contradicted: ",
                                           "one of the two is not where the setup has it")};
  };
  const Verdict base = sample.base_agrees ? Verdict{} : judge_alone(*sample.base, base_, base_record_.tags);
  if (base.refusal != Refusal::none) return base;
  const Verdict probe = judge_alone(*sample.probe, probe_.body, probe_record_.tags);
  if (probe.refusal != Refusal::none) return probe;
  const bool probe_alone = sample.probe->tags.size() == 1;
  const bool base_alone = sample.base->tags.size() == 1 && !sample.base_agrees;
  if (!(probe_alone || base_alone) || std::isinf(acceptance_.max_pause)) return {};
  const std::string who = "only one tag of '" + (probe_alone ? probe_.body.name : base_.name) +
                          "' is visible, and the previous image ";
  if (!measured_before_) return {Refusal::unconfirmed, who + "did not measure the ball"};
  if (const double pause = sample.time - last_measured_->time; pause > acceptance_.max_pause)
    return {Refusal::unconfirmed,
            sentence(who, "was taken ", pause, " s earlier, at most ", acceptance_.max_pause)};
  return {};
}

Probe::Verdict Probe::judge_speed(PaintingSample& sample) const {
  double turning = 0.0;
  for (const std::optional<Place>& last : {last_measured_, last_accepted_}) {
    if (!last) continue;
    const double passed = sample.time - last->time;
    const Eigen::AngleAxisd turn(last->turn.transpose() * sample.base_from_probe.pose.linear());
    sample.speed = std::max(sample.speed, (sample.sphere.center - last->center).norm() / passed);
    turning = std::max(turning, turn.angle() / passed);
  }
  if (!(sample.speed <= acceptance_.max_speed))
    return {Refusal::too_fast,
            sentence("the ball moved at ", sample.speed, " m/s, at most ", acceptance_.max_speed)};
  if (!(turning <= acceptance_.max_turn_speed))
    return {Refusal::too_fast,
            sentence("the probe turned at ", turning, " rad/s, at most ", acceptance_.max_turn_speed)};
  return {};
}

void Probe::remember(const PaintingSample& sample, Refusal refusal) {
  const Place place{sample.time, sample.sphere.center, sample.base_from_probe.pose.linear()};
  measured_before_ =
      refusal == Refusal::none || refusal == Refusal::unconfirmed || refusal == Refusal::too_fast;
  if (measured_before_) last_measured_ = place;
  if (refusal != Refusal::none) return;
  last_accepted_ = place;
  const auto alone = [](const BodyPose& pose) { return pose.tags.size() == 1 ? pose.tags.front() : kNoTag; };
  ++accepted_alone_[{sample.base_agrees ? kNoTag : alone(*sample.base), alone(*sample.probe)}];
}

Probe::Doubts Probe::doubts() const {
  Doubts doubts;
  const auto note = [&](int id, const Record& record) {
    const bool is_doubtful = id != kNoTag && (record.tags.is_disputed(id) || !record.tags.is_trusted(id));
    if (is_doubtful) doubts.tags.insert(id);
    return is_doubtful;
  };
  for (const auto& [ids, count] : accepted_alone_) {
    const bool by_base = note(ids.first, base_record_), by_probe = note(ids.second, probe_record_);
    if (by_base || by_probe) doubts.samples += count;
  }
  return doubts;
}

PaintingSample Probe::finish(PaintingSample sample, const Verdict& verdict) {
  sample.accepted = verdict.refusal == Refusal::none;
  sample.refusal = verdict.refusal;
  sample.reason = verdict.reason;
  ++counts_[static_cast<std::size_t>(verdict.refusal)];
  return sample;
}

}  // namespace clearway

#include "datasets/sources/rawlog_decoder.hpp"

#include <mrpt/maps/CPointsMap.h>
#include <mrpt/maps/registerAllClasses.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CActionRobotMovement3D.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/obs/registerAllClasses.h>
#include <mrpt/serialization/CArchive.h>

#include "datasets/sources/observation_decoder.hpp"

namespace clearway {

namespace {

/// What MRPT's archive asks of a stream.
struct Source {
  RawlogDecoder::ReadBytes read;
  size_t Read(void* target, size_t size) { return read(target, size); }
  size_t Write(const void*, size_t) { throw std::logic_error("a recording is read only"); }
  std::string getStreamDescription() const { return "recording"; }
};

}  // namespace

struct RawlogDecoder::State {
  explicit State(ReadBytes read) : source{std::move(read)}, archive(source) {}

  Source source;
  mrpt::serialization::CArchiveStreamBase<Source> archive;
  mrpt::poses::CPose3D world_from_robot;  // the sum of the actions' increments
  bool has_actions = false;
  double time = DecodedFrame::unknown_time;  // that of the last object that had one

  double time_of(mrpt::Clock::time_point stamp) {
    if (stamp != mrpt::Clock::time_point()) time = mrpt::Clock::toDouble(stamp);
    return time;
  }
};

RawlogDecoder::RawlogDecoder(ReadBytes read) : state_(std::make_unique<State>(std::move(read))) {}
RawlogDecoder::~RawlogDecoder() = default;

void register_rawlog_classes() {
  mrpt::obs::registerAllClasses_mrpt_obs();
  mrpt::maps::registerAllClasses_mrpt_maps();
}

namespace {

/// The robot's movement of one action; false when the action is of another kind.
bool movement(const mrpt::obs::CAction& action, mrpt::poses::CPose3D& increment) {
  if (const auto* flat = dynamic_cast<const mrpt::obs::CActionRobotMovement2D*>(&action)) {
    // The raw reading where there is one: the distribution made from it may consist of random samples.
    if (flat->estimationMethod == mrpt::obs::CActionRobotMovement2D::emOdometry)
      increment = mrpt::poses::CPose3D(flat->rawOdometryIncrementReading);
    else if (flat->poseChange)
      increment = mrpt::poses::CPose3D(flat->poseChange->getMeanVal());
    return true;
  }
  if (const auto* spatial = dynamic_cast<const mrpt::obs::CActionRobotMovement3D*>(&action)) {
    increment = spatial->estimationMethod == mrpt::obs::CActionRobotMovement3D::emOdometry
                    ? spatial->rawOdometryIncrementReading
                    : spatial->poseChange.mean;
    return true;
  }
  return false;
}

}  // namespace

void RawlogDecoder::decode_object(const std::function<void(DecodedFrame&&)>& frame,
                                  const std::function<void(const std::string&)>& skipped) {
  const auto object = state_->archive.ReadObject();
  if (!object) throw std::runtime_error("an empty object");

  if (const auto actions = std::dynamic_pointer_cast<mrpt::obs::CActionCollection>(object)) {
    for (const auto& action : *actions) {
      mrpt::poses::CPose3D increment;
      if (!action || !movement(*action, increment)) continue;
      state_->has_actions = true;
      state_->world_from_robot = state_->world_from_robot + increment;
      frame({{state_->time_of(action->timestamp), "odometry",
              OdometryFrame{isometry(state_->world_from_robot)}},
             true});
    }
    return;
  }

  const auto observe = [&](const mrpt::obs::CObservation& observation) {
    const double time = state_->time_of(observation.timestamp);
    const auto placed = state_->has_actions ? state_->world_from_robot : mrpt::poses::CPose3D();
    decode_observation(
        observation, placed,
        [&](auto&& content) {
          frame({{time, observation.sensorLabel, std::move(content)}, state_->has_actions});
        },
        skipped);
  };
  if (const auto together = std::dynamic_pointer_cast<mrpt::obs::CSensoryFrame>(object)) {
    for (const auto& observation : *together)
      if (observation) observe(*observation);
  } else if (const auto observation = std::dynamic_pointer_cast<mrpt::obs::CObservation>(object)) {
    observe(*observation);
  } else {
    skipped("");
  }
}

}  // namespace clearway

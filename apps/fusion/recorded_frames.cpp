#include "apps/fusion/recorded_frames.hpp"

#include <utility>

namespace clearway {
namespace {

constexpr std::size_t most_unwritten = 64;  ///< frames; a disk that is slower for long slows the source

}  // namespace

RecordedFrames::RecordedFrames(std::unique_ptr<FrameSource> frames, const std::filesystem::path& file,
                               const Setup& setup)
    : frames_(std::move(frames)),
      setup_(setup),
      writer_(file, UnfinishedRecording::kept),
      worker_([this] { write_frames(); }) {}

RecordedFrames::~RecordedFrames() {
  if (worker_.joinable()) hand_over(std::nullopt);
}

std::optional<Frame> RecordedFrames::next() {
  std::optional<Frame> frame = frames_->next();
  while (frame && std::holds_alternative<OdometryFrame>(frame->content)) frame = frames_->next();
  if (!frame) return frame;
  if (auto* cloud = std::get_if<CloudFrame>(&frame->content)) {
    if (const SensorSetup* sensor = setup_.sensor(frame->sensor, cloud->kind)) frame->sensor = sensor->name;
    cloud->kind = "points";
  }
  hand_over(*frame);
  frame->time = recorded_time(frame->time);
  return frame;
}

void RecordedFrames::finish() {
  hand_over(std::nullopt);
  worker_.join();
  if (failure_) std::rethrow_exception(failure_);
  writer_.finish();
}

void RecordedFrames::hand_over(std::optional<Frame> frame) {
  std::unique_lock lock(guard_);
  wake_.wait(lock, [&] { return unwritten_.size() < most_unwritten || failure_; });
  if (failure_ && frame) std::rethrow_exception(failure_);
  unwritten_.push_back(std::move(frame));
  wake_.notify_all();
}

void RecordedFrames::write_frames() {
  while (true) {
    std::optional<Frame> frame;
    {
      std::unique_lock lock(guard_);
      wake_.wait(lock, [this] { return !unwritten_.empty(); });
      frame = std::move(unwritten_.front());
      unwritten_.pop_front();
    }
    wake_.notify_all();
    if (!frame) return;
    try {
      writer_.write(*frame);
    } catch (...) {
      const std::lock_guard lock(guard_);
      failure_ = std::current_exception();
      wake_.notify_all();
      return;
    }
  }
}

}  // namespace clearway

#include "apps/fusion/recorded_frames.hpp"

namespace clearway {

RecordedFrames::RecordedFrames(std::unique_ptr<FrameSource> frames, const std::filesystem::path& file)
    : frames_(std::move(frames)), writer_(file) {}

std::optional<Frame> RecordedFrames::next() {
  std::optional<Frame> frame = frames_->next();
  if (frame) {
    writer_.write(*frame);
    frame->time = recorded_time(frame->time);
  } else if (!is_finished_) {
    writer_.finish();
    is_finished_ = true;
  }
  return frame;
}

}  // namespace clearway

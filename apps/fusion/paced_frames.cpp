#include "apps/fusion/paced_frames.hpp"

#include <thread>
#include <utility>

#include "mapping/system/number_text.hpp"

namespace clearway {

std::optional<Frame> PacedFrames::next() {
  std::optional<Frame> frame = ahead_ ? std::exchange(ahead_, std::nullopt) : frames_->next();
  if (!frame || std::holds_alternative<CommentFrame>(frame->content)) return frame;
  if (!first_time_) {
    first_time_ = frame->time;
    begin_ = Clock::now();
  }
  while (std::holds_alternative<ImageFrame>(frame->content)) {
    ahead_ = frames_->next();
    if (!ahead_ || !std::holds_alternative<ImageFrame>(ahead_->content) || wait_for(*ahead_) > 0.0) break;
    frame = std::exchange(ahead_, std::nullopt);
    ++dropped_;
  }
  if (const double wait = wait_for(*frame); wait > 0.0)
    std::this_thread::sleep_for(std::chrono::duration<double>(wait));
  return frame;
}

std::vector<std::string> PacedFrames::warnings() const {
  std::vector<std::string> warnings = frames_->warnings();
  if (dropped_ > 0)
    warnings.push_back(counted(dropped_, "image") +
                       " came while one before them was worked on, and were left out");
  return warnings;
}

double PacedFrames::wait_for(const Frame& frame) const {
  return frame.time - *first_time_ - std::chrono::duration<double>(Clock::now() - begin_).count();
}

}  // namespace clearway

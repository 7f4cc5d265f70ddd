#pragma once

#include <chrono>
#include <memory>
#include <optional>

#include "datasets/sources/frame_source.hpp"

namespace clearway {

/// The frames of a recording as if they came now: each not before its time since the first one. An image for
/// which nobody had time until the next one was due is left out, as a camera's would be; scans wait.
class PacedFrames final : public FrameSource {
 public:
  explicit PacedFrames(std::unique_ptr<FrameSource> frames) : frames_(std::move(frames)) {}

  std::optional<Frame> next() override;
  std::optional<std::string> damage() const override { return frames_->damage(); }
  std::vector<std::string> warnings() const override;
  std::string time_caveat() const override { return frames_->time_caveat(); }
  std::vector<TakenCamera> cameras() const override { return frames_->cameras(); }
  double progress() const override { return frames_->progress(); }
  bool is_live() const override { return true; }

 private:
  using Clock = std::chrono::steady_clock;
  /// How long until a frame is due, s; below 0 when it is late.
  double wait_for(const Frame& frame) const;

  std::unique_ptr<FrameSource> frames_;
  std::optional<Frame> ahead_;
  std::optional<double> first_time_;
  Clock::time_point begin_;
  std::size_t dropped_ = 0;
};

}  // namespace clearway

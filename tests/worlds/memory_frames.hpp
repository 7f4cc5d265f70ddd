#pragma once

#include <utility>
#include <vector>

#include "datasets/sources/frame_source.hpp"

namespace clearway {

/// Frames from memory; counts how many were asked for.
class MemoryFrames final : public FrameSource {
 public:
  explicit MemoryFrames(std::vector<Frame> frames) : frames_(std::move(frames)) {}
  std::optional<Frame> next() override {
    if (given == frames_.size()) return std::nullopt;
    return frames_[given++];
  }
  std::optional<std::string> damage() const override { return std::nullopt; }
  std::vector<std::string> warnings() const override { return {}; }
  double progress() const override { return 0.0; }
  bool is_live() const override { return live; }
  std::size_t given = 0;
  bool live = false;

 private:
  std::vector<Frame> frames_;
};

}  // namespace clearway

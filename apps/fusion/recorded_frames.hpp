#pragma once

#include <filesystem>
#include <memory>

#include "datasets/sources/frame_source.hpp"

namespace clearway {

/// The frames of a source, each written to a rawlog before it is handed on, with its time as the rawlog keeps
/// it (100 ns): whoever reads the rawlog gets the same images and times. Clouds keep their points and places
/// alone.
class RecordedFrames final : public FrameSource {
 public:
  /// @throws std::runtime_error when the file cannot be written.
  RecordedFrames(std::unique_ptr<FrameSource> frames, const std::filesystem::path& file);

  std::optional<Frame> next() override;
  std::optional<std::string> damage() const override { return frames_->damage(); }
  std::vector<std::string> warnings() const override { return frames_->warnings(); }
  double progress() const override { return frames_->progress(); }

 private:
  std::unique_ptr<FrameSource> frames_;
  RecordingWriter writer_;
  bool is_finished_ = false;
};

}  // namespace clearway

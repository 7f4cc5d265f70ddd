#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

#include "datasets/descriptions/setup.hpp"
#include "datasets/sources/frame_source.hpp"

namespace clearway {

/// The frames of a source, each with its time as a rawlog keeps it (100 ns), and written to one by a thread
/// of its own: whoever reads the rawlog gets the same images and times. Clouds keep their points, their
/// places and the setup's name of their sensor. Odometry is left out: frames have it in their places already,
/// and a reader of the rawlog would add it once more. Without `finish` the rawlog ends where the frames did.
class RecordedFrames final : public FrameSource {
 public:
  /// @param setup has the sensors; it must outlive this
  /// @throws std::runtime_error when the file cannot be written.
  RecordedFrames(std::unique_ptr<FrameSource> frames, const std::filesystem::path& file, const Setup& setup);

  ~RecordedFrames() override;
  RecordedFrames(const RecordedFrames&) = delete;
  RecordedFrames& operator=(const RecordedFrames&) = delete;

  std::optional<Frame> next() override;
  std::optional<std::string> damage() const override { return frames_->damage(); }
  std::vector<std::string> warnings() const override { return frames_->warnings(); }
  std::string time_caveat() const override { return frames_->time_caveat(); }
  std::vector<TakenCamera> cameras() const override { return frames_->cameras(); }
  double progress() const override { return frames_->progress(); }
  bool is_live() const override { return frames_->is_live(); }

  /// Waits until all is written. Nothing may be asked for afterwards.
  /// @throws std::runtime_error when the disk refuses; `next` may throw it, too.
  void finish();

 private:
  void write_frames();
  void hand_over(std::optional<Frame> frame);

  std::unique_ptr<FrameSource> frames_;
  const Setup& setup_;
  RecordingWriter writer_;
  std::mutex guard_;  ///< of what follows
  std::condition_variable wake_;
  std::deque<std::optional<Frame>> unwritten_;  ///< empty: the end
  std::exception_ptr failure_;
  std::jthread worker_;
};

}  // namespace clearway

#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "datasets/sources/frame_source.hpp"

namespace clearway {

/// Frames of a source that may give them somewhat out of order, in the order of their times; those of one
/// time as they come, and comments before the first frame at once. It holds back the frames that come next
/// (64, or 64 MB). A scan that is older than one already given is left out, because an older look must not
/// count as a newer one, and is damage.
class OrderedFrames final : public FrameSource {
 public:
  /// @param name of the recording, for the sentence about scans that are left out
  OrderedFrames(std::unique_ptr<FrameSource> frames, std::string name)
      : frames_(std::move(frames)), name_(std::move(name)) {}

  std::optional<Frame> next() override;
  std::optional<std::string> damage() const override;
  std::vector<std::string> warnings() const override { return frames_->warnings(); }
  std::string time_caveat() const override { return frames_->time_caveat(); }
  std::vector<TakenCamera> cameras() const override { return frames_->cameras(); }
  double progress() const override { return frames_->progress(); }
  bool is_live() const override { return frames_->is_live(); }
  /// At the end: where a sensor's scans come as of a clock that was set back (find_set_back), so that its
  /// newest ones were given as its oldest, or left out. @throws std::invalid_argument one sentence
  void refuse_set_back() const;

 private:
  void read_ahead();

  std::unique_ptr<FrameSource> frames_;
  std::string name_;
  std::multimap<double, Frame> waiting_;              ///< by time
  std::map<std::string, std::vector<double>> times_;  ///< s, of each sensor's scans, as they came
  std::size_t waiting_bytes_ = 0, clouds_ = 0, late_ = 0;
  bool is_at_end_ = false;
  std::optional<double> newest_;  ///< s, of the scans given
  double latest_ = 0.0;           ///< s, by how much a scan was late at most
};

}  // namespace clearway

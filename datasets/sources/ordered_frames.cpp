#include "datasets/sources/ordered_frames.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "datasets/sources/clock_restart.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr std::size_t most_waiting = 64, most_bytes = std::size_t{64} << 20U;

std::size_t bytes_of(const Frame& frame) {
  if (const auto* image = std::get_if<ImageFrame>(&frame.content)) return image->image.pixels.size();
  if (const auto* cloud = std::get_if<CloudFrame>(&frame.content))
    return cloud->points.size() * sizeof cloud->points[0];
  return 0;
}

}  // namespace

void OrderedFrames::read_ahead() {
  while (!is_at_end_ && waiting_.size() < most_waiting && waiting_bytes_ < most_bytes) {
    std::optional<Frame> frame = frames_->next();
    is_at_end_ = !frame;
    if (!frame) return;
    const double time = frame->time;
    waiting_bytes_ += bytes_of(*frame);
    if (std::holds_alternative<CloudFrame>(frame->content)) times_[frame->sensor].push_back(time);
    waiting_.emplace(time, std::move(*frame));
    const bool begins_with_comment = !newest_ && waiting_.size() == 1 &&
                                     std::holds_alternative<CommentFrame>(waiting_.begin()->second.content);
    if (begins_with_comment) return;
  }
}

std::optional<Frame> OrderedFrames::next() {
  for (;;) {
    read_ahead();
    if (waiting_.empty()) return std::nullopt;
    Frame frame = std::move(waiting_.extract(waiting_.begin()).mapped());
    waiting_bytes_ -= bytes_of(frame);
    if (!std::holds_alternative<CloudFrame>(frame.content)) return frame;
    ++clouds_;
    if (!newest_ || frame.time >= *newest_) {
      newest_ = frame.time;
      return frame;
    }
    ++late_;
    latest_ = std::max(latest_, *newest_ - frame.time);
  }
}

void OrderedFrames::refuse_set_back() const {
  for (const auto& [sensor, times] : times_)
    if (const auto step = find_set_back(times))
      throw std::invalid_argument(
          "recording " + quote_path(name_) + " holds more than one run of its clock: " +
          set_back_clause("sensor " + quote(sensor), times, "the times", *step) +
          "; expected a recording for each run, whose maps `clearway inspect --merge` joins");
}

std::optional<std::string> OrderedFrames::damage() const {
  std::optional<std::string> damage = frames_->damage();
  if (late_ == 0) return damage;
  const std::string late =
      "recording " + quote_path(name_) + " is not in the order of its times: " + std::to_string(late_) +
      (late_ == 1 ? " scan that is" : " scans that are") + " older than scans before, by up to " +
      short_text(latest_, 4) + " s, " + (late_ == 1 ? "is" : "are") + " not used" +
      (4 * late_ > clouds_ ? ", as of several runs in one recording: expected one for each run." : ".");
  return damage ? *damage + " " + late : late;
}

}  // namespace clearway

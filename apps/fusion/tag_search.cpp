#include "apps/fusion/tag_search.hpp"

#include <opencv2/core.hpp>
#include <utility>

#include "apps/console/stopwatch.hpp"

namespace clearway {
namespace {

constexpr std::size_t most_pixels = 64'000'000;

std::vector<TagDetection> tags_in(TagDetector& detector, const GrayImage& image) {
  const cv::Mat gray(image.height, image.width, CV_8UC1, const_cast<std::uint8_t*>(image.pixels.data()));
  if (!is_detectable(gray, detector.options().decimate)) return {};
  return detector.detect(gray);
}

}  // namespace

TagSearch::TagSearch(FrameSource& frames, const TagDetectorOptions& options, std::size_t threads)
    : frames_(frames), options_(options), threads_(threads) {
  if (threads > 0) TagDetector{options};  // refuses wrong options here
  for (std::size_t i = 0; i < threads; ++i) workers_.emplace_back([this] { search(); });
}

TagSearch::~TagSearch() {
  {
    const std::lock_guard lock(guard_);
    stopping_ = true;
  }
  wake_.notify_all();
}

std::optional<SearchedFrame> TagSearch::next() {
  read_ahead();
  if (waiting_.empty()) return std::nullopt;
  Waiting& first = waiting_.front();
  SearchedFrame searched;
  const auto* image = std::get_if<ImageFrame>(&first.frame.content);
  if (image != nullptr && threads_ > 0) {
    const Stopwatch watch(waited_);
    searched.tags = first.tags.get_future().get();
    --images_;
    pixels_ -= image->image.pixels.size();
  }
  searched.frame = std::move(first.frame);
  searched.read = first.read;
  waiting_.pop_front();
  return searched;
}

void TagSearch::read_ahead() {
  const std::size_t most_images = frames_.is_live() ? 1 : 2 * threads_;
  const std::size_t most_frames = frames_.is_live() ? 1 : 2 * most_images + 1;
  while (!ended_ && waiting_.size() < most_frames && (images_ < most_images || threads_ == 0) &&
         pixels_ < most_pixels) {
    std::optional<Frame> frame = frames_.next();
    if (!frame) {
      ended_ = true;
      return;
    }
    waiting_.push_back({std::move(*frame), {}, std::chrono::steady_clock::now()});
    const auto* image = std::get_if<ImageFrame>(&waiting_.back().frame.content);
    if (image == nullptr || threads_ == 0) continue;
    ++images_;
    pixels_ += image->image.pixels.size();
    {
      const std::lock_guard lock(guard_);
      unsearched_.push_back(&waiting_.back());
    }
    wake_.notify_one();
  }
}

/// What each worker does: a detector belongs to one thread.
void TagSearch::search() {
  TagDetector detector(options_);
  while (true) {
    Waiting* next = nullptr;
    {
      std::unique_lock lock(guard_);
      wake_.wait(lock, [this] { return stopping_ || !unsearched_.empty(); });
      if (stopping_) return;
      next = unsearched_.front();
      unsearched_.pop_front();
    }
    try {
      next->tags.set_value(tags_in(detector, std::get<ImageFrame>(next->frame.content).image));
    } catch (...) {
      next->tags.set_exception(std::current_exception());
    }
  }
}

}  // namespace clearway

#include "apps/overlay/film.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "apps/console/quantile.hpp"

namespace clearway {

void Film::add(double time, const cv::Mat& picture) {
  if (video_) return place(time, picture);
  waiting_.push_back(picture);
  times_.push_back(time);
  constexpr std::size_t enough = 16;
  if (times_.size() == enough) open();
}

void Film::add(const cv::Mat& picture) {
  if (!video_) open();
  show(next_ + 1);
  video_->add(picture);
}

double Film::rate() {
  if (!video_) open();
  return rate_;
}

void Film::finish() {
  if (!video_) open();
  show(next_ + 1);
  video_->finish();
}

namespace {

/// The time between most pictures, or between the denser ones where they are uneven; 0: it is not known.
double usual_gap(const std::vector<double>& times) {
  std::vector<double> gaps;
  for (std::size_t i = 1; i < times.size(); ++i) gaps.push_back(times[i] - times[i - 1]);
  if (gaps.empty()) return 0.0;
  constexpr double uneven = 0.55;
  const double middle = quantile(gaps, 0.5), dense = quantile(gaps, 0.1);
  if (dense > 0.0 && dense < uneven * middle) return dense;
  std::erase_if(gaps, [&](double gap) { return std::abs(gap - middle) > (1.0 - uneven) * middle; });
  return gaps.empty() ? 0.0
                      : std::accumulate(gaps.begin(), gaps.end(), 0.0) / static_cast<double>(gaps.size());
}

}  // namespace

void Film::open() {
  if (const double gap = usual_gap(times_); gap > 0.0)
    rate_ = std::clamp(std::round(1.0 / gap), 2.0, 60.0);  // what players can show
  video_.emplace(file_, waiting_.front().cols, waiting_.front().rows, rate_);
  for (std::size_t i = 0; i < waiting_.size(); ++i) place(times_[i], waiting_[i]);
  waiting_.clear();
}

/// Shows the one before until that time. Of pictures that are denser than the rate, some are left out; one
/// that is early by less than a place is not.
void Film::place(double time, const cv::Mat& picture) {
  constexpr double longest = 600.0;  // s: else the clock was set
  if (shown_.empty()) {
    start_ = time;
  } else {
    if (time < last_ || time > last_ + longest) start_ += time - last_ - 1.0 / rate_;
    const double place = (time - start_) * rate_;
    if (place > static_cast<double>(next_))
      show(std::max(next_ + 1, static_cast<std::int64_t>(std::llround(place))));
  }
  last_ = time;
  shown_ = picture;
}

/// Writes the picture that waits up to a place in the video.
void Film::show(std::int64_t until) {
  if (shown_.empty()) return;
  for (; next_ < until; ++next_) video_->add(shown_);
  shown_.release();
}

}  // namespace clearway

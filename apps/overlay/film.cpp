#include "apps/overlay/film.hpp"

#include <algorithm>
#include <cmath>

#include "apps/console/quantile.hpp"

namespace clearway {

void Film::add(double time, const cv::Mat& picture) {
  if (video_) return video_->add(picture);
  waiting_.push_back(picture);
  times_.push_back(time);
  constexpr std::size_t enough = 16;
  if (times_.size() == enough) open();
}

void Film::add(const cv::Mat& picture) {
  if (!video_) open();
  video_->add(picture);
}

double Film::rate() {
  if (!video_) open();
  return rate_;
}

void Film::finish() {
  if (!video_) open();
  video_->finish();
}

void Film::open() {
  std::vector<double> gaps;
  for (std::size_t i = 1; i < times_.size(); ++i) gaps.push_back(times_[i] - times_[i - 1]);
  if (const double gap = gaps.empty() ? 0.0 : quantile(gaps, 0.5); gap > 0.0)
    rate_ = std::clamp(std::round(1.0 / gap), 2.0, 60.0);  // what players can show
  video_.emplace(file_, waiting_.front().cols, waiting_.front().rows, rate_);
  for (const cv::Mat& picture : waiting_) video_->add(picture);
  waiting_.clear();
}

}  // namespace clearway

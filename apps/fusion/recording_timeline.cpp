#include "apps/fusion/recording_timeline.hpp"

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace clearway {

void TimelineKeeper::see(const ImageFrame& image, const std::vector<TagDetection>& tags,
                         const PaintingSample* sample, double time) {
  if (timeline_.images.size() % stride_ == 0) keep(image, tags, time);
  timeline_.images.push_back(time);
  timeline_.tags.push_back(static_cast<std::uint8_t>(std::min<std::size_t>(tags.size(), 255)));
  timeline_.accepted.push_back(sample != nullptr && sample->accepted ? 1 : 0);
  if (sample != nullptr && !sample->accepted) return note_refusal(*sample, time);
  goes_on_ = false;
}

void TimelineKeeper::note_refusal(const PaintingSample& sample, double time) {
  std::vector<TimelineRefusal>& runs = timeline_.refusals;
  const std::string refusal = to_string(sample.refusal);
  if (goes_on_ && runs.back().refusal == refusal) {
    runs.back().to = time;
    ++runs.back().images;
    return;
  }
  goes_on_ = runs.size() < RecordingTimeline::most_refusals;
  if (goes_on_)
    runs.push_back({time, time, 1, refusal, sample.reason});
  else
    ++timeline_.refusals_left_out;
}

void TimelineKeeper::keep(const ImageFrame& image, const std::vector<TagDetection>& tags, double time) {
  const GrayImage& whole = image.image;
  if (whole.width <= 0 || whole.height <= 0 ||
      whole.pixels.size() != static_cast<std::size_t>(whole.width) * static_cast<std::size_t>(whole.height))
    return;
  const double shrink = std::min(1.0, static_cast<double>(RecordingTimeline::picture_width) / whole.width);
  const cv::Mat pixels(whole.height, whole.width, CV_8UC1, const_cast<std::uint8_t*>(whole.pixels.data()));
  cv::Mat small;
  const int height = std::max(1, static_cast<int>(shrink * whole.height));
  cv::resize(pixels, small, {std::max(1, static_cast<int>(shrink * whole.width)), height}, 0.0, 0.0,
             cv::INTER_AREA);
  kept_.push_back({time,
                   {small.cols, small.rows, {small.begin<std::uint8_t>(), small.end<std::uint8_t>()}},
                   tags,
                   shrink});
  if (kept_.size() < 2 * RecordingTimeline::most_pictures) return;
  for (std::size_t i = 1; 2 * i < kept_.size(); ++i) kept_[i] = std::move(kept_[2 * i]);
  kept_.resize(kept_.size() / 2);
  stride_ *= 2;
}

void TimelineKeeper::finish() {
  constexpr int quality = 55;
  const std::size_t most = RecordingTimeline::most_pictures, count = std::min(kept_.size(), most);
  for (std::size_t i = 0; i < count; ++i) {
    Kept& kept = kept_[i * kept_.size() / count];
    const cv::Mat gray(kept.image.height, kept.image.width, CV_8UC1, kept.image.pixels.data());
    cv::Mat picture;
    cv::cvtColor(gray, picture, cv::COLOR_GRAY2BGR);
    for (const TagDetection& tag : kept.tags) {
      std::vector<cv::Point> outline;
      for (const Eigen::Vector2d& corner : tag.corners)
        outline.emplace_back(static_cast<int>(kept.shrink * corner.x()),
                             static_cast<int>(kept.shrink * corner.y()));
      cv::polylines(picture, outline, true, {80, 200, 40}, 1, cv::LINE_AA);
    }
    std::vector<unsigned char> bytes;
    cv::imencode(".jpg", picture, bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
    timeline_.pictures.push_back({kept.time, {bytes.begin(), bytes.end()}});
  }
  kept_.clear();
}

}  // namespace clearway

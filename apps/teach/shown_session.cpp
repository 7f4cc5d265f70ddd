#include "apps/teach/shown_session.hpp"

#include <opencv2/imgcodecs.hpp>

#include "apps/console/parse.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {

std::string line_of(const TaughtEvent& event) {
  std::string line = significant(event.event.time, 6) + " s  " + std::string(to_string(event.event.action));
  if (!event.event.name.empty()) line += " " + shortened(event.event.name);
  if (!event.refusal.empty()) return line + " refused: " + event.refusal;
  return line + (event.remark.empty() ? "" : ": " + event.remark) + "  [" +
         std::string(to_string(event.state)) + "]";
}

void ShownSession::begin(const Setup& setup, FreeSpaceMap& map, const FusionCounts& counts) {
  session_.begin(setup, map, counts);
  viewer_.emplace(session_, setup, map, counts);
  screen_viewer_.emplace(session_, setup, map, counts);
}

void ShownSession::see(const SeenImage& image) {
  session_.see(image);
  const std::string moment = new_moment();
  const auto& frame = std::get<ImageFrame>(image.frame.content);
  if (screen_ != nullptr) {
    TeachView shown = screen_viewer_->view(image, frame);
    shown.more_keys = keys_;
    screen_->show(std::move(shown));
  }
  if (video_file_.empty() && moment.empty()) return;
  const TeachView view = viewer_->view(image, frame);
  const cv::Mat picture = painter_.draw(view);
  if (!video_file_.empty()) film_.add(view.since_start, picture);
  if (!moment.empty()) keep(picture, moment);
}

void ShownSession::finish_film() {
  if (!film_.is_empty()) film_.finish();
}

/// What was done since the last image and is worth a picture; empty for nothing.
std::string ShownSession::new_moment() {
  constexpr std::size_t most_pictures = 16;
  std::string moment;
  for (; shown_ < session_.events().size(); ++shown_) {
    const TaughtEvent& done = session_.events()[shown_];
    const TeachAction action = done.event.action;
    const bool is_worth_it = action == TeachAction::paint_off || action == TeachAction::start ||
                             action == TeachAction::goal || action == TeachAction::play ||
                             action == TeachAction::attach || action == TeachAction::detach ||
                             action == TeachAction::object_off || action == TeachAction::pick ||
                             action == TeachAction::place || action == TeachAction::approve;
    if (is_worth_it && pictures_.size() < most_pictures) moment = line_of(done);
  }
  return moment;
}

void ShownSession::keep(const cv::Mat& picture, const std::string& caption) {
  std::vector<unsigned char> bytes;
  cv::imencode(".jpg", picture, bytes, {cv::IMWRITE_JPEG_QUALITY, 88});
  pictures_.push_back({caption, std::string(bytes.begin(), bytes.end())});
}

}  // namespace clearway

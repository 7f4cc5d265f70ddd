#include "apps/teach/teach_screen.hpp"

#include <cstdlib>
#include <stdexcept>
#include <utility>

#include "apps/teach/teach_window.hpp"
#include "mapping/system/thread_time.hpp"

namespace clearway {

namespace {

TeachDisplay window_of(const std::string& title) {
  const auto window = std::make_shared<TeachWindow>(title);
  return {[window](const cv::Mat& picture) { window->show(picture); },
          [window] { return window->key(1); }};  // which also lets the window draw itself
}

}  // namespace

TeachScreen::TeachScreen(const std::string& title) : TeachScreen([title] { return window_of(title); }) {}

TeachScreen::TeachScreen(const std::function<TeachDisplay()>& open) {
  ::setenv("QT_LOGGING_RULES", "*=false", 0);  // HighGUI's parts log nothing
  worker_ = std::jthread([this, open] { run(open); });
  std::unique_lock lock(guard_);
  wake_.wait(lock, [this] { return is_open_ || !failure_.empty(); });
  if (!failure_.empty()) throw std::runtime_error(failure_);
}

TeachScreen::~TeachScreen() {
  {
    const std::lock_guard lock(guard_);
    is_ending_ = true;
  }
  wake_.notify_all();
}

void TeachScreen::show(TeachView view) {
  const std::lock_guard lock(guard_);
  if (next_) {  // what a view holds only when it changed goes on to the next one
    ++times_.dropped;
    if (!view.volumes) view.volumes = std::move(next_->volumes);
    if (!view.sensed) view.sensed = std::move(next_->sensed);
  }
  next_ = std::move(view);
  wake_.notify_all();
}

std::vector<int> TeachScreen::keys() {
  const std::lock_guard lock(guard_);
  return std::exchange(keys_, {});
}

ScreenTimes TeachScreen::times() const {
  const std::lock_guard lock(guard_);
  return times_;
}

void TeachScreen::run(const std::function<TeachDisplay()>& open) {
  TeachDisplay display;
  try {
    display = open();
  } catch (const std::exception& error) {
    const std::lock_guard lock(guard_);
    failure_ = error.what();
    wake_.notify_all();
    return;
  }
  TeachPainter painter(1);
  std::unique_lock lock(guard_);
  is_open_ = true;
  wake_.notify_all();
  while (!is_ending_) {
    wake_.wait_for(lock, std::chrono::milliseconds(10), [this] { return next_ || is_ending_; });
    std::optional<TeachView> view = std::exchange(next_, std::nullopt);
    lock.unlock();
    if (view) display.show(painter.draw(*view));
    const int key = display.key();
    lock.lock();
    if (view) times_.latencies.push_back(seconds_since(view->taken));
    if (key >= 0) keys_.push_back(key);
  }
}

}  // namespace clearway

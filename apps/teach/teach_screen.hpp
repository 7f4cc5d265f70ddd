#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "apps/teach/teach_picture.hpp"

namespace clearway {

/// How long pictures took, s, from when their image was there until they were shown.
struct ScreenTimes {
  std::vector<double> latencies;
  std::size_t dropped = 0;  ///< views that were replaced by newer ones before they were drawn
};

/// Where pictures are shown and keys come from.
struct TeachDisplay {
  std::function<void(const cv::Mat&)> show;
  std::function<int()> key;  ///< pressed within the next millisecond; below 0: none
};

/// Shows the newest view in a window, by a thread of its own, and collects the keys pressed there. What
/// cannot be drawn in time is left out: a session never waits for its picture.
class TeachScreen {
 public:
  /// @throws std::runtime_error when no window can be opened
  explicit TeachScreen(const std::string& title);
  /// Elsewhere than in a window. @param open called once, by the thread that will show @throws what it throws
  explicit TeachScreen(const std::function<TeachDisplay()>& open);
  ~TeachScreen();
  TeachScreen(const TeachScreen&) = delete;
  TeachScreen& operator=(const TeachScreen&) = delete;

  void show(TeachView view);
  /// Keys pressed since the last call, in order.
  std::vector<int> keys();
  ScreenTimes times() const;

 private:
  void run(const std::function<TeachDisplay()>& open);

  mutable std::mutex guard_;  ///< of what follows
  std::condition_variable wake_;
  std::optional<TeachView> next_;
  std::vector<int> keys_;
  ScreenTimes times_;
  std::string failure_;
  bool is_open_ = false, is_ending_ = false;
  std::jthread worker_;
};

}  // namespace clearway

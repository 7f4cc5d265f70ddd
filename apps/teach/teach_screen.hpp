#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
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

/// Shows the newest view in a window, by a thread of its own, and collects the keys pressed there. What
/// cannot be drawn in time is left out: a session never waits for its picture.
class TeachScreen {
 public:
  /// @throws std::runtime_error when no window can be opened
  explicit TeachScreen(const std::string& title);
  ~TeachScreen();
  TeachScreen(const TeachScreen&) = delete;
  TeachScreen& operator=(const TeachScreen&) = delete;

  void show(TeachView view);
  /// Keys pressed since the last call, in order.
  std::vector<int> keys();
  ScreenTimes times() const;

 private:
  void run(const std::string& title);

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

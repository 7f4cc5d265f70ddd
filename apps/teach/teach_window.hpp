#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>

namespace clearway {

/// Whether a window can be opened here: the environment names a display, and it answers within 10 s.
bool has_display();

/// As large as a picture is shown: not larger than it is, and whole on a screen of this size, beside the
/// window's frame and title, its ratio kept.
cv::Size shown_size(const cv::Size& picture, const cv::Size& screen);

/// A window of OpenCV's HighGUI, whose library is loaded by the first one. Used by one thread.
class TeachWindow {
 public:
  /// @throws std::runtime_error in one clause when the library is missing
  explicit TeachWindow(const std::string& title);
  ~TeachWindow();
  TeachWindow(const TeachWindow&) = delete;
  TeachWindow& operator=(const TeachWindow&) = delete;

  /// A picture that the screen does not hold is shown smaller. @param picture CV_8UC3 (BGR) or CV_8UC1
  void show(const cv::Mat& picture);
  /// The key that was pressed in the window, waiting for it so long, ms at least 1; -1: none.
  int key(int milliseconds);

 private:
  std::string title_;
  std::shared_ptr<void> display_;  ///< of X; it is not left while there is a window
  cv::Size screen_;
};

}  // namespace clearway

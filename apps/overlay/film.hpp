#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "apps/overlay/video_file.hpp"

namespace clearway {

/// A video that lasts as long as the pictures' times: its rate is constant, because players expect it, and a
/// picture is repeated until it is time for the next. The rate follows from the first pictures: they wait for
/// it.
class Film {
 public:
  explicit Film(const std::filesystem::path& file) : file_(file) {}

  /// A picture of that time, s, rising; a gap of more than ten minutes counts as none.
  /// @throws std::runtime_error as VideoFile
  void add(double time, const cv::Mat& picture);
  /// A picture after those with times. @pre there is one
  void add(const cv::Mat& picture);
  /// Pictures a second. @pre a picture was added
  double rate();
  /// @pre a picture was added
  void finish();
  bool is_empty() const { return !video_ && waiting_.empty(); }

 private:
  void open();
  void place(double time, const cv::Mat& picture);
  void show(std::int64_t until);

  std::filesystem::path file_;
  std::vector<cv::Mat> waiting_;
  std::vector<double> times_;  ///< of those that wait
  double rate_ = 15.0;
  std::optional<VideoFile> video_;
  cv::Mat shown_;  ///< waits for the time of the next one; empty: none does
  double start_ = 0.0, last_ = 0.0;
  std::int64_t next_ = 0;  ///< place of `shown_` in the video
};

}  // namespace clearway

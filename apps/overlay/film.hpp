#pragma once

#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "apps/overlay/video_file.hpp"

namespace clearway {

/// A video whose rate follows from its first pictures: they wait for it.
class Film {
 public:
  explicit Film(const std::filesystem::path& file) : file_(file) {}

  /// A picture of that time, s, rising. @throws std::runtime_error as VideoFile
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

  std::filesystem::path file_;
  std::vector<cv::Mat> waiting_;
  std::vector<double> times_;
  double rate_ = 15.0;
  std::optional<VideoFile> video_;
};

}  // namespace clearway

#pragma once

#include <filesystem>
#include <memory>

namespace cv {
class Mat;
}

namespace clearway {

/// An .mp4 file that appears under its name whole or not at all. H.264 where the system's OpenCV can write
/// it, else MPEG-4.
class VideoFile {
 public:
  /// @param rate pictures per second
  /// @throws std::runtime_error when there is no encoder or no room
  VideoFile(const std::filesystem::path& file, int width, int height, double rate);
  ~VideoFile();
  VideoFile(const VideoFile&) = delete;
  VideoFile& operator=(const VideoFile&) = delete;

  /// @param picture CV_8UC3 (BGR) of the size; an odd last row or column is left out
  void add(const cv::Mat& picture);
  /// Nothing may be added afterwards. @throws std::runtime_error naming the file and the reason
  void finish();

 private:
  struct State;
  std::filesystem::path file_;
  int width_, height_;  ///< even
  std::unique_ptr<State> state_;
};

}  // namespace clearway

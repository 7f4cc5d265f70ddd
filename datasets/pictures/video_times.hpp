#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace clearway {

/// What the container of a video says of its pictures, none of them decoded.
struct VideoTimes {
  std::vector<double>
      times;  ///< s from the stream's begin, not falling: of the pictures that are shown; or empty
  std::size_t shown = 0;   ///< pictures that are in the file, without those that an edit hides, and `leading`
  std::size_t stated = 0;  ///< pictures that the container says it has; 0: it does not say
  bool is_cut = false;     ///< the file ends before it should
  bool is_time_reported = false;  ///< the times that OpenCV reports, those of decoding, are those of showing
  std::size_t leading = 0;        ///< the first ones, which need pictures that are not in the file
};

/// Reads the packets of the first video stream (FFmpeg's libavformat, which comes with OpenCV's videoio), for
/// OpenCV 4.6 does not say when pictures are shown: it reports the decoding times of packets, and none of the
/// last pictures, where some are stored in another order. Where a container has no times of showing (AVI),
/// those of decoding are in their place. For a DecodingChild.
/// @throws std::runtime_error a clause that says why it cannot be read
VideoTimes read_video_times(const std::string& file);

/// Gives each picture that is decoded its time.
class PictureClock {
 public:
  /// @param rate pictures a second, where the video has no times
  PictureClock(VideoTimes video, double rate) : video_(std::move(video)), rate_(rate) {}

  /// Of the next picture, s; empty when there are more pictures than times.
  /// @param reported by OpenCV for it, s: tells where pictures are missing that could not be decoded
  std::optional<double> next(double reported);

  /// Whether it would tell where pictures are missing.
  bool sees_gaps() const { return video_.is_time_reported; }

 private:
  VideoTimes video_;
  double rate_;
  std::size_t number_ = 0;
};

}  // namespace clearway

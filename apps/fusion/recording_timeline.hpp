#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "datasets/sources/recording.hpp"
#include "tracking/probe.hpp"

namespace clearway {

/// An image of the recording, small, with the tags that were found drawn into it.
struct TimelinePicture {
  double time = 0.0;  ///< s since the first frame, as all times here
  std::string jpeg;   ///< the file's bytes
};

/// Images one after the other that painted nothing for the same reason.
struct TimelineRefusal {
  double from = 0.0, to = 0.0;
  int images = 0;
  std::string refusal;  ///< as Refusal's words are
  std::string reason;   ///< the first image's sentence
};

/// What happened when in a recording, as its page shows it.
struct RecordingTimeline {
  double start = 0.0;  ///< of the first frame, s by the recording's own clock
  std::vector<double> images;
  std::vector<std::uint8_t> tags;      ///< found in each image; 255: as many or more
  std::vector<std::uint8_t> accepted;  ///< whether each image's sample painted: 1 yes, 0 no
  std::vector<TimelineRefusal> refusals;
  std::size_t refusals_left_out = 0;  ///< runs beyond most_refusals
  std::vector<double> scans;
  std::vector<TimelinePicture> pictures;  ///< evenly chosen

  static constexpr std::size_t most_refusals = 1000, most_pictures = 32;
  static constexpr int picture_width = 240;  ///< pixels, of images that are wider
};

/// Makes a timeline of what a fusion sees, in its order. Memory: a small image for each of 2 most_pictures.
class TimelineKeeper {
 public:
  explicit TimelineKeeper(RecordingTimeline& timeline) : timeline_(timeline) {}

  void start_at(double time) { timeline_.start = time; }
  /// @param sample null without a probe
  void see(const ImageFrame& image, const std::vector<TagDetection>& tags, const PaintingSample* sample,
           double time);
  void see_scan(double time) { timeline_.scans.push_back(time); }
  /// Encodes the pictures. To be called once, at the end.
  void finish();

 private:
  struct Kept {
    double time;
    GrayImage image;  ///< shrunk
    std::vector<TagDetection> tags;
    double shrink;
  };
  void note_refusal(const PaintingSample& sample, double time);
  void keep(const ImageFrame& image, const std::vector<TagDetection>& tags, double time);

  RecordingTimeline& timeline_;
  std::vector<Kept> kept_;
  std::size_t stride_ = 1;  ///< each stride-th image is kept
  bool goes_on_ = false;    ///< the image before was refused, too, in the last run
};

}  // namespace clearway

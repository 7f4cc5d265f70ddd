#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace clearway {

/// One tag seen in one image.
struct TagDetection {
  int id = -1;
  int hamming = 0;               ///< bits corrected
  double decision_margin = 0.0;  ///< grey levels between data bits and their threshold, mean

  /// Corners of the square whose edge the family's border is (tag36h11: the black one), in pixels with the
  /// centre of the upper left pixel at (0, 0): OpenCV's convention, that is apriltag's minus 0.5. Their order
  /// is apriltag's p[3], p[2], p[1], p[0]: upper left, upper right, lower right, lower left of the upright
  /// tag, so that they belong to the object points (-h, h), (h, h), (h, -h), (-h, -h) of OpenCV's IPPE-square
  /// (h half the side), in the tag frame with x to the right, y up and z out of the tag towards the viewer.
  /// Turning the order gives another pose with the same reprojection error: nothing downstream can notice.
  std::array<Eigen::Vector2d, 4> corners;
};

struct TagDetectorOptions {
  std::string family = "tag36h11";  ///< one of tag_families()
  int decimate = 1;          ///< 1, or 2: quads are found in the image at half size: twice as fast, less far
  int threads = 1;           ///< 1 to 64; the result does not depend on it
  double sigma = 0.0;        ///< Gaussian blur before quads are searched, pixels; 0.8 helps noisy images
  bool refine_edges = true;  ///< fit the quad's edges to the grey gradient: corner accuracy
  double sharpening = 0.25;  ///< of the bits before decoding; helps small tags
  int max_hamming = 1;  ///< bits that may be corrected, 0 to 2; 2 finds tags in noise (1 in 1,000 images)
  double min_margin = 30.0;     ///< detections with a smaller decision margin are dropped
  double border = 2.0;          ///< pixels: a tag with a corner nearer to the border is dropped (may be cut)
  bool drop_duplicates = true;  ///< an id seen twice in one image is dropped: which one is ours is not known
};

/// What one `detect` found and left out.
struct TagDetectorCounts {
  std::int64_t detected = 0, low_margin = 0, at_border = 0, duplicate = 0;
};

/// The families whose tags are found, sorted: those of apriltag 3 with at most some thousand codes.
std::vector<std::string> tag_families();

/// Finds tags of one family (Olson; apriltag 3). One detector belongs to one thread: two threads
/// in one detector crash; any number of detectors may run side by side.
class TagDetector {
 public:
  /// Throws std::invalid_argument naming the option that is out of its range.
  explicit TagDetector(const TagDetectorOptions& options = {});
  ~TagDetector();
  TagDetector(TagDetector&&) noexcept;
  TagDetector& operator=(TagDetector&&) noexcept;

  /// The tags in a grey image, sorted by id (then by place). Throws std::invalid_argument unless the image
  /// is CV_8UC1, both sides are at least 32 pixels after decimation and at most 20,000, and it has at most
  /// 64 million pixels: smaller images crash apriltag, larger ones exhaust the memory.
  std::vector<TagDetection> detect(const cv::Mat& gray);

  /// Summed over all calls; `duplicate` counts detections, not ids.
  const TagDetectorCounts& counts() const;
  const TagDetectorOptions& options() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// True when `detect` with this decimation would take the image; the reason is in the exception otherwise.
bool is_detectable(const cv::Mat& gray, int decimate);

}  // namespace clearway

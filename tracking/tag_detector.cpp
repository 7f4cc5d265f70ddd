#include "tracking/tag_detector.hpp"

#include <apriltag/apriltag.h>
#include <apriltag/tag16h5.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h10.h>
#include <apriltag/tag36h11.h>
#include <apriltag/tagCircle21h7.h>
#include <apriltag/tagStandard41h12.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <string>

#include "tracking/validation.hpp"

namespace clearway {
namespace {

constexpr int kMinSide = 32, kMaxSide = 20000;
constexpr std::int64_t kMaxPixels = 64'000'000;
constexpr double kPixelCentre = 0.5;  // apriltag's pixel (0, 0) covers [0, 1): its centre is at 0.5

/// How apriltag makes and frees a family.
struct FamilyCode {
  apriltag_family_t* (*create)();
  void (*destroy)(apriltag_family_t*);
};

const std::map<std::string, FamilyCode>& family_codes() {
  static const std::map<std::string, FamilyCode> codes{
      {"tag16h5", {tag16h5_create, tag16h5_destroy}},
      {"tag25h9", {tag25h9_create, tag25h9_destroy}},
      {"tag36h10", {tag36h10_create, tag36h10_destroy}},
      {"tag36h11", {tag36h11_create, tag36h11_destroy}},
      {"tagCircle21h7", {tagCircle21h7_create, tagCircle21h7_destroy}},
      {"tagStandard41h12", {tagStandard41h12_create, tagStandard41h12_destroy}}};
  return codes;
}

using Family = std::unique_ptr<apriltag_family_t, void (*)(apriltag_family_t*)>;

Family make_family(const std::string& name) {
  const FamilyCode& code = family_codes().at(name);
  return {code.create(), code.destroy};
}

struct DetectorDeleter {
  void operator()(apriltag_detector_t* detector) const { apriltag_detector_destroy(detector); }
};
struct DetectionsDeleter {
  void operator()(zarray_t* detections) const { apriltag_detections_destroy(detections); }
};

void validate(const TagDetectorOptions& o) {
  require(family_codes().contains(o.family), "tag detector: family", "one of apriltag's smaller families");
  require(o.decimate == 1 || o.decimate == 2, "tag detector: decimate", "1 or 2");
  require(o.threads >= 1 && o.threads <= 64, "tag detector: threads", "1 to 64");
  require(o.sigma >= 0.0 && o.sigma <= 5.0, "tag detector: sigma", "0 to 5 pixels");
  require(o.sharpening >= 0.0 && o.sharpening <= 10.0, "tag detector: sharpening", "0 to 10");
  require(o.max_hamming >= 0 && o.max_hamming <= 2, "tag detector: max_hamming", "0 to 2 bits");
  require(o.min_margin >= 0.0 && o.min_margin <= 255.0, "tag detector: min_margin", "0 to 255 grey levels");
  require(o.border >= 0.0 && std::isfinite(o.border), "tag detector: border", "0 pixels or more");
}

// Grey levels between dark and bright below which apriltag searches a place for no tag; `usual` is its own.
// Bits lie at most half of the tag's contrast from their threshold, and apriltag's Laplacian, times the
// sharpening, adds up to eight times that (a bit among four others): a tag of margin m has a contrast of
// 2 m / (1 + 8 sharpening) at least. Three quarters of it, at most half the margin, leave room for shading.
// What is left out is a camera's noise, each speck of which apriltag would trace.
int least_contrast(const TagDetectorOptions& options, int usual) {
  const double share = std::min(0.5, 1.5 / (1.0 + 8.0 * options.sharpening));
  return std::max(usual, static_cast<int>(share * options.min_margin));
}

TagDetection from_apriltag(const apriltag_detection_t& found) {
  TagDetection tag{found.id, found.hamming, found.decision_margin, {}};
  for (int i = 0; i < 4; ++i)
    tag.corners[i] = Eigen::Vector2d(found.p[3 - i][0] - kPixelCentre, found.p[3 - i][1] - kPixelCentre);
  return tag;
}

bool is_inside(const TagDetection& tag, const cv::Mat& image, double border) {
  return std::all_of(tag.corners.begin(), tag.corners.end(), [&](const Eigen::Vector2d& c) {
    return c.x() >= border - kPixelCentre && c.x() <= image.cols - kPixelCentre - border &&
           c.y() >= border - kPixelCentre && c.y() <= image.rows - kPixelCentre - border;
  });
}

bool comes_before(const TagDetection& a, const TagDetection& b) {
  if (a.id != b.id) return a.id < b.id;
  if (a.corners[0].x() != b.corners[0].x()) return a.corners[0].x() < b.corners[0].x();
  return a.corners[0].y() < b.corners[0].y();
}

// Drops every detection of an id that was seen more than once in `tags` (sorted); returns how many.
std::int64_t drop_duplicates(std::vector<TagDetection>& tags) {
  std::vector<TagDetection> single;
  for (std::size_t i = 0; i < tags.size(); ++i) {
    const bool as_before = i > 0 && tags[i - 1].id == tags[i].id;
    const bool as_next = i + 1 < tags.size() && tags[i + 1].id == tags[i].id;
    if (!as_before && !as_next) single.push_back(tags[i]);
  }
  const auto dropped = static_cast<std::int64_t>(tags.size() - single.size());
  tags = std::move(single);
  return dropped;
}

}  // namespace

std::vector<std::string> tag_families() {
  std::vector<std::string> names;
  for (const auto& [name, code] : family_codes()) names.push_back(name);
  return names;
}

struct TagDetector::Impl {
  explicit Impl(const TagDetectorOptions& how) : options(how) {}

  TagDetectorOptions options;
  TagDetectorCounts counts;
  Family family = make_family(options.family);
  std::unique_ptr<apriltag_detector_t, DetectorDeleter> detector{apriltag_detector_create()};
};

TagDetector::TagDetector(const TagDetectorOptions& options) {
  validate(options);
  impl_ = std::make_unique<Impl>(options);
  apriltag_detector_t& detector = *impl_->detector;
  detector.nthreads = options.threads;
  detector.quad_decimate = static_cast<float>(options.decimate);
  detector.quad_sigma = static_cast<float>(options.sigma);
  detector.refine_edges = options.refine_edges;
  detector.decode_sharpening = options.sharpening;
  detector.qtp.min_white_black_diff = least_contrast(options, detector.qtp.min_white_black_diff);
  apriltag_detector_add_family_bits(&detector, impl_->family.get(), options.max_hamming);
}

TagDetector::~TagDetector() = default;
TagDetector::TagDetector(TagDetector&&) noexcept = default;
TagDetector& TagDetector::operator=(TagDetector&&) noexcept = default;

const TagDetectorCounts& TagDetector::counts() const { return impl_->counts; }
const TagDetectorOptions& TagDetector::options() const { return impl_->options; }

bool is_detectable(const cv::Mat& gray, int decimate) {
  const int smallest = std::min(gray.rows, gray.cols), largest = std::max(gray.rows, gray.cols);
  return gray.dims == 2 && gray.type() == CV_8UC1 && gray.data && smallest >= kMinSide * decimate &&
         largest <= kMaxSide && static_cast<std::int64_t>(gray.rows) * gray.cols <= kMaxPixels;
}

std::vector<TagDetection> TagDetector::detect(const cv::Mat& gray) {
  const TagDetectorOptions& options = impl_->options;
  if (!is_detectable(gray, options.decimate))
    throw std::invalid_argument("tag detector: image of " + std::to_string(gray.cols) + " x " +
                                std::to_string(gray.rows) + " pixels, type " + std::to_string(gray.type()) +
                                ", expected 8-bit grey of 32 to 20000 pixels a side after decimation");
  const cv::Mat own = options.sigma > 0.0 ? gray.clone() : gray;  // apriltag blurs what it is given
  image_u8_t image{own.cols, own.rows, static_cast<int>(own.step[0]), own.data};
  const std::unique_ptr<zarray_t, DetectionsDeleter> found(
      apriltag_detector_detect(impl_->detector.get(), &image));
  std::vector<TagDetection> tags;
  for (int i = 0; i < zarray_size(found.get()); ++i) {
    const apriltag_detection_t* detection = nullptr;
    zarray_get(found.get(), i, &detection);
    const TagDetection tag = from_apriltag(*detection);
    if (tag.decision_margin < options.min_margin) {
      ++impl_->counts.low_margin;
    } else if (!is_inside(tag, gray, options.border)) {
      ++impl_->counts.at_border;
    } else {
      tags.push_back(tag);
    }
  }
  std::sort(tags.begin(), tags.end(), comes_before);
  if (options.drop_duplicates) impl_->counts.duplicate += drop_duplicates(tags);
  impl_->counts.detected += static_cast<std::int64_t>(tags.size());
  return tags;
}

}  // namespace clearway

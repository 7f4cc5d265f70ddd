#include "tracking/tag_detector.hpp"

#include <apriltag/apriltag.h>
#include <apriltag/tag16h5.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h10.h>
#include <apriltag/tag36h11.h>
#include <apriltag/tagCircle21h7.h>
#include <apriltag/tagStandard41h12.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <sstream>
#include <stdexcept>

#include "tests/worlds/tag_scene.hpp"
#include "tests/worlds/trials.hpp"

namespace clearway {
namespace tag_detector_test {

using scene::PlacedTag;

std::vector<PlacedTag> tags_at_all_tilts(double x_reach, double y_reach) {
  std::vector<PlacedTag> tags;
  for (int i = 0; i < 12; ++i) {
    const double x = x_reach * (i % 4 - 1.5) / 1.5, y = y_reach * (i / 4 - 1.0);
    tags.push_back({20 + i, 0.06, scene::tag_before_camera(0.6, 0.08 * i, 0.9 * i, 0.5 * i, x, y)});
  }
  return tags;
}

// Root mean square distance of the detected corners to the true ones, over all tags; checks the ids.
double corner_rms(const Camera& camera, const std::vector<PlacedTag>& tags, const cv::Mat& image,
                  const TagDetectorOptions& options) {
  const auto found = TagDetector(options).detect(image);
  EXPECT_EQ(found.size(), tags.size());
  double sum = 0.0;
  for (std::size_t i = 0; i < found.size() && i < tags.size(); ++i) {
    EXPECT_EQ(found[i].id, tags[i].id);
    const auto truth = scene::true_corners(camera, tags[i]);
    for (int k = 0; k < 4; ++k) sum += (found[i].corners[k] - truth[k]).squaredNorm();
  }
  return std::sqrt(sum / (4.0 * static_cast<double>(found.size())));
}

TEST(TagDetector, corners_lie_within_a_tenth_of_a_pixel_of_rendered_truth_in_opencv_pixels_and_print_order) {
  const auto tags = tags_at_all_tilts(0.21, 0.15);
  const Camera camera = scene::plain_camera();
  const double rms = corner_rms(camera, tags, scene::render(camera, tags), {});
  RecordProperty("rms_px_times_1000", static_cast<int>(1000 * rms));
  EXPECT_LT(rms, 0.1);
}

/// An upright tag as apriltag itself prints it, enlarged and blurred; the square's upper left corner and
/// side, pixels from the image's corner.
struct Print {
  cv::Mat image;
  double left = 0.0, side = 0.0;
};

Print print_of(apriltag_family_t* family, int id) {
  image_u8_t* cells = apriltag_to_image(family, static_cast<std::uint32_t>(id));
  const cv::Mat small(cells->height, cells->width, CV_8UC1, cells->buf,
                      static_cast<std::size_t>(cells->stride));
  constexpr int cell = 16, margin = 3 * cell;
  Print print;
  cv::Mat large;
  cv::resize(small, large, {}, cell, cell, cv::INTER_NEAREST);
  cv::copyMakeBorder(large, print.image, margin, margin, margin, margin, cv::BORDER_CONSTANT,
                     cv::Scalar(255));
  cv::GaussianBlur(print.image, print.image, {}, 1.0);
  print.side = cell * family->width_at_border;
  print.left = margin + 0.5 * cell * (family->total_width - family->width_at_border);
  std::free(cells->buf);
  std::free(cells);
  return print;
}

TEST(TagDetector, each_family_is_read_from_its_own_print_with_the_corners_in_print_order) {
  const std::map<std::string, std::pair<apriltag_family_t* (*)(), void (*)(apriltag_family_t*)>> families{
      {"tag16h5", {tag16h5_create, tag16h5_destroy}},
      {"tag25h9", {tag25h9_create, tag25h9_destroy}},
      {"tag36h10", {tag36h10_create, tag36h10_destroy}},
      {"tag36h11", {tag36h11_create, tag36h11_destroy}},
      {"tagCircle21h7", {tagCircle21h7_create, tagCircle21h7_destroy}},
      {"tagStandard41h12", {tagStandard41h12_create, tagStandard41h12_destroy}}};
  ASSERT_EQ(tag_families().size(), families.size());
  for (const std::string& name : tag_families()) {
    apriltag_family_t* family = families.at(name).first();
    for (const int id : {0, 7, static_cast<int>(family->ncodes) - 1}) {
      const Print print = print_of(family, id);
      const auto found = TagDetector({.family = name}).detect(print.image);
      ASSERT_EQ(found.size(), 1U) << name << ' ' << id;
      EXPECT_EQ(found[0].id, id) << name;
      const double low = print.left - 0.5, high = low + print.side;
      const Eigen::Vector2d corners[] = {{low, low}, {high, low}, {high, high}, {low, high}};
      for (std::size_t k = 0; k < 4; ++k)
        EXPECT_LT((found[0].corners[k] - corners[k]).norm(), 0.5) << name << ' ' << id << ' ' << k;
      const bool is_default = name == "tag36h11";
      EXPECT_EQ(TagDetector().detect(print.image).empty(), !is_default) << name;
    }
    families.at(name).second(family);
  }
  EXPECT_THROW(TagDetector({.family = "tag16h6"}), std::invalid_argument);
}

TEST(TagDetector, corners_lie_within_a_tenth_of_a_pixel_under_lens_distortion) {
  const auto tags = tags_at_all_tilts(0.2, 0.14);
  const Camera camera = scene::distorted_camera();
  const double rms = corner_rms(camera, tags, scene::render(camera, tags), {});
  RecordProperty("rms_px_times_1000", static_cast<int>(1000 * rms));
  EXPECT_LT(rms, 0.1);
}

TEST(TagDetector, stays_within_a_quarter_of_a_pixel_under_strong_noise_blur_and_decimation) {
  const auto tags = tags_at_all_tilts(0.2, 0.14);
  const Camera camera = scene::plain_camera();
  TagDetectorOptions halved;
  halved.decimate = 2;
  EXPECT_LT(corner_rms(camera, tags, scene::render(camera, tags, {4, 1.5, 2.0, 5}), {}), 0.25);
  EXPECT_LT(corner_rms(camera, tags, scene::render(camera, tags, {4, 0.6, 10.0, 6}), {}), 0.25);
  EXPECT_LT(corner_rms(camera, tags, scene::render(camera, tags), halved), 0.25);
}

bool are_equal(const std::vector<TagDetection>& a, const std::vector<TagDetection>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const TagDetection& x, const TagDetection& y) {
    return x.id == y.id && x.hamming == y.hamming && x.decision_margin == y.decision_margin &&
           x.corners == y.corners;
  });
}

TEST(TagDetector, gives_the_same_bits_again_and_with_one_or_four_threads) {
  const auto tags = tags_at_all_tilts(0.2, 0.14);
  const cv::Mat image = scene::render(scene::plain_camera(), tags);
  TagDetectorOptions four;
  four.threads = 4;
  TagDetector one, many(four);
  const auto first = one.detect(image);
  ASSERT_EQ(first.size(), tags.size());
  for (int i = 0; i < 5; ++i) {
    EXPECT_TRUE(are_equal(first, one.detect(image)));
    EXPECT_TRUE(are_equal(first, many.detect(image)));
  }
}

TEST(TagDetector, leaves_the_image_as_it_was) {
  const auto tags = tags_at_all_tilts(0.2, 0.14);
  const cv::Mat image = scene::render(scene::plain_camera(), tags), before = image.clone();
  for (double sigma : {0.0, 0.8})
    for (int decimate : {1, 2}) {
      TagDetectorOptions options;
      options.sigma = sigma;
      options.decimate = decimate;
      EXPECT_EQ(TagDetector(options).detect(image).size(), tags.size());
      EXPECT_EQ(cv::norm(image, before, cv::NORM_L1), 0.0) << sigma << " " << decimate;
    }
}

TEST(TagDetector, what_is_too_dim_to_be_searched_would_have_been_dropped_for_its_margin) {
  std::mt19937 random(23);
  const auto within = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  struct Sharpened {
    double by, least, most;  ///< contrasts at which tags come near the least margin
  };
  for (const auto& [sharpening, least, most] :
       {Sharpened{0.0, 0.2, 0.5}, {0.25, 0.15, 0.4}, {2.0, 0.015, 0.07}}) {
    TagDetectorOptions asked, all;
    asked.sharpening = all.sharpening = sharpening;
    all.min_margin = 0.0;
    TagDetector dropping(asked), searching(all);
    std::size_t tags = 0, dim = 0;
    for (unsigned i = 0; i < static_cast<unsigned>(trials(12, 100)); ++i) {
      const Camera camera = scene::plain_camera();
      const auto placed = tags_at_all_tilts(within(0.2, 0.5), within(0.15, 0.4));
      cv::Mat image = scene::render(camera, placed, {3, within(0.4, 1.6), within(0.0, 4.0), i});
      const double contrast = within(least, most);
      image.convertTo(image, CV_8UC1, contrast, within(0.0, 255.0 * (1.0 - contrast)));
      auto expected = searching.detect(image);
      dim += std::erase_if(expected,
                           [&](const TagDetection& tag) { return tag.decision_margin < asked.min_margin; });
      const auto found = dropping.detect(image);
      ASSERT_EQ(found.size(), expected.size()) << sharpening << " image " << i;
      for (std::size_t k = 0; k < found.size(); ++k) {
        EXPECT_EQ(found[k].id, expected[k].id);
        for (int c = 0; c < 4; ++c)
          EXPECT_LT((found[k].corners[c] - expected[k].corners[c]).norm(), 0.1)
              << sharpening << " image " << i;
      }
      tags += found.size();
    }
    EXPECT_GT(tags, 20u) << sharpening;
    EXPECT_GT(dim, 2u) << sharpening;
  }
}

TEST(TagDetector, reads_a_part_of_a_larger_image_without_copying_it) {
  const auto tags = tags_at_all_tilts(0.2, 0.14);
  const cv::Mat image = scene::render(scene::plain_camera(), tags);
  cv::Mat larger(700, 900, CV_8UC1, cv::Scalar(70));
  cv::Mat part = larger(cv::Rect(100, 90, 640, 480));
  image.copyTo(part);
  ASSERT_FALSE(part.isContinuous());
  EXPECT_TRUE(are_equal(TagDetector().detect(part), TagDetector().detect(image)));
}

TEST(TagDetector, finds_no_tag_in_200_images_of_noise_blocks_and_random_quads) {
  std::mt19937 random(17);
  TagDetector detector;
  for (int i = 0; i < 200; ++i) {
    cv::RNG rng(random());
    cv::Mat image(240, 320, CV_8UC1);
    rng.fill(image, cv::RNG::UNIFORM, 0, 256);
    if (i % 4 == 1)
      cv::GaussianBlur(image, image, cv::Size(), 1.5), cv::normalize(image, image, 0, 255, cv::NORM_MINMAX);
    if (i % 4 == 2)
      cv::resize(image(cv::Rect(0, 0, 40, 30)).clone(), image, image.size(), 0, 0, cv::INTER_NEAREST);
    if (i % 4 == 3) {  // black squares filled with random bits on white: tags of no family
      image.setTo(230);
      for (int k = 0; k < 12; ++k) {
        cv::Mat bits(8, 8, CV_8UC1, cv::Scalar(20)), inside = bits(cv::Rect(1, 1, 6, 6));
        rng.fill(inside, cv::RNG::UNIFORM, 0, 2);
        inside = inside * 210 + 20;
        cv::Mat place = image(cv::Rect(12 + 76 * (k % 4), 12 + 76 * (k / 4), 56, 56));
        cv::resize(bits, place, place.size(), 0, 0, cv::INTER_NEAREST);
      }
    }
    EXPECT_TRUE(detector.detect(image).empty()) << "image " << i;
  }
}

TEST(TagDetector, drops_both_tags_of_one_id_and_counts_them) {
  const std::vector<PlacedTag> tags = {{5, 0.06, scene::tag_before_camera(0.6, 0.1, 0, 0, -0.1)},
                                       {5, 0.06, scene::tag_before_camera(0.6, 0.1, 0, 0, 0.1)},
                                       {9, 0.06, scene::tag_before_camera(0.6, 0.1, 0, 0, 0.0, 0.12)}};
  const cv::Mat image = scene::render(scene::plain_camera(), tags);
  TagDetector detector;
  const auto found = detector.detect(image);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].id, 9);
  EXPECT_EQ(detector.counts().duplicate, 2);
  EXPECT_EQ(detector.counts().detected, 1);
  TagDetectorOptions keep;
  keep.drop_duplicates = false;
  EXPECT_EQ(TagDetector(keep).detect(image).size(), 3u);
}

TEST(TagDetector, never_reports_a_tag_that_the_image_border_cuts) {
  const Camera camera = scene::plain_camera();
  TagDetector detector;
  for (int i = 0; i < 30; ++i) {
    const PlacedTag tag{7, 0.08, scene::tag_before_camera(0.5, 0.2, 0.3, 0.04 * i, -0.27 + 0.0024 * i)};
    const auto truth = scene::true_corners(camera, tag);
    const bool is_cut =
        std::any_of(truth.begin(), truth.end(), [&](const auto& c) { return !camera.sees(c); });
    const auto found = detector.detect(scene::render(camera, {tag}));
    if (is_cut) {
      EXPECT_TRUE(found.empty()) << i;
    }
    for (const TagDetection& detection : found)
      for (int k = 0; k < 4; ++k) EXPECT_LT((detection.corners[k] - truth[k]).norm(), 0.5) << i;
  }
}

TEST(TagDetector, refuses_images_that_crash_apriltag) {
  TagDetector whole;
  TagDetectorOptions options;
  options.decimate = 2;
  TagDetector halved(options);
  for (const cv::Size& size :
       {cv::Size(0, 0), cv::Size(1, 1), cv::Size(2, 2), cv::Size(3, 3), cv::Size(640, 1), cv::Size(31, 480),
        cv::Size(20000, 4), cv::Size(20001, 64), cv::Size(9000, 9000)}) {
    EXPECT_THROW(whole.detect(cv::Mat::zeros(size, CV_8UC1)), std::invalid_argument) << size;
    EXPECT_THROW(halved.detect(cv::Mat::zeros(size, CV_8UC1)), std::invalid_argument) << size;
  }
  EXPECT_THROW(halved.detect(cv::Mat::zeros(63, 640, CV_8UC1)), std::invalid_argument);
  for (int type : {CV_8UC3, CV_16UC1, CV_32FC1, CV_8SC1, CV_64FC1})
    EXPECT_THROW(whole.detect(cv::Mat::zeros(480, 640, type)), std::invalid_argument) << type;
  const int sides[] = {64, 64, 64};
  EXPECT_THROW(whole.detect(cv::Mat(3, sides, CV_8UC1, cv::Scalar(0))), std::invalid_argument);
}

TEST(TagDetector, survives_every_smallest_and_narrowest_image_it_accepts) {
  std::mt19937 random(19);
  for (int decimate : {1, 2}) {
    TagDetectorOptions options;
    options.decimate = decimate;
    TagDetector detector(options);
    const int least = 32 * decimate;
    for (const cv::Size& size : {cv::Size(least, least), cv::Size(least + 1, least),
                                 cv::Size(least, least + 3), cv::Size(20000, least), cv::Size(least, 19999)})
      for (int kind = 0; kind < 3; ++kind) {
        cv::Mat image(size, CV_8UC1, cv::Scalar(kind == 0 ? 0 : 255));
        if (kind == 2) cv::RNG(random()).fill(image, cv::RNG::UNIFORM, 0, 256);
        EXPECT_TRUE(detector.detect(image).empty());
      }
  }
}

TEST(TagDetector, refuses_each_option_out_of_its_range) {
  const auto with = [](auto spoil) {
    TagDetectorOptions options;
    spoil(options);
    return options;
  };
  const TagDetectorOptions faults[] = {
      with([](auto& o) { o.decimate = 0; }),     with([](auto& o) { o.decimate = 3; }),
      with([](auto& o) { o.threads = 0; }),      with([](auto& o) { o.sigma = -1; }),
      with([](auto& o) { o.sharpening = -1; }),  with([](auto& o) { o.max_hamming = 3; }),
      with([](auto& o) { o.max_hamming = -1; }), with([](auto& o) { o.min_margin = NAN; }),
      with([](auto& o) { o.border = -1; })};
  for (const TagDetectorOptions& options : faults) EXPECT_THROW(TagDetector{options}, std::invalid_argument);
}

// The three photographs that AprilTag tests itself with, and their corners (its own pixels and order).
using Corners = std::array<Eigen::Vector2d, 4>;

std::vector<Corners> corners_in(const std::filesystem::path& file) {
  std::vector<Corners> tags;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    std::replace_if(
        line.begin(), line.end(), [](char c) { return c == '(' || c == ')' || c == ','; }, ' ');
    std::istringstream words(line);
    int id = 0;
    Corners corners;
    words >> id;
    for (int i = 3; i >= 0; --i) words >> corners[i].x() >> corners[i].y();
    for (Eigen::Vector2d& c : corners) c -= Eigen::Vector2d(0.5, 0.5);
    if (words) tags.push_back(corners);
  }
  return tags;
}

TEST(TagDetector, finds_every_tag_of_the_three_nasa_photographs_at_its_published_corners) {
  const char* shared = std::getenv("CLEARWAY_SHARED_DATA");
  const std::filesystem::path folder =
      std::filesystem::path(shared ? shared : "/work/shared/data") / "apriltag_repo";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no photographs in " << folder;
  TagDetectorOptions options;  // as the corners were made: unrefined; all tags are id 0, some at the border
  options.drop_duplicates = false;
  options.border = 0.0;
  options.min_margin = 0.0;
  options.max_hamming = 2;
  options.refine_edges = false;
  TagDetector detector(options);
  for (const char* name :
       {"33369213973_9d9bb4cc96_c", "34085369442_304b6bafd9_c", "34139872896_defdb2f8d9_c"}) {
    const cv::Mat image = cv::imread((folder / name).string() + ".jpg", cv::IMREAD_GRAYSCALE);
    ASSERT_FALSE(image.empty());
    const auto found = detector.detect(image);
    const auto truth = corners_in((folder / name).string() + ".txt");
    std::size_t matched = 0;
    for (const Corners& tag : truth) {
      const auto error_of = [&](const TagDetection& d) {
        double worst = 0;
        for (int k = 0; k < 4; ++k) worst = std::max(worst, (d.corners[k] - tag[k]).norm());
        return worst;
      };
      double nearest = 1e9;
      for (const TagDetection& d : found) nearest = std::min(nearest, error_of(d));
      matched += nearest < 0.2;
    }
    EXPECT_EQ(matched, truth.size()) << name;
    EXPECT_EQ(found.size(), truth.size()) << name;
  }
}

}  // namespace tag_detector_test
}  // namespace clearway

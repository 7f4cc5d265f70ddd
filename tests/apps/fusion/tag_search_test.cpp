#include "apps/fusion/tag_search.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <opencv2/core.hpp>

#include "datasets/descriptions/scene.hpp"
#include "datasets/simulation/simulate.hpp"
#include "tests/worlds/memory_frames.hpp"
#include "tests/worlds/small_scene.hpp"
#include "tests/worlds/temporary_folder.hpp"

namespace clearway {
namespace tag_search_test {

/// The images of a stroke three times, with scans among them and an image too small for any tag.
std::vector<Frame> stroke_frames() {
  const TemporaryFolder folder;
  folder.write("setup.yaml", small_setup);
  simulate(parse_scene(small_scene, "small scene", folder / ""), folder / "r.rawlog");
  std::vector<Frame> frames;
  for (int round = 0; round < 3; ++round) {
    RecordingReader reader(folder / "r.rawlog");
    while (auto frame = reader.next()) {
      frame->time += 10.0 * round;
      frames.push_back(*frame);
      if (frames.size() % 2 == 0) frames.push_back({frame->time, "scan", CloudFrame{}});
    }
    frames.push_back({9.0 + 10.0 * round, "small", ImageFrame{{8, 8, std::vector<uint8_t>(64)}, {}}});
  }
  return frames;
}

TEST(TagSearch, GivesEveryFrameInOrderWithTheTagsThatOneDetectorFindsForAnyNumberOfThreads) {
  const std::vector<Frame> frames = stroke_frames();
  for (const std::size_t threads : {1U, 2U, 5U}) {
    TagDetector detector;
    MemoryFrames source(frames);
    TagSearch search(source, {}, threads);
    std::size_t tags = 0;
    for (const Frame& frame : frames) {
      const auto searched = search.next();
      ASSERT_TRUE(searched);
      EXPECT_EQ(searched->frame.time, frame.time);
      EXPECT_EQ(searched->frame.sensor, frame.sensor);
      ASSERT_EQ(searched->frame.content.index(), frame.content.index());
      std::vector<TagDetection> expected;
      if (const auto* image = std::get_if<ImageFrame>(&frame.content)) {
        EXPECT_EQ(std::get<ImageFrame>(searched->frame.content).image, image->image);
        const cv::Mat gray(image->image.height, image->image.width, CV_8UC1,
                           const_cast<uint8_t*>(image->image.pixels.data()));
        if (is_detectable(gray, 1)) expected = detector.detect(gray);
      }
      ASSERT_EQ(searched->tags.size(), expected.size());
      for (std::size_t i = 0; i < expected.size(); ++i) {
        EXPECT_EQ(searched->tags[i].id, expected[i].id);
        for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(searched->tags[i].corners[k], expected[i].corners[k]);
      }
      tags += expected.size();
      EXPECT_LE(source.given, static_cast<std::size_t>(&frame - frames.data()) + 4 * threads + 2);
    }
    EXPECT_FALSE(search.next());
    EXPECT_GT(tags, 30U);
  }
}

TEST(TagSearch, HoldsAtMostOneImageMoreWhenTheyAreHuge) {
  const GrayImage huge{8000, 6000, std::vector<uint8_t>(48'000'000)};
  std::vector<Frame> frames;
  for (int i = 0; i < 5; ++i) frames.push_back({1.0 * i, "", ImageFrame{huge, {}}});
  MemoryFrames source(std::move(frames));
  TagSearch search(source, {.decimate = 2}, 8);
  ASSERT_TRUE(search.next());
  EXPECT_LE(source.given, 2U);
}

TEST(TagSearch, LooksForNoTagsWithoutThreadsAndMayBeDroppedHalfway) {
  const std::vector<Frame> frames = stroke_frames();
  MemoryFrames source(frames);
  TagSearch none(source, {}, 0);
  while (const auto searched = none.next()) EXPECT_TRUE(searched->tags.empty());
  EXPECT_EQ(source.given, frames.size());
  MemoryFrames again(frames);
  TagSearch dropped(again, {}, 3);
  dropped.next();
  EXPECT_THROW(TagSearch(again, {.decimate = 7}, 1), std::invalid_argument);
}

TEST(TagSearch, NothingIsReadAheadOfALiveSource) {
  MemoryFrames source(stroke_frames());
  source.live = true;
  TagSearch search(source, {}, 2);
  for (std::size_t asked = 1; asked <= 6; ++asked) {
    ASSERT_TRUE(search.next());
    EXPECT_EQ(source.given, asked);
  }
}

}  // namespace tag_search_test
}  // namespace clearway

#include "apps/fusion/recording_timeline.hpp"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

namespace clearway {
namespace recording_timeline_test {

ImageFrame image(int width, int height) {
  ImageFrame frame;
  frame.image = {width, height, std::vector<std::uint8_t>(static_cast<std::size_t>(width * height), 128)};
  return frame;
}

PaintingSample sample(Refusal refusal, const std::string& reason) {
  PaintingSample sample;
  sample.accepted = refusal == Refusal::none;
  sample.refusal = refusal;
  sample.reason = reason;
  return sample;
}

TEST(RecordingTimeline, ImagesThatAreRefusedForOneReasonInARowAreOneRun) {
  RecordingTimeline timeline;
  TimelineKeeper keeper(timeline);
  keeper.start_at(100.0);
  const PaintingSample accepted = sample(Refusal::none, "");
  const PaintingSample hidden = sample(Refusal::probe_not_seen, "first"),
                       again = sample(Refusal::probe_not_seen, "second");
  const PaintingSample fast = sample(Refusal::too_fast, "third");
  const ImageFrame frame = image(64, 48);
  double time = 0.0;
  for (const PaintingSample* each : {&accepted, &hidden, &again, &fast, &accepted, &hidden})
    keeper.see(frame, std::vector<TagDetection>(static_cast<std::size_t>(time)), each, time), time += 1.0;
  keeper.see_scan(2.5);
  keeper.finish();
  EXPECT_EQ(timeline.start, 100.0);
  EXPECT_EQ(timeline.images, (std::vector<double>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(timeline.tags, (std::vector<std::uint8_t>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(timeline.accepted, (std::vector<std::uint8_t>{1, 0, 0, 0, 1, 0}));
  EXPECT_EQ(timeline.scans, std::vector<double>{2.5});
  ASSERT_EQ(timeline.refusals.size(), 3U);
  EXPECT_EQ(timeline.refusals[0].refusal, "probe_not_seen");
  EXPECT_EQ(timeline.refusals[0].reason, "first");
  EXPECT_EQ(timeline.refusals[0].images, 2);
  EXPECT_EQ(timeline.refusals[0].to, 2.0);
  EXPECT_EQ(timeline.refusals[1].refusal, "too_fast");
  EXPECT_EQ(timeline.refusals[2].from, 5.0);
}

TEST(RecordingTimeline, KeepsFewSmallPicturesEvenlyHoweverManyImagesThereAre) {
  for (const int images : {1, 5, 64, 65, 1000}) {
    RecordingTimeline timeline;
    TimelineKeeper keeper(timeline);
    const ImageFrame frame = image(640, 480);
    for (int i = 0; i < images; ++i) keeper.see(frame, {}, nullptr, i);
    keeper.finish();
    EXPECT_EQ(timeline.images.size(), static_cast<std::size_t>(images));
    ASSERT_GE(timeline.pictures.size(), static_cast<std::size_t>(std::min(images, 16)));
    ASSERT_LE(timeline.pictures.size(), RecordingTimeline::most_pictures);
    const double step = static_cast<double>(images) / static_cast<double>(timeline.pictures.size());
    for (std::size_t i = 0; i < timeline.pictures.size(); ++i) {
      const auto& [time, jpeg] = timeline.pictures[i];
      EXPECT_NEAR(time, static_cast<double>(i) * step, 2.0 * step) << images << " images";
      const cv::Mat picture = cv::imdecode(std::vector<char>(jpeg.begin(), jpeg.end()), cv::IMREAD_COLOR);
      EXPECT_EQ(picture.cols, RecordingTimeline::picture_width);
      EXPECT_EQ(picture.rows, 180);
    }
  }
}

TEST(RecordingTimeline, CountsRefusalsBeyondTheirLimit) {
  RecordingTimeline timeline;
  TimelineKeeper keeper(timeline);
  const ImageFrame frame = image(8, 8);
  const PaintingSample hidden = sample(Refusal::probe_not_seen, "a"), fast = sample(Refusal::too_fast, "b");
  const int runs = static_cast<int>(RecordingTimeline::most_refusals) + 7;
  for (int i = 0; i < runs; ++i) keeper.see(frame, {}, i % 2 == 0 ? &hidden : &fast, i);
  EXPECT_EQ(timeline.refusals.size(), RecordingTimeline::most_refusals);
  EXPECT_EQ(timeline.refusals_left_out, 7U);
}

}  // namespace recording_timeline_test
}  // namespace clearway

#include "apps/overlay/strip.hpp"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "tracking/probe.hpp"

namespace strip_test {

using namespace clearway;

int width_of(const std::string& text, double scale) {
  int baseline = 0;
  return cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, scale, 1, &baseline).width;
}

TEST(Strip, text_that_fits_stays_and_longer_text_is_cut_to_the_width) {
  EXPECT_EQ(fitting_text("painting", 0.5, 400), "painting");
  const std::string longer(500, 'm');
  for (const int width : {40, 100, 333, 900}) {
    const std::string cut = fitting_text(longer, 0.5, width);
    EXPECT_LE(width_of(cut, 0.5), width);
    EXPECT_TRUE(cut.ends_with("..."));
    EXPECT_GT(width_of(cut + "mm", 0.5), width);
  }
  EXPECT_EQ(fitting_text(longer, 0.5, 3), "");
}

TEST(Strip, longer_text_is_broken_between_words_before_it_is_cut) {
  const std::string text = "Show two tags of the probe and of the fixed board, or keep them in view longer.";
  for (const int width : {150, 260, 400, 2000})
    for (const std::size_t most : {1, 2, 9}) {
      const std::vector<std::string> lines = fitting_lines(text, 0.5, width, most);
      ASSERT_LE(lines.size(), most);
      std::string whole;
      for (const std::string& line : lines) {
        EXPECT_LE(width_of(line, 0.5), width);
        whole += (whole.empty() ? "" : " ") + line;
      }
      EXPECT_TRUE(whole == text || (most < 9 && whole.ends_with("..."))) << whole;
      for (std::size_t i = 1; i < lines.size(); ++i)  // no line could have held the next word, too
        EXPECT_GT(width_of(lines[i - 1] + " " + lines[i].substr(0, lines[i].find(' ')), 0.5), width);
    }
  EXPECT_EQ(fitting_lines(std::string(500, 'm'), 0.5, 100, 3).size(), 1U);  // a word that is too long is cut
}

TEST(Strip, characters_that_the_font_lacks_are_replaced) {
  EXPECT_EQ(fitting_text("a\xc3\xa4\xe2\x80\xa6\n\tb", 0.5, 400), "a??  b");
}

TEST(Strip, lines_keep_within_the_lower_part_of_the_picture) {
  for (const cv::Size size : {cv::Size(640, 480), cv::Size(1280, 720), cv::Size(160, 120)}) {
    for (const int grey : {0, 255}) {
      cv::Mat picture(size, CV_8UC3, cv::Scalar::all(grey));
      const std::string longer(400, 'W');
      draw_strip(picture, {longer, longer, longer, longer, 0.02});
      const int untouched = size.height / 2 - 20;
      const cv::Mat above = picture.rowRange(0, untouched);
      EXPECT_EQ(cv::norm(above, cv::Mat(above.size(), CV_8UC3, cv::Scalar::all(grey)), cv::NORM_INF), 0.0);
      double low = 0.0, high = 0.0;
      cv::minMaxLoc(picture.rowRange(size.height - 20, size.height).reshape(1), &low, &high);
      EXPECT_LT(low, 80.0);    // dark behind
      EXPECT_GT(high, 150.0);  // bright letters
    }
  }
}

TEST(Strip, nothing_to_say_leaves_the_picture) {
  cv::Mat picture(480, 640, CV_8UC3, cv::Scalar::all(77));
  draw_strip(picture, {});
  EXPECT_EQ(cv::norm(picture, cv::Mat(480, 640, CV_8UC3, cv::Scalar::all(77)), cv::NORM_INF), 0.0);
}

TEST(Strip, what_a_person_can_mend_has_a_cure) {
  for (const Refusal refusal :
       {Refusal::image_refused, Refusal::base_not_seen, Refusal::probe_not_seen, Refusal::too_few_tags,
        Refusal::reprojection_error, Refusal::ambiguous_pose, Refusal::base_moved, Refusal::uncertain_center,
        Refusal::unconfirmed, Refusal::too_fast})
    EXPECT_TRUE(cure_of(to_string(refusal)).ends_with(".")) << to_string(refusal);
  EXPECT_EQ(cure_of("accepted"), "");
}

}  // namespace strip_test

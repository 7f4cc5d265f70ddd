#include "tracking/calibration/calibrate_board.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/worlds/calibration_views.hpp"
#include "tests/worlds/trials.hpp"

namespace clearway {
namespace calibrate_board_test {

struct DrawnBoard {
  TagBody stated, actual;
  std::vector<BoardView> views;
};

DrawnBoard draw_board(unsigned seed, std::size_t count, double wrong_size = 1.0) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  DrawnBoard drawn;
  drawn.stated = scene::board("base", 0, 3, 2, 0.05, 0.07);
  drawn.stated.errors = {0.0, 0.002, 0.002, 0.01};
  drawn.actual = scene::true_body(drawn.stated, random);
  drawn.actual.tags.at(3).size *= wrong_size;
  while (drawn.views.size() < count) {
    const Eigen::Isometry3d pose = scene::tag_before_camera(
        0.45 + 0.1 * unit(random), 0.75 * std::abs(unit(random)), M_PI * unit(random), M_PI * unit(random),
        0.03 * unit(random), 0.03 * unit(random));
    const auto tags = scene::look_at_body(scene::plain_camera(), drawn.actual, pose, 0.2, random);
    if (tags.size() >= 3) drawn.views.push_back({"view " + std::to_string(drawn.views.size()), tags});
  }
  return drawn;
}

Camera exact_camera() {
  Camera camera = scene::plain_camera();
  camera.errors = {0.0005, 0.0, 0.3, 0.05};
  return camera;
}

TEST(CalibrateBoard, places_relative_to_each_other_are_within_the_sigmas_of_drawn_boards) {
  const int drawn_boards = trials(15, 50);
  double size = 0.0, distance = 0.0, before = 0.0, after = 0.0;
  for (int seed = 1; seed <= drawn_boards; ++seed) {
    const DrawnBoard drawn = draw_board(static_cast<unsigned>(seed), 20);
    const BoardCalibration found = calibrate_board(exact_camera(), drawn.stated, drawn.views);
    ASSERT_EQ(found.refusal, "") << seed;
    for (const TagChange& tag : found.tags) {
      const double ratio = found.board.tags.at(tag.id).size / drawn.actual.tags.at(tag.id).size;
      size += std::pow(std::log(ratio) / tag.size_sigma, 2) / 6.0;
      EXPECT_FALSE(tag.is_size_wrong) << seed << " tag " << tag.id;
    }
    const auto way = [](const TagBody& body) {
      return (body.tags.at(5).body_from_tag.translation() - body.tags.at(0).body_from_tag.translation())
          .norm();
    };
    distance += std::pow((way(found.board) - way(drawn.actual)) / found.tags.back().place_sigma, 2);
    after += std::pow(way(found.board) - way(drawn.actual), 2);
    before += std::pow(way(drawn.stated) - way(drawn.actual), 2);
  }
  EXPECT_LT(size, chi_square_of_a_thousand(drawn_boards));
  EXPECT_LT(distance, chi_square_of_a_thousand(drawn_boards));
  EXPECT_GT(distance, 0.04 * drawn_boards);
  EXPECT_LT(after, 0.05 * before);
}

TEST(CalibrateBoard, names_the_one_tag_whose_size_is_wrong_and_finds_its_size) {
  for (const double wrong : {0.9, 1.05, 1.3}) {
    const DrawnBoard drawn = draw_board(77, 25, wrong);
    const BoardCalibration found = calibrate_board(exact_camera(), drawn.stated, drawn.views);
    ASSERT_EQ(found.refusal, "") << wrong;
    for (const TagChange& tag : found.tags)
      EXPECT_EQ(tag.is_size_wrong, tag.id == 3) << wrong << ' ' << tag.id;
    EXPECT_NEAR(found.board.tags.at(3).size / drawn.actual.tags.at(3).size, 1.0, 0.006) << wrong;
  }
}

TEST(CalibrateBoard, few_views_and_tags_apart_are_refused_with_the_reason) {
  DrawnBoard drawn = draw_board(3, 20);
  std::vector<BoardView> few(drawn.views.begin(), drawn.views.begin() + 4);
  EXPECT_NE(calibrate_board(exact_camera(), drawn.stated, few).refusal.find("4 images"), std::string::npos);
  for (BoardView& view : drawn.views)
    std::erase_if(view.tags, [](const TagDetection& tag) { return tag.id == 4; });
  EXPECT_NE(calibrate_board(exact_camera(), drawn.stated, drawn.views).refusal.find("tag 4 is in no image"),
            std::string::npos);
}

}  // namespace calibrate_board_test
}  // namespace clearway

#include "datasets/descriptions/setup_blocks.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/worlds/small_scene.hpp"

namespace clearway {
namespace setup_blocks_test {

TEST(SetupBlocks, every_block_reads_back_to_what_was_written) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int i = 0; i < 200; ++i) {
    clearway::Setup setup = parse_setup(small_setup, "small");
    setup.camera->fx *= 1.0 + 0.1 * unit(random);
    setup.camera->distortion[2] = 1e-4 * unit(random);
    setup.errors.camera = {0.001, std::abs(unit(random)) * 0.1, 2.0, 0.3};
    setup.errors.edge = std::abs(unit(random));
    for (BoardSetup& board : setup.boards) {
      board.errors = {0.001, 0.002, 0.0003, 0.004};
      for (TagSetup& tag : board.tags) {
        tag.size *= 1.0 + 0.01 * unit(random);
        tag.board_from_tag.translate(Eigen::Vector3d(unit(random), unit(random), unit(random)));
        tag.board_from_tag.rotate(Eigen::AngleAxisd(
            3.0 * unit(random), Eigen::Vector3d(unit(random), 0.3, unit(random)).normalized()));
      }
    }
    setup.probe->ball_center.x() = 0.01 * unit(random);
    std::string text = small_setup;
    for (const std::string& block : {boards_block(setup.boards), camera_block(*setup.camera),
                                     errors_block(setup.errors), probe_block(*setup.probe)})
      text = with_block(text, block);
    const clearway::Setup again = parse_setup(text, "again");
    EXPECT_NEAR(again.camera->fx, setup.camera->fx, 1e-5);
    EXPECT_NEAR(again.camera->distortion[2], setup.camera->distortion[2], 1e-12);
    EXPECT_NEAR(*again.errors.camera.aspect, *setup.errors.camera.aspect, 1e-9);
    EXPECT_NEAR(*again.errors.edge, *setup.errors.edge, 1e-8);
    EXPECT_LT((again.probe->ball_center - setup.probe->ball_center).norm(), 1e-9);
    for (std::size_t b = 0; b < setup.boards.size(); ++b)
      for (std::size_t t = 0; t < setup.boards[b].tags.size(); ++t) {
        const TagSetup &one = setup.boards[b].tags[t], &other = again.boards[b].tags[t];
        EXPECT_EQ(one.id, other.id);
        EXPECT_NEAR(one.size, other.size, 1e-9);
        EXPECT_TRUE(one.board_from_tag.isApprox(other.board_from_tag, 1e-7));
        EXPECT_EQ(again.boards[b].errors.place, 0.0003);
      }
  }
}

TEST(SetupBlocks, all_other_lines_and_comments_stay) {
  const std::string text =
      "# mine\ntitle: a  # kept\ncamera:\n  width: 1\n  # gone\n# between\nqueries: []\n";
  const std::string camera = "camera: {width: 2}\n";
  EXPECT_EQ(with_block(text, camera),
            "# mine\ntitle: a  # kept\ncamera: {width: 2}\n# between\nqueries: []\n");
  EXPECT_EQ(with_block("title: a\n", camera), "title: a\n\ncamera: {width: 2}\n");
  EXPECT_THROW(with_block("{title: a}\n", camera), std::invalid_argument);
}

}  // namespace setup_blocks_test
}  // namespace clearway

#include "apps/print/tag_boards.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <opencv2/core.hpp>
#include <regex>
#include <set>
#include <sstream>

#include "datasets/descriptions/setup.hpp"
#include "tests/apps/run_command.hpp"
#include "tracking/tag_detector.hpp"

namespace clearway {
namespace tag_boards_test {

struct Area {
  double x = 0, y = 0, width = 0, height = 0;
  bool is_black = false;
};

/// The rectangles of an SVG, by its text alone.
std::vector<Area> areas_of_svg(const std::string& svg) {
  static const std::regex rect(
      R"re(<rect x="([^"]+)" y="([^"]+)" width="([^"]+)" height="([^"]+)" fill="(#000|#fff)"/>)re");
  std::vector<Area> areas;
  for (std::sregex_iterator i(svg.begin(), svg.end(), rect), end; i != end; ++i)
    areas.push_back(
        {std::stod((*i)[1]), std::stod((*i)[2]), std::stod((*i)[3]), std::stod((*i)[4]), (*i)[5] == "#000"});
  return areas;
}

/// The rectangles of a PDF's page, millimetres, y down, by its operators and its first transform.
std::vector<Area> areas_of_pdf(const std::string& pdf) {
  const std::size_t stream = pdf.find("stream\n") + 7;
  std::istringstream words(pdf.substr(stream, pdf.find("endstream") - stream));
  std::vector<Area> areas;
  std::vector<double> numbers;
  double a = 1, d = 1, f = 0;
  bool is_black = true;
  for (std::string word; words >> word;) {
    char* end = nullptr;
    const double number = std::strtod(word.c_str(), &end);
    if (*end == '\0') {
      numbers.push_back(number);
      continue;
    }
    if (word == "cm") a = numbers.at(0), d = numbers.at(3), f = numbers.at(5);
    if (word == "g") is_black = numbers.at(0) == 0.0;
    if (word == "re") {
      const double mm = 25.4 / 72.0, page = 297.0;
      areas.push_back({mm * a * numbers[0], page - mm * (d * numbers[1] + f), mm * a * numbers[2],
                       -mm * d * numbers[3], is_black});
    }
    numbers.clear();
  }
  return areas;
}

constexpr double kDots = 8.0;  // a mm

/// The page on paper, black and white.
cv::Mat rasterised(const std::vector<Area>& areas) {
  cv::Mat page(static_cast<int>(297 * kDots), static_cast<int>(210 * kDots), CV_8UC1, cv::Scalar(255));
  for (const Area& area : areas) {
    const int x0 = static_cast<int>(std::lround(area.x * kDots)),
              y0 = static_cast<int>(std::lround(area.y * kDots));
    const int x1 = static_cast<int>(std::lround((area.x + area.width) * kDots)),
              y1 = static_cast<int>(std::lround((area.y + area.height) * kDots));
    page(cv::Rect(x0, y0, x1 - x0, y1 - y0)) = cv::Scalar(area.is_black ? 0 : 255);
  }
  return page;
}

/// Where a tag lies on its sheet, mm, y up: seen by the detector.
struct Seen {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  double size = 0.0;
};

std::map<int, Seen> seen_on(const std::string& svg) {
  std::map<int, Seen> seen;
  for (const TagDetection& tag : TagDetector().detect(rasterised(areas_of_svg(svg)))) {
    Seen& place = seen[tag.id];
    for (int i = 0; i < 4; ++i) {
      const Eigen::Vector2d corner = (tag.corners[i] + Eigen::Vector2d(0.5, 0.5)) / kDots;
      place.middle += 0.25 * Eigen::Vector2d(corner.x(), -corner.y());
      place.size += 0.25 * (tag.corners[(i + 1) % 4] - tag.corners[i]).norm() / kDots;
    }
    EXPECT_NEAR(tag.corners[1].y(), tag.corners[0].y(), 0.5) << "upright";
    EXPECT_GT(tag.corners[1].x(), tag.corners[0].x());
  }
  return seen;
}

class TagBoardsPrint : public ::testing::TestWithParam<double> {
 protected:
  /// A scale of all tags.
  TagBoards boards() const {
    const double k = GetParam();
    return lay_out_boards({60.0 * k, 28.0 * k, 20.0, 80.0, 28.0 * k, 34.0 * k});
  }
};

TEST_P(TagBoardsPrint, tags_on_paper_have_the_ids_and_sizes_of_the_setup) {
  const TagBoards printed = boards();
  const auto setup = parse_setup(printed.setup, "printed.yaml");
  const std::map<std::string, std::size_t> counts = {
      {"base", 6}, {"probe", 5}, {"gripper", 2}, {"calibration", 17}};
  ASSERT_EQ(printed.sheets.size(), counts.size());
  for (const Sheet& sheet : printed.sheets) {
    const BoardSetup* board = setup.board(sheet.name);
    ASSERT_NE(board, nullptr) << sheet.name;
    const std::map<int, Seen> seen = seen_on(to_svg(sheet));
    EXPECT_EQ(seen.size(), counts.at(sheet.name)) << sheet.name;
    EXPECT_EQ(board->tags.size(), seen.size());
    for (const TagSetup& tag : board->tags) {
      ASSERT_TRUE(seen.count(tag.id)) << sheet.name << " " << tag.id;
      EXPECT_NEAR(seen.at(tag.id).size, 1000.0 * tag.size, 0.2) << sheet.name << " " << tag.id;
    }
  }
}

TEST_P(TagBoardsPrint, flat_boards_have_the_places_of_the_setup) {
  const TagBoards printed = boards();
  const auto setup = parse_setup(printed.setup, "printed.yaml");
  for (const Sheet& sheet : printed.sheets) {
    if (sheet.name != "base" && sheet.name != "calibration") continue;
    const std::map<int, Seen> seen = seen_on(to_svg(sheet));
    const BoardSetup& board = *setup.board(sheet.name);
    const Eigen::Vector2d offset =
        seen.at(board.tags[0].id).middle - 1000.0 * board.tags[0].board_from_tag.translation().head<2>();
    for (const TagSetup& tag : board.tags) {
      EXPECT_TRUE(tag.board_from_tag.linear().isIdentity(1e-9));
      EXPECT_LT(
          (seen.at(tag.id).middle - offset - 1000.0 * tag.board_from_tag.translation().head<2>()).norm(),
          0.15)
          << sheet.name << " " << tag.id;
    }
  }
}

/// A place of the sheet in the finished body, by the tag of its panel.
Eigen::Vector3d in_body(const TagSetup& tag, const Seen& seen, const Eigen::Vector2d& on_paper) {
  const Eigen::Vector2d from_tag = 1e-3 * (on_paper - seen.middle);
  return tag.board_from_tag * Eigen::Vector3d(from_tag.x(), from_tag.y(), 0.0);
}

/// Two panels beside each other on paper, with their tags' middles `edge` apart: folding keeps the edge
/// between them together.
void expect_hinged(const TagSetup& a, const TagSetup& b, const std::map<int, Seen>& seen) {
  const Seen &at_a = seen.at(a.id), &at_b = seen.at(b.id);
  const Eigen::Vector2d along = at_b.middle - at_a.middle, middle = 0.5 * (at_a.middle + at_b.middle);
  const Eigen::Vector2d side(0.5 * along.y(), -0.5 * along.x());
  for (double end : {-1.0, 1.0}) {
    const Eigen::Vector2d on_edge = middle + end * side;
    EXPECT_LT((in_body(a, at_a, on_edge) - in_body(b, at_b, on_edge)).norm(), 2e-4)
        << a.id << " and " << b.id;
  }
  EXPECT_NEAR(a.board_from_tag.linear().col(2).dot(b.board_from_tag.linear().col(2)), 0.0, 1e-9);
}

TEST_P(TagBoardsPrint, folded_bodies_hold_together_where_their_sheets_are_folded) {
  const TagBoards printed = boards();
  const auto setup = parse_setup(printed.setup, "printed.yaml");
  const auto& cube = setup.board("probe")->tags;
  const std::map<int, Seen> net = seen_on(to_svg(printed.sheets[1]));
  for (std::size_t i = 1; i < cube.size(); ++i) expect_hinged(cube[0], cube[i], net);
  const double half = cube[0].board_from_tag.translation().norm();
  for (const TagSetup& tag : cube) {  // each face looks away from the middle, all equally far from it
    EXPECT_NEAR(tag.board_from_tag.translation().norm(), half, 1e-9);
    EXPECT_NEAR(tag.board_from_tag.linear().col(2).dot(tag.board_from_tag.translation()), half, 1e-9);
    EXPECT_GT(2.0 * half, 1.2 * tag.size);
  }
  EXPECT_EQ(setup.probe->board, "probe");
  EXPECT_EQ(setup.probe->ball_radius, 0.02);
  EXPECT_EQ(setup.map.resolution, 0.01);  // by the default of 0.02 the ball would hardly hold a voxel
  EXPECT_NEAR(setup.probe->ball_center.z(), -half - 0.08, 1e-9);
  const auto& roof = setup.board("gripper")->tags;
  expect_hinged(roof[0], roof[1], seen_on(to_svg(printed.sheets[2])));
  for (const TagSetup& tag : roof) EXPECT_GT(tag.board_from_tag.linear()(2, 2), 0.5);
}

TEST_P(TagBoardsPrint, pdf_and_svg_show_the_same) {
  for (const Sheet& sheet : boards().sheets) {
    const std::vector<Area> svg = areas_of_svg(to_svg(sheet)), pdf = areas_of_pdf(to_pdf(sheet));
    ASSERT_EQ(svg.size(), pdf.size());
    ASSERT_GT(svg.size(), 10u);
    for (std::size_t i = 0; i < svg.size(); ++i) {
      EXPECT_NEAR(svg[i].x, pdf[i].x, 1e-4);
      EXPECT_NEAR(svg[i].y, pdf[i].y, 1e-4);
      EXPECT_NEAR(svg[i].width, pdf[i].width, 1e-4);
      EXPECT_NEAR(svg[i].height, pdf[i].height, 1e-4);
      EXPECT_EQ(svg[i].is_black, pdf[i].is_black);
      EXPECT_GE(svg[i].x, 8.0);
      EXPECT_LE(svg[i].x + svg[i].width, 202.0);
      EXPECT_LE(svg[i].y + svg[i].height, 262.0) << "over the ruler";
    }
  }
}

/// The words of an SVG, with where they begin and their size.
struct Words {
  double x = 0, y = 0, size = 0;
  std::string text;
};
std::vector<Words> words_of_svg(const std::string& svg) {
  static const std::regex text(
      R"re(<text x="([^"]+)" y="([^"]+)" font-size="([^"]+)"[^>]*>([^<]*)</text>)re");
  std::vector<Words> words;
  for (std::sregex_iterator i(svg.begin(), svg.end(), text), end; i != end; ++i)
    words.push_back({std::stod((*i)[1]), std::stod((*i)[2]), std::stod((*i)[3]), (*i)[4]});
  return words;
}
std::set<std::string> texts_of_pdf(const std::string& pdf) {
  static const std::regex text(R"re(Tm \((([^)\\]|\\.)*)\) Tj)re");
  std::set<std::string> words;
  for (std::sregex_iterator i(pdf.begin(), pdf.end(), text), end; i != end; ++i)
    words.insert(std::regex_replace((*i)[1].str(), std::regex(R"re(\\(.))re"), "$1"));
  return words;
}
/// The millimetres behind some words of a text.
double mm_in(const std::string& text, const std::string& before, const std::string& after = "") {
  std::smatch match;
  const bool is_found = std::regex_search(text, match, std::regex(before + R"re(([0-9.]+) mm)re" + after));
  return is_found ? std::stod(match[1]) : -1.0;
}

TEST_P(TagBoardsPrint, each_tag_has_its_id_and_size_above_it_outside_of_its_white_ring) {
  const TagBoards printed = boards();
  const auto setup = parse_setup(printed.setup, "printed.yaml");
  for (const Sheet& sheet : printed.sheets) {
    const std::string svg = to_svg(sheet);
    const std::map<int, Seen> seen = seen_on(svg);
    const std::vector<Words> words = words_of_svg(svg);
    for (const TagSetup& tag : setup.board(sheet.name)->tags) {
      const std::string label = "id " + std::to_string(tag.id) + ", ";
      const auto found =
          std::find_if(words.begin(), words.end(), [&](const Words& w) { return w.text.starts_with(label); });
      ASSERT_NE(found, words.end()) << sheet.name << " " << tag.id;
      EXPECT_NEAR(mm_in(found->text, label), 1000.0 * tag.size, 1e-6);
      const Eigen::Vector2d& middle = seen.at(tag.id).middle;
      const double side = 1000.0 * tag.size, above = -middle.y() - 0.5 * side - found->y;
      EXPECT_GE(above, side / 8.0);
      EXPECT_LT(above + 0.73 * found->size, 0.2 * side + 0.2) << "nearer to this tag than to the next";
      EXPECT_NEAR(found->x, middle.x() - 0.5 * side, 0.2);
      EXPECT_GT(found->size, 1.0);
    }
  }
}

TEST_P(TagBoardsPrint, the_probes_sheet_says_how_to_build_what_the_setup_says) {
  const TagBoards printed = boards();
  const auto setup = parse_setup(printed.setup, "printed.yaml");
  const double half = setup.board("probe")->tags[0].board_from_tag.translation().norm();
  std::string all;
  for (const Words& words : words_of_svg(to_svg(printed.sheets[1]))) all += words.text + "\n";
  EXPECT_NEAR(mm_in(all, "ball: radius "), 1000.0 * setup.probe->ball_radius, 1e-6) << all;
  EXPECT_NEAR(mm_in(all, "ball radius "), 1000.0 * setup.probe->ball_radius, 1e-6);
  EXPECT_NEAR(mm_in(all, "cube: edge "), 2000.0 * half, 1e-6);
  const double stem = -1000.0 * (setup.probe->ball_center.z() + half);
  EXPECT_NEAR(mm_in(all, "stem: ", " from the cube's lower face to the ball's middle"), stem, 1e-6);
  EXPECT_NEAR(mm_in(all, "\n", " to the ball's middle"), stem, 1e-6);
}

TEST_P(TagBoardsPrint, pdf_and_svg_say_the_same) {
  for (const Sheet& sheet : boards().sheets) {
    std::set<std::string> svg;
    for (const Words& words : words_of_svg(to_svg(sheet))) svg.insert(words.text);
    EXPECT_GE(svg.size(), 5U);
    EXPECT_EQ(svg, texts_of_pdf(to_pdf(sheet)));
  }
}

INSTANTIATE_TEST_SUITE_P(Scales, TagBoardsPrint, ::testing::Values(1.0, 0.63));

TEST(TagBoards, the_calibration_board_has_black_squares_where_a_charuco_board_has_them) {
  const auto areas = areas_of_svg(to_svg(lay_out_boards({}).sheets[3]));
  int squares = 0;
  double left = 1e9, top = 1e9;
  for (const Area& area : areas)
    if (area.is_black && area.width == 34.0) left = std::min(left, area.x), top = std::min(top, area.y);
  for (const Area& area : areas) {
    if (!area.is_black || area.width != 34.0) continue;
    ++squares;
    const int column = static_cast<int>(std::lround((area.x - left) / 34.0)),
              row = static_cast<int>(std::lround((area.y - top) / 34.0));
    EXPECT_EQ((row + column) % 2, 0);
    EXPECT_NEAR(area.x, left + 34.0 * column, 1e-6);
    EXPECT_NEAR(area.y, top + 34.0 * row, 1e-6);
  }
  EXPECT_EQ(squares, 18);
}

TEST(TagBoards, a_pdf_ends_with_a_table_that_finds_its_objects) {
  const std::string pdf = to_pdf(lay_out_boards({}).sheets[0]);
  EXPECT_EQ(pdf.rfind("%PDF-", 0), 0u);
  const std::size_t start = std::stoul(pdf.substr(pdf.rfind("startxref\n") + 10));
  ASSERT_EQ(pdf.compare(start, 5, "xref\n"), 0);
  std::istringstream table(pdf.substr(start));
  std::string line;
  for (int i = 0; i < 3; ++i) std::getline(table, line);
  for (int object = 1; object <= 5; ++object) {
    std::getline(table, line);
    EXPECT_EQ(line.size(), 19u);
    const std::string begin = std::to_string(object) + " 0 obj";
    EXPECT_EQ(pdf.compare(std::stoul(line), begin.size(), begin), 0) << object;
  }
}

TEST(TagBoards, that_do_not_fit_the_page_are_refused_by_the_flags_name) {
  const auto refusal = [](const TagBoardsOptions& options) -> std::string {
    try {
      lay_out_boards(options);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal({}), "");
  EXPECT_NE(refusal({.base_tag = 100.0}).find("--base-tag"), std::string::npos);
  EXPECT_NE(refusal({.probe_tag = 60.0}).find("--probe-tag"), std::string::npos);
  EXPECT_NE(refusal({.gripper_tag = 120.0}).find("--gripper-tag"), std::string::npos);
  EXPECT_NE(refusal({.square = 40.0}).find("--square"), std::string::npos);
  EXPECT_NE(refusal({.ball_radius = 20.0, .stem = 20.0})
                .find("--stem: expected more than the ball's radius of 20 mm"),
            std::string::npos);
}

TEST(TagsPrint, writes_sheets_and_a_setup_and_refuses_what_it_does_not_know) {
  const TemporaryFolder folder;
  const CommandRun run = run_command({"tags", "print", "--out", folder.file("out"), "--stem", "100"});
  EXPECT_EQ(run.status, exit_done) << run.log;
  for (const char* name : {"base", "probe", "gripper", "calibration"})
    for (const char* kind : {".svg", ".pdf"})
      EXPECT_TRUE(std::filesystem::exists(folder.file("out/") + name + kind)) << name << kind;
  const auto setup = load_setup(folder.file("out/setup.yaml"));
  EXPECT_NEAR(setup.probe->ball_center.z(), -0.12, 1e-12);
  EXPECT_EQ(run_command({"tags", "show", "--out", folder.file("b")}).status, exit_bad_input);
  EXPECT_EQ(run_command({"tags", "print", "--out", folder.file("b"), "--square", "200"}).status,
            exit_bad_input);
  EXPECT_FALSE(std::filesystem::exists(folder.file("b")));
}

}  // namespace tag_boards_test
}  // namespace clearway

#include "apps/print/tag_boards.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <locale>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "datasets/yaml/pose_numbers.hpp"
#include "mapping/system/number_text.hpp"

namespace clearway {
namespace {

constexpr double kPageWidth = 190.0, kPageHeight = 237.0;  // what any printer reaches, with room for a ruler
constexpr double kLeft = 13.0, kTop = 20.0;
constexpr double kQuiet = 1.125;  // a tag with most of its white ring, over its size

struct Board {
  std::string name, errors;
  bool is_fixed = false;
  struct Tag {
    int id = 0;
    double size = 0.0;  ///< m
    Eigen::Isometry3d board_from_tag = Eigen::Isometry3d::Identity();
  };
  std::vector<Tag> tags;
};

/// A flat part of a sheet and where it is in the finished body.
struct Panel {
  double x = 0.0, y = 0.0;                                             ///< of its middle on the sheet, mm
  Eigen::Isometry3d board_from_panel = Eigen::Isometry3d::Identity();  ///< x right, y up on the sheet, z out
};

/// A length in metres as the sheets say it: "28 mm".
std::string in_mm(double length) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(9);
  text << 1e3 * length << " mm";
  return text.str();
}

void require_fit(double needed, double available, const std::string& option) {
  if (needed <= available) return;
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text << option << " needs " << needed << " mm of the page, expected at most " << available;
  throw std::invalid_argument(text.str());
}

/// A tag whose middle is (right, up) mm from the panel's. Its id and size stand above it, outside of its
/// white ring. @param room from the tag's upper side to where another thing begins, mm
void add_tag(Sheet& sheet, Board& board, const Panel& panel, int id, double size, double room,
             double right = 0.0, double up = 0.0) {
  const double left = panel.x + right - 0.5 * size, top = panel.y - up - 0.5 * size;
  sheet.tag(id, left, top, size);
  const Eigen::Translation3d shift(1e-3 * right, 1e-3 * up, 0.0);
  board.tags.push_back({id, 1e-3 * size, panel.board_from_panel * shift});
  const double ring = size / 8.0, letters = std::min(3.0, 0.8 * (room - ring));
  const Board::Tag& tag = board.tags.back();
  sheet.words.push_back(
      {left, top - ring - 0.2 * letters, letters, "id " + std::to_string(tag.id) + ", " + in_mm(tag.size)});
}

/// What all tags of a sheet have in common.
std::string told_tags(const Board& board) {
  return "tag36h11 " + std::to_string(board.tags.front().id) + " to " + std::to_string(board.tags.back().id) +
         ", black squares of " + in_mm(board.tags.front().size);
}

/// The lines of a net of squares: folds between two of them, cuts along the others' sides.
void add_net(Sheet& sheet, const std::vector<Eigen::Vector2d>& middles, double edge) {
  const Eigen::Vector2d sides[] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  for (std::size_t i = 0; i < middles.size(); ++i) {
    for (const Eigen::Vector2d& side : sides) {
      const auto next = std::find_if(middles.begin(), middles.end(), [&](const Eigen::Vector2d& other) {
        return (middles[i] + edge * side - other).norm() < 1e-6 * edge;
      });
      const bool is_fold = next != middles.end();
      if (is_fold && static_cast<std::size_t>(next - middles.begin()) < i) continue;  // drawn already
      const Eigen::Vector2d middle = middles[i] + 0.5 * edge * side,
                            along(-0.5 * edge * side.y(), 0.5 * edge * side.x());
      const Eigen::Vector2d from = middle - along, to = middle + along;
      sheet.lines.push_back({from.x(), from.y(), to.x(), to.y(), is_fold});
    }
  }
}

Sheet titled(const std::string& name, const std::string& title) {
  Sheet sheet{name, 210.0, 297.0, {}, {}, {}};
  sheet.words.push_back({kLeft, 8.5, 4.0, "Clearway: " + title});
  sheet.ruler(kLeft, 266.0, 150.0);
  return sheet;
}

/// A line below the title.
void add_facts(Sheet& sheet, const std::string& facts, int line = 0) {
  sheet.words.push_back({kLeft, 12.5 + 4.0 * line, 3.0, facts});
}

Board base_board(const TagBoardsOptions& options, Sheet& sheet) {
  const double pitch = 1.4 * options.base_tag, first = 20;
  require_fit(pitch + kQuiet * options.base_tag, kPageWidth, "--base-tag");
  require_fit(2.0 * pitch + kQuiet * options.base_tag, kPageHeight, "--base-tag");
  sheet = titled("base", "base board, lies where `map_from_board` says: keep it flat");
  Board board{"base", "{place: 0.0001, turn: 0.002}", true, {}};
  const Panel panel{105.0, kTop + 0.5 * kPageHeight, Eigen::Isometry3d::Identity()};
  for (int i = 0; i < 6; ++i)
    add_tag(sheet, board, panel, static_cast<int>(first) + i, options.base_tag,
            0.5 * (pitch - options.base_tag), (i % 2 - 0.5) * pitch, (1 - i / 2) * pitch);
  add_facts(sheet, told_tags(board) + "; frame: in the middle of them, x right, y up");
  return board;
}

Eigen::Isometry3d face(const Eigen::Vector3d& right, const Eigen::Vector3d& up,
                       const Eigen::Vector3d& middle) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() << right, up, right.cross(up);
  pose.translation() = middle;
  return pose;
}

/// The probe's ball, metres.
struct Ball {
  double radius = 0.0, stem = 0.0;  ///< stem: from the cube's lower face to the ball's middle
};
Ball ball_of(const TagBoardsOptions& options) { return {1e-3 * options.ball_radius, 1e-3 * options.stem}; }

double cube_edge(const TagBoardsOptions& options) { return std::ceil(options.probe_tag * 1.4); }

// A cross: the top, its four neighbours, and below the lowest of them the face that the stem leaves by.
Board probe_board(const TagBoardsOptions& options, Sheet& sheet) {
  const double edge = cube_edge(options), half = 0.5e-3 * edge;
  require_fit(3.0 * edge, kPageWidth, "--probe-tag");
  require_fit(4.0 * edge, kPageHeight, "--probe-tag");
  sheet = titled("probe", "probe, a cube: cut along the lines, fold along the dashes, print outside");
  Board board{"probe", "", false, {}};
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(),
                        z = Eigen::Vector3d::UnitZ();
  const double middle_x = 105.0, middle_y = kTop + 1.5 * edge;
  const Panel panels[] = {{middle_x, middle_y, face(x, y, half * z)},
                          {middle_x - edge, middle_y, face(z, y, -half * x)},
                          {middle_x, middle_y + edge, face(x, z, -half * y)},
                          {middle_x + edge, middle_y, face(-z, y, half * x)},
                          {middle_x, middle_y - edge, face(x, -z, half * y)}};
  int id = 30;
  const double stem_y = middle_y + 2.0 * edge;
  std::vector<Eigen::Vector2d> net{{middle_x, stem_y}};
  for (const Panel& panel : panels) {
    add_tag(sheet, board, panel, id++, options.probe_tag, 0.5 * (edge - options.probe_tag));
    net.emplace_back(panel.x, panel.y);
  }
  add_net(sheet, net, edge);
  sheet.lines.push_back({middle_x - 4.0, stem_y, middle_x + 4.0, stem_y, false});
  sheet.lines.push_back({middle_x, stem_y - 4.0, middle_x, stem_y + 4.0, false});
  const Ball ball = ball_of(options);
  const std::string of_stem[] = {"stem leaves here:", in_mm(ball.stem) + " to the ball's middle",
                                 "ball radius " + in_mm(ball.radius)};
  double line = 0.26;  // below the middle, in edges
  for (const std::string& words : of_stem) {
    sheet.words.push_back({middle_x - 0.45 * edge, stem_y + line * edge, edge / 16.0, words});
    line += 0.09;
  }
  add_facts(sheet, told_tags(board) + "; cube: edge " + in_mm(2.0 * half));
  add_facts(sheet,
            "stem: " + in_mm(ball.stem) + " from the cube's lower face to the ball's middle; ball: radius " +
                in_mm(ball.radius),
            1);
  return board;
}

// Two tags on a fold: each leans back by 45 degrees from the frame's z.
Board gripper_board(const TagBoardsOptions& options, Sheet& sheet) {
  const double edge = std::ceil(options.gripper_tag * 1.4);
  require_fit(edge, kPageWidth, "--gripper-tag");
  require_fit(2.0 * edge, kPageHeight, "--gripper-tag");
  sheet = titled("gripper", "gripper probe: fold back by 90 degrees along the dashes, print outside");
  Board board{"gripper", "", false, {}};
  const double half = 0.5e-3 * edge, fold_y = kTop + edge + 10.0, lean = std::sqrt(0.5);
  std::vector<Eigen::Vector2d> net;
  for (double side : {1.0, -1.0}) {  // above the fold, below it
    const Eigen::Vector3d up(0.0, lean, -side * lean);
    const Panel panel{105.0, fold_y - side * 0.5 * edge,
                      face(Eigen::Vector3d::UnitX(), up, side * half * up)};
    add_tag(sheet, board, panel, side > 0.0 ? 40 : 41, options.gripper_tag,
            0.5 * (edge - options.gripper_tag));
    net.emplace_back(panel.x, panel.y);
  }
  add_net(sheet, net, edge);
  add_facts(sheet, told_tags(board) + "; frame: in the middle of the fold, z between the tags");
  return board;
}

Board calibration_board(const TagBoardsOptions& options, Sheet& sheet) {
  constexpr int columns = 5, rows = 7;
  const double square = options.square, tag = 0.7 * square;
  require_fit(columns * square, kPageWidth, "--square");
  require_fit(rows * square, kPageHeight + 9.0, "--square");
  sheet =
      titled("calibration", "calibration board (ChArUco, tag36h11, 5 x 7): glue it on glass or aluminium");
  Board board{"calibration", "{place: 0.0001, turn: 0.002}", false, {}};
  const double left = 105.0 - 0.5 * columns * square, top = 14.0;
  const Panel panel{105.0, top + 0.5 * rows * square, Eigen::Isometry3d::Identity()};
  int id = 0;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      if ((row + column) % 2 == 0)
        sheet.areas.push_back({left + column * square, top + row * square, square, square, true});
      else
        add_tag(sheet, board, panel, id++, tag, 0.5 * (square - tag), (column - 0.5 * (columns - 1)) * square,
                (0.5 * (rows - 1) - row) * square);
    }
  add_facts(sheet, told_tags(board) + "; squares of " + in_mm(1e-3 * square));
  return board;
}

void write_board(const Board& board, std::ostringstream& text) {
  text << "  - name: " << board.name << '\n';
  if (board.is_fixed) text << "    map_from_board: [0, 0, 0, 0, 0, 0]  # measure it\n";
  if (!board.errors.empty()) text << "    errors: " << board.errors << "  # on one sheet\n";
  text << "    tags:\n";
  for (const Board::Tag& tag : board.tags) {
    const std::vector<double> pose = pose_numbers(tag.board_from_tag);
    text << "      - {id: " << tag.id << ", size: " << tag.size << ", pose_deg: [";
    for (std::size_t i = 0; i < 6; ++i) {
      const double value = i < 3 ? pose[i] : pose[i] * (180.0 / M_PI);
      text << (i > 0 ? ", " : "") << (std::abs(value) < 1e-12 ? 0.0 : value);
    }
    text << "]}\n";
  }
}

}  // namespace

TagBoards lay_out_boards(const TagBoardsOptions& options) {
  if (!(options.stem > options.ball_radius))
    throw std::invalid_argument("--stem: expected more than the ball's radius of " +
                                short_text(options.ball_radius) +
                                " mm, because it is measured to the ball's middle");
  TagBoards boards;
  boards.sheets.resize(4);
  const Board parts[] = {base_board(options, boards.sheets[0]), probe_board(options, boards.sheets[1]),
                         gripper_board(options, boards.sheets[2]),
                         calibration_board(options, boards.sheets[3])};
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(9);
  text << "# Written by `clearway tags print`, as the sheets beside it. Metres; measure the rulers first.\n"
          "boards:\n";
  for (const Board& board : parts) write_board(board, text);
  const Ball ball = ball_of(options);
  text << "\nprobe:\n  board: probe\n"
       << "  ball_center: [0, 0, " << -(0.5e-3 * cube_edge(options) + ball.stem) << "]\n"
       << "  ball_radius: " << ball.radius << '\n'
       << "  robot_error: 0.001\n  modelling_error: 0.001  # of the ball and its stem\n"
       << "\nmap: {resolution: " << 0.5 * ball.radius << "}  # half the ball's radius: it holds voxels then\n"
       << "\ngripper:  # for `clearway teach`\n  board: gripper\n"
       << "  tip_deg: [0, 0, -0.1, 180, 0, 0]  # measure it: where the board has the robot's tip\n";
  boards.setup = text.str();
  return boards;
}

}  // namespace clearway

#pragma once

#include <string>
#include <vector>

namespace clearway {

/// A page to print, true to scale: millimetres from its upper left corner, x right, y down. What comes later
/// covers what came before; lines and words lie on top.
struct Sheet {
  struct Area {
    double x = 0.0, y = 0.0, width = 0.0, height = 0.0;
    bool is_black = true;  ///< else the paper's white
  };
  struct Line {
    double x0 = 0.0, y0 = 0.0, x1 = 0.0, y1 = 0.0;
    bool is_fold = false;  ///< dashed; else one to cut along, or a mark
  };
  struct Words {
    double x = 0.0, y = 0.0;  ///< where their base line begins
    double size = 3.0;
    std::string text;  ///< ASCII
  };
  std::string name;                      ///< of its files, without extension
  double width = 210.0, height = 297.0;  ///< A4
  std::vector<Area> areas;
  std::vector<Line> lines;
  std::vector<Words> words;

  /// A tag36h11 whose black square has the side `size` and its upper left corner at (x, y), upright.
  /// @throws std::invalid_argument when the family has no such id.
  void tag(int id, double x, double y, double size);
  /// A ruler of `length` mm that begins at (x, y): it shows whether the printer kept the scale.
  void ruler(double x, double y, double length);
};

std::string to_svg(const Sheet& sheet);
std::string to_pdf(const Sheet& sheet);

}  // namespace clearway

#pragma once

#include <string>
#include <vector>

#include "apps/print/sheet.hpp"

namespace clearway {

/// What is printed, millimetres. The defaults fit A4 and letter paper.
struct TagBoardsOptions {
  double base_tag = 60.0;     ///< side of a black square of the base board, 2 x 3 of them
  double probe_tag = 28.0;    ///< of the cube's five tags
  double ball_radius = 20.0;  ///< of the probe's ball
  double stem = 80.0;         ///< from the cube's lower face to the middle of the ball
  double gripper_tag = 28.0;  ///< of the gripper probe's two tags
  double square = 34.0;       ///< of the calibration board, 5 x 7 of them
};

struct TagBoards {
  std::vector<Sheet> sheets;  ///< base, probe, gripper, calibration
  std::string setup;          ///< YAML with the same ids, sizes and places, metres
};

/// Lays the boards out. Base: a sheet. Probe: the net of a cube, with a tag on each face but the lower one,
/// where the ball's stem leaves it; its board's frame is in the cube's middle, z up. Gripper probe: two tags
/// on a fold of 90 degrees, the frame in the fold's middle, z out between them. Calibration: a ChArUco board
/// of odd rows and columns, a black square first, tags of 0.7 squares in the white ones, ids along the rows.
/// @throws std::invalid_argument naming the option that does not fit the page.
TagBoards lay_out_boards(const TagBoardsOptions& options);

}  // namespace clearway

#pragma once

#include <string>
#include <utility>
#include <vector>

#include "apps/calibrate/board_views.hpp"
#include "apps/console/commands.hpp"

namespace clearway {

/// What a calibration says of itself and of the setup.
struct CalibrationReport {
  std::string refusal;                                    ///< one sentence; empty: the blocks may be used
  std::vector<std::pair<std::string, std::string>> rows;  ///< of the table
  std::vector<std::pair<std::string, double>> figures;    ///< of the JSON, SI units and pixels by their names
  std::vector<std::string> blocks;                        ///< of the setup, as setup_blocks.hpp has them
  std::string next;                                       ///< what to do with them, one sentence
};

// One function a kind; each takes the setup and the images of the source.
// @throws std::invalid_argument when the setup lacks what is needed, or nothing of it is seen

CalibrationReport report_camera(const CalibrateOptions& options, const Setup& setup,
                                const SearchedImages& images);
CalibrationReport report_board(const CalibrateOptions& options, const Setup& setup,
                               const SearchedImages& images);
CalibrationReport report_probe(const CalibrateOptions& options, const Setup& setup,
                               const SearchedImages& images);
CalibrationReport report_base(const CalibrateOptions& options, const Setup& setup,
                              const SearchedImages& images);
CalibrationReport report_hand_eye(const CalibrateOptions& options, const Setup& setup,
                                  const SearchedImages& images);

}  // namespace clearway

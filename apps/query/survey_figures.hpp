#pragma once

#include <string>
#include <utility>
#include <vector>

#include "planning/survey/path_survey.hpp"

namespace clearway {

/// The rows on what the map knows of where the robot goes: swept volume, unknown space that counts as
/// free, bodies that stand in occupied voxels, parts outside of the map.
std::vector<std::pair<std::string, std::string>> survey_figures(const PathSurvey& survey);

/// "0 mm (flag), less than the robot's position accuracy of 1 mm". Metres; accuracy 0: not known.
/// @param source stands behind the padding: " (flag)"
std::string describe_padding(double padding, double position_accuracy, const std::string& source = "");

}  // namespace clearway

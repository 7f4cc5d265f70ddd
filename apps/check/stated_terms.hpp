#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "datasets/yaml/yaml_fields.hpp"
#include "planning/files/plan_file.hpp"

namespace clearway {

/// What a trajectory that we exported says of the robot that it was proved for, beside its points.
struct StatedTerms {
  std::string robot{};            ///< name or path
  std::optional<double> scale{};  ///< none: not said
  Eigen::Isometry3d map_from_base = Eigen::Isometry3d::Identity();
  std::string group{};                       ///< planning group; empty: all joints but those held
  std::map<std::string, double> held{};      ///< joints that stand still, rad or m at full size
  std::vector<LegLoad> loads{};              ///< that ride all the way
  double payload = 0.0;                      ///< kg at full size
  std::optional<Eigen::Vector3d> gravity{};  ///< m/s^2, map frame; none: not said, the usual one
  std::string map_sha256{};                  ///< empty: not said
};

/// Of the comments that a YAML file begins with; none unless they name the base, as those of other programs.
/// @throws std::invalid_argument naming `file` and the comment that is not as exports write it, or one that
/// says that a load is taken or left on the way
std::optional<StatedTerms> stated_in_comments(const std::string& text, const std::filesystem::path& file);

/// Of the keys of our JSON; none unless it has `base`. @param text that `root` was read from
/// @throws std::invalid_argument as YamlFields and JsonField
std::optional<StatedTerms> stated_in_json(const YamlFields& root, const std::string& text,
                                          const std::filesystem::path& file);

/// States them in the plan that is made of the trajectory.
void state_terms(const StatedTerms& stated, Plan& plan);

/// Why an export with events is not judged, for a sentence that names where they are.
extern const char* const expected_no_events;

}  // namespace clearway

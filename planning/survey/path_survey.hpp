#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "planning/check/check_legs.hpp"
#include "planning/check/path_check.hpp"
#include "planning/survey/path_poses.hpp"
#include "planning/survey/swept_voxels.hpp"

namespace clearway {

/// A part that leaves the map's bounds, which its policy, `not_occupied`, would let pass in silence.
struct LeavingPart {
  std::string part;
  double distance =
      0.0;  ///< metres between the boxes around part and map, where it is largest; infinite for an empty map
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< the middle of the part there, map frame
  PathPlace place;
};

/// What the map knows of where the robot goes: says how much a verdict "valid" rests on.
struct PathSurvey {
  std::optional<SweptVoxels> swept;
  std::vector<StandingContact> standing;
  std::vector<LeavingPart> leaving;  ///< in the robot's order
  std::vector<std::string>
      unknown_free;  ///< parts with the policy `not_occupied`, for which unknown counts as free
  std::vector<std::string> only_seen = {};  ///< Robot::only_seen
  bool is_of_obstacles_alone = false;       ///< the map has neither paint nor voxels that were seen free
};

/// What a user allows by name, or asks for beyond the contract of check_path.
struct SurveyDemands {
  std::vector<std::string> allow_outside = {};  ///< parts that may leave the map's bounds; "all": every part
  /// Bodies that no joint moves must not touch occupied voxels, and every link that is seen must have a body.
  bool strict = false;
};

/// Surveys the path (it may be empty, or of one waypoint). Parts that `policies` does not name are
/// `not_occupied`.
///
/// The map's bounds are the box around all voxels that it stores. A part with the policy `not_occupied`
/// leaves them when, somewhere on the path, none of it is inside. A map without voxels that were seen free
/// does not say where its sensors looked: there no part leaves unless the box is farther from all that the
/// robot can reach, its base included, than that is wide. Precondition: every waypoint has as many values as
/// the robot has joints, all finite.
/// @throws std::invalid_argument for a path that moves a body over more than a million voxels.
PathSurvey survey_path(const Robot& robot, const Snapshot& map, const std::map<std::string, Policy>& policies,
                       const std::vector<Configuration>& path);

/// Whether parts can leave the map, as survey_path says of its bounds.
bool can_be_left(const Robot& robot, const Snapshot& map);

/// Whether `allow_outside` holds the part, or "all".
bool is_allowed_outside(const std::string& part, const std::vector<std::string>& allow_outside);

/// "tool leaves the map's bounds by 0.3 m at (1, 0, 0.5)"
std::string to_text(const LeavingPart& leaving);

/// ": nothing is known of that place, ..., allow it by name with --allow-outside PART": ends the sentence of
/// a refusal.
std::string why_refused_outside(const std::string& part);

/// The same of legs on which the robot carries different loads, in one: edges are numbered as if it were one
/// path, and a voxel that is swept on two legs with different loads counts twice.
PathSurvey survey_legs(const std::vector<LegsToCheck>& legs, const std::map<std::string, Policy>& policies);

/// Takes the word "valid" back from a path that is refused for what was surveyed; `first_contact` says why.
void refuse_surveyed(const PathSurvey& survey, const SurveyDemands& demands, PathVerdict& verdict);

/// One sentence that says why the path is refused for what was surveyed; none when it is not.
std::optional<std::string> refusal(const PathSurvey& survey, const SurveyDemands& demands);

/// "unknown space counts as free for link1, link2 (policy not_occupied)", or that the map holds obstacles
/// alone; empty where no part has that policy.
std::string unknown_sentence(const PathSurvey& survey);

/// "links a, b have a visual shape but no collision shape: nothing of them is checked"; of many the first few
/// by name. Empty where there are none.
std::string only_seen_sentence(const std::vector<std::string>& links);

/// The survey as the text of one JSON object: swept, unknown_counts_as_free_for, note, standing_in_occupied,
/// outside_map, and where there are some links_without_collision_shape. Lengths in metres.
std::string to_json(const PathSurvey& survey);

/// "link0 touches 12 occupied voxels, the lowest at (0, 0, -0.01)", of all that stand so; empty when none
/// does.
std::string describe_standing(const std::vector<StandingContact>& standing);

/// @param what names the parts in the error: "--allow-outside".
/// @throws std::invalid_argument when a part that may leave is neither "all" nor one of the robot's.
void require_parts(const std::vector<std::string>& allow_outside, const Robot& robot,
                   const std::string& what);

}  // namespace clearway

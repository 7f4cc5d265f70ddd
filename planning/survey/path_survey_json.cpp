#include <nlohmann/json.hpp>

#include "planning/survey/path_survey.hpp"

namespace clearway {
namespace {

using Json = nlohmann::ordered_json;

Json numbers(const Eigen::Vector3d& point) { return {point.x(), point.y(), point.z()}; }

Json swept_json(const SweptVoxels& swept) {
  Json json = {{"voxels", swept.total()}, {"litres", swept.litres(swept.total())}, {"voxel_m", swept.edge}};
  for (const auto& [name, voxels] :
       {std::pair{"unknown", swept.unknown}, std::pair{"beyond_bounds", swept.beyond},
        std::pair{"seen_once", swept.seen_once}, std::pair{"seen_free", swept.seen_free},
        std::pair{"painted", swept.painted}, std::pair{"occupied", swept.occupied}}) {
    json[name] = {{"voxels", voxels}, {"litres", swept.litres(voxels)}, {"share", swept.share(voxels)}};
  }
  if (swept.maybe_by_hand > 0)
    json["maybe_by_hand"] = {{"voxels", swept.maybe_by_hand},
                             {"litres", swept.litres(swept.maybe_by_hand)},
                             {"share", swept.share(swept.maybe_by_hand)}};
  if (swept.oldest_look) json["oldest_look_s"] = *swept.oldest_look;
  return json;
}

}  // namespace

std::string to_json(const PathSurvey& survey) {
  Json json = Json::object();
  if (survey.swept) json["swept"] = swept_json(*survey.swept);
  json["unknown_counts_as_free_for"] = survey.unknown_free;
  if (const std::string note = unknown_sentence(survey); !note.empty()) json["note"] = note;
  json["standing_in_occupied"] = Json::array();
  for (const StandingContact& contact : survey.standing) {
    json["standing_in_occupied"].push_back(
        {{"part", contact.part}, {"voxels", contact.voxels}, {"lowest", numbers(contact.lowest)}});
  }
  json["outside_map"] = Json::array();
  for (const LeavingPart& leaving : survey.leaving) {
    json["outside_map"].push_back({{"part", leaving.part},
                                   {"distance_m", leaving.distance},
                                   {"point", numbers(leaving.point)},
                                   {"edge", leaving.place.edge},
                                   {"parameter", leaving.place.parameter}});
  }
  if (!survey.only_seen.empty()) json["links_without_collision_shape"] = survey.only_seen;
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace clearway

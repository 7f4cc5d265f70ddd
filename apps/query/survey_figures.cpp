#include "apps/query/survey_figures.hpp"

#include "apps/console/parse.hpp"

namespace clearway {
namespace {

std::string millimetres(double length) { return significant(length * 1000.0, 3) + " mm"; }

std::string percent(const SweptVoxels& swept, std::size_t voxels) {
  return significant(100.0 * swept.share(voxels), 3) + " %";
}

std::string oldest_look(const SweptVoxels& swept) {
  if (swept.oldest_look.value_or(0.0) == 0.0) return {};
  return " (last seen up to " + significant(*swept.oldest_look, 3) + " s before the map's newest look)";
}

std::string maybe_by_hand(const SweptVoxels& swept) {
  if (swept.maybe_by_hand == 0) return {};
  return " (of " + percent(swept, swept.maybe_by_hand) +
         " no later look is known: they may be free by hand alone)";
}

std::string describe_swept(const SweptVoxels& swept) {
  const double litres = swept.litres(swept.total());
  std::string text =
      (litres < 1000.0 ? significant(litres, 3) + " l" : significant(litres / 1000.0, 3) + " m^3") + " (" +
      counted(swept.total(), "voxel") + "): ";
  text += percent(swept, swept.unknown) + " unknown";
  if (swept.beyond > 0) text += " (" + percent(swept, swept.beyond) + " beyond the map's bounds)";
  text += ", " + percent(swept, swept.seen_once) + " seen once, " +
          percent(swept, swept.seen_free - swept.seen_once) + " seen free more often" + oldest_look(swept) +
          maybe_by_hand(swept) + ", " + percent(swept, swept.painted) + " painted";
  if (swept.occupied > 0) text += ", " + percent(swept, swept.occupied) + " occupied";
  return text;
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

}  // namespace

std::vector<std::pair<std::string, std::string>> survey_figures(const PathSurvey& survey) {
  std::vector<std::pair<std::string, std::string>> rows;
  if (survey.swept) rows.emplace_back("swept volume", describe_swept(*survey.swept));
  if (const std::string note = unknown_sentence(survey); !note.empty()) rows.emplace_back("note", note);
  if (const std::string note = only_seen_sentence(survey.only_seen); !note.empty())
    rows.emplace_back("note", note);
  if (!survey.standing.empty()) rows.emplace_back("standing", describe_standing(survey.standing));
  if (!survey.leaving.empty()) {
    std::vector<std::string> parts;
    for (const LeavingPart& part : survey.leaving) {
      if (parts.empty() || parts.back() != part.part) parts.push_back(part.part);
    }
    rows.emplace_back("outside the map", joined(parts));
  }
  return rows;
}

std::string describe_padding(double padding, double position_accuracy, const std::string& source) {
  const std::string text = millimetres(padding) + source;
  if (position_accuracy <= 0.0) return text;
  if (padding == position_accuracy) return text + ", the robot's position accuracy";
  return text + (padding < position_accuracy ? ", less" : ", more") +
         " than the robot's position accuracy of " + millimetres(position_accuracy);
}

}  // namespace clearway

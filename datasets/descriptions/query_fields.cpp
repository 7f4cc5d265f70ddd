#include "datasets/descriptions/query_fields.hpp"

#include "datasets/yaml/yaml_fields.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {

RobotTermsSetup read_robot_terms(const YamlFields& fields, const std::filesystem::path& folder) {
  RobotTermsSetup terms;
  if (fields.has("srdf")) terms.srdf = folder / fields.file("srdf");
  if (fields.has("group")) terms.group = fields.text("group");
  if (fields.has("fixed")) {
    const YamlFields fixed = fields.map("fixed");
    for (const std::string& joint : fixed.keys()) terms.fixed[joint] = fixed.number(joint, within_reach);
  }
  if (fields.has("xacro")) {
    const YamlFields xacro = fields.map("xacro");
    for (const std::string& name : xacro.keys()) terms.xacro[name] = xacro.prose(name, "");
  }
  if (!fields.has("packages")) return terms;
  const YamlFields packages = fields.map("packages");
  for (const std::string& name : packages.keys()) terms.packages[name] = folder / packages.file(name);
  return terms;
}

void read_start(const YamlFields& fields, WaySetup& way) {
  if (fields.is_word("start"))
    way.start_state = fields.text("start");
  else
    way.start = fields.angles("start");
  if (way.start.empty() && way.start_state.empty())
    fields.fail("start", "expected a number for each joint, or the name of a state");
}

void read_goals(const YamlFields& fields, WaySetup& way) {
  way.goals = fields.lists_among("goals");
  way.goal_states = fields.words_among("goals");
}

std::map<std::string, std::string> read_options(const YamlFields& fields) {
  std::map<std::string, std::string> options;
  for (const auto& key : fields.keys()) options[key] = fields.text_or_numbers(key);
  return options;
}

std::map<std::string, std::string> read_policies(const YamlFields& fields) {
  std::map<std::string, std::string> policies;
  for (const auto& key : fields.keys()) policies[key] = fields.text(key);
  for (const auto& [part, policy] : policies)
    if (policy != "painted" && policy != "known_free" && policy != "not_occupied")
      fields.fail(part, "expected painted, known_free or not_occupied, got " + quote(policy));
  return policies;
}

std::optional<double> read_padding(const YamlFields& fields) {
  if (!fields.has("padding") || fields.text("padding") == "auto") return std::nullopt;
  return fields.number("padding", paddings);
}

std::string name_as_file(const std::string& name) {
  std::string text = name;
  for (char& c : text) {
    const bool plain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                       std::string_view("._-=").find(c) != std::string_view::npos;
    if (!plain) c = '_';
  }
  return text.empty() || text[0] == '.' ? "_" + text : text;
}

void take_name(std::set<std::string>& taken, const std::string& name, const YamlFields& fields,
               const std::string& key) {
  if (taken.insert(name_as_file(name)).second) return;
  fields.fail(key, "'" + name +
                       "' is given twice; expected names that differ in letters, digits, '-', '=' or a '.' "
                       "that is not the first");
}

}  // namespace clearway

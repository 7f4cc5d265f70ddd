#include "apps/teach/teach_event.hpp"

#include "apps/teach/teach_keys.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <stdexcept>

#include "datasets/yaml/yaml_fields.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/nearest_name.hpp"
#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"
#include "planning/files/json_field.hpp"
#include "planning/files/json_text.hpp"

namespace clearway {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::string_view, teach_actions> action_names = {
    "paint_on", "paint_off", "erase_on", "erase_off", "object", "object_off",  "volume", "robot",
    "branch",   "start",     "via",      "goal",      "clear",  "pick",        "place",  "attach",
    "detach",   "plan",      "play",     "approve",   "undo",   "undo_stroke", "save",   "quit"};

/// Whether it is done where the virtual robot is, or at a configuration.
bool takes_place(TeachAction action) {
  return action == TeachAction::start || action == TeachAction::via || action == TeachAction::goal ||
         action == TeachAction::pick || action == TeachAction::place;
}

std::set<std::string> fields_of(TeachAction action) {
  std::set<std::string> fields = {"action"};
  if (action == TeachAction::volume) fields.merge(std::set<std::string>{"label", "critical_parts"});
  if (action == TeachAction::robot)
    fields.merge(
        std::set<std::string>{"robot", "scale", "base", "group", "fixed", "policies", "padding", "near"});
  if (takes_place(action)) fields.insert("q");
  if (action == TeachAction::object) fields.merge(std::set<std::string>{"name", "link", "mass", "touches"});
  if (action == TeachAction::pick) fields.merge(std::set<std::string>{"name", "approach", "lift", "contact"});
  if (action == TeachAction::plan) fields.merge(std::set<std::string>{"name", "planner", "options"});
  if (action == TeachAction::save || action == TeachAction::detach) fields.insert("name");
  if (action == TeachAction::attach) fields.merge(std::set<std::string>{"name", "load"});
  return fields;
}

/// A length or mass, of which none may be below 0.
double size_of(const JsonField& field) {
  const double value = field.number();
  if (value < 0.0 || value > 1e6) field.refuse("a number from 0 to 1e6");
  return value;
}

void read_object(const JsonField& line, TeachEvent& event) {
  if (event.action == TeachAction::object) line.at("name");
  if (line.has("link")) event.link = line.at("link").text();
  if (line.has("mass")) event.mass = size_of(line.at("mass"));
  if (line.has("approach")) event.approach = line.at("approach").numbers(3);
  if (line.has("lift")) event.lift = size_of(line.at("lift"));
  if (line.has("contact")) event.contact = size_of(line.at("contact"));
}

std::vector<double> numbers_of(const JsonField& field) {
  std::vector<double> values;
  for (const JsonField& item : field.items()) values.push_back(item.number());
  return values;
}

std::vector<std::string> texts_of(const JsonField& field) {
  std::vector<std::string> texts;
  for (const JsonField& item : field.items()) {
    texts.push_back(item.text());
    if (texts.back().empty()) item.refuse("a word");
  }
  return texts;
}

/// A plan's or map's name becomes the name of its file.
std::string file_name_of(const JsonField& field) {
  const std::string name = field.text();
  const bool is_plain = !name.empty() && name.size() <= 80 && name.front() != '.' &&
                        std::all_of(name.begin(), name.end(), [](unsigned char c) {
                          return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.';
                        });
  if (!is_plain) field.refuse("1 to 80 letters, digits, '_', '-' and '.'");
  return name;
}

TeachAction action_of(const JsonField& field) {
  const std::string name = field.text();
  const auto found = std::find(action_names.begin(), action_names.end(), name);
  if (found == action_names.end()) {
    const std::vector<std::string> known(action_names.begin(), action_names.end());
    field.fail("unknown action " + quote(name) + ": " + suggestion(name, known));
  }
  return static_cast<TeachAction>(found - action_names.begin());
}

/// Where a robot stands: numbers, or where the ball is.
void read_base(const JsonField& field, TeachEvent& event) {
  constexpr const char* expected = "x, y, z or x, y, z, roll, pitch, yaw (m, rad), or \"ball\"";
  event.base_at_ball = field.is_text() && field.text() == "ball";
  if (event.base_at_ball) return;
  if (field.is_text()) field.refuse(expected);
  event.robot.base = numbers_of(field);
  if (event.robot.base.size() != 3 && event.robot.base.size() != 6) field.refuse(expected);
}

RobotChoice robot_of(const JsonField& line) {
  RobotChoice robot;
  robot.robot = line.at("robot").text();
  if (line.has("scale")) robot.scale = scale_of(line.at("scale"));
  if (line.has("group")) robot.group = line.at("group").text();
  if (line.has("fixed"))
    for (const auto& [joint, value] : line.at("fixed").members()) {
      if (joint.empty() || joint.find('=') != std::string::npos)
        value.refuse("the name of a joint, without '='");
      robot.fixed.push_back(joint + "=" + to_text(value.number()));
    }
  if (line.has("policies"))
    for (const auto& [part, policy] : line.at("policies").members()) {
      if ((part + policy.text()).find('=') != std::string::npos)
        policy.refuse("a policy of a part, without '='");
      robot.policies.push_back(part == "default" ? policy.text() : part + "=" + policy.text());
    }
  if (line.has("padding")) robot.padding = padding_of(line.at("padding"));
  return robot;
}

/// A robot's file is named from the folder of the events, as a load's mesh is; one that is not there may be a
/// known robot, or named from where the program runs.
void take_own_robot(const std::filesystem::path& folder, RobotChoice& robot) {
  const std::filesystem::path own = folder / robot.robot;
  std::error_code error;
  if (std::filesystem::path(robot.robot).has_extension() && std::filesystem::is_regular_file(own, error))
    robot.robot = std::filesystem::weakly_canonical(own).string();
}

/// As in a load's file; JSON is YAML, so that one reader takes both. @param line as it is called in
/// complaints
TaughtLoad load_of(Json json, const std::string& line, const std::filesystem::path& folder) {
  if (json.is_object() && json.contains("mesh") && json["mesh"].is_string())
    json["mesh"] = std::filesystem::weakly_canonical(folder / json["mesh"].get<std::string>()).string();
  TaughtLoad load;
  load.json = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  const std::string what = line + ": field 'load'";
  try {
    load.setup = read_load(YamlFields(load.json, what), {});
  } catch (const std::invalid_argument& error) {
    std::string sentence = error.what();  // there is one line alone
    if (sentence.starts_with(what + ", line 1")) sentence.erase(what.size(), std::string(", line 1").size());
    throw std::invalid_argument(sentence);
  }
  json["name"] = load.setup.name;  // YAML takes 5 for a text
  load.json = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  return load;
}

/// The load itself, or the name of one that the setup has.
void read_attach(const Json& json, const JsonField& line, const std::string& name,
                 const std::filesystem::path& folder, TeachEvent& event) {
  if (line.has("load") == line.has("name"))
    line.refuse("to have either 'load', a load, or 'name', that of a load of the setup");
  if (!line.has("load")) return;
  event.load = load_of(json["load"], name, folder);
  if (!event.load->setup.legs.empty())
    line.at("load").refuse("no 'legs': a load rides from 'attach' to 'detach'");
  event.name = event.load->setup.name;
}

PlannerOptions options_of(const JsonField& field) {
  PlannerOptions options;
  for (const auto& [key, value] : field.members()) options[key] = value.text();
  return options;
}

/// Of a load as it is written in files of loads; of plans and maps it becomes the name of a file.
std::string name_of(const JsonField& line, TeachAction action) {
  const bool is_of_file = action == TeachAction::plan || action == TeachAction::save;
  return !is_of_file ? line.at("name").text() : file_name_of(line.at("name"));
}

double time_of(const JsonField& field) {
  const double time = field.number();
  if (time < 0.0) field.refuse("seconds after the first frame, 0 or more");
  constexpr double longest = 1e6;  // eleven days
  if (time > longest) field.refuse("seconds after the first frame, at most 1000000, and not since 1970");
  return time;
}

/// All but its time. @param when the field that says when it happens
TeachEvent event_of(const JsonField& line, const char* when) {
  TeachEvent event;
  line.at(when);
  event.action = action_of(line.at("action"));
  std::set<std::string> known = fields_of(event.action);
  known.insert(when);
  for (const auto& [key, value] : line.members()) {
    if (known.contains(key)) continue;
    const std::vector<std::string> names(known.begin(), known.end());
    value.fail("action " + quote(to_string(event.action)) + " has no such field: " + suggestion(key, names));
  }
  if (line.has("name")) event.name = name_of(line, event.action);
  if (event.action == TeachAction::volume) event.name = line.at("label").text();
  if (line.has("critical_parts")) event.critical_parts = texts_of(line.at("critical_parts"));
  if (event.action == TeachAction::robot) {
    event.robot = robot_of(line);
    if (line.has("base")) read_base(line.at("base"), event);
  }
  read_object(line, event);
  if (line.has("touches")) event.touches = texts_of(line.at("touches"));
  if (line.has("near")) event.near = numbers_of(line.at("near"));
  if (line.has("q")) event.q = line.at("q").text();
  if (line.has("planner")) event.planner = line.at("planner").text();
  if (line.has("options")) event.options = options_of(line.at("options"));
  return event;
}

/// "part=policy" texts as an object again.
Json policies_json(const std::vector<std::string>& texts) {
  Json json = Json::object();
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos)
      json["default"] = text;
    else
      json[text.substr(0, equals)] = text.substr(equals + 1);
  }
  return json;
}

void add_robot(const TeachEvent& event, Json& json) {
  const RobotChoice& robot = event.robot;
  json["robot"] = robot.robot;
  if (robot.scale) json["scale"] = *robot.scale;
  if (!robot.base.empty()) json["base"] = robot.base;
  if (event.base_at_ball) json["base"] = "ball";
  if (!robot.group.empty()) json["group"] = robot.group;
  for (const std::string& text : robot.fixed)
    json["fixed"][text.substr(0, text.find('='))] = std::stod(text.substr(text.find('=') + 1));
  if (!robot.policies.empty()) json["policies"] = policies_json(robot.policies);
  if (robot.padding) json["padding"] = *robot.padding;
  if (!event.near.empty()) json["near"] = event.near;
}

void add_object(const TeachEvent& event, Json& json) {
  if (!event.link.empty()) json["link"] = event.link;
  if (event.mass > 0.0) json["mass"] = event.mass;
  if (!event.touches.empty()) json["touches"] = event.touches;
  if (event.approach) json["approach"] = {event.approach->x(), event.approach->y(), event.approach->z()};
  if (event.lift) json["lift"] = *event.lift;
  if (event.contact) json["contact"] = *event.contact;
}

}  // namespace

std::string_view to_string(TeachAction action) { return action_names.at(static_cast<std::size_t>(action)); }

namespace {

/// Calls `take` with each line's event, all but its time, and its fields.
template <class Take>
void read_events(const std::filesystem::path& file, const std::string& what, const char* when,
                 const Take& take) {
  constexpr std::size_t most_lines = 100'000;
  std::istringstream lines(read_input(file, what, 64U << 20U));
  std::size_t number = 0;
  for (std::string line; std::getline(lines, line);) {
    if (++number > most_lines)
      throw std::invalid_argument(what + " " + quote_path(file.string()) +
                                  ": expected at most 100,000 lines");
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    const std::string name = what + " " + quote_path(file.string()) + ", line " + std::to_string(number);
    require_json(line, name);
    const Json json = Json::parse(line);
    const JsonField field(json, name);
    TeachEvent event = event_of(field, when);
    if (event.action == TeachAction::robot) take_own_robot(file.parent_path(), event.robot);
    if (event.action == TeachAction::attach) read_attach(json, field, name, file.parent_path(), event);
    take(std::move(event), field);
  }
}

char key_of(const JsonField& field, const std::vector<TeachKey>& known) {
  const std::string text = field.text();
  if (text.size() != 1 || text[0] <= ' ' || text[0] > '~') field.refuse("one visible ASCII character");
  if (action_of_key(text[0], TeachState::ready)) field.refuse("a key that does nothing yet");
  for (const TeachKey& key : known)
    if (key.key == text[0]) field.refuse("each key once");
  return text[0];
}

}  // namespace

std::vector<TeachEvent> load_teach_events(const std::filesystem::path& file) {
  std::vector<TeachEvent> events;
  read_events(file, "events file", "time", [&](TeachEvent event, const JsonField& line) {
    event.time = time_of(line.at("time"));
    if (!events.empty() && event.time < events.back().time)
      line.at("time").refuse("a time not before the last line's");
    events.push_back(std::move(event));
  });
  return events;
}

std::vector<TeachKey> load_teach_keys(const std::filesystem::path& file) {
  std::vector<TeachKey> keys;
  read_events(file, "keys file", "key", [&](TeachEvent event, const JsonField& line) {
    keys.push_back({key_of(line.at("key"), keys), std::move(event)});
  });
  return keys;
}

std::string to_json_line(const TeachEvent& event) {
  Json json{{"time", event.time}, {"action", to_string(event.action)}};
  if (event.action == TeachAction::volume) json["label"] = event.name;
  if (!event.critical_parts.empty()) json["critical_parts"] = event.critical_parts;
  if (event.action == TeachAction::robot) add_robot(event, json);
  add_object(event, json);
  if (!event.q.empty()) json["q"] = event.q;
  if (event.action == TeachAction::plan) {
    json["planner"] = event.planner;
    if (!event.options.empty()) json["options"] = event.options;
  }
  if (event.load)
    json["load"] = Json::parse(event.load->json);
  else if (event.action == TeachAction::object ||
           (event.action != TeachAction::volume && !event.name.empty()))
    json["name"] = event.name;
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace clearway

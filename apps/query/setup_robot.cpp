#include "apps/query/setup_robot.hpp"

#include <filesystem>
#include <stdexcept>

#include "apps/console/flag_names.hpp"
#include "apps/query/query.hpp"
#include "mapping/system/number_text.hpp"

namespace clearway {
namespace {

/// Sentences about flags become those about the setup's keys.
template <class Load>
Robot in_place(const RobotSetup& setup, const Load& load) try {
  Robot robot = load();
  robot.map_from_base = setup.map_from_base;
  return robot;
} catch (const std::invalid_argument& error) {
  const std::string sentence = error.what(), said = with_keys(sentence);
  throw std::invalid_argument(said == sentence ? sentence : "setup, robot, " + said);
}

/// By their names alone: in a session that is done again the files may be gone.
bool is_same_robot(const std::string& one, const std::string& other) {
  const std::filesystem::path path = one;
  return path.lexically_normal() == std::filesystem::path(other).lexically_normal();
}

/// Adds those of `more`, "NAME=VALUE", whose names are not there yet.
void add_unsaid(const std::vector<std::string>& more, std::vector<std::string>& said) {
  const auto name_of = [](const std::string& text) { return text.substr(0, text.find('=')); };
  std::set<std::string> names;
  for (const std::string& text : said) names.insert(name_of(text));
  for (const std::string& text : more)
    if (!names.contains(name_of(text))) said.push_back(text);
}

}  // namespace

RobotChoice choice_of(const RobotSetup& setup) {
  const RobotTermsSetup& terms = setup.terms;
  RobotChoice choice;
  choice.robot = setup.name;
  choice.scale = setup.scale;
  choice.srdf = terms.srdf;
  choice.group = terms.group;
  for (const auto& [joint, value] : terms.fixed) choice.fixed.push_back(joint + "=" + to_text(value));
  for (const auto& [name, folder] : terms.packages) choice.packages.push_back(name + "=" + folder.string());
  for (const auto& [name, value] : terms.xacro) choice.xacro.push_back(name + ":=" + value);
  return choice;
}

RobotChoice with_terms_of(const RobotSetup& setup, RobotChoice asked) {
  if (!is_same_robot(asked.robot, setup.name)) return asked;
  const RobotChoice own = choice_of(setup);
  if (!asked.scale) asked.scale = own.scale;
  if (asked.srdf.empty()) asked.srdf = own.srdf;
  if (asked.group.empty() || asked.group == own.group) add_unsaid(own.fixed, asked.fixed);
  if (asked.group.empty()) asked.group = own.group;
  add_unsaid(own.packages, asked.packages);
  add_unsaid(own.xacro, asked.xacro);
  return asked;
}

Robot planned_robot(const RobotSetup& setup) {
  return in_place(setup, [&] { return choose_robot(choice_of(setup)); });
}

Robot recorded_robot(const RobotSetup& setup, const std::set<std::string>& moving) {
  return in_place(setup, [&] {
    RobotRequest request = robot_request(choice_of(setup));
    request.moving = moving;
    const Robot robot = load_robot(request);
    return setup.scale ? scaled(robot, *setup.scale / robot.scale) : robot;
  });
}

}  // namespace clearway

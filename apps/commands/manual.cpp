#include "apps/commands/manual.hpp"

#include <CLI/CLI.hpp>
#include <map>
#include <vector>

#include "apps/console/flags.hpp"
#include "apps/console/shipped_file.hpp"
#include "planning/files/trajectory_file.hpp"
#include "planning/planner_table.hpp"
#include "planning/robot_files/load_robot.hpp"

namespace clearway {
namespace {

std::vector<const CLI::App*> commands_of(const CLI::App& app) { return app.get_subcommands({}); }

/// "-o,--out FILE", "--json", or "SUITE.yaml" for what has no name.
std::string spelling(const CLI::Option& option) {
  std::string names;
  for (const std::string& name : option.get_snames()) names += (names.empty() ? "-" : ",-") + name;
  for (const std::string& name : option.get_lnames()) names += (names.empty() ? "--" : ",--") + name;
  const std::string type = option.get_items_expected_max() > 0 ? type_of(option) : "";
  return names + (names.empty() || type.empty() ? "" : " ") + type;
}

/// Text for roff: backslashes, and what a line may not begin with.
std::string roff(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '\\')
      result += "\\e";
    else if (c == '-')
      result += "\\-";
    else if ((c == '.' || c == '\'') && (result.empty() || result.back() == '\n'))
      result += std::string("\\&") + c;
    else
      result += c;
  }
  return result;
}

std::string roff_options(const CLI::App& command) {
  std::string text;
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_group().empty()) continue;
    text += ".TP\n.B " + roff(spelling(*option)) + "\n" + roff(option->get_description()) + "\n";
  }
  return text;
}

std::string flags_of(const CLI::App& command) {
  std::string words;
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_group().empty()) continue;
    for (const std::string& name : option->get_lnames()) words += (words.empty() ? "--" : " --") + name;
  }
  return words;
}

std::string names_of(const CLI::App& app) {
  std::string words;
  for (const CLI::App* command : commands_of(app)) words += (words.empty() ? "" : " ") + command->get_name();
  return words;
}

/// `text` inside single quotes of a shell, without what zsh takes for the end of a description.
std::string quoted(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '\'')
      result += "'\\''";
    else if (c == '[' || c == ']' || c == ':' || c == '\\')
      result += std::string("\\") + c;
    else
      result += c;
  }
  return result;
}

/// What may follow an option, or be a positional.
struct Offer {
  std::vector<std::string> values;
  bool has_files = true;  ///< files may, too
};

std::vector<std::string> planner_names() {
  std::vector<std::string> names;
  for (const PlannerEntry& planner : planner_table()) names.emplace_back(planner.name);
  return names;
}

std::vector<std::string> robot_names() {
  std::vector<std::string> names;
  for (const auto& [name, description] : available_robots()) names.push_back(name);
  return names;
}

std::vector<std::string> format_names() {
  std::vector<std::string> names;
  for (const TrajectoryFormat& format : trajectory_formats()) names.emplace_back(format.name);
  return names;
}

/// Suites, and what `clearway compare` does instead of running one.
std::vector<std::string> comparisons() {
  std::vector<std::string> words = shipped_names("suites");
  words.insert(words.end(), {"diff", "merge"});
  return words;
}

Offer offer_of(const CLI::Option& option) {
  if (std::vector<std::string> closed = values_of(option); !closed.empty()) return {closed, false};
  static const std::vector<std::string> policies{"painted", "known_free", "not_occupied"};
  static const std::map<std::string, Offer> known{{"robot", {robot_names(), true}},
                                                  {"planner", {planner_names(), false}},
                                                  {"policy", {policies, false}},
                                                  {"clearance", {policies, false}},
                                                  {"padding", {{"auto"}, false}},
                                                  {"trajectory", {format_names(), false}},
                                                  {"planners", {planner_names(), false}},
                                                  {"setup", {shipped_names("setups"), true}},
                                                  {"scene", {shipped_names("scenes"), true}},
                                                  {"suite", {comparisons(), true}}};
  const auto found =
      known.find(option.get_lnames().empty() ? option.get_single_name() : option.get_lnames().front());
  return found == known.end() ? Offer() : found->second;
}

std::string joined_words(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

/// The first that has no name of its own; null: there is none.
const CLI::Option* first_positional(const CLI::App& command) {
  for (const CLI::Option* option : command.get_options())
    if (option->get_positional()) return option;
  return nullptr;
}

/// A branch of bash's `case`, for a flag or `first`: what may come then.
std::string bash_branch(const std::string& pattern, const CLI::Option& option) {
  const Offer offer = offer_of(option);
  if (offer.values.empty()) return {};
  return "        " + pattern + ") values='" + joined_words(offer.values) + "'" +
         (offer.has_files ? "" : " closed=yes") + " ;;\n";
}

std::string bash_branches(const CLI::App& command) {
  std::string text;
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_group().empty() || option->get_lnames().empty()) continue;
    std::string pattern;
    for (const std::string& name : option->get_lnames()) pattern += (pattern.empty() ? "--" : "|--") + name;
    text += bash_branch(pattern, *option);
  }
  if (const CLI::Option* first = first_positional(command)) text += bash_branch("first", *first);
  return text;
}

std::string bash_completion(const CLI::App& app) {
  std::string text =
      "# bash completion for clearway, written by `clearway --completion bash`\n"
      "_clearway() {\n"
      "  local word=${COMP_WORDS[COMP_CWORD]} flag=${COMP_WORDS[COMP_CWORD-1]} flags= values= closed=\n"
      "  if [ \"$COMP_CWORD\" -eq 1 ]; then\n"
      "    COMPREPLY=($(compgen -W '" +
      names_of(app) + " " + flags_of(app) +
      "' -- \"$word\"))\n"
      "    return\n"
      "  fi\n"
      "  [ \"$flag\" != = ] || flag=${COMP_WORDS[COMP_CWORD-2]}\n"
      "  [ \"$word\" != = ] || word=\n"
      "  [ \"$COMP_CWORD\" -ne 2 ] || flag=first\n"
      "  case ${COMP_WORDS[1]} in\n";
  for (const CLI::App* command : commands_of(app)) {
    text += "    " + command->get_name() + ") flags='" + flags_of(*command) + "'\n";
    if (const std::string branches = bash_branches(*command); !branches.empty())
      text += "      case $flag in\n" + branches + "      esac\n";
    text += "      ;;\n";
  }
  return text +
         "  esac\n"
         "  case $word in\n"
         "    -*) COMPREPLY=($(compgen -W \"$flags\" -- \"$word\")) ;;\n"
         "    *) COMPREPLY=($(compgen -W \"$values\" -- \"$word\"))\n"
         "      [ -n \"$closed\" ] || COMPREPLY+=($(compgen -f -- \"$word\")) ;;\n"
         "  esac\n"
         "}\n"
         "complete -o filenames -F _clearway clearway\n";
}

/// What zsh is to do for a value.
std::string zsh_action(const CLI::Option& option) {
  const Offer offer = offer_of(option);
  if (offer.values.empty()) return "_files";
  const std::string values = joined_words(offer.values);
  return offer.has_files ? "{compadd " + values + "; _files}" : "(" + values + ")";
}

std::string zsh_completion(const CLI::App& app) {
  std::string text =
      "#compdef clearway\n# written by `clearway --completion zsh`\n"
      "_clearway() {\n"
      "  local -a commands=(\n";
  for (const CLI::App* command : commands_of(app))
    text += "    '" + command->get_name() + ":" + quoted(command->get_description()) + "'\n";
  text +=
      "  )\n"
      "  if (( CURRENT == 2 )); then\n"
      "    _describe command commands\n"
      "    return\n"
      "  fi\n"
      "  case $words[2] in\n";
  for (const CLI::App* command : commands_of(app)) {
    text += "    " + command->get_name() + ")\n      _arguments -S";
    for (const CLI::Option* option : command->get_options()) {
      if (option->get_group().empty()) continue;
      for (const std::string& name : option->get_lnames())
        text +=
            " \\\n        '*--" + name + "[" + quoted(option->get_description()) + "]" +
            (option->get_items_expected_max() > 0 ? ":" + quoted(type_of(*option)) + ":" + zsh_action(*option)
                                                  : "") +
            "'";
    }
    if (const CLI::Option* first = first_positional(*command))
      text += " \\\n        '2:" + quoted(type_of(*first)) + ":" + zsh_action(*first) + "'";
    text += " \\\n        '*:file:_files' ;;\n";
  }
  return text + "  esac\n}\n_clearway \"$@\"\n";
}

}  // namespace

std::string manual_page(const CLI::App& app) {
  std::string text = ".TH CLEARWAY 1 \"\" \"clearway " CLEARWAY_VERSION
                     "\" \"User Commands\"\n"
                     ".SH NAME\nclearway \\- " +
                     roff(app.get_description()) +
                     "\n.SH SYNOPSIS\n.B clearway\n.I command\n.RI [ flags ]\n.SH OPTIONS\n" +
                     roff_options(app) + ".SH COMMANDS\n";
  for (const CLI::App* command : commands_of(app)) {
    text += ".SS " + command->get_name() + "\n" + roff(command->get_description()) + "\n" +
            roff_options(*command);
  }
  return text +
         ".SH EXIT STATUS\n0 done, 1 the answer is no, 2 usage or bad input, 3 damaged input.\n"
         ".SH ENVIRONMENT\n.TP\n.B CLEARWAY_DATASETS\n"
         "folder of robots, scenes, setups and suites, instead of the one that comes with the program\n"
         ".TP\n.B CLEARWAY_THREADS\n"
         "number of threads, 1 to 64, instead of one for each core; results do not depend on it\n"
         ".TP\n.B CLEARWAY_MRPT_DATASETS\n"
         "what ${MRPT_DATASETS} in a scene stands for, instead of /usr/share/mrpt/datasets\n"
         ".TP\n.B NO_COLOR\n"
         "where set, slices in the terminal have no colours\n"
         ".SH FILES\nBelow share/doc/clearway where it is installed, else in the sources:\n"
         ".TP\n.B datasets/FORMATS.md\n"
         "recordings, setups, scenes, events, loads, picks, truth: every field\n"
         ".TP\n.B datasets/suites/FORMAT.md\n"
         "suites and imported problem sets\n"
         ".TP\n.B apps/OUTPUTS.md\n"
         "files and JSON that the program writes: every key and column\n"
         ".SH EXAMPLES\n.nf\nclearway robots\n"
         "clearway simulate miniature_kitchen \\-\\-out kitchen.rawlog\n"
         "clearway replay kitchen.rawlog \\-\\-out kitchen\n"
         "clearway compare quick \\-\\-out quick\n.fi\n";
}

std::string completion(const CLI::App& app, const std::string& shell) {
  return shell == "zsh" ? zsh_completion(app) : bash_completion(app);
}

}  // namespace clearway

#include "apps/commands/manual.hpp"

#include <CLI/CLI.hpp>
#include <functional>
#include <utility>
#include <vector>

namespace clearway {
namespace {

std::vector<const CLI::App*> commands_of(const CLI::App& app) { return app.get_subcommands({}); }

/// "-o,--out FILE", "--json", or "SUITE.yaml" for what has no name.
std::string spelling(const CLI::Option& option) {
  std::string names;
  for (const std::string& name : option.get_snames()) names += (names.empty() ? "-" : ",-") + name;
  for (const std::string& name : option.get_lnames()) names += (names.empty() ? "--" : ",--") + name;
  const std::string type = option.get_items_expected_max() > 0 ? option.get_type_name() : "";
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

std::string bash_completion(const CLI::App& app) {
  std::string text =
      "# bash completion for clearway, written by `clearway --completion bash`\n"
      "_clearway() {\n"
      "  local word=${COMP_WORDS[COMP_CWORD]} flags=\n"
      "  if [ \"$COMP_CWORD\" -eq 1 ]; then\n"
      "    COMPREPLY=($(compgen -W '" +
      names_of(app) + " " + flags_of(app) +
      "' -- \"$word\"))\n"
      "    return\n"
      "  fi\n"
      "  case ${COMP_WORDS[1]} in\n";
  for (const CLI::App* command : commands_of(app))
    text += "    " + command->get_name() + ") flags='" + flags_of(*command) + "' ;;\n";
  return text +
         "  esac\n"
         "  case $word in\n"
         "    -*) COMPREPLY=($(compgen -W \"$flags\" -- \"$word\")) ;;\n"
         "    *) COMPREPLY=($(compgen -f -- \"$word\")) ;;\n"
         "  esac\n"
         "}\n"
         "complete -o filenames -F _clearway clearway\n";
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
            (option->get_items_expected_max() > 0 ? ":" + quoted(option->get_type_name()) + ":_files" : "") +
            "'";
    }
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
         ".SH EXAMPLES\n.nf\nclearway robots\n"
         "clearway simulate miniature_kitchen \\-\\-out kitchen.rawlog\n"
         "clearway replay kitchen.rawlog \\-\\-out kitchen\n"
         "clearway compare quick \\-\\-out quick\n.fi\n";
}

std::string completion(const CLI::App& app, const std::string& shell) {
  return shell == "zsh" ? zsh_completion(app) : bash_completion(app);
}

}  // namespace clearway

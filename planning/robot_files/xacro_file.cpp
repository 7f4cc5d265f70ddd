#include "planning/robot_files/xacro_file.hpp"

#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <tinyxml2.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <set>
#include <stdexcept>
#include <vector>

#include "mapping/system/child_process.hpp"
#include "mapping/system/input_file.hpp"
#include "mapping/system/nearest_name.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

constexpr int no_such_program = 127;

/// @param words of its command line, the program first
[[noreturn]] void become_xacro(int output, std::vector<std::string>& words) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  ::dup2(output, STDOUT_FILENO);
  ::execvp("xacro", arguments.data());
  ::_exit(errno == ENOENT ? no_such_program : 1);
}

/// All that is written, or a little more than `most` bytes.
std::string read_up_to(int descriptor, std::size_t most) {
  std::string text;
  std::array<char, 65536> buffer{};
  while (text.size() <= most + 1) {
    const ssize_t count = ::read(descriptor, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    text.append(buffer.data(), static_cast<std::size_t>(count));
  }
  return text;
}

/// Runs in the child, which its limits hold: the exit status as one byte, and what xacro wrote.
std::string run_xacro(std::vector<std::string> words, std::size_t largest) {
  std::array<int, 2> ends{};
  if (::pipe(ends.data()) != 0) return "\1";
  const pid_t xacro = ::fork();
  if (xacro < 0) return "\1";
  if (xacro == 0) become_xacro(ends[1], words);
  ::close(ends[1]);
  const std::string text = read_up_to(ends[0], largest);
  if (text.size() > largest) ::kill(xacro, SIGKILL);
  int status = 0;
  while (::waitpid(xacro, &status, 0) < 0 && errno == EINTR) {
  }
  return std::string(1, static_cast<char>(WIFEXITED(status) ? WEXITSTATUS(status) : 1)) + text;
}

std::string answer_of_xacro(const std::vector<std::string>& words, const std::filesystem::path& file,
                            std::size_t largest) {
  const ChildOutcome run =
      run_in_child([&] { return run_xacro(words, largest); },
                   {.memory = std::size_t{1} << 30U, .output = largest + 1, .seconds = 20, .patience = 3});
  if (!run.finished || run.parts.empty() || run.parts.front().empty())
    throw std::invalid_argument(file.string() + ": xacro could not expand it: " + run.failure);
  const std::string& answer = run.parts.front();
  if (answer.front() == no_such_program)
    throw std::invalid_argument(file.string() +
                                ": the program 'xacro' is not installed, expected it or a .urdf that it made "
                                "(xacro FILE NAME:=VALUE > robot.urdf)");
  if (answer.front() != 0)
    throw std::invalid_argument(file.string() +
                                ": xacro could not expand it, expected a xacro file whose includes are "
                                "found and whose arguments --xacro NAME:=VALUE or the settings' xacro: "
                                "give");
  return answer.substr(1);
}

}  // namespace

namespace {

/// Names of arguments in a xacro file and those that it includes.
class XacroNames {
 public:
  explicit XacroNames(const PackageFolders& packages) : packages_(packages) {}

  /// False: a part of it cannot be found or read.
  bool add(const std::filesystem::path& file) {
    constexpr std::size_t most_files = 200, largest = 16U << 20U;
    if (!seen_.insert(file.lexically_normal().string()).second) return true;
    if (seen_.size() > most_files) return false;
    std::string text;
    try {
      text = read_input(file, "xacro file", largest);
    } catch (const std::exception&) {
      return false;
    }
    add_used(text);
    tinyxml2::XMLDocument xml;
    if (xml.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) return false;
    return add_below(xml, file);
  }

  const std::set<std::string>& names() const { return names_; }

 private:
  void add_used(const std::string& text) {
    const std::string opening = "$(arg ";
    for (std::size_t at = text.find(opening); at != std::string::npos; at = text.find(opening, at + 1)) {
      const std::size_t end = text.find(')', at);
      if (end == std::string::npos) return;
      std::string name = text.substr(at + opening.size(), end - at - opening.size());
      std::erase(name, ' ');
      names_.insert(std::move(name));
    }
  }

  bool add_below(const tinyxml2::XMLNode& node, const std::filesystem::path& file) {
    for (const auto* at = node.FirstChildElement(); at != nullptr; at = at->NextSiblingElement()) {
      const std::string kind = at->Name();
      if (const char* name = at->Attribute("name"); kind == "xacro:arg" && name != nullptr)
        names_.insert(name);
      if (const char* name = at->Attribute("filename"); kind == "xacro:include" && name != nullptr)
        if (!add_include(name, file.parent_path())) return false;
      if (!add_below(*at, file)) return false;
    }
    return true;
  }

  /// `rest` of the folder, or `$(find PACKAGE)/rest`; what else xacro computes is not known here.
  bool add_include(std::string name, const std::filesystem::path& folder) {
    const std::string opening = "$(find ";
    if (name.starts_with(opening) && name.find(')') != std::string::npos)
      name.replace(name.find(')'), 1, "").replace(0, opening.size(), "package://");
    if (name.find('$') != std::string::npos) return false;
    try {
      return add(find_mesh(name, folder, packages_));
    } catch (const std::invalid_argument&) {
      return false;
    }
  }

  const PackageFolders& packages_;
  std::set<std::string> seen_, names_;
};

}  // namespace

std::vector<std::string> xacro_notes(const std::filesystem::path& file, const XacroArguments& arguments,
                                     const PackageFolders& packages) {
  std::vector<std::string> notes;
  XacroNames found(packages);
  if (arguments.empty() || !found.add(file)) return notes;
  const std::vector<std::string> known(found.names().begin(), found.names().end());
  for (const auto& [name, value] : arguments) {
    if (found.names().contains(name)) continue;
    notes.push_back("xacro argument " + quote(name) + " has no effect, as " + quote_path(file.string()) +
                    " does not declare it, " + suggestion(name, known));
  }
  return notes;
}

bool is_xacro_name(const std::string& name) {
  const auto is_part = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  };
  return !name.empty() && std::all_of(name.begin(), name.end(), is_part);
}

std::string expanded_xacro(const std::filesystem::path& file, std::size_t largest,
                           const XacroArguments& arguments) {
  std::vector<std::string> words{"xacro", whole_input_path(file).string()};
  for (const auto& [name, value] : arguments) {
    if (!is_xacro_name(name))
      throw std::invalid_argument(file.string() + ": xacro argument " + quote(name) +
                                  ": expected a name of letters, digits and underscores");
    words.push_back(name + ":=" + value);
  }
  std::string question;
  for (const std::string& word : words) question += (question.empty() ? "" : " ") + word;
  return kept_answer(question, [&] { return answer_of_xacro(words, file, largest); });
}

}  // namespace clearway

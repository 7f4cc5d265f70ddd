#include "apps/compare/compare_files.hpp"

#include <algorithm>
#include <string_view>

namespace clearway {

std::string name_as_file(const std::string& name) {
  std::string text = name;
  for (char& c : text) {
    const bool plain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                       std::string_view("._-=").find(c) != std::string_view::npos;
    if (!plain) c = '_';
  }
  return text.empty() || text[0] == '.' ? "_" + text : text;
}

std::vector<std::string> names_as_files(const std::vector<ComparePlanner>& planners) {
  std::vector<std::string> names;
  for (const ComparePlanner& planner : planners) {
    std::string name = name_as_file(planner.label);
    while (std::find(names.begin(), names.end(), name) != names.end()) name += "_";
    names.push_back(name);
  }
  return names;
}

}  // namespace clearway

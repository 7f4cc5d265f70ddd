#pragma once

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "tests/worlds/temporary_folder.hpp"

namespace clearway {

/// apps/OUTPUTS.md: what the program writes, key by key, read from the tables of the page.
class OutputsPage {
 public:
  using Json = nlohmann::json;

  /// @param text of a page: below each title tables whose first column is "key" or "column". A row names keys
  /// ("legs[].status"), or a place and the section of the keys below it ("`loads[]`: [load](#load)").
  explicit OutputsPage(const std::string& text) {
    std::istringstream lines(text);
    std::string title, head;
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with("#")) title = line.substr(line.find_first_not_of("# "));
      if (!line.starts_with("|")) {
        head.clear();
        continue;
      }
      const std::vector<std::string> cells = cells_of(line);
      if (head.empty())
        head = cells.front();
      else if ((head == "key" || head == "column") && !cells.front().starts_with("---"))
        add_row(cells, title);
    }
  }

  /// The page of the sources.
  static const OutputsPage& written() {
    static const OutputsPage page(read_file(CLEARWAY_SOURCE_DIR "/apps/OUTPUTS.md"));
    return page;
  }

  /// The keys of a section, in their order, as its rows spell them.
  std::vector<std::string> keys(const std::string& section) const {
    std::vector<std::string> names;
    for (const Row& row : rows(section))
      if (row.link.empty()) names.push_back(row.path);
    return names;
  }

  std::vector<std::string> sections() const {
    std::vector<std::string> titles;
    for (const auto& [title, rows] : sections_) titles.push_back(title);
    return titles;
  }

  /// What `json` holds that the section does not describe, what it lacks although no row calls it "absent",
  /// and what is of another type; a sentence each, once.
  std::set<std::string> complaints(const Json& json, const std::string& section) const {
    Place root;
    grow(section, root);
    std::set<std::string> found;
    compare(json, {&root}, section, found);
    return found;
  }

  /// "### Trajectory, json" is #trajectory-json.
  static std::string anchor_of(const std::string& title) {
    std::string anchor;
    for (const char c : title) {
      if (c == ' ') anchor += '-';
      if (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_')
        anchor += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
    return anchor;
  }

 private:
  struct Row {
    std::string path, link, type;  ///< link: of the section whose keys stand there; empty: it is a key
    bool may_be_absent = false;
  };

  /// A place in the JSON: what may be there, and the places below it by name ("[]": entries of a list).
  struct Place {
    std::string type;
    bool may_be_absent = true;
    std::map<std::string, Place> below;
  };

  static std::vector<std::string> cells_of(const std::string& line) {
    std::vector<std::string> cells;
    std::istringstream text(line.substr(1));
    for (std::string cell; std::getline(text, cell, '|');) {
      const std::size_t first = cell.find_first_not_of(' ');
      cells.push_back(
          first == std::string::npos ? "" : cell.substr(first, cell.find_last_not_of(' ') + 1 - first));
    }
    return cells;
  }

  void add_row(const std::vector<std::string>& cells, const std::string& section) {
    if (cells.size() != 3) throw std::invalid_argument(section + ": " + cells[0] + " is not in three cells");
    static const std::regex quoted("`([^`]+)`"), link(R"(\]\(#([^)]+)\))");
    std::vector<std::string> names;
    for (std::sregex_iterator at(cells[0].begin(), cells[0].end(), quoted), end; at != end; ++at)
      names.push_back((*at)[1]);
    std::smatch match;
    const std::string target = std::regex_search(cells[0], match, link) ? match[1].str() : "";
    if (names.empty()) names.emplace_back();
    const std::vector<std::string> types = types_of(cells[1]);
    const bool may_be_absent = cells[2].find("absent") != std::string::npos;
    for (std::size_t i = 0; i < names.size(); ++i) {
      const std::string type = types.empty() ? "" : types.size() == names.size() ? types[i] : types.front();
      if (target.empty() && type.empty())
        throw std::invalid_argument(section + ": " + names[i] + " has no type");
      sections_[section].push_back({names[i], target, type, may_be_absent});
    }
  }

  /// "number or null, m" is a type and its unit; "text, count" are the types of two keys.
  static std::vector<std::string> types_of(const std::string& cell) {
    std::vector<std::string> types;
    std::istringstream words(cell);
    for (std::string word; std::getline(words, word, ',');) {
      word.erase(0, word.find_first_not_of(' '));
      const std::string type = word.substr(0, word.find(" or "));
      if (is_type(type)) types.push_back(word);
    }
    return types;
  }

  static bool is_type(const std::string& word) {
    static const std::set<std::string> known = {
        "any",           "text",           "texts", "flag", "count",  "number",
        "list",          "numbers",        "point", "pose", "matrix", "quaternion pose",
        "configuration", "configurations", "object"};
    return known.contains(word);
  }

  static bool are_numbers(const Json& json, std::size_t count = 0) {
    return json.is_array() && (count == 0 || json.size() == count) &&
           std::all_of(json.begin(), json.end(), [](const Json& value) { return value.is_number(); });
  }

  static bool is_of(const Json& json, const std::string& type) {
    const std::string name = type.substr(0, type.find(" or "));
    const auto all = [&](const auto& is) {
      return json.is_array() && std::all_of(json.begin(), json.end(), is);
    };
    if (json.is_null()) return type.ends_with("or null");
    if (name == "text") return json.is_string();
    if (name == "texts") return all([](const Json& value) { return value.is_string(); });
    if (name == "flag") return json.is_boolean();
    if (name == "count") return json.is_number_unsigned();
    if (name == "number") return json.is_number();
    if (name == "numbers" || name == "configuration") return are_numbers(json);
    if (name == "point") return are_numbers(json, 3);
    if (name == "pose") return are_numbers(json, 6);
    if (name == "quaternion pose") return are_numbers(json, 7);
    if (name == "matrix") return json.size() == 4 && all([](const Json& row) { return are_numbers(row, 4); });
    if (name == "configurations") return all([](const Json& q) { return are_numbers(q); });
    if (name == "list") return json.is_array();
    return name == "any" || json.is_object();
  }

  const std::vector<Row>& rows(const std::string& section) const {
    const auto found = sections_.find(section);
    if (found == sections_.end()) throw std::invalid_argument("OUTPUTS.md has no section '" + section + "'");
    return found->second;
  }

  /// Puts the keys of a section below a place.
  void grow(const std::string& section, Place& root) const {
    for (const Row& row : rows(section)) {
      Place* place = &root;
      std::istringstream names(row.path);
      for (std::string name; std::getline(names, name, '.');) {
        std::size_t lists = 0;
        for (; name.ends_with("[]"); ++lists) name.resize(name.size() - 2);
        place = &place->below[name];
        for (; lists > 0; --lists) place = &place->below["[]"];
      }
      if (row.link.empty()) {
        place->type = row.type;
        place->may_be_absent = row.may_be_absent;
        continue;
      }
      for (const std::string& title : sections())
        if (anchor_of(title) == row.link) grow_below(title, row.may_be_absent, *place);
    }
  }

  void grow_below(const std::string& section, bool may_be_absent, Place& place) const {
    Place part;
    grow(section, part);
    for (auto& [name, below] : part.below) {
      below.may_be_absent = below.may_be_absent || may_be_absent;
      place.below[name] = std::move(below);
    }
  }

  /// `*` in a name of the page stands for any text.
  static bool is_named(const std::string& key, const std::string& name) {
    const std::size_t star = name.find('*');
    if (star == std::string::npos) return key == name;
    const std::string_view begin = std::string_view(name).substr(0, star),
                           end = std::string_view(name).substr(star + 1);
    return key.size() >= begin.size() + end.size() && key.starts_with(begin) && key.ends_with(end);
  }

  /// @param at of the page, that all stand for this place @param name of the place, for complaints
  static void compare(const Json& json, const std::vector<const Place*>& at, const std::string& name,
                      std::set<std::string>& found) {
    const bool is_any =
        std::any_of(at.begin(), at.end(), [](const Place* place) { return place->type == "any"; });
    if (is_any || !json.is_structured()) return;
    if (json.is_array()) {
      std::vector<const Place*> entries;
      for (const Place* place : at)
        if (const auto entry = place->below.find("[]"); entry != place->below.end())
          entries.push_back(&entry->second);
      for (const Json& value : json)
        if (value.is_object() || !entries.empty()) compare(value, entries, name + "[]", found);
      return;
    }
    for (const auto& [key, value] : json.items()) compare_key(key, value, at, name + "." + key, found);
    for (const Place* place : at)
      for (const auto& [key, below] : place->below)
        if (key.find('*') == std::string::npos && key != "[]" && !below.may_be_absent && !json.contains(key))
          found.insert(name + " lacks " + key + ", which is described as always there");
  }

  static void compare_key(const std::string& key, const Json& value, const std::vector<const Place*>& at,
                          const std::string& name, std::set<std::string>& found) {
    std::vector<const Place*> next;
    std::string type;
    for (const Place* place : at)
      for (const auto& [known, below] : place->below) {
        if (!is_named(key, known)) continue;
        next.push_back(&below);
        if (type.empty() || known == key) type = below.type.empty() ? type : below.type;
      }
    if (next.empty() || type.empty()) {
      found.insert(name + " is not described");
      return;
    }
    if (!is_of(value, type)) found.insert(name + " is no " + type + ": " + value.dump().substr(0, 60));
    compare(value, next, name, found);
  }

  std::map<std::string, std::vector<Row>> sections_;  ///< by title
};

/// The section of apps/OUTPUTS.md that describes what a command prints with --json.
inline std::string section_of(const std::vector<std::string>& arguments, const nlohmann::json& printed) {
  const std::string& command = arguments.front();
  if (command == "plan") return "plan.json";
  if (command == "replay" || command == "teach") return "report.json";
  if (command == "inspect") return printed.contains("map") ? "inspect" : "inspect of a recording";
  if (command == "compare" && arguments.at(1) == "diff") return "compare diff";
  if (command == "robots") return printed.contains("robots") ? "robots" : "One robot";
  return command;
}

/// @throws std::logic_error when the page does not describe the JSON
inline void require_described(const nlohmann::json& json, const std::string& section) {
  std::string text;
  for (const std::string& complaint : OutputsPage::written().complaints(json, section))
    text += "\n  " + complaint;
  if (!text.empty()) throw std::logic_error("apps/OUTPUTS.md, section '" + section + "':" + text);
}

}  // namespace clearway

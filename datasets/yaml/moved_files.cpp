#include "datasets/yaml/moved_files.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <set>
#include <stdexcept>
#include <vector>

#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

/// A scalar of a text: where it stands, with its quotes, and what it says.
struct Scalar {
  std::size_t begin = 0, length = 0;
  std::string value;
};

/// Whether a field's value names a file or a folder. @param above the key of the map that has the field
bool names_file(const std::string& above, const std::string& key, const std::string& value) {
  static const std::set<std::string> keys{"file", "poses", "joint_file", "mesh", "hull"};
  if (above == "packages") return true;  // folders by the packages' names
  if (above == "robot" && key == "name") return is_description_file(value);
  return keys.contains(key) || (above == "robot" && key == "srdf");
}

/// Of the files and folders that a setup names.
void collect_files(const YAML::Node& node, const std::string& above, const std::string& text,
                   std::vector<Scalar>& found) {
  if (node.IsSequence())
    for (const YAML::Node& part : node) collect_files(part, above, text, found);
  if (!node.IsMap()) return;
  for (const auto& field : node) {
    const std::string key = field.first.Scalar();
    if (!field.second.IsScalar() || !names_file(above, key, field.second.Scalar())) {
      collect_files(field.second, key, text, found);
      continue;
    }
    Scalar scalar{static_cast<std::size_t>(field.second.Mark().pos), 0, field.second.Scalar()};
    const char quote_mark = text.at(scalar.begin);
    const bool is_quoted = quote_mark == '"' || quote_mark == '\'';
    scalar.length = scalar.value.size() + (is_quoted ? 2 : 0);
    if (text.compare(scalar.begin + (is_quoted ? 1 : 0), scalar.value.size(), scalar.value) != 0)
      throw std::invalid_argument("field " + quote(key) +
                                  ": expected a file's name in one line, without "
                                  "escapes, so that it can be written for another folder");
    const auto is_same = [&](const Scalar& other) { return other.begin == scalar.begin; };  // by an alias
    if (std::none_of(found.begin(), found.end(), is_same)) found.push_back(std::move(scalar));
  }
}

}  // namespace

std::string with_files_from(const std::string& setup, const std::filesystem::path& folder,
                            const std::filesystem::path& other) {
  namespace fs = std::filesystem;
  const fs::path from = fs::absolute(folder).lexically_normal(), to = fs::absolute(other).lexically_normal();
  if (from == to) return setup;
  std::vector<Scalar> files;
  collect_files(YAML::Load(setup), "", setup, files);
  std::string text = setup;
  std::sort(files.begin(), files.end(), [](const auto& a, const auto& b) { return a.begin > b.begin; });
  for (const Scalar& file : files)
    if (!fs::path(file.value).is_absolute())
      text.replace(file.begin, file.length, yaml_quoted(fs::proximate(from / file.value, to).string()));
  return text;
}

bool is_description_file(const std::string& robot) {
  const std::filesystem::path path(robot);
  return path.has_extension() || path.has_parent_path();
}

std::string yaml_quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) result += (c == '"' || c == '\\' ? std::string("\\") : std::string()) + c;
  return result + "\"";
}

}  // namespace clearway

#include "datasets/descriptions/query_fields.hpp"

#include "datasets/yaml/yaml_fields.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {

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

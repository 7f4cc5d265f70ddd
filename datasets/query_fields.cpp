#include "datasets/query_fields.hpp"

#include "datasets/yaml_fields.hpp"

namespace clearway {

std::map<std::string, std::string> read_words(const YamlFields& fields) {
  std::map<std::string, std::string> words;
  for (const auto& key : fields.keys()) words[key] = fields.text(key);
  return words;
}

std::map<std::string, std::string> read_policies(const YamlFields& fields) {
  auto policies = read_words(fields);
  for (const auto& [part, policy] : policies)
    if (policy != "painted" && policy != "known_free" && policy != "not_occupied")
      fields.fail(part, "expected painted, known_free or not_occupied, got '" + policy + "'");
  return policies;
}

void read_legs(const YamlFields& fields, std::vector<double>& start,
               std::vector<std::vector<double>>& goals) {
  start = fields.angles("start");
  goals = fields.lists_of_angles("goals");
  if (start.empty()) fields.fail("start", "expected a number for each joint");
  if (goals.empty()) fields.fail("goals", "expected at least one goal");
  for (const auto& goal : goals)
    if (goal.size() != start.size())
      fields.fail("goals", "expected as many numbers in each goal as in the start");
}

}  // namespace clearway

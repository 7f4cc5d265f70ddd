#include "tests/mutation/entries.hpp"

#include <fstream>
#include <stdexcept>

namespace clearway::mutation {

std::vector<std::map<std::string, std::string>> read_entries(const std::filesystem::path& file,
                                                             const std::vector<std::string>& keys) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error(file.string() + " cannot be read");
  std::vector<std::map<std::string, std::string>> entries;
  std::map<std::string, std::string> entry;
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (line.starts_with('#') || (line.empty() && entry.empty())) continue;
    const std::string key = keys[entry.size()], begin = key + ": ";
    if (!line.starts_with(begin) || line.size() == begin.size())
      throw std::runtime_error(file.string() + ", line " + std::to_string(number) + ": expected '" + begin +
                               "…'");
    entry[key] = line.substr(begin.size());
    if (entry.size() < keys.size()) continue;
    entries.push_back(entry);
    entry.clear();
  }
  if (!entry.empty()) throw std::runtime_error(file.string() + ": the last entry is not whole");
  return entries;
}

}  // namespace clearway::mutation

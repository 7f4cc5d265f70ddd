#include "tests/mutation/accepted.hpp"

#include <fstream>
#include <stdexcept>

namespace clearway::mutation {

AcceptedSurvivors::AcceptedSurvivors(const std::filesystem::path& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error(file.string() + " cannot be read");
  constexpr const char* keys[] = {"file: ", "line: ", "fault: ", "reason: "};
  std::string Entry::*const fields[] = {&Entry::file, &Entry::line, &Entry::fault, &Entry::reason};
  std::size_t next = 0;
  int number = 0;
  Entry entry;
  for (std::string line; std::getline(in, line);) {
    ++number;
    if (line.starts_with('#') || (line.empty() && next == 0)) continue;
    const std::string key = keys[next];
    if (!line.starts_with(key) || line.size() == key.size())
      throw std::runtime_error(file.string() + ", line " + std::to_string(number) + ": expected '" + key +
                               "…'");
    entry.*fields[next] = line.substr(key.size());
    next = (next + 1) % 4;
    if (next == 0) entries_.push_back(entry);
  }
  if (next != 0) throw std::runtime_error(file.string() + ": the last entry is not whole");
}

std::string AcceptedSurvivors::reason(const Candidate& candidate) const {
  for (const Entry& entry : entries_) {
    if (entry.file == candidate.file && entry.line == candidate.text &&
        entry.fault == candidate.fault.kind + ": " + candidate.change)
      return entry.reason;
  }
  return "";
}

}  // namespace clearway::mutation

#include "tests/mutation/accepted.hpp"

#include "tests/mutation/entries.hpp"

namespace clearway::mutation {

AcceptedSurvivors::AcceptedSurvivors(const std::filesystem::path& file) {
  for (const auto& entry : read_entries(file, {"file", "line", "fault", "reason"}))
    entries_.push_back({entry.at("file"), entry.at("line"), entry.at("fault"), entry.at("reason")});
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

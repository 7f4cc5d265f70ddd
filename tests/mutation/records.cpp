#include "tests/mutation/records.hpp"

#include <sstream>

namespace clearway::mutation {

Records::Records(const std::filesystem::path& file, bool trust_noticed) : trust_noticed_(trust_noticed) {
  std::filesystem::create_directories(file.parent_path());
  std::ifstream in(file);
  for (std::string line;
       std::getline(in, line);) {  // key, digest, kind, by; what a kill cut off is no record
    std::istringstream words(line);
    std::string key, by;
    Known known;
    int kind = 0;
    char end = 0;
    if (!(words >> key >> known.digest >> kind >> end) || end != '|') continue;
    std::getline(words, by);
    known.outcome = {static_cast<Outcome::Kind>(kind), by};
    known_.emplace(key, known);
  }
  out_.open(file, std::ios::app);
}

std::optional<Outcome> Records::find(const std::string& key, const std::string& digest) const {
  const std::lock_guard lock(mutex_);
  const auto [first, last] = known_.equal_range(key);
  std::optional<Outcome> latest;
  for (auto it = first; it != last; ++it) {
    const Outcome& outcome = it->second.outcome;
    const bool holds_always = outcome.kind == Outcome::Kind::not_compiled ||
                              (trust_noticed_ && outcome.kind == Outcome::Kind::noticed);
    if (holds_always || it->second.digest == digest) latest = outcome;
  }
  return latest;
}

void Records::add(const std::string& key, const std::string& digest, const Outcome& outcome) {
  const std::lock_guard lock(mutex_);
  known_.emplace(key, Known{digest, outcome});
  out_ << key << ' ' << digest << ' ' << static_cast<int>(outcome.kind) << " |" << outcome.by << std::endl;
}

}  // namespace clearway::mutation

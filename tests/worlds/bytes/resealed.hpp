#pragma once

// What checksums stop is not read, and neither a fuzzer nor a drawn change guesses one: files of ours that
// were changed get the right ones again, so that what is behind them is reached.

#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "datasets/sources/record_seal.hpp"
#include "mapping/files/map_digest.hpp"
#include "mapping/files/octree_check.hpp"
#include "tests/worlds/mutated_bytes.hpp"

namespace clearway {

/// Of map.ot and provenance.bin, whose second line is the seal; put in where it is missing.
inline std::string resealed(const std::string& bytes) {
  constexpr std::string_view seal = "# clearway seal";
  const auto first = bytes.find('\n');
  if (first == std::string::npos) return bytes;
  const std::string before = bytes.substr(0, first + 1);
  std::string after = bytes.substr(first + 1);
  if (after.starts_with(seal)) after.erase(0, after.find('\n', seal.size()) + 1);
  return before + seal_line(before, after) + after;
}

/// Of queries.json.
inline std::string with_sha256(std::string text) {
  const std::string key = "\"sha256\": \"";
  const std::size_t at = text.rfind(key), digits = 64;
  if (at == std::string::npos || at + key.size() + digits > text.size()) return text;
  text.replace(at + key.size(), digits, std::string(digits, '0'));
  return text.replace(at + key.size(), digits, sha256(text));
}

/// A record of a recording: its seal, and what is packed behind it.
struct SealedContent {
  RecordSeal seal;
  std::string content;
};

/// The records of a whole recording, the empty one at its end included.
inline std::vector<SealedContent> sealed_contents(const std::string& recording) {
  std::vector<SealedContent> records;
  const std::string_view all = recording;
  for (std::size_t at = 0; at < all.size(); at += records.back().seal.size) {
    const RecordSeal seal = seal_of(all.substr(at)).value();
    records.push_back({seal, unsealed(all.substr(at, seal.size)).value()});
  }
  return records;
}

/// The recording of these records, each with its checksums.
inline std::string recording_of(const std::vector<SealedContent>& records) {
  std::string bytes;
  for (const SealedContent& record : records) bytes += sealed_record(record.content, record.seal);
  return bytes;
}

/// A whole recording of which the content or the seal of a record is changed, or records are left out,
/// doubled or exchanged; every checksum fits.
inline std::string mutated_recording(const std::string& whole, std::mt19937& random) {
  std::vector<SealedContent> records = sealed_contents(whole);
  const auto at = static_cast<std::ptrdiff_t>(random() % records.size());
  SealedContent& record = records[static_cast<std::size_t>(at)];
  switch (random() % 8) {
    case 0:
      record.seal.index = random() % 4 == 0 ? random() : record.seal.index + random() % 3 - 1;
      break;
    case 1:
      record.seal.is_end = !record.seal.is_end;
      break;
    case 2:
      records.erase(records.begin() + at);
      break;
    case 3:
      records.insert(records.begin() + at, records[random() % records.size()]);
      break;
    default:
      record.content = mutated(record.content, random);
  }
  return recording_of(records);
}

}  // namespace clearway

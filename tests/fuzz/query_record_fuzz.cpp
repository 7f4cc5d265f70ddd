// libFuzzer on queries.json, with its checksum put right: what is behind it is reached.
#include "planning/files/query_record.hpp"

#include "tests/fuzz/fuzzed_input.hpp"
#include "tests/worlds/bytes/resealed.hpp"

extern "C" int query_record_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  static const fuzz::InputFolder folder("queries");
  folder.write("queries.json", with_sha256(std::string(fuzz::as_text(data, size))));
  return fuzz::read_or_refuse([&] {
    if (const auto record = load_query_record(folder.path())) static_cast<void>(to_json(*record));
  });
}

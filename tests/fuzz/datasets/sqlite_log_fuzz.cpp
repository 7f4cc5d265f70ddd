// libFuzzer on ROS 2 bags in SQLite with a write-ahead log, which is read by our own reader: what the child
// process of a bag does, without that process. The input is the size of the database (four bytes,
// little-endian), the database and its log.
#include <cstring>

#include "datasets/ros/message_bag.hpp"
#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int sqlite_log_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  static const fuzz::InputFile database(".db3"), log(".db3-wal");
  std::uint32_t first = 0;
  if (size < sizeof first) return 0;
  std::memcpy(&first, data, sizeof first);
  const std::string_view bytes = fuzz::as_text(data + sizeof first, size - sizeof first);
  if (first > bytes.size()) return 0;
  database.write(bytes.substr(0, first));
  log.write(bytes.substr(first));
  try {
    const auto bag = open_sqlite_bag(database.path());
    bag->visit(std::vector<bool>(bag->topics().size(), true), [](const BagMessage&) { return true; });
    if (!bag->damage().empty()) fuzz::require_sentence(std::runtime_error(bag->damage()));
  } catch (const std::bad_alloc&) {        // SQLite's word for what it refuses to take
  } catch (const std::exception& error) {  // a clause, as message_bag.hpp says
    fuzz::require_sentence(error);
  }
  return 0;
}

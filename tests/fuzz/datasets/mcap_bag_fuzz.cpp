// libFuzzer on MCAP files and the messages in them: what the child process of a bag does, without that
// process, whose limits hold where a chunk asks for much memory.
#include <fcntl.h>

#include <cstring>

#include "datasets/bags/mcap_format.hpp"
#include "datasets/ros/bag_frames.hpp"
#include "datasets/ros/bag_readings.hpp"
#include "mapping/system/file_descriptor.hpp"
#include "tests/fuzz/fuzzed_input.hpp"
#include "tests/worlds/bag_topics.hpp"

namespace {

/// Whether some chunk says that it unpacks to much: each of hundreds may, in a small file.
bool asks_for_much(std::string_view bytes) {
  constexpr std::uint64_t most = 1U << 20U;
  constexpr std::size_t head = 9, times = 16;
  std::uint64_t size = 0, unpacked = 0;
  for (std::size_t at = 8; at + head + times + 8 <= bytes.size(); at += head + size) {
    std::memcpy(&size, &bytes[at + 1], sizeof size);
    std::memcpy(&unpacked, &bytes[at + head + times], sizeof unpacked);
    if (bytes[at] == clearway::mcap::chunk && unpacked > most) return true;
    if (size > bytes.size()) return false;
  }
  return false;
}

}  // namespace

extern "C" int mcap_bag_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  static const fuzz::InputFile file(".mcap");
  static const SourceOptions options = worlds::all_topics();
  if (asks_for_much(fuzz::as_text(data, size))) return 0;
  const FileDescriptor input(::open(file.write(fuzz::as_text(data, size)).c_str(), O_RDONLY | O_CLOEXEC));
  const auto require = [](const std::string& clause) {
    if (!clause.empty()) fuzz::require_sentence(std::runtime_error(clause));
  };
  try {
    const auto bag = open_mcap(input.number(), size);
    for (const BagFrame& frame : frames_of(*bag)) static_cast<void>(frame);
    BagFrames frames(*bag, options);
    frames.visit([](const Frame&) {});
    for (const std::string& clause : frames.left_out()) require(clause);
    require(frames.damage());
    require(bag->damage());
  } catch (const std::runtime_error& error) {  // a clause, as message_bag.hpp says
    fuzz::require_sentence(error);
  }
  return 0;
}

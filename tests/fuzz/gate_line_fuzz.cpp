// libFuzzer on the lines that a gate is asked, one input a line.
#include "planning/files/gate_line.hpp"

#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int gate_line_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  return fuzz::read_or_refuse([&] {
    const ChunkLine line = parse_chunk_line(fuzz::as_text(data, size));
    if (!line.is_read()) fuzz::require_sentence(std::runtime_error(line.fault.sentence));
    static_cast<void>(
        verdict_line(1, line.id, {.reason = line.fault.reason, .sentence = line.fault.sentence}));
  });
}

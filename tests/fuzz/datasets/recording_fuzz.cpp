// libFuzzer on our own recordings behind their checksums, as users open them: MRPT decodes in a child
// process, whose crash, exit or want of memory has to become one sentence, too. The input is the content of a
// record; a whole one is before and behind it.
#include "datasets/sources/record_seal.hpp"
#include "datasets/sources/recording.hpp"

#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int recording_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  static const fuzz::InputFile file(".rawlog");
  const std::string record = sealed_record(fuzz::as_text(data, size), {.index = 0, .time = 1.0}),
                    end = sealed_record("", {.index = 1, .is_end = true});
  return fuzz::read_or_refuse([&] {
    RecordingReader reader(file.write(record + end));
    while (reader.next()) continue;
    for (const std::string& warning : reader.warnings()) fuzz::require_sentence(std::runtime_error(warning));
    if (reader.damage()) fuzz::require_sentence(std::runtime_error(*reader.damage()));
  });
}

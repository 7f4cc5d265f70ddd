// libFuzzer on the events and keys of teaching sessions (JSONL). An event that is written is read back alike.
#include "apps/teach/teach_event.hpp"
#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  static const fuzz::InputFile file(".jsonl");
  const std::filesystem::path& lines = file.write(fuzz::as_text(data, size));
  fuzz::read_or_refuse([&] { load_teach_keys(lines); });
  const auto text_of = [](const std::vector<TeachEvent>& events) {
    std::string text;
    for (const TeachEvent& event : events) text += to_json_line(event) + "\n";
    return text;
  };
  return fuzz::read_or_refuse([&] {
    const std::string written = text_of(load_teach_events(lines));
    if (text_of(load_teach_events(file.write(written))) != written) std::abort();
  });
}

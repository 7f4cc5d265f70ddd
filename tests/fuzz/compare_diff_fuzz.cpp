// libFuzzer on results of comparisons (results.sqlite), against themselves.
#include "apps/results/compare_diff.hpp"
#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int compare_diff_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  static const fuzz::InputFile file(".sqlite");
  const std::filesystem::path& results = file.write(fuzz::as_text(data, size));
  return fuzz::read_or_refuse([&] {
    const CompareDiff diff = compare_diff(results, results);
    for (const std::string& note : diff.notes) fuzz::require_sentence(std::runtime_error(note));
    static_cast<void>(to_json(diff));
  });
}

// libFuzzer on scan graphs of OctoMap, binary and text.
#include "datasets/sources/scan_graph.hpp"

#include "tests/fuzz/fuzzed_input.hpp"

namespace {

void read(const std::filesystem::path& file) {
  using namespace clearway;
  static_cast<void>(is_scan_graph(file));
  const auto graph = open_scan_graph(file, {});
  while (graph->next()) continue;
  if (const auto damage = graph->damage()) fuzz::require_sentence(std::runtime_error(*damage));
}

}  // namespace

extern "C" int scan_graph_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  static const fuzz::InputFile binary(".graph"), text(".log");
  return fuzz::read_or_refuse([&] {
    read(binary.write(fuzz::as_text(data, size)));
    read(text.write(fuzz::as_text(data, size)));
  });
}

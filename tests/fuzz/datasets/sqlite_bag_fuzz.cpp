// libFuzzer on ROS 2 bags in SQLite, as users open them: SQLite works in a child process, whose crash, exit
// or want of memory has to become one sentence, too.
#include "datasets/bags/bag_source.hpp"
#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int sqlite_bag_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  static const fuzz::InputFile file(".db3");
  const std::filesystem::path& bag = file.write(fuzz::as_text(data, size));
  SourceOptions options;
  options.bag.scans = {"/scan"};
  return fuzz::read_or_refuse([&] {
    const auto source = open_bag(bag, options);
    while (source->next()) continue;
    for (const std::string& warning : source->warnings()) fuzz::require_sentence(std::runtime_error(warning));
    if (source->damage()) fuzz::require_sentence(std::runtime_error(*source->damage()));
  });
}

// libFuzzer on the metadata.yaml of a bag of ROS 2.
#include "datasets/bags/bag_metadata.hpp"

#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int bag_metadata_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  static const fuzz::InputFolder folder("bag");
  folder.write("metadata.yaml", fuzz::as_text(data, size));
  fuzz::read_or_refuse([&] { require_unpacked(folder.path()); });
  return fuzz::read_or_refuse([&] {
    for (const std::string& part : listed_parts(folder.path()))
      if (part.find('/') != std::string::npos) std::abort();  // outside of the folder
  });
}

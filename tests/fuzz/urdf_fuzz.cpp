// libFuzzer on robot files (URDF).
#include "planning/robot/robot.hpp"

#include "planning/robot_files/load_robot.hpp"
#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int urdf_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  static const fuzz::InputFile file(".urdf");
  return fuzz::read_or_refuse([&] { load_robot(file.write(fuzz::as_text(data, size)).string()); });
}

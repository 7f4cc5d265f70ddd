// libFuzzer on the times beside poses as arrays of NumPy: an array, or a number a line.
#include "datasets/depth_files/npy_file.hpp"
#include "datasets/depth_files/npy_poses.hpp"

#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int pose_times_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  static const fuzz::InputFolder arrays("times_npy"), texts("times_txt");
  const std::string bytes(fuzz::as_text(data, size));
  const bool is_array = is_npy(bytes);
  const fuzz::InputFolder& folder = is_array ? arrays : texts;
  folder.write(is_array ? "poses_times.npy" : "poses_times.txt", bytes);
  std::vector<std::string> notes;
  return fuzz::read_or_refuse([&] {
    const std::vector<double> times = times_of_npy_poses(folder.path() / "poses.npy", 3, notes);
    if (times.size() != 3 || !(times[0] < times[1] && times[1] < times[2])) std::abort();
  });
}

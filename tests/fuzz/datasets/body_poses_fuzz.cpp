// libFuzzer on EuRoC's sensor.yaml, of the camera and of the sensor beside the poses.
#include "datasets/cameras/body_poses.hpp"

#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int body_poses_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  static const fuzz::InputFolder folder("body");
  const std::string text(fuzz::as_text(data, size));
  static_cast<void>(are_poses_of_body(text));
  const std::filesystem::path camera = folder.write("camera.yaml", text);
  folder.write("sensor.yaml", text);
  return fuzz::read_or_refuse([&] {
    const CameraOnBody on_body = camera_on_body(folder.path() / "data.csv", camera);
    fuzz::require_sentence(std::runtime_error(on_body.note));
    if (!on_body.body_from_camera.matrix().allFinite()) std::abort();
  });
}

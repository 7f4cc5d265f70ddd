// libFuzzer on scans of KITTI and nuScenes.
#include "mapping/files/velodyne_scan.hpp"

#include "tests/fuzz/fuzzed_input.hpp"

extern "C" int velodyne_scan_fuzz(const std::uint8_t* data, std::size_t size) {
  using namespace clearway;
  static const fuzz::InputFile kitti(".bin"), nuscenes(".pcd.bin");
  for (const fuzz::InputFile* file : {&kitti, &nuscenes}) {
    file->write(fuzz::as_text(data, size));
    fuzz::read_or_refuse([&] {
      for (const Eigen::Vector3f& point : read_velodyne_scan(file->path()).points)
        if (!point.allFinite()) std::abort();
    });
  }
  return 0;
}

#include "apps/fusion/taken_cameras.hpp"

#include <algorithm>

namespace clearway {
namespace {

bool holds(const std::vector<TakenCamera>& cameras, const std::string& sensor) {
  return std::any_of(cameras.begin(), cameras.end(),
                     [&](const TakenCamera& camera) { return camera.sensor == sensor; });
}

}  // namespace

void TakenCameras::see(const Frame& frame, const Setup& setup) {
  const auto* image = std::get_if<ImageFrame>(&frame.content);
  if (image == nullptr || holds(seen_, frame.sensor)) return;
  if (image->intrinsics.is_rectified)
    seen_.push_back({frame.sensor, true, "the recording"});
  else if (setup.camera && setup.camera->is_rectified)
    seen_.push_back({frame.sensor, true, "'rectified' of 'camera' in the setup"});
  else
    seen_.push_back({frame.sensor, false, "default"});
}

bool TakenCameras::has_seen(const std::string& sensor) const { return holds(seen_, sensor); }

std::vector<TakenCamera> TakenCameras::all(const FrameSource& source) const {
  std::vector<TakenCamera> cameras = source.cameras();
  for (const TakenCamera& camera : seen_)
    if (!holds(cameras, camera.sensor)) cameras.push_back(camera);
  return cameras;
}

}  // namespace clearway

#include "mapping/history/provenance.hpp"

#include <algorithm>

#include "mapping/voxels/sphere_cells.hpp"

namespace clearway {
namespace {

/// A sphere that covers the voxel, as far as it is left.
struct CoveringSphere {
  const PaintEvent* event = nullptr;
  Sphere left;
};

StrokeTouch& touch_of(std::vector<StrokeTouch>& touches, const PaintEvent& event) {
  const auto same = [&](const StrokeTouch& touch) {
    return touch.volume == event.volume && touch.stroke == event.stroke && touch.erases == event.erases;
  };
  const auto found = std::find_if(touches.begin(), touches.end(), same);
  if (found != touches.end()) return *found;
  touches.push_back({event.volume, event.stroke, event.erases, 0, event.time, event.time});
  return touches.back();
}

void count(std::vector<StrokeTouch>& touches, const PaintEvent& event) {
  StrokeTouch& touch = touch_of(touches, event);
  ++touch.spheres;
  touch.first = std::min(touch.first, event.time);
  touch.last = std::max(touch.last, event.time);
}

}  // namespace

std::vector<StrokeTouch> strokes_at(const Provenance& provenance, const Eigen::Vector3i& cell) {
  const CellCube voxel{cell, 1};
  std::vector<CoveringSphere> covering;
  std::vector<const PaintEvent*> informative;
  for (const PaintEvent& event : provenance.events) {
    if (!event.erases) {
      if (covers(event.sphere, voxel, provenance.resolution)) covering.push_back({&event, event.sphere});
      continue;
    }
    const auto uncovered = [&](CoveringSphere& sphere) {
      if (sphere.event->volume != event.volume) return false;
      const std::optional<Sphere> left = shrunk(sphere.left, event.sphere);
      if (left) sphere.left = *left;
      return !left || !covers(*left, voxel, provenance.resolution);
    };
    if (std::erase_if(covering, uncovered) > 0) informative.push_back(&event);
  }
  for (const CoveringSphere& sphere : covering) informative.push_back(sphere.event);
  std::sort(informative.begin(), informative.end());  // events lie in one array, in order
  std::vector<StrokeTouch> touches;
  for (const PaintEvent* event : informative) count(touches, *event);
  return touches;
}

}  // namespace clearway

#include "mapping/history/paint_log.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <tuple>

#include "mapping/system/number_text.hpp"
#include "mapping/system/plain_text.hpp"

namespace clearway {
namespace {

bool less(const Sphere& a, const Sphere& b) {
  const auto tied = [](const Sphere& s) {
    return std::tie(s.center.x(), s.center.y(), s.center.z(), s.radius);
  };
  return tied(a) < tied(b);
}

/// Spheres of one list but not of the other.
std::vector<Sphere> difference(std::vector<Sphere> before, std::vector<Sphere> now) {
  std::sort(before.begin(), before.end(), less);
  std::sort(now.begin(), now.end(), less);
  std::vector<Sphere> changed;
  std::set_symmetric_difference(before.begin(), before.end(), now.begin(), now.end(),
                                std::back_inserter(changed), less);
  return changed;
}

/// Shrinks the spheres of a volume and removes those of which nothing is left.
PaintLog::Change erase_from(PaintedVolume& volume, const Sphere& eraser) {
  PaintLog::Change change;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < volume.spheres.size(); ++i) {
    const std::optional<Sphere> left = shrunk(volume.spheres[i], eraser);
    if (!left || left->radius != volume.spheres[i].radius) change.spheres.push_back(volume.spheres[i]);
    if (!left) {
      ++change.removed;
      continue;
    }
    if (left->radius != volume.spheres[i].radius) {
      ++change.shrunk;
      change.spheres.push_back(*left);
    }
    volume.spheres[kept] = *left;
    volume.times[kept] = volume.times[i];
    volume.stroke_of[kept++] = volume.stroke_of[i];
  }
  volume.spheres.resize(kept);
  volume.times.resize(kept);
  volume.stroke_of.resize(kept);
  return change;
}

}  // namespace

void require_sphere(const Sphere& sphere, double time) {
  if (!sphere.center.allFinite() || !std::isfinite(sphere.radius) || !(sphere.radius > 0.0) ||
      !std::isfinite(time))
    throw std::invalid_argument("painted ball: expected a finite centre and time and a radius > 0 in metres");
}

void require_paintable(const Sphere& sphere, double time, double resolution) {
  require_sphere(sphere, time);
  const double largest = largest_painted(resolution);
  if (sphere.radius > largest)
    throw std::invalid_argument("painted ball: got a radius of " + short_text(sphere.radius) +
                                " m, expected at most " + short_text(largest) +
                                " m, 1000 voxels of this map");
}

void require_storable(const std::string& label, const std::vector<std::string>& critical_parts) {
  const auto is_part = [](const std::string& part) { return !part.empty() && is_storable_name(part); };
  if (is_storable_name(label) && std::all_of(critical_parts.begin(), critical_parts.end(), is_part)) return;
  throw std::invalid_argument(
      "painted volume " + quote(label) +
      ": expected a label and part names without control characters, and no part without a name");
}

int PaintLog::add_volume(const std::string& label, const std::vector<std::string>& critical_parts) {
  volumes_.push_back({label, critical_parts});
  numbers_.emplace_back();
  return static_cast<int>(volumes_.size()) - 1;
}

bool PaintLog::remove_last_volume() {
  const int last = static_cast<int>(volumes_.size()) - 1;
  if (last < 0 || std::any_of(events_.begin(), events_.end(),
                              [last](const PaintEvent& event) { return event.volume == last; }))
    return false;
  volumes_.pop_back();
  numbers_.pop_back();
  return true;
}

int PaintLog::begin_stroke(const std::string& label, const std::string& source) {
  strokes_.push_back({label, source});
  open_ = static_cast<int>(strokes_.size()) - 1;
  return open_;
}

void PaintLog::paint(int volume, const Sphere& sphere, double time) {
  events_.push_back({volume, open_, false, sphere, time});
  apply(events_.back());
}

PaintLog::Change PaintLog::erase(int volume, const Sphere& eraser, double time) {
  events_.push_back({volume, open_, true, eraser, time});
  Change change = erase_from(volumes_[static_cast<std::size_t>(volume)], eraser);
  change.volume = volume;
  return change;
}

void PaintLog::apply(const PaintEvent& event) {
  const auto index = static_cast<std::size_t>(event.volume);
  PaintedVolume& volume = volumes_[index];
  if (event.erases) {
    erase_from(volume, event.sphere);
    return;
  }
  int local = -1;
  if (event.stroke >= 0) {
    std::vector<int>& numbers = numbers_[index];
    const auto found = std::find(numbers.begin(), numbers.end(), event.stroke);
    local = static_cast<int>(found - numbers.begin());
    if (found == numbers.end()) {
      const Stroke& stroke = strokes_[static_cast<std::size_t>(event.stroke)];
      numbers.push_back(event.stroke);
      volume.strokes.push_back({stroke.label, stroke.source});
    }
  }
  volume.add(event.sphere, event.time, local);
}

void PaintLog::rebuild(int volume) {
  const auto index = static_cast<std::size_t>(volume);
  volumes_[index] = {volumes_[index].label, volumes_[index].critical_parts};
  numbers_[index].clear();
  for (const PaintEvent& event : events_) {
    if (event.volume == volume) apply(event);
  }
}

std::vector<PaintLog::Change> PaintLog::undo(int stroke) {
  end_stroke();
  std::vector<Change> changes;
  for (std::size_t v = 0; v < volumes_.size(); ++v) {
    const int volume = static_cast<int>(v);
    const auto undone = [&](const PaintEvent& e) { return e.volume == volume && e.stroke == stroke; };
    const auto kept = std::remove_if(events_.begin(), events_.end(), undone);
    if (kept == events_.end()) continue;
    events_.erase(kept, events_.end());
    const std::vector<Sphere> before = volumes_[v].spheres;
    rebuild(volume);
    changes.push_back({volume, difference(before, volumes_[v].spheres)});
  }
  return changes;
}

int PaintLog::last_stroke() const {
  int last = -1;
  for (const PaintEvent& event : events_) last = std::max(last, event.stroke);
  return last;
}

}  // namespace clearway

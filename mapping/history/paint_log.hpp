#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "mapping/voxels/painted_volume.hpp"

namespace clearway {

/// @throws std::invalid_argument for a sphere that is none, or no time
void require_sphere(const Sphere& sphere, double time);

/// @param resolution metres, of the voxels
/// @throws std::invalid_argument as require_sphere, and for a radius beyond largest_painted
void require_paintable(const Sphere& sphere, double time, double resolution);

/// @throws std::invalid_argument for a label or part that cannot be stored (is_storable_name), or an empty
/// part
void require_storable(const std::string& label, const std::vector<std::string>& critical_parts);

/// One sphere that was painted into a volume, or one that erased from it.
struct PaintEvent {
  int volume = 0;
  int stroke = -1;  ///< index into PaintLog::strokes, -1 for none
  bool erases = false;
  Sphere sphere;
  double time = 0.0;  ///< seconds
};

/// Everything that was painted and erased and not undone, in order, and the volumes that this makes: an
/// eraser shrinks the spheres painted before it (see `shrunk`), later spheres are whole. Knows no voxels.
class PaintLog {
 public:
  /// Spheres of one volume that changed: as they were before, and as they are now.
  struct Change {
    int volume = 0;
    std::vector<Sphere> spheres{};
    std::size_t shrunk = 0, removed = 0;  ///< of the volume's spheres
  };

  /// Precondition: the label is new.
  int add_volume(const std::string& label, const std::vector<std::string>& critical_parts);
  /// Takes the last volume out. False, and nothing is done, where something was painted into it.
  bool remove_last_volume();

  /// What follows belongs to a new stroke; returns its number. Ends the open one.
  int begin_stroke(const std::string& label, const std::string& source);
  void end_stroke() { open_ = -1; }
  int open_stroke() const { return open_; }  ///< -1 for none

  void paint(int volume, const Sphere& sphere, double time);
  Change erase(int volume, const Sphere& eraser, double time);
  /// Takes a stroke out, as if it had never been; later strokes stay. Ends the open one.
  std::vector<Change> undo(int stroke);

  const std::vector<PaintedVolume>& volumes() const { return volumes_; }
  const std::vector<PaintEvent>& events() const { return events_; }
  /// All strokes by number, undone ones too; without their time spans, which the volumes' strokes have.
  const std::vector<Stroke>& strokes() const { return strokes_; }
  /// The last stroke that holds any event, -1 when there is none.
  int last_stroke() const;

 private:
  void apply(const PaintEvent& event);
  void rebuild(int volume);

  std::vector<PaintedVolume> volumes_;
  std::vector<std::vector<int>> numbers_;  ///< of each volume's strokes: their numbers here
  std::vector<PaintEvent> events_;
  std::vector<Stroke> strokes_;
  int open_ = -1;
};

}  // namespace clearway

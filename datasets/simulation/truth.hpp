#pragma once

#include <memory>
#include <span>
#include <string>

#include "datasets/simulation/probe_surfaces.hpp"
#include "datasets/sources/recording.hpp"

namespace clearway {

/// Collects what is true of a simulated recording and writes it as JSON; the file is described in
/// datasets/FORMATS.md.
class Truth {
 public:
  /// @param scene as it truly is; lives as long as this
  explicit Truth(const Scene& scene);
  ~Truth();

  /// @param surfaces of `moving`
  void add_image(double time, const Eigen::Isometry3d& map_from_camera, const MovingThings& moving,
                 std::span<const Surface> still, std::span<const Surface> surfaces);
  void add_depth(double time, const Eigen::Isometry3d& map_from_sensor);
  /// @param recording that it is of
  std::string json(const RecordingSum& recording);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace clearway

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/fusion/board_poses.hpp"
#include "datasets/descriptions/setup.hpp"
#include "mapping/scans/scan.hpp"

namespace clearway {

/// Probe, gripper and the hands that hold them, as scans meet them: where the images around a scan saw their
/// boards, on the straight way between, within the setup's `hands: latency` before and after. Grown by
/// `hands: margin` (two voxels when left out), by a (t - t0) (t1 - t) / 2, which is how far an acceleration
/// of at most a leads away from the straight way between images at t0 and t1, and by at most an eighth of the
/// margin for steps along the way.
class HeldBodies {
 public:
  /// @param boards must follow the boards of probe and gripper, and live as long as this
  HeldBodies(const Setup& setup, const BoardPoses& boards, double resolution);

  enum class Visibility {
    seen,    ///< or there is nothing that is held
    hidden,  ///< not seen, but not long before and not long after
    unseen   ///< nothing shows where the probe is
  };
  Visibility visibility(double time) const;

  /// False while an image to come may still show more of them at `time`.
  bool is_settled(double time) const;

  /// What they may fill at that time, map frame. @pre they are not hidden; what is unseen is left out
  std::vector<Capsule> bodies(double time) const;

 private:
  struct Held {
    std::string board;
    std::vector<Capsule> capsules;  ///< in the board's frame
    bool is_probe;                  ///< a gripper is out of sight most of the time
  };
  struct Place {
    Eigen::Isometry3d map_from_board;
    double growth;  ///< m, of what acceleration allows
  };
  Visibility visibility(const Held& held, double time) const;
  std::optional<Place> place(const Held& held, double time) const;
  void add(const Held& held, double time, std::vector<Capsule>& bodies) const;

  HandsSetup options_;
  double margin_;
  const BoardPoses& boards_;
  std::vector<Held> held_;
};

}  // namespace clearway

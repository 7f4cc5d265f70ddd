#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "mapping/snapshot.hpp"

namespace clearway {

/// Hands snapshots from the one thread that writes a map to the many that read it. A reader waits for nothing
/// but the exchange of a pointer, whatever the writer is doing, and never pays for taking an old snapshot
/// apart: the writer does that, once no reader holds it any more.
class LatestSnapshot {
 public:
  /// Starts with an empty map of 1 m voxels.
  LatestSnapshot() = default;

  /// Makes `snapshot` the one that readers get from now on, and takes apart old ones that nobody reads. Call
  /// it from the writing thread only.
  void publish(Snapshot snapshot);

  /// The snapshot published last. The reader may keep it as long as it likes; while it does, the writer's
  /// copies of what changes since then take memory.
  std::shared_ptr<const Snapshot> get() const;

 private:
  mutable std::mutex exchange_;
  std::shared_ptr<const Snapshot> latest_ = std::make_shared<const Snapshot>();
  std::vector<std::shared_ptr<const Snapshot>> retired_;  ///< the writer's own
};

}  // namespace clearway

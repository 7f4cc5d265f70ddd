#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "mapping/snapshot.hpp"

namespace clearway {

/// Hands values from the one thread that makes them to the many that read them. A reader waits for nothing
/// but the exchange of a pointer, whatever the writer is doing, and never pays for taking an old value apart:
/// the writer does that, once no reader holds it any more.
template <class Value>
class Latest {
 public:
  /// @param first what readers get before anything was published; may be null
  explicit Latest(std::shared_ptr<const Value> first = nullptr) : latest_(std::move(first)) {}

  /// Makes `value` the one that readers get from now on, and takes apart old ones that nobody reads. Call it
  /// from the writing thread only.
  void publish(std::shared_ptr<const Value> value) {
    {
      const std::lock_guard lock(exchange_);
      latest_.swap(value);
    }
    retired_.push_back(std::move(value));
    // Once out of `latest_`, only readers can hold it: a count of one cannot grow again.
    std::erase_if(retired_, [](const auto& old) { return old.use_count() <= 1; });
  }

  /// What was published last. The reader may keep it as long as it likes.
  std::shared_ptr<const Value> get() const {
    const std::lock_guard lock(exchange_);
    return latest_;
  }

 private:
  mutable std::mutex exchange_;
  std::shared_ptr<const Value> latest_;
  std::vector<std::shared_ptr<const Value>> retired_;  ///< the writer's own
};

/// Hands over snapshots of a map. Starts with an empty map of 1 m voxels. While a reader keeps a snapshot,
/// the writer's copies of what changes since then take memory.
class LatestSnapshot : public Latest<Snapshot> {
 public:
  LatestSnapshot() : Latest(std::make_shared<const Snapshot>()) {}
  void publish(Snapshot snapshot) { Latest::publish(std::make_shared<const Snapshot>(std::move(snapshot))); }
};

}  // namespace clearway

#include "mapping/latest_snapshot.hpp"

#include <utility>

namespace clearway {

void LatestSnapshot::publish(Snapshot snapshot) {
  auto next = std::make_shared<const Snapshot>(std::move(snapshot));
  {
    const std::lock_guard lock(exchange_);
    latest_.swap(next);
  }
  retired_.push_back(std::move(next));
  // Once out of `latest_`, only readers can hold it: a count of one cannot grow again.
  std::erase_if(retired_, [](const auto& old) { return old.use_count() == 1; });
}

std::shared_ptr<const Snapshot> LatestSnapshot::get() const {
  const std::lock_guard lock(exchange_);
  return latest_;
}

}  // namespace clearway

#pragma once

// Not part of the installed library.

#include <algorithm>
#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

namespace clearway {

/// What was made of robots, the few asked for last: spaces of one robot in map after map make it once. Safe
/// to use from many threads.
template <class Made>
class LastMade {
 public:
  /// The one that `is_wanted(made)`, else what `make()` returns.
  template <class IsWanted, class Make>
  std::shared_ptr<const Made> get(const IsWanted& is_wanted, const Make& make) {
    if (auto known = find(is_wanted)) return known;
    auto made = std::make_shared<const Made>(make());
    const std::lock_guard lock(mutex_);
    made_.insert(made_.begin(), made);
    if (made_.size() > most) made_.pop_back();
    return made;
  }

 private:
  static constexpr std::size_t most = 8;

  template <class IsWanted>
  std::shared_ptr<const Made> find(const IsWanted& is_wanted) {
    const std::lock_guard lock(mutex_);
    const auto known =
        std::find_if(made_.begin(), made_.end(), [&](const auto& made) { return is_wanted(*made); });
    if (known == made_.end()) return nullptr;
    std::rotate(made_.begin(), known, known + 1);
    return made_.front();
  }

  std::mutex mutex_;
  std::vector<std::shared_ptr<const Made>> made_;  ///< the last asked for first
};

}  // namespace clearway

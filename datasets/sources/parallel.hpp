#pragma once

#include <cstddef>
#include <functional>

namespace clearway {

/// Calls `work` once for every index below `count`, on all cores (or as many threads as the environment's
/// CLEARWAY_THREADS says). The calls must be independent of each other, so that the result does not depend on
/// how many there are. The first exception is passed on.
void for_each_index(size_t count, const std::function<void(size_t)>& work);

/// How many threads that are.
size_t thread_count();

/// Calls `step` again and again, on this thread and on `threads` - 1 others, on each until it returns false.
/// After an exception nobody calls it any more; the first one is passed on when all have ended.
void on_threads(size_t threads, const std::function<bool()>& step);

}  // namespace clearway

#pragma once

#include <cstddef>
#include <functional>

namespace clearway {

/// Calls `work(0)` ... `work(threads - 1)` at the same time, `work(0)` on the calling thread, and returns
/// when all have returned. The others run on helpers that the calling thread keeps: they sleep until its next
/// call and end with it, so that a call costs no start of threads. What `work` throws is thrown again, one of
/// several. `work` must not call `parallel` itself.
/// @param threads >= 1.
void parallel(std::size_t threads, const std::function<void(std::size_t)>& work);

/// Calls `step` again and again, on this thread and on `threads` - 1 others that it starts, on each until it
/// returns false. After an exception nobody calls it any more; the first one is passed on when all have
/// ended. `step` may call the other functions of this file.
void parallel_until_false(std::size_t threads, const std::function<bool()>& step);

/// Calls `work` once for every index below `count`, on thread_count() threads that it starts. The calls must
/// be independent of each other, so that the result does not depend on how many there are. The first
/// exception is passed on.
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& work);

/// The environment's CLEARWAY_THREADS, else all cores; 1 to 64.
std::size_t thread_count();

}  // namespace clearway

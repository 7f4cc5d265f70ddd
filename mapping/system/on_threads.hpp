#pragma once

#include <cstddef>
#include <functional>

namespace clearway {

/// Calls `work(0)` ... `work(threads - 1)` at the same time, `work(0)` on the calling thread, and returns
/// when all have returned. The others run on helpers that the calling thread keeps: they sleep until its next
/// call and end with it, so that a call costs no start of threads. What `work` throws is thrown again, one of
/// several. `work` must not call on_threads itself.
/// @param threads >= 1.
void on_threads(std::size_t threads, const std::function<void(std::size_t)>& work);

}  // namespace clearway

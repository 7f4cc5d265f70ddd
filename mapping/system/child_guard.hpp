#pragma once

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <initializer_list>

namespace clearway {

/// What a forked child that reads hostile files may take.
struct ChildGuard {
  /// Address space beyond what the program has already, bytes; none under sanitizers, which reserve
  /// terabytes.
  std::size_t memory = 0;
  std::uint64_t seconds = 10;  ///< processor time; SIGXCPU ends it
  /// The process before the fork: the child dies with the thread that forked. 0: it does not, and has to end
  /// when its pipe breaks.
  pid_t parent = 0;
};

/// Takes from a forked process the parent's signal handlers, terminal and files (but `kept`): for one that
/// goes on with work of ours. SIGPIPE is ignored, as is what the parent ignores. It dies with the thread of
/// `parent` that forked. To be called in it alone, first thing.
/// @param kept as of guard_child
/// @param nowhere /dev/null, opened by the parent; -1: it is opened here
void leave_parent(std::initializer_list<int*> kept, pid_t parent, int nowhere = -1);

/// Takes from a forked child the parent's signal handlers, terminal and files (but `kept`), core dumps,
/// writing files, and what the guard does not allow. SIGPIPE is ignored, as is what the parent ignores. To be
/// called in the child alone, first thing.
/// @param kept descriptors; those below 3 get other numbers, which are written back, and 0 to 2 become
/// /dev/null
void guard_child(std::initializer_list<int*> kept, const ChildGuard& guard);

/// Writes all of it, whatever signals come; false when that cannot be done.
bool write_fully(int descriptor, const void* from, std::size_t size);

}  // namespace clearway

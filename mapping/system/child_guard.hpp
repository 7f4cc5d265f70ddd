#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>

namespace clearway {

/// What shuts a forked child in that reads hostile files: takes from it the parent's signal handlers,
/// terminal and files (but `kept`), core dumps, writing files, memory and time beyond the limits, and life
/// beyond the parent's. SIGPIPE is ignored. To be called in the child alone, first thing.
/// @param memory address space beyond what the program has already, bytes (none under sanitizers, which
/// reserve
///        terabytes)
/// @param seconds processor time; SIGXCPU ends it
void guard_child(std::initializer_list<int> kept, std::size_t memory, std::uint64_t seconds);

/// Writes all of it, whatever signals come; false when that cannot be done.
bool write_fully(int descriptor, const void* from, std::size_t size);

}  // namespace clearway

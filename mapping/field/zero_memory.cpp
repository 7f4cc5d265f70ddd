#include "mapping/field/zero_memory.hpp"

#include <cstdlib>
#include <new>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace clearway {
namespace {

#if defined(__linux__)
constexpr std::size_t mapped_from = std::size_t{1} << 16U;  ///< bytes; below, malloc is quicker
#else
constexpr std::size_t mapped_from = ~std::size_t{0};
#endif

}  // namespace

std::span<std::uint8_t> zero_memory(std::size_t bytes) {
  void* memory = nullptr;
  if (bytes < mapped_from) {
    memory = std::calloc(bytes, 1);
  } else {
#if defined(__linux__)
    memory = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (memory == MAP_FAILED) memory = nullptr;
#endif
  }
  if (memory == nullptr) throw std::bad_alloc();
  return {static_cast<std::uint8_t*>(memory), bytes};
}

void free_zero_memory(std::span<std::uint8_t> memory) {
  if (memory.size() < mapped_from) return std::free(memory.data());
#if defined(__linux__)
  munmap(memory.data(), memory.size());
#endif
}

}  // namespace clearway

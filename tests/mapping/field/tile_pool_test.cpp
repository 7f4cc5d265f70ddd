#include "mapping/field/tile_pool.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <thread>
#include <vector>

#if defined(__linux__)
#include "tests/mapping/use_in_forks.hpp"
#endif

namespace clearway {
namespace tile_pool_test {

TEST(TilePool, SlotsAreAlignedAndDoNotOverlap) {
  std::vector<unsigned char*> slots;
  for (int i = 0; i < 1500; ++i) {
    slots.push_back(static_cast<unsigned char*>(TilePool::allocate()));
    ASSERT_EQ(reinterpret_cast<std::uintptr_t>(slots.back()) % 64, 0U);
    std::memset(slots.back(), i % 251, TilePool::slot_bytes);
  }
  for (std::size_t i = 0; i < slots.size(); ++i) {
    for (std::size_t k = 0; k < TilePool::slot_bytes; ++k) ASSERT_EQ(slots[i][k], i % 251);
  }
  for (unsigned char* slot : slots) TilePool::free(slot);
}

TEST(TilePool, WhatIsFreedIsGivenBackButForOneSlab) {
  const std::size_t before = TilePool::reserved_bytes();
  for (int round = 0; round < 3; ++round) {
    std::vector<void*> slots(5000);
    for (void*& slot : slots) slot = TilePool::allocate();
    for (void* slot : slots) TilePool::free(slot);
  }
  EXPECT_LE(TilePool::reserved_bytes(), before + (std::size_t{2} << 20U));
}

TEST(TilePool, ManyThreadsMayUseIt) {
  std::vector<std::thread> threads;
  for (unsigned char mark = 1; mark <= 4; ++mark) {
    threads.emplace_back([mark] {
      std::vector<unsigned char*> slots;
      for (int i = 0; i < 20000; ++i) {
        if (i % 3 == 2) {
          ASSERT_EQ(slots.back()[0], mark);
          TilePool::free(slots.back());
          slots.pop_back();
        } else if (slots.size() < 600) {
          slots.push_back(static_cast<unsigned char*>(TilePool::allocate()));
          slots.back()[0] = mark;
        }
      }
      for (unsigned char* slot : slots) TilePool::free(slot);
    });
  }
  for (std::thread& thread : threads) thread.join();
}

#if defined(__linux__)
TEST(TilePool, AForkedProcessCanUseIt) {
  EXPECT_EQ(use_in_forks([] { TilePool::free(TilePool::allocate()); }), 100);
}
#endif

}  // namespace tile_pool_test
}  // namespace clearway

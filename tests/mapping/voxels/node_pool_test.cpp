#include "mapping/voxels/node_pool.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <set>
#include <thread>
#include <vector>

#if defined(__linux__)
#include "tests/mapping/use_in_forks.hpp"
#endif

namespace clearway {
namespace node_pool_test {

void* slot() { return NodePool::allocate(NodePool::node_bytes); }
void give_back(void* memory) { NodePool::free(memory, NodePool::node_bytes); }

/// More than a thread keeps: some come from the others, and go back to them.
void use_many() {
  std::vector<void*> slots(3000);
  for (void*& each : slots) each = slot();
  for (void* each : slots) give_back(each);
}

TEST(NodePool, SlotsThatAreInUseNeverOverlap) {
  struct Taken {
    unsigned char* memory;
    std::size_t size;
  };
  std::vector<Taken> taken;
  for (int i = 0; i < 60000; ++i) {
    const std::size_t size = i % 4 == 0 ? NodePool::children_bytes : NodePool::node_bytes;
    taken.push_back({static_cast<unsigned char*>(NodePool::allocate(size)), size});
    std::memset(taken.back().memory, i % 251, size);
    if (i % 3 == 2) {
      NodePool::free(taken[taken.size() - 2].memory, taken[taken.size() - 2].size);
      taken.erase(taken.end() - 2);
    }
  }
  std::sort(taken.begin(), taken.end(), [](const Taken& a, const Taken& b) { return a.memory < b.memory; });
  for (std::size_t i = 1; i < taken.size(); ++i)
    ASSERT_GE(taken[i].memory - taken[i - 1].memory, static_cast<std::ptrdiff_t>(taken[i - 1].size));
  for (const Taken& slot : taken) {
    for (std::size_t byte = 1; byte < slot.size; ++byte) ASSERT_EQ(slot.memory[byte], slot.memory[0]);
    NodePool::free(slot.memory, slot.size);
  }
}

TEST(NodePool, WhatWasFreedIsUsedAgain) {
  std::vector<void*> taken;
  const auto take = [&] {
    for (int i = 0; i < 100000; ++i) taken.push_back(slot());
  };
  const auto free_all = [&] {
    for (void* memory : taken) give_back(memory);
    taken.clear();
  };
  take();
  free_all();
  const std::size_t reserved = NodePool::reserved_bytes();
  for (int round = 0; round < 5; ++round) {
    take();
    free_all();
  }
  EXPECT_EQ(NodePool::reserved_bytes(), reserved);
}

TEST(NodePool, ThreadsMayFreeWhatOthersTookAndLeaveTheRestBehind) {
  for (int round = 0; round < 20; ++round) {
    std::vector<void*> taken(20000);
    std::thread([&] {
      for (void*& memory : taken) memory = slot();
    }).join();
    EXPECT_EQ(std::set<void*>(taken.begin(), taken.end()).size(), taken.size());
    std::thread([&] {
      for (void* memory : taken) give_back(memory);
    }).join();
  }
  const std::size_t reserved = NodePool::reserved_bytes();
  std::thread([&] {
    std::vector<void*> taken(20000);
    for (void*& memory : taken) memory = slot();
    for (void* memory : taken) give_back(memory);
  }).join();
  EXPECT_EQ(NodePool::reserved_bytes(), reserved);
}

#if defined(__linux__)
TEST(NodePool, AForkedProcessCanUseIt) {
  EXPECT_EQ(use_in_forks([] { use_many(); }), 100);
}
#endif

}  // namespace node_pool_test
}  // namespace clearway

#include "mapping/node_pool.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <set>
#include <thread>
#include <vector>

namespace clearway {
namespace {

void* slot() { return NodePool::allocate(NodePool::slot_bytes); }
void give_back(void* memory) { NodePool::free(memory, NodePool::slot_bytes); }

TEST(NodePool, SlotsThatAreInUseNeverOverlap) {
  std::vector<unsigned char*> taken;
  for (int i = 0; i < 40000; ++i) {
    taken.push_back(static_cast<unsigned char*>(slot()));
    std::memset(taken.back(), i % 251, NodePool::slot_bytes);
    if (i % 3 == 2) {
      give_back(taken[taken.size() - 2]);
      taken.erase(taken.end() - 2);
    }
  }
  std::sort(taken.begin(), taken.end());
  for (std::size_t i = 1; i < taken.size(); ++i) {
    ASSERT_GE(taken[i] - taken[i - 1], static_cast<std::ptrdiff_t>(NodePool::slot_bytes));
  }
  for (unsigned char* memory : taken) {
    for (std::size_t byte = 1; byte < NodePool::slot_bytes; ++byte) ASSERT_EQ(memory[byte], memory[0]);
    give_back(memory);
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

}  // namespace
}  // namespace clearway

#include "common/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

namespace omnitag {
namespace {

TEST(ForEachIndex, CallsEachIndexOnce) {
  for (const int threads : {-1, 0, 1, 2, 5}) {
    for (const std::size_t count : {0U, 1U, 3U, 1000U}) {
      std::vector<std::atomic<int>> calls(count);
      forEachIndex(count, threads, 1, [&](std::size_t i) { ++calls[i]; });
      for (const std::atomic<int>& times : calls) EXPECT_EQ(times, 1);
    }
  }
}

TEST(ForEachIndexByWorker, NoTwoAreTheSameWorkerAtOnce) {
  constexpr int kThreads = 4;
  std::vector<std::atomic<int>> at_work(kThreads);
  std::atomic<int> calls{0};
  std::atomic<bool> is_alone{true};
  forEachIndexByWorker(2000, kThreads, 1, [&](std::size_t worker, std::size_t) {
    if (worker >= kThreads || ++at_work[worker] != 1) is_alone = false;
    ++calls;
    std::this_thread::yield();
    if (worker < kThreads) --at_work[worker];
  });
  EXPECT_EQ(calls, 2000);
  EXPECT_TRUE(is_alone);
}

TEST(ForEachIndex, StaysOnTheCallersThreadWhereThereIsToBeOne) {
  std::set<std::thread::id> used;
  forEachIndex(100, 1, 1, [&](std::size_t) { used.insert(std::this_thread::get_id()); });
  EXPECT_EQ(used, std::set<std::thread::id>{std::this_thread::get_id()});
}

TEST(ForEachIndex, UsesAllOfItsThreadsAtOnce) {
  constexpr int kThreads = 3;
  std::atomic<int> at_work{0};
  std::atomic<bool> did_meet{true};
  // Each waits for the others, so a single thread would wait in vain.
  forEachIndex(kThreads, kThreads, 1, [&](std::size_t) {
    ++at_work;
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (at_work < kThreads && did_meet) {
      if (std::chrono::steady_clock::now() > deadline) did_meet = false;
      std::this_thread::yield();
    }
  });
  EXPECT_TRUE(did_meet);
}

TEST(ForEachIndex, UsesNoMoreThreadsThanItMay) {
  constexpr int kThreads = 2;
  std::mutex mutex;
  std::set<std::thread::id> used;
  forEachIndex(1000, kThreads, 1, [&](std::size_t) {
    const std::lock_guard<std::mutex> lock(mutex);
    used.insert(std::this_thread::get_id());
  });
  EXPECT_LE(used.size(), kThreads);
}

TEST(ForEachIndex, StaysOnTheCallersThreadWhereThereIsTooLittleToDo) {
  std::set<std::thread::id> used;
  forEachIndex(7, 4, 4, [&](std::size_t) { used.insert(std::this_thread::get_id()); });
  EXPECT_EQ(used, std::set<std::thread::id>{std::this_thread::get_id()});
}

}  // namespace
}  // namespace omnitag

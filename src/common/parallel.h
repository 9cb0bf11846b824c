#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace omnitag {

/// Calls `work(worker, i)` for every i below `count`, on at most `threads` threads including the
/// calling one; each thread is a worker, numbered from 0. The calls must be independent of each
/// other and must not throw. Starting the threads takes some ten microseconds each time:
/// `worth_a_thread` is the number of calls that take longer than that.
template <typename Work>
void forEachIndexByWorker(std::size_t count, int threads, std::size_t worth_a_thread,
                          const Work& work) {
  std::atomic<std::size_t> next{0};
  const auto takeTurns = [&](std::size_t worker) {
    for (std::size_t i = next++; i < count; i = next++) work(worker, i);
  };
  const std::size_t workers =
      std::min(count / worth_a_thread, static_cast<std::size_t>(std::max(1, threads)));
  std::vector<std::thread> others;
  for (std::size_t k = 1; k < workers; ++k) others.emplace_back(takeTurns, k);
  takeTurns(0);
  for (std::thread& other : others) other.join();
}

/// The same if it does not matter which worker makes a call.
template <typename Work>
void forEachIndex(std::size_t count, int threads, std::size_t worth_a_thread, const Work& work) {
  forEachIndexByWorker(count, threads, worth_a_thread,
                       [&work](std::size_t /*worker*/, std::size_t i) { work(i); });
}

}  // namespace omnitag

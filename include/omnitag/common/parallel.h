#pragma once

#include <cstddef>
#include <opencv2/core/utility.hpp>

namespace omnitag {

/// Calls `work(i)` for every i below `count`, on at most so many threads at once: OpenCV's, which
/// stay from call to call. The calls must not depend on each other and must not throw.
template <typename Work>
void forEachIndex(std::size_t count, int threads, const Work& work) {
  if (threads <= 1 || count < 2) {
    for (std::size_t i = 0; i < count; ++i) work(i);
    return;
  }
  cv::parallel_for_(
      cv::Range(0, static_cast<int>(count)),
      [&work](const cv::Range& range) {
        for (int i = range.start; i < range.end; ++i) work(static_cast<std::size_t>(i));
      },
      threads);
}

}  // namespace omnitag

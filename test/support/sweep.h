#pragma once

namespace omnitag::test {

/// Of so many cases of a long sweep one is tried: all, but under sanitizers, which take twenty
/// times as long, and see in some of them what there is to see in all.
#ifdef OMNITAG_SANITIZED
constexpr int kSweepStride = 3;
#else
constexpr int kSweepStride = 1;
#endif

}  // namespace omnitag::test

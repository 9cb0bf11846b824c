#pragma once

namespace omnitag::test {

#ifdef OMNITAG_SANITIZED
constexpr bool kIsSanitized = true;
#else
constexpr bool kIsSanitized = false;
#endif

/// One of this many cases of a long sweep is tried: all, or a fifth under sanitizers, which take
/// ten times as long and find in some cases what they would find in all.
constexpr int kSweepStride = kIsSanitized ? 5 : 1;

/// Why a test skips itself under sanitizers.
constexpr char kRepeats[] = "repeats, for statistics or to compare, what others do once";

}  // namespace omnitag::test

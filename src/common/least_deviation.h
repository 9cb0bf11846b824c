#pragma once

namespace omnitag {

/// m and rad: the smallest standard deviation, which keeps information finite. It is a map file's
/// last digit, and so much more exact than anything else that it amounts to holding what has it.
inline constexpr double kLeastDeviation = 1e-6;

}  // namespace omnitag

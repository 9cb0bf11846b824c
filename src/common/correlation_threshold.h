#pragma once

namespace omnitag {

/// The correlation with a given pattern that a random pattern, which varies in `dimensions`
/// independent ways, reaches in at most `rate` of all cases: the cap of half-angle acos(t) has at
/// most the share (1 - t^2)^((n - 1) / 2) / 2 of the sphere in n dimensions.
double correlationThreshold(double dimensions, double rate);

}  // namespace omnitag

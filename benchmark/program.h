#pragma once

#include <cstdlib>
#include <exception>
#include <iostream>
#include <string>

#include "omnitag/common/error.h"

namespace omnitag {

/// What main() returns: what `run` does, or 1 after one line on standard error where it throws.
template <typename Run>
int runProgram(const std::string& name, const Run& run) {
  try {
    return run();
  } catch (const std::exception& error) {
    std::cerr << name << ": " << error.what() << '\n';
    return 1;
  }
}

/// The number that is the only argument, or `standard` without one. Throws InputError.
inline int countFrom(int argc, char** argv, int standard, int least) {
  if (argc == 1) return standard;
  constexpr long kMost = 100000000;
  char* end = nullptr;
  const long count = std::strtol(argv[1], &end, 10);
  if (argc != 2 || *end != '\0' || count < least || count > kMost) {
    throw InputError("expected a number >= " + std::to_string(least) + ", or nothing");
  }
  return static_cast<int>(count);
}

}  // namespace omnitag

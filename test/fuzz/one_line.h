#pragma once

#include <cstdio>
#include <cstdlib>
#include <string>

namespace omnitag::test {

/// Ends the program where a refusal is not one line.
inline void expectOneLine(const std::string& refusal) {
  if (!refusal.empty() && refusal.find('\n') == std::string::npos) return;
  std::fprintf(stderr, "expected a refusal of one line, found:\n%s\n", refusal.c_str());
  std::abort();
}

}  // namespace omnitag::test

#pragma once

#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace omnitag {

/// The values formatted by printf's pattern, which must match them.
template <typename... Values>
std::string format(const char* pattern, Values... values) {
  const int length = std::snprintf(nullptr, 0, pattern, values...);
  std::string text(static_cast<std::size_t>(length) + 1, '\0');
  std::snprintf(text.data(), text.size(), pattern, values...);
  text.pop_back();
  return text;
}

/// The fewest digits that read back as the same number.
inline std::string shortestText(double number) {
  constexpr int kFewest = 15;
  constexpr int kEnough = 17;
  for (int digits = kFewest; digits < kEnough; ++digits) {
    std::string text = format("%.*g", digits, number);
    if (std::strtod(text.c_str(), nullptr) == number) return text;
  }
  return format("%.*g", kEnough, number);
}

}  // namespace omnitag

#pragma once

#include <cstddef>
#include <cstdio>
#include <string>

namespace omnitag {

/// A text by printf's pattern, which must be right for the values.
template <typename... Values>
std::string format(const char* pattern, Values... values) {
  const int length = std::snprintf(nullptr, 0, pattern, values...);
  std::string text(static_cast<std::size_t>(length) + 1, '\0');
  std::snprintf(text.data(), text.size(), pattern, values...);
  text.pop_back();
  return text;
}

}  // namespace omnitag

#pragma once

#include <stdexcept>

namespace omnitag {

/// Bad input from outside: a file, a parameter, a message or a command line. `what()` is one line
/// that names the place, what was expected there and what was found.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace omnitag

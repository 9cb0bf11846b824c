#include "mounting_option.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <sstream>
#include <utility>

#include "omnitag/adjustment/leaning_mounting.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

constexpr std::size_t kSize = 6;
using Numbers = std::array<double, kSize>;

/// x, y, z, roll, pitch, yaw.
Numbers numbersOf(const Eigen::Isometry3d& base_from_camera) {
  const Eigen::Vector3d position = base_from_camera.translation();
  const Eigen::Vector3d angles = rollPitchYaw(base_from_camera.linear());
  return {position.x(), position.y(), position.z(), angles.x(), angles.y(), angles.z()};
}

std::string join(const Numbers& numbers, const char* separator) {
  std::string text;
  for (const double number : numbers) {
    std::array<char, 32> digits{};
    std::snprintf(digits.data(), digits.size(), "%.6f", number);
    text += (text.empty() ? "" : separator) + std::string(digits.data());
  }
  return text;
}

}  // namespace

Eigen::Isometry3d parseMounting(const std::string& option, const std::string& text) {
  std::istringstream stream(text);
  Numbers numbers{};
  bool is_read = true;
  for (std::size_t i = 0; i < kSize; ++i) {
    char comma = ',';
    if (i > 0) stream >> comma;
    stream >> numbers.at(i);
    is_read = is_read && !stream.fail() && comma == ',' && std::isfinite(numbers.at(i));
  }
  if (!is_read || !(stream >> std::ws).eof()) {
    throw InputError(option + ": expected X,Y,Z,ROLL,PITCH,YAW in metres and radians, found '" +
                     text + "'");
  }
  const auto& [x, y, z, roll, pitch, yaw] = numbers;
  Eigen::Isometry3d base_from_camera(Eigen::Translation3d(x, y, z));
  base_from_camera.linear() = fromRollPitchYaw({roll, pitch, yaw});
  return base_from_camera;
}

std::string mountingText(const Eigen::Isometry3d& base_from_camera) {
  return join(numbersOf(base_from_camera), ",");
}

std::string publisherArguments(const Eigen::Isometry3d& base_from_camera) {
  Numbers numbers = numbersOf(base_from_camera);
  std::swap(numbers[3], numbers[5]);
  return join(numbers, " ");
}

}  // namespace omnitag

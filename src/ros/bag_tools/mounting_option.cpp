#include "ros/bag_tools/mounting_option.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <sstream>
#include <utility>
#include <vector>

#include "adjustment/leaning_mounting.h"
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

/// The finite numbers between commas; none if there is anything else.
std::vector<double> numbersIn(const std::string& text) {
  std::istringstream stream(text);
  std::vector<double> numbers;
  char comma = ',';
  while (comma == ',') {
    double number = 0.0;
    if (!(stream >> number) || !std::isfinite(number)) return {};
    numbers.push_back(number);
    if ((stream >> std::ws).eof()) return numbers;
    stream >> comma;
  }
  return {};
}

}  // namespace

Eigen::Isometry3d parseMounting(const std::string& option, const std::string& text) {
  constexpr std::size_t kWithQuaternion = 7;
  constexpr double kUnit = 0.01;  // what is left off a quaternion's length by printed digits
  const std::vector<double> numbers = numbersIn(text);
  const bool has_quaternion = numbers.size() == kWithQuaternion;
  const Eigen::Vector4d quaternion =
      has_quaternion ? Eigen::Vector4d(&numbers[3]) : Eigen::Vector4d(Eigen::Vector4d::UnitW());
  const bool is_unit = std::abs(quaternion.norm() - 1.0) < kUnit;
  if ((numbers.size() != kSize && !has_quaternion) || !is_unit) {
    throw InputError(option +
                     ": expected X,Y,Z,ROLL,PITCH,YAW in metres and radians, or X,Y,Z,QX,QY,QZ,QW "
                     "with a unit quaternion, found '" +
                     text + "'");
  }
  Eigen::Isometry3d base_from_camera(Eigen::Translation3d(numbers[0], numbers[1], numbers[2]));
  base_from_camera.linear() = has_quaternion
                                  ? Eigen::Quaterniond(quaternion.normalized()).toRotationMatrix()
                                  : fromRollPitchYaw({numbers[3], numbers[4], numbers[5]});
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

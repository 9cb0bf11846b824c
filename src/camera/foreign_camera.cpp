#include "camera/foreign_camera.h"

#include <algorithm>
#include <utility>

#include "common/format.h"

namespace omnitag {

YAML::Node describedCamera(const std::string& model, const Intrinsics& intrinsics) {
  YAML::Node camera(YAML::NodeType::Map);
  camera["model"] = model;
  YAML::Node image = camera["image"];
  image["width"] = intrinsics.size.width;
  image["height"] = intrinsics.size.height;
  image.SetStyle(YAML::EmitterStyle::Flow);
  YAML::Node lens = camera["lens"];
  lens["fx"] = shortestText(intrinsics.fx);
  lens["fy"] = shortestText(intrinsics.fy);
  lens["cx"] = shortestText(intrinsics.cx);
  lens["cy"] = shortestText(intrinsics.cy);
  if (intrinsics.skew != 0.0) lens["skew"] = shortestText(intrinsics.skew);
  lens.SetStyle(YAML::EmitterStyle::Flow);
  return camera;
}

YAML::Node describedCamera(const std::string& model, const Intrinsics& intrinsics,
                           const std::vector<double>& distortion) {
  YAML::Node camera = describedCamera(model, intrinsics);
  for (const double each : distortion) camera["distortion"].push_back(shortestText(each));
  camera["distortion"].SetStyle(YAML::EmitterStyle::Flow);
  return camera;
}

std::vector<double> pinholeDistortion(const YamlReader& file, const std::string& key,
                                      std::vector<double> coefficients) {
  constexpr std::size_t kKnown = 5;
  constexpr std::size_t kFewest = 4;
  if (!coefficients.empty() && coefficients.size() < kFewest) {
    file.refuse(key, "4, 5 or more coefficients, or none");
  }
  const auto others =
      coefficients.begin() + static_cast<std::ptrdiff_t>(std::min(kKnown, coefficients.size()));
  if (std::any_of(others, coefficients.end(), [](double x) { return x != 0.0; })) {
    file.refuse(key, "k1, k2, p1, p2, k3 and 0 for all others, which no model here has");
  }
  coefficients.resize(kKnown, 0.0);
  return coefficients;
}

std::vector<double> matrixNumbers(const YamlReader& file, const std::string& key) {
  return file.isMapping(key) ? file.mapping(key).numbers("data") : file.numbers(key);
}

Intrinsics cameraMatrix(const YamlReader& file, const std::string& key) {
  constexpr std::size_t kEntries = 9;
  const std::vector<double> k = matrixNumbers(file, key);
  const bool is_matrix = k.size() == kEntries && k[0] > 0.0 && k[4] > 0.0 && k[3] == 0.0;
  if (!is_matrix) {
    throw InputError(file.where(key) +
                     ": expected the 9 numbers of a camera matrix [fx, s, cx, 0, fy, cy, 0, 0, 1] "
                     "with focal lengths > 0, found another list");
  }
  return {{}, k[0], k[4], k[2], k[5], k[1]};
}

}  // namespace omnitag

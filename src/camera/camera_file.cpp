#include "omnitag/camera/camera_file.h"

#include <array>
#include <filesystem>
#include <sstream>
#include <string_view>
#include <utility>

#include "camera/camera_reader.h"
#include "camera/camera_yaml.h"
#include "camera/foreign_camera.h"

namespace omnitag {
namespace {

using Reader = std::shared_ptr<CameraModel> (*)(const YamlReader&);

/// One for each `model`.
constexpr std::array<std::pair<std::string_view, Reader>, 8> kReaders = {
    {{"catadioptric", readCatadioptric},
     {"equidistant", readEquidistant},
     {"unified", readUnified},
     {"pinhole", readPinhole},
     {"double_sphere", readDoubleSphere},
     {"eucm", readEucm},
     {"ocam", readOcam},
     {"equirectangular", readEquirectangular}}};

std::shared_ptr<CameraModel> readModel(const YamlReader& camera) {
  const std::string model = camera.text("model");
  std::string known;
  for (const auto& [name, read] : kReaders) {
    if (model == name) return read(camera);
    known += (known.empty() ? "" : ", ") + std::string(name);
  }
  camera.refuse("model", "one of " + known);
}

std::shared_ptr<const CameraModel> readCamera(const YamlReader& camera) {
  std::shared_ptr<CameraModel> model = readModel(camera);
  model->setUncertainty(readUncertainty(camera, model->imageSize()));
  bool scales_to_image = false;
  camera.read("scale_to_image", &scales_to_image);
  model->setScalesToImage(scales_to_image);
  return model;
}

/// A path and, behind a '#', the name of one of the file's cameras.
struct Place {
  std::string path;
  std::string camera;
};

Place placeOf(const std::string& text) {
  const std::size_t mark = text.rfind('#');
  std::error_code ignored;
  if (mark == std::string::npos || std::filesystem::exists(text, ignored)) return {text, ""};
  return {text.substr(0, mark), text.substr(mark + 1)};
}

/// Whether a text begins as OCamCalib's files do: with a number, after comments.
bool isOcamCalibration(const std::string& text) {
  std::istringstream lines(text);
  std::string line;
  while (std::getline(lines, line)) {
    const std::size_t first = line.find_first_not_of(" \t\r");
    if (first != std::string::npos && line[first] != '#') {
      return line[first] >= '0' && line[first] <= '9';
    }
  }
  return false;
}

YAML::Node ocamFile(const std::string& path) {
  YAML::Node camera(YAML::NodeType::Map);
  camera["model"] = "ocam";
  camera["calibration_file"] = std::filesystem::path(path).filename().string();
  return camera;
}

/// As a camera file of this package, whichever tool wrote it.
YAML::Node ownFile(const YAML::Node& node, const Place& place) {
  const YamlReader file(node, place.path);
  const bool is_kalibr = !file.has("model") && isKalibr(file);
  if (!place.camera.empty() && !is_kalibr) {
    file.refuse("expected one of several cameras, as Kalibr writes them, by the name '" +
                place.camera + "', found another file");
  }
  if (file.has("model")) return node;
  if (is_kalibr) return cameraFromKalibr(file, place.camera);
  if (isCameraInfo(file)) return cameraFromCameraInfo(file);
  if (isOpenCv(file)) return cameraFromOpenCv(file);
  file.refuse("model",
              "a camera's model, or the file of another tool, with camera_model (Kalibr), "
              "camera_matrix (OpenCV) or distortion_model (camera_info)");
}

YAML::Node ownFileOf(const std::string& text, const Place& place) {
  if (isOcamCalibration(text)) return ownFile(ocamFile(place.path), place);
  return ownFile(YamlReader::fromText(text, place.path).node(), place);
}

}  // namespace

std::shared_ptr<const CameraModel> loadCamera(const std::string& path) {
  return cameraOf(readCameraFile(path), cameraFilePath(path));
}

std::shared_ptr<const CameraModel> parseCamera(const std::string& text, const std::string& origin) {
  return cameraOf(ownFileOf(text, {origin, ""}), origin);
}

YAML::Node readCameraFile(const std::string& path) {
  const Place place = placeOf(path);
  return ownFileOf(YamlReader::textOf(place.path), place);
}

std::string cameraFilePath(const std::string& path) { return placeOf(path).path; }

YAML::Node cameraFileOfInfo(const YAML::Node& info, const std::string& origin) {
  return cameraFromCameraInfo(YamlReader(info, origin));
}

std::shared_ptr<const CameraModel> cameraOf(const YAML::Node& file, const std::string& origin) {
  return readCamera(YamlReader(file, origin));
}

}  // namespace omnitag

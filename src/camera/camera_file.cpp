#include "omnitag/camera/camera_file.h"

#include <string_view>
#include <utility>

#include "camera_reader.h"

namespace omnitag {
namespace {

using Reader = std::shared_ptr<CameraModel> (*)(const YamlReader&);

/// One for each `model`.
constexpr std::pair<std::string_view, Reader> kReaders[] = {
    {"catadioptric", readCatadioptric},
    {"equidistant", readEquidistant},
    {"unified", readUnified},
    {"pinhole", readPinhole},
    {"double_sphere", readDoubleSphere},
    {"eucm", readEucm},
    {"ocam", readOcam},
    {"equirectangular", readEquirectangular}};

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
  return model;
}

}  // namespace

std::shared_ptr<const CameraModel> loadCamera(const std::string& path) {
  return readCamera(YamlReader::fromFile(path));
}

std::shared_ptr<const CameraModel> parseCamera(const std::string& text, const std::string& origin) {
  return readCamera(YamlReader::fromText(text, origin));
}

}  // namespace omnitag

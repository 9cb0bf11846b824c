#include "omnitag/camera/camera_file.h"

#include "camera_reader.h"

namespace omnitag {
namespace {

std::shared_ptr<CameraModel> readModel(const YamlReader& camera) {
  const std::string model = camera.text("model");
  if (model == "catadioptric") return readCatadioptric(camera);
  if (model == "equidistant") return readEquidistant(camera);
  if (model == "unified") return readUnified(camera);
  if (model == "ocam") return readOcam(camera);
  camera.refuse("model", "one of catadioptric, equidistant, unified, ocam");
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

#include "camera/camera_reader.h"

namespace omnitag {

ImageSize readImageSize(const YamlReader& camera) {
  const YamlReader image = camera.mapping("image");
  image.allowOnly({"width", "height"});
  constexpr Interval kPixels{1, 1 << 15};
  return {image.integer("width", kPixels), image.integer("height", kPixels)};
}

ImagePlane readImagePlane(const YamlReader& lens, const ImagePlane::Distortion& distortion) {
  Eigen::Matrix2d affine = Eigen::Matrix2d::Zero();
  affine(0, 0) = lens.number("fx", kPositive);
  affine(1, 1) = lens.number("fy", kPositive);
  lens.read("skew", &affine(0, 1));
  return {affine, {lens.number("cx"), lens.number("cy")}, distortion};
}

CameraUncertainty readUncertainty(const YamlReader& camera, const ImageSize& size) {
  const std::string key = "uncertainty";
  constexpr double kPerHeight = 0.5 / 500.0;
  const double usual = kPerHeight * size.height;
  if (!camera.has(key)) return {usual, usual, usual, usual};
  if (camera.isText(key)) {
    if (camera.text(key) != "none") camera.refuse(key, "none or a mapping of deviations in pixels");
    return {};
  }
  const YamlReader reader = camera.mapping(key);
  reader.allowOnly({"principal_point", "scale", "tilt", "rim"});
  CameraUncertainty uncertainty;
  reader.read("principal_point", &uncertainty.principal_point, kNonNegative);
  reader.read("scale", &uncertainty.scale, kNonNegative);
  reader.read("tilt", &uncertainty.tilt, kNonNegative);
  reader.read("rim", &uncertainty.rim, kNonNegative);
  return uncertainty;
}

FieldLimits readFieldLimits(const YamlReader& camera) {
  FieldLimits limits;
  if (camera.has("max_angle")) {
    limits.max_angle = camera.number("max_angle", {0.0, CentralCamera::kLargestAngle, false});
  }
  camera.read("through_mirror", &limits.through_mirror);
  return limits;
}

}  // namespace omnitag

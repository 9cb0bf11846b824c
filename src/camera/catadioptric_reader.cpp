#include <algorithm>
#include <vector>

#include "camera/camera_reader.h"
#include "camera/catadioptric_camera.h"

namespace omnitag {
namespace {

MirrorProfile readConic(const YamlReader& mirror, const std::string& profile) {
  double conic_constant = 0.0;
  if (profile == "spherical" || profile == "parabolic") {
    conic_constant = profile == "spherical" ? 0.0 : -1.0;
    double stated = conic_constant;
    mirror.read("conic_constant", &stated);
    if (stated != conic_constant) {
      mirror.refuse("conic_constant", std::string(profile == "spherical" ? "0" : "-1") +
                                          " or none with the " + profile + " profile");
    }
  } else {
    conic_constant = mirror.number("conic_constant");
    if (profile == "hyperbolic" && !(conic_constant < -1.0)) {
      mirror.refuse("conic_constant", "a number < -1 with the hyperbolic profile");
    }
  }
  std::vector<double> coefficients;
  if (profile == "aspheric") {
    coefficients = mirror.numbers("coefficients");
  } else if (mirror.has("coefficients")) {
    mirror.refuse("coefficients", "none with the " + profile + " profile");
  }
  return MirrorProfile::conic(mirror.number("radius_of_curvature", kPositive), conic_constant,
                              coefficients);
}

MirrorProfile readTabulated(const YamlReader& mirror) {
  std::vector<Eigen::Vector2d> samples;
  for (const std::vector<double>& row : mirror.table("samples", 2)) {
    samples.emplace_back(row[0], row[1]);
  }
  try {
    return MirrorProfile::tabulated(samples);
  } catch (const InputError& error) {
    throw InputError(mirror.where("samples") + ": " + error.what());
  }
}

MirrorProfile readProfile(const YamlReader& mirror) {
  const std::string profile = mirror.text("profile");
  if (profile == "tabulated") {
    mirror.allowOnly({"profile", "samples", "apex_distance", "rim_radius"});
    return readTabulated(mirror);
  }
  if (profile == "spherical" || profile == "parabolic" || profile == "hyperbolic" ||
      profile == "aspheric") {
    mirror.allowOnly({"profile", "radius_of_curvature", "conic_constant", "coefficients",
                      "apex_distance", "rim_radius"});
    return readConic(mirror, profile);
  }
  mirror.refuse("profile", "one of spherical, parabolic, hyperbolic, aspheric, tabulated");
}

}  // namespace

std::shared_ptr<CameraModel> readCatadioptric(const YamlReader& camera) {
  camera.allowOnly({"model", "image", "lens", "mirror", "uncertainty", "scale_to_image"});
  const YamlReader lens = camera.mapping("lens");
  lens.allowOnly({"fx", "fy", "cx", "cy", "distortion", "housing_radius"});
  const YamlReader mirror = camera.mapping("mirror");
  CatadioptricCamera::Mirror shape{readProfile(mirror), mirror.number("apex_distance", kPositive),
                                   mirror.number("rim_radius", kPositive)};
  lens.read("housing_radius", &shape.housing_radius, kNonNegative);
  const ImageSize image_size = readImageSize(camera);
  ImagePlane::Distortion distortion{};
  if (lens.has("distortion")) {
    const std::vector<double> coefficients = lens.numbers("distortion", distortion.size());
    std::copy(coefficients.begin(), coefficients.end(), distortion.begin());
  }
  const ImagePlane image_plane = readImagePlane(lens, distortion);
  return madeFor(
      camera, [&] { return std::make_shared<CatadioptricCamera>(image_size, image_plane, shape); });
}

}  // namespace omnitag

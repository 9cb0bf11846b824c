#pragma once

#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <memory>
#include <opencv2/calib3d.hpp>
#include <opencv2/ccalib/omnidir.hpp>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "camera/double_sphere_camera.h"
#include "camera/equidistant_camera.h"
#include "camera/eucm_camera.h"
#include "camera/ocam_camera.h"
#include "camera/unified_camera.h"
#include "toolbox_ocam.h"

namespace omnitag {

/// A central camera for tests, and somebody else's code for the same parameters.
struct CentralSample {
  std::string name;
  std::shared_ptr<const CentralCamera> camera;
  /// The pixel of a point of the camera's frame, z out of the lens; nothing where the oracle does
  /// not reach.
  std::function<std::optional<Eigen::Vector2d>(const Eigen::Vector3d&)> oracle;
};

/// How gtest names a sample.
inline void PrintTo(const CentralSample& sample, std::ostream* out) { *out << sample.name; }

inline ImagePlane lensOf(double fx, double fy, double cx, double cy, double skew = 0.0,
                         const ImagePlane::Distortion& distortion = {}) {
  Eigen::Matrix2d affine;
  affine << fx, skew, 0.0, fy;
  return {affine, {cx, cy}, distortion};
}

inline cv::Matx33d matrixOf(const ImagePlane& plane) {
  const Eigen::Matrix2d& a = plane.affine();
  const Eigen::Vector2d& c = plane.principalPoint();
  return {a(0, 0), a(0, 1), c.x(), a(1, 0), a(1, 1), c.y(), 0.0, 0.0, 1.0};
}

/// OpenCV's fisheye module divides by z and so knows no point at 90 degrees or beyond.
inline CentralSample equidistantSample(const std::string& name, const ImageSize& size,
                                       const ImagePlane& plane,
                                       const EquidistantCamera::Coefficients& k,
                                       const FieldLimits& limits = {}) {
  const auto oracle = [plane, k](const Eigen::Vector3d& p) -> std::optional<Eigen::Vector2d> {
    if (p.z() < 1e-3 * p.norm()) return std::nullopt;
    std::vector<cv::Point2d> pixels;
    cv::fisheye::projectPoints(std::vector<cv::Point3d>{{p.x(), p.y(), p.z()}}, pixels,
                               cv::Vec3d(0, 0, 0), cv::Vec3d(0, 0, 0), matrixOf(plane),
                               cv::Vec4d(k[0], k[1], k[2], k[3]));
    return Eigen::Vector2d(pixels[0].x, pixels[0].y);
  };
  return {name, std::make_shared<EquidistantCamera>(size, plane, k, limits), oracle};
}

/// A point by OpenCV's omnidir module.
inline Eigen::Vector2d byOmnidir(const Eigen::Vector3d& p, const cv::Matx33d& matrix, double xi,
                                 const cv::Vec4d& distortion = {}) {
  std::vector<cv::Point2d> pixels;
  cv::omnidir::projectPoints(std::vector<cv::Point3d>{{p.x(), p.y(), p.z()}}, pixels,
                             cv::Vec3d(0, 0, 0), cv::Vec3d(0, 0, 0), matrix, xi, distortion);
  return {pixels[0].x, pixels[0].y};
}

/// With focal lengths larger by a factor.
inline cv::Matx33d enlarged(cv::Matx33d matrix, double factor) {
  for (const auto& [row, column] : {std::pair{0, 0}, {0, 1}, {1, 1}}) matrix(row, column) *= factor;
  return matrix;
}

/// From the first sphere to the second by hand; from there on it is the unified model with the
/// parameter alpha / (1 - alpha), and a focal length 1 / (1 - alpha) times as long.
inline CentralSample doubleSphereSample(const std::string& name, const ImageSize& size,
                                        const ImagePlane& plane,
                                        const DoubleSphereCamera::Parameters& parameters,
                                        const FieldLimits& limits = {}) {
  const auto oracle = [=](const Eigen::Vector3d& p) {
    const double sign = limits.through_mirror ? -1.0 : 1.0;
    const Eigen::Vector3d first = Eigen::Vector3d(p.x(), p.y(), sign * p.z()).normalized();
    const double rest = 1.0 - parameters.alpha;
    return std::optional(byOmnidir(first + Eigen::Vector3d(0.0, 0.0, parameters.xi),
                                   enlarged(matrixOf(plane), 1.0 / rest), parameters.alpha / rest));
  };
  return {name, std::make_shared<DoubleSphereCamera>(size, plane, parameters, limits), oracle};
}

/// Stretching directions across the axis by the root of beta turns the ellipsoid into a sphere and
/// the model into the unified one; the image is stretched as much.
inline CentralSample eucmSample(const std::string& name, const ImageSize& size,
                                const ImagePlane& plane, const EucmCamera::Parameters& parameters,
                                const FieldLimits& limits = {}) {
  const auto oracle = [=](const Eigen::Vector3d& p) {
    const double sign = limits.through_mirror ? -1.0 : 1.0;
    const double stretch = std::sqrt(parameters.beta);
    const double rest = 1.0 - parameters.alpha;
    return std::optional(byOmnidir({stretch * p.x(), stretch * p.y(), sign * p.z()},
                                   enlarged(matrixOf(plane), 1.0 / (rest * stretch)),
                                   parameters.alpha / rest));
  };
  return {name, std::make_shared<EucmCamera>(size, plane, parameters, limits), oracle};
}

/// A lens without any of these spheres.
inline CentralSample pinholeSample(const std::string& name, const ImageSize& size,
                                   const ImagePlane& plane, const FieldLimits& limits = {}) {
  const auto oracle = [plane](const Eigen::Vector3d& p) -> std::optional<Eigen::Vector2d> {
    if (p.z() < 1e-3 * p.norm()) return std::nullopt;
    const ImagePlane::Distortion& d = plane.distortion();
    std::vector<cv::Point2d> pixels;
    cv::projectPoints(std::vector<cv::Point3d>{{p.x(), p.y(), p.z()}}, cv::Vec3d(0, 0, 0),
                      cv::Vec3d(0, 0, 0), matrixOf(plane), std::vector<double>(d.begin(), d.end()),
                      pixels);
    return Eigen::Vector2d(pixels[0].x, pixels[0].y);
  };
  return {name, std::make_shared<UnifiedCamera>(size, plane, 0.0, limits), oracle};
}

inline CentralSample unifiedSample(const std::string& name, const ImageSize& size,
                                   const ImagePlane& plane, double xi,
                                   const FieldLimits& limits = {}) {
  const auto oracle = [plane, xi, limits](const Eigen::Vector3d& p) {
    const ImagePlane::Distortion& d = plane.distortion();
    return std::optional(byOmnidir({p.x(), p.y(), limits.through_mirror ? -p.z() : p.z()},
                                   matrixOf(plane), xi, {d[0], d[1], d[2], d[3]}));
  };
  return {name, std::make_shared<UnifiedCamera>(size, plane, xi, limits), oracle};
}

inline CentralSample ocamSample(const std::string& name, const OcamCalibration& calibration,
                                const FieldLimits& limits = {}) {
  const auto oracle = [calibration, limits](const Eigen::Vector3d& p) {
    return test::world2cam(calibration, {p.x(), p.y(), limits.through_mirror ? -p.z() : p.z()});
  };
  return {name, std::make_shared<OcamCamera>(calibration, limits), oracle};
}

/// Every model, with each of its complications.
inline std::vector<CentralSample> centralSamples() {
  const ImageSize small{500, 500};
  const ImageSize wide{1280, 800};
  const auto upTo = [](double max_angle) { return FieldLimits{max_angle, false}; };
  return {
      equidistantSample("Equidistant190", small, lensOf(146, 146, 249.5, 249.5), {}, upTo(1.6581)),
      equidistantSample("EquidistantOffCentre", wide, lensOf(402.1, 398.7, 651.3, 391.8),
                        {-0.0312, 0.0081, -0.0043, 0.00071}),
      equidistantSample("EquidistantThatFoldsInTheCorners", wide,
                        lensOf(286.0, 286.0, 640.0, 400.0), {-0.01, 0.002, -0.009, 0.0}),
      equidistantSample("EquidistantAllAround", small, lensOf(80, 80, 249.5, 249.5),
                        {0.01, -0.001, 0.0, 0.0}, upTo(3.0)),
      unifiedSample("UnifiedParabolic", small, lensOf(210, 210, 249.5, 249.5), 1.0, upTo(1.7)),
      unifiedSample(
          "UnifiedDistortedSkewed", wide,
          lensOf(1021.3, 1018.9, 633.2, 402.6, 1.7, {-0.215, 0.161, 0.0012, -0.0009, 0.0}), 1.62),
      unifiedSample("UnifiedThroughAMirror", small, lensOf(260, 262, 251.0, 246.0), 0.93,
                    {1.9, true}),
      unifiedSample("UnifiedPinhole", small, lensOf(300, 300, 249.5, 249.5), 0.0),
      pinholeSample(
          "PinholeDistorted", wide,
          lensOf(702.1, 698.4, 643.9, 391.5, 0.0, {-0.21, 0.07, 0.0008, -0.0011, -0.004})),
      doubleSphereSample("DoubleSphere", wide, lensOf(313.7, 312.9, 638.2, 401.7), {-0.182, 0.591}),
      doubleSphereSample("DoubleSphereSkewed", small, lensOf(151.0, 150.2, 253.0, 247.1, 0.4),
                         {0.31, 0.42}, upTo(1.75)),
      doubleSphereSample("DoubleSphereThroughAMirror", small, lensOf(120.0, 121.0, 251.0, 246.0),
                         {-0.2, 0.61}, {1.9, true}),
      eucmSample("Eucm", wide, lensOf(431.5, 432.6, 641.1, 397.9), {0.631, 1.118}),
      eucmSample("EucmWide", small, lensOf(141.0, 140.0, 250.1, 248.2), {0.57, 1.31}, upTo(1.7)),
      eucmSample("EucmThroughAMirror", small, lensOf(150.0, 150.0, 249.5, 249.5), {0.55, 0.92},
                 {1.8, true}),
      ocamSample("Ocam", {{-289.5569, 0.0, 1.538894e-3, -3.140320e-6, 7.206996e-9},
                          390.949324,
                          423.714757,
                          0.999134,
                          -0.000325,
                          -0.000071,
                          {848, 800}}),
      ocamSample("OcamSheared", {{-180.2, 0.0, 2.1e-3, -1.7e-6, 4.4e-9, 1e-12},
                                 231.7,
                                 338.2,
                                 1.013,
                                 0.004,
                                 -0.006,
                                 {640, 480}}),
      ocamSample("OcamThroughAMirror",
                 {{-110.0, 0.0, 2.9e-3, 0.0, 2e-9}, 240.0, 320.0, 1.0, 0.0, 0.0, {640, 480}},
                 {1.95, true})};
}

}  // namespace omnitag

#include "pixel_information.h"

#include <Eigen/LU>
#include <cmath>

namespace omnitag {

Light fitLight(const std::vector<PatternPixel>& pixels, double noise) {
  const auto count = static_cast<double>(pixels.size());
  double white = 0.0;
  double grey = 0.0;
  for (const PatternPixel& pixel : pixels) {
    white += pixel.white / count;
    grey += pixel.grey / count;
  }
  double white_white = 0.0;
  double white_grey = 0.0;
  double grey_grey = 0.0;
  for (const PatternPixel& pixel : pixels) {
    white_white += (pixel.white - white) * (pixel.white - white);
    white_grey += (pixel.white - white) * (pixel.grey - grey);
    grey_grey += (pixel.grey - grey) * (pixel.grey - grey);
  }
  Light light;
  light.contrast = white_grey / white_white;
  light.black = grey - light.contrast * white;
  light.correlation = white_grey / std::sqrt(white_white * (grey_grey - count * noise * noise));
  return light;
}

double samplingVariance(const std::vector<PatternPixel>& pixels) {
  double squares = 0.0;
  int count = 0;
  for (const PatternPixel& pixel : pixels) {
    if (pixel.isEven()) continue;
    squares += (pixel.sampled_white - pixel.white) * (pixel.sampled_white - pixel.white);
    ++count;
  }
  return count > 0 ? squares / count : 0.0;
}

FrameEquations pixelInformation(const std::vector<PatternPixel>& pixels, double contrast,
                                double noise, double edge_variance) {
  FrameMatrix frame = FrameMatrix::Zero();
  Eigen::Matrix4d light = Eigen::Matrix4d::Zero();
  Eigen::Matrix<double, kFrameUnknowns, 4> both = Eigen::Matrix<double, kFrameUnknowns, 4>::Zero();
  FrameVector grey_with_frame = FrameVector::Zero();
  Eigen::Vector4d grey_with_light = Eigen::Vector4d::Zero();
  for (const PatternPixel& pixel : pixels) {
    const double variance =
        noise * noise + (pixel.isEven() ? 0.0 : contrast * contrast * edge_variance);
    const FrameVector grey_by_frame = contrast * pixel.white_by_frame;
    const Eigen::Vector4d grey_by_light(1.0, pixel.white, pixel.white * pixel.offset.x(),
                                        pixel.white * pixel.offset.y());
    frame += grey_by_frame * grey_by_frame.transpose() / variance;
    light += grey_by_light * grey_by_light.transpose() / variance;
    both += grey_by_frame * grey_by_light.transpose() / variance;
    grey_with_frame += pixel.grey * grey_by_frame / variance;
    grey_with_light += pixel.grey * grey_by_light / variance;
  }
  // The Schur complement: what is left once the light is fitted.
  const Eigen::Matrix<double, kFrameUnknowns, 4> frame_by_light = both * light.inverse();
  FrameEquations equations;
  equations.information = frame - frame_by_light * both.transpose();
  equations.gradient = grey_with_frame - frame_by_light * grey_with_light;
  equations.by_chance = equations.information;
  return equations;
}

}  // namespace omnitag

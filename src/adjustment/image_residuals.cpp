#include "adjustment/image_residuals.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "adjustment/outliers.h"

namespace omnitag {
namespace {

bool isMostlyLeftOut(const ImageResidual& image) { return image.left_out > image.used; }

}  // namespace

std::vector<ImageResidual> imageResiduals(const std::vector<CornerResidual>& corners,
                                          const std::vector<double>& stamps) {
  std::vector<ImageResidual> images(stamps.size());
  for (std::size_t i = 0; i < stamps.size(); ++i) images[i].stamp = stamps[i];
  const double limit = farLimit(corners);
  for (const CornerResidual& corner : corners) {
    ImageResidual& image = images.at(corner.frame);
    if (lengthOf(corner) > limit) {
      ++image.left_out;
      continue;
    }
    ++image.used;
    image.rms += corner.residual->squaredNorm();
  }
  for (ImageResidual& image : images) {
    if (image.used > 0) image.rms = std::sqrt(image.rms / static_cast<double>(image.used));
  }
  return images;
}

double medianRms(const std::vector<ImageResidual>& images) {
  std::vector<double> sample;
  for (const ImageResidual& image : images) {
    if (image.used > 0) sample.push_back(image.rms);
  }
  return medianOf(std::move(sample));
}

std::vector<std::size_t> outstandingImages(const std::vector<ImageResidual>& images) {
  constexpr double kFar = 2.0;  // medians
  const double limit = kFar * medianRms(images);
  std::vector<std::size_t> outstanding;
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (isMostlyLeftOut(images[i]) || images[i].rms > limit) outstanding.push_back(i);
  }
  std::stable_sort(outstanding.begin(), outstanding.end(), [&](std::size_t a, std::size_t b) {
    const bool first = isMostlyLeftOut(images[a]);
    return first == isMostlyLeftOut(images[b]) ? images[a].rms > images[b].rms : first;
  });
  return outstanding;
}

}  // namespace omnitag

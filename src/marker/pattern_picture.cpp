#include "marker/pattern_picture.h"

#include <array>
#include <cmath>
#include <fstream>
#include <locale>
#include <opencv2/core.hpp>
#include <sstream>

#include "common/format.h"
#include "omnitag/common/error.h"

namespace omnitag {
namespace {

constexpr int kBlocks = 4;
constexpr int kPlanes = 3;
constexpr int kFewestCells = 4;
constexpr int kMostCells = 64;
/// Shares of blue, green and red in the luma of Rec. 601.
constexpr std::array<double, kPlanes> kLuma = {0.114, 0.587, 0.299};

std::vector<double> valuesOf(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw InputError(path + ": cannot be read");
  std::vector<double> values;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    std::istringstream words(line);
    for (std::string word; words >> word;) {
      std::istringstream digits(word);
      digits.imbue(std::locale::classic());
      double value = -1.0;
      digits >> value;
      const bool is_plain = word.find_first_not_of("0123456789.") == std::string::npos;
      if (!is_plain || !digits || !digits.eof() || !(value >= 0.0 && value <= 255.0)) {
        throw InputError(format("%s:%d: expected numbers from 0 to 255, found '%s'", path.c_str(),
                                number, word.c_str()));
      }
      values.push_back(value);
    }
  }
  return values;
}

/// Row by row, without their mean.
cv::Mat_<double> centred(const PatternPicture& picture) {
  cv::Mat_<double> cells(picture.side, picture.side);
  for (int row = 0; row < picture.side; ++row) {
    for (int column = 0; column < picture.side; ++column) {
      cells(row, column) = picture.whiteAt(column, row);
    }
  }
  cells -= cv::mean(cells);
  return cells;
}

}  // namespace

PatternPicture loadPatternPicture(const std::string& path) {
  const std::vector<double> values = valuesOf(path);
  const double cells = static_cast<double>(values.size()) / (kBlocks * kPlanes);
  PatternPicture picture;
  picture.path = picture.name = path;
  picture.side = static_cast<int>(std::lround(std::sqrt(cells)));
  if (picture.side < kFewestCells || picture.side > kMostCells ||
      picture.side * picture.side != cells) {
    throw InputError(
        format("%s: expected 4 blocks of 3 planes of N x N numbers, N from %d to %d "
               "(3072 for N = 16), found %zu numbers",
               path.c_str(), kFewestCells, kMostCells, values.size()));
  }
  const std::size_t plane = gridIndex(0, picture.side, picture.side);
  for (std::size_t cell = 0; cell < plane; ++cell) {
    double luma = 0.0;
    for (std::size_t k = 0; k < kLuma.size(); ++k) luma += kLuma[k] * values[k * plane + cell];
    picture.white.push_back(luma / 255.0);
  }
  constexpr double kLeastDeviation = 5.0 / 255.0;
  const double deviation = cv::norm(centred(picture)) / picture.side;
  if (deviation < kLeastDeviation) {
    throw InputError(path + ": expected a picture with contrast, found hardly any");
  }
  return picture;
}

double correlationOf(const PatternPicture& a, const PatternPicture& b, int quarters) {
  cv::Mat turned = centred(b);
  for (int i = 0; i < quarters % 4; ++i) cv::rotate(turned, turned, cv::ROTATE_90_COUNTERCLOCKWISE);
  const cv::Mat upright = centred(a);
  return upright.dot(turned) / (cv::norm(upright) * cv::norm(turned));
}

double dimensionsOf(const PatternPicture& picture) {
  cv::Mat spectrum;
  cv::dft(centred(picture), spectrum, cv::DFT_COMPLEX_OUTPUT);
  double sum = 0.0;
  double squares = 0.0;
  for (const cv::Vec2d& component : cv::Mat_<cv::Vec2d>(spectrum)) {
    const double power = component.dot(component);
    sum += power;
    squares += power * power;
  }
  return sum * sum / squares;
}

}  // namespace omnitag

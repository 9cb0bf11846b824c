#include "camera/ocam_calibration.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "omnitag/common/error.h"

namespace omnitag {
namespace {

/// Reads numbers one after the other, wherever lines end. Comments begin with '#' and end with
/// the line.
class NumberReader {
 public:
  NumberReader(const std::string& text, std::string origin) : origin_(std::move(origin)) {
    std::istringstream lines(text);
    std::string line;
    while (std::getline(lines, line)) {
      ++last_line_;
      std::istringstream words(line.substr(0, line.find('#')));
      std::string word;
      while (words >> word) words_.push_back({word, last_line_});
    }
  }

  double number(const std::string& what, const std::string& expected = "a number") {
    if (next_ == words_.size()) refuse(last_line_, what, expected, "the file's end");
    const Word& word = words_[next_++];
    std::istringstream stream(word.text);
    double value = 0.0;
    stream >> value;
    if (stream.fail() || !stream.eof() || !std::isfinite(value)) refuseLast(what, expected);
    return value;
  }

  int integer(const std::string& what, int low, int high) {
    const std::string expected =
        "an integer from " + std::to_string(low) + " to " + std::to_string(high);
    const double value = number(what, expected);
    if (value != std::floor(value) || value < low || value > high) refuseLast(what, expected);
    return static_cast<int>(value);
  }

  void expectEnd() const {
    if (next_ == words_.size()) return;
    refuse(words_[next_].line, "after the image size", "nothing more",
           "'" + shortened(words_[next_].text) + "'");
  }

 private:
  struct Word {
    std::string text;
    int line;
  };

  static std::string shortened(std::string text) {
    constexpr std::size_t kLongest = 40;
    if (text.size() > kLongest) text = text.substr(0, kLongest) + "...";
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return c < ' '; }, ' ');
    return text;
  }

  [[noreturn]] void refuseLast(const std::string& what, const std::string& expected) const {
    const Word& word = words_[next_ - 1];
    refuse(word.line, what, expected, "'" + shortened(word.text) + "'");
  }

  [[noreturn]] void refuse(int line, const std::string& what, const std::string& expected,
                           const std::string& found) const {
    throw InputError(origin_ + ":" + std::to_string(std::max(line, 1)) + ": " + what +
                     ": expected " + expected + ", found " + found);
  }

  std::string origin_;
  std::vector<Word> words_;
  std::size_t next_ = 0;
  int last_line_ = 0;
};

}  // namespace

OcamCalibration parseOcamCalibration(const std::string& text, const std::string& origin) {
  constexpr int kMostCoefficients = 64;
  constexpr int kMostPixels = 1 << 15;
  NumberReader reader(text, origin);
  OcamCalibration calibration;
  const int coefficients = reader.integer("number of coefficients", 1, kMostCoefficients);
  for (int i = 0; i < coefficients; ++i) {
    calibration.polynomial.push_back(reader.number("coefficient a" + std::to_string(i)));
  }
  const int inverse_coefficients =
      reader.integer("number of inverse coefficients", 0, kMostCoefficients);
  for (int i = 0; i < inverse_coefficients; ++i) reader.number("inverse coefficient");
  calibration.center_row = reader.number("row of the centre");
  calibration.center_column = reader.number("column of the centre");
  calibration.c = reader.number("affine parameter c");
  calibration.d = reader.number("affine parameter d");
  calibration.e = reader.number("affine parameter e");
  calibration.image_size.height = reader.integer("image height", 1, kMostPixels);
  calibration.image_size.width = reader.integer("image width", 1, kMostPixels);
  reader.expectEnd();
  return calibration;
}

OcamCalibration loadOcamCalibration(const std::string& path) {
  // A device or a pipe might never end.
  std::error_code ignored;
  std::ifstream file(path);
  if (!file.is_open() || !std::filesystem::is_regular_file(path, ignored)) {
    throw InputError(path + ": expected a readable file, found " +
                     (file.is_open() ? "something else" : "none"));
  }
  std::ostringstream text;
  text << file.rdbuf();
  return parseOcamCalibration(text.str(), path);
}

}  // namespace omnitag

#include <algorithm>
#include <boost/program_options.hpp>
#include <iostream>
#include <string>

#include "camera/camera_writer.h"
#include "camera/camera_yaml.h"
#include "common/file_replacement.h"
#include "omnitag/camera/camera_file.h"
#include "omnitag/common/error.h"
#include "ros/bag_tools/command_line.h"

namespace omnitag {
namespace {

namespace po = boost::program_options;

constexpr const char* kUsage =
    "usage: convert_camera IN OUT [--to FORMAT]\n\n"
    "Writes a camera file in the format of another tool, or what another tool wrote as a camera\n"
    "file. IN may be a camera file, Kalibr's camchain (IN.yaml#cam0 where it has several "
    "cameras),\n"
    "a calibration of OpenCV, a camera_info, or OCamCalib's calib_results.txt; what it is shows\n"
    "from its content. A camera that the format has no words for is refused. Needs no roscore.\n";

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

void checkFormat(const std::string& format) {
  const std::vector<std::string>& known = cameraFormats();
  if (std::find(known.begin(), known.end(), format) != known.end()) return;
  throw InputError("--to: expected one of " + joined(known) + ", found '" + format + "'");
}

void convert(int argc, char** argv) {
  std::string input;
  std::string output;
  std::string format = "omnitag";
  po::options_description description("options");
  description.add_options()("help,h", "print this")("in", textOption(&input, "IN")->required(),
                                                    "camera to read; IN is the same as --in IN")(
      "out", textOption(&output, "OUT")->required(), "file to write; OUT is the same as --out OUT")(
      "to", textOption(&format, "FORMAT"),
      ("one of " + joined(cameraFormats()) + "; default: omnitag, a camera file").c_str());
  po::positional_options_description positional;
  positional.add("in", 1).add("out", 1);
  if (!parseCommandLine(argc, argv, kUsage, description, positional)) return;
  checkFormat(format);
  checkOutputs({cameraFilePath(input)}, {{"OUT", output}});
  const WrittenCamera written = writtenCamera(input, format, output);
  replaceFile(output, written.text);
  std::cout << output << ": " << format;
  if (!written.left_out.empty()) {
    std::cout << ", which has no place for " << joined(written.left_out);
  }
  std::cout << '\n';
}

}  // namespace
}  // namespace omnitag

int main(int argc, char** argv) {
  try {
    omnitag::convert(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "convert_camera: " << error.what() << '\n';
    return 1;
  }
  return 0;
}

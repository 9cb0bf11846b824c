#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

#include "camera/ocam_camera.h"
#include "omnitag/common/error.h"
#include "one_line.h"
#include "view/contour_table.h"

// As with camera files: one accepted calibration in eight must do for what a localizer builds of
// it.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(data, data + size);
  try {
    const omnitag::OcamCamera camera(omnitag::parseOcamCalibration(text, "calib_results.txt"));
    constexpr std::size_t kOneIn = 8;
    if (std::hash<std::string>()(text) % kOneIn == 0) omnitag::ContourTable(camera, 3.0);
  } catch (const omnitag::InputError& error) {
    omnitag::test::expectOneLine(error.what());
  }
  return 0;
}

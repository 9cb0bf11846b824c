#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "omnitag/camera/camera_file.h"
#include "omnitag/common/error.h"
#include "one_line.h"
#include "view/contour_table.h"

// A camera that is accepted must do for what a localizer builds of it. That takes a while, and is
// therefore done for one in eight, chosen by the text so that every crash comes again.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(data, data + size);
  try {
    const std::shared_ptr<const omnitag::CameraModel> camera =
        omnitag::parseCamera(text, "camera.yaml");
    constexpr std::size_t kOneIn = 8;
    if (std::hash<std::string>()(text) % kOneIn == 0) omnitag::ContourTable(*camera, 3.0);
  } catch (const omnitag::InputError& error) {
    omnitag::test::expectOneLine(error.what());
  }
  return 0;
}

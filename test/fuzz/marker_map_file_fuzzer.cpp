#include <cstddef>
#include <cstdint>
#include <string>

#include "omnitag/common/error.h"
#include "omnitag/marker/marker_map_file.h"
#include "one_line.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    omnitag::parseMarkerMap({data, data + size}, "map.yaml");
  } catch (const omnitag::InputError& error) {
    omnitag::test::expectOneLine(error.what());
  }
  return 0;
}

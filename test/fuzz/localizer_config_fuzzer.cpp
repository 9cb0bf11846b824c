#include <cstddef>
#include <cstdint>
#include <string>

#include "common/yaml_reader.h"
#include "omnitag/common/error.h"
#include "omnitag/localization/localizer_config.h"
#include "one_line.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    omnitag::readLocalizerConfig(
        omnitag::YamlReader::fromText({data, data + size}, "localizer.yaml"));
  } catch (const omnitag::InputError& error) {
    omnitag::test::expectOneLine(error.what());
  }
  return 0;
}

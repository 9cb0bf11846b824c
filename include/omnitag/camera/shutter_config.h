#pragma once

namespace omnitag {

class YamlReader;

/// When the rows of an image are exposed. If all values are 0, all rows are exposed at the image's
/// stamp, for no time.
struct ShutterConfig {
  /// s, from the image's stamp to the middle of the exposure of row 0.
  double image_time_offset = 0.0;
  /// s from a row to the next; negative if the last row is read first.
  double row_readout_time = 0.0;
  /// s for which each row is exposed.
  double exposure_time = 0.0;

  /// s, from the image's stamp to the middle of a row's exposure; to the beginning of the first
  /// exposure, and to the end of the last one, of an image with this many rows.
  double timeOf(double row) const { return image_time_offset + row * row_readout_time; }
  double begin(int rows) const;
  double end(int rows) const;

  bool isInstant() const {
    return image_time_offset == 0.0 && row_readout_time == 0.0 && exposure_time == 0.0;
  }
};

/// Reads the keys above; absent ones stay as in `defaults`. Other keys are ignored.
/// Throws InputError.
ShutterConfig readShutterConfig(const YamlReader& reader, const ShutterConfig& defaults = {});

}  // namespace omnitag

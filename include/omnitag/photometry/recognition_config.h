#pragma once

namespace omnitag {

class YamlReader;

/// How markers are recognized where they are predicted.
struct RecognitionConfig {
  /// In widths of a module, or of a picture's independent parts, including the lens's blur: markers
  /// that may be farther from their predicted place are searched for with the decoder.
  double max_margin = 9.0;
  /// Upper limit of the probability that something else is taken for the predicted marker.
  double false_accept_rate = 1e-5;
  /// Least difference between black and white, in grey levels.
  double min_contrast = 8.0;
};

/// Reads the keys above; absent ones keep their defaults. Throws InputError.
RecognitionConfig readRecognitionConfig(const YamlReader& reader);

}  // namespace omnitag

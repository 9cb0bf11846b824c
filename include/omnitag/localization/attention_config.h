#pragma once

namespace omnitag {

class YamlReader;

/// What a frame looks at in addition to the markers that it expects to see.
struct AttentionConfig {
  /// s: the time in which views all around are decoded one after another, for markers that are not
  /// expected.
  double period = 2.0;
  /// Most pixels of one of these views; larger ones are made coarser. Each pixel takes 30 ns on a
  /// processor of 2020.
  int max_pixels = 40000;
  /// m and s: a marker that was missed twice, for example because it is behind a wall, is looked
  /// for again once the camera has moved this far, or after this time.
  double hidden_way = 0.25;
  double hidden_time = 1.0;
};

/// Reads the keys above; absent ones keep their defaults. Throws InputError.
AttentionConfig readAttentionConfig(const YamlReader& reader);

}  // namespace omnitag

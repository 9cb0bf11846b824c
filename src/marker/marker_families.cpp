#include "marker/marker_families.h"

namespace omnitag {

MarkerFamilies familiesOf(const MarkerMap& map) {
  MarkerFamilies families;
  for (const Marker& marker : map.markers) {
    if (marker.picture) {
      families.pictures.emplace(marker.id, marker.picture);
    } else {
      families.codes.insert(marker.family);
    }
  }
  const bool is_of_codes = !map.default_family.empty() && map.default_family != kPictureFamily;
  if (is_of_codes) families.codes.insert(map.default_family);
  return families;
}

}  // namespace omnitag

#include "omnitag/view/view.h"

#include <cmath>

namespace omnitag {

double View::azimuthOffset(double column) const {
  const double tangent = (column - 0.5 * (size.width - 1)) / focal_length;
  return std::atan(axis_up ? -tangent : tangent);
}

double View::height(double row) const {
  const double above_middle = (0.5 * (size.height - 1) - row) * distance / focal_length;
  return middle_height + (axis_up ? above_middle : -above_middle);
}

double View::column(double azimuth_offset) const {
  const double tangent = std::tan(azimuth_offset);
  return 0.5 * (size.width - 1) + focal_length * (axis_up ? -tangent : tangent);
}

double View::row(double height) const {
  const double above_middle = axis_up ? height - middle_height : middle_height - height;
  return 0.5 * (size.height - 1) - above_middle * focal_length / distance;
}

}  // namespace omnitag

#pragma once

#include <std_msgs/ColorRGBA.h>
#include <visualization_msgs/Marker.h>

#include <string>

namespace omnitag {

/// Red, green, blue and opacity, each from 0 to 1.
std_msgs::ColorRGBA color(double red, double green, double blue, double opacity = 1.0);

/// A visible RViz marker, still without a shape, at the origin of the frame and not turned.
visualization_msgs::Marker rvizMarker(const std::string& frame_id, const std::string& name_space,
                                      int type, const std_msgs::ColorRGBA& color);

}  // namespace omnitag

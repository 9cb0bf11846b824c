#pragma once

#include <interactive_markers/interactive_marker_server.h>
#include <interactive_markers/menu_handler.h>

#include <functional>
#include <string>

#include "omnitag/marker/marker_map.h"
#include "ros/localizer_settings.h"

namespace omnitag {

/// Lets people drag the map's markers into place in RViz (display InteractiveMarkers, topic
/// `edit_map/update`), by arrows along the marker's axes and rings about them. A marker moves when
/// the mouse is released; its menu saves the map.
class MarkerDragging {
 public:
  /// `topic`: that of RViz's display, without `/update`. `settings` must outlive it. `save`: saves
  /// the map and says what it did; may throw InputError.
  MarkerDragging(const std::string& topic, std::string name, std::string map_frame,
                 LocalizerSettings* settings, std::function<std::string()> save);

  /// Shows the map as it is now.
  void show();

 private:
  using Feedback = visualization_msgs::InteractiveMarkerFeedbackConstPtr;
  void add(std::size_t entry, const Marker& marker);
  void onFeedback(std::size_t entry, const Marker& marker, const Feedback& feedback);
  void attempt(const std::string& what, const std::function<std::string()>& work);

  std::string name_;
  std::string map_frame_;
  LocalizerSettings* settings_;
  std::function<std::string()> save_;
  interactive_markers::MenuHandler menu_;
  interactive_markers::InteractiveMarkerServer server_;
};

}  // namespace omnitag

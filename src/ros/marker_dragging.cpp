#include "ros/marker_dragging.h"

#include <visualization_msgs/InteractiveMarker.h>

#include <Eigen/Geometry>
#include <cmath>
#include <utility>

#include "marker/marker_selection.h"
#include "omnitag/common/error.h"
#include "ros/conversions.h"
#include "ros/log_line.h"

namespace omnitag {
namespace {

/// A handle along or about one of the marker's axes; it turns the control's x axis to that axis.
visualization_msgs::InteractiveMarkerControl control(const Eigen::Vector3d& axis,
                                                     const std::string& name,
                                                     std::uint8_t interaction_mode) {
  visualization_msgs::InteractiveMarkerControl control;
  control.name = name;
  control.orientation =
      toMessage(Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitX(), axis));
  control.interaction_mode = interaction_mode;
  return control;
}

}  // namespace

MarkerDragging::MarkerDragging(const std::string& topic, std::string name, std::string map_frame,
                               LocalizerSettings* settings, std::function<std::string()> save)
    : name_(std::move(name)),
      map_frame_(std::move(map_frame)),
      settings_(settings),
      save_(std::move(save)),
      server_(topic) {
  menu_.insert("save the map", [this](const Feedback& /*feedback*/) { attempt("save", save_); });
  show();
}

void MarkerDragging::show() {
  server_.clear();
  const MarkerMap map = settings_->map();
  for (std::size_t i = 0; i < map.markers.size(); ++i) add(i, map.markers[i]);
  server_.applyChanges();
}

void MarkerDragging::add(std::size_t entry, const Marker& marker) {
  using Control = visualization_msgs::InteractiveMarkerControl;
  visualization_msgs::InteractiveMarker handle;
  handle.header.frame_id = map_frame_;
  handle.name = std::to_string(entry) + " " + displayName(marker);
  handle.description = displayName(marker);
  handle.scale = static_cast<float>(2.0 * marker.size);
  handle.pose = poseOf(marker);
  const std::vector<std::pair<std::string, Eigen::Vector3d>> axes = {
      {"x", Eigen::Vector3d::UnitX()},
      {"y", Eigen::Vector3d::UnitY()},
      {"z", Eigen::Vector3d::UnitZ()}};
  for (const auto& [axis_name, axis] : axes) {
    handle.controls.push_back(control(axis, "move_" + axis_name, Control::MOVE_AXIS));
    handle.controls.push_back(control(axis, "rotate_" + axis_name, Control::ROTATE_AXIS));
  }
  Control face;
  face.name = "menu";
  face.interaction_mode = Control::MENU;
  face.always_visible = 1;
  visualization_msgs::Marker plate;
  plate.type = visualization_msgs::Marker::CUBE;
  plate.scale.x = plate.scale.y = marker.size;
  plate.scale.z = 0.02 * marker.size;
  plate.color.r = plate.color.g = 0.9F;
  plate.color.a = 0.5F;
  plate.pose.orientation.w = 1.0;
  face.markers.push_back(plate);
  handle.controls.push_back(face);
  server_.insert(handle, [this, entry, marker](const Feedback& feedback) {
    onFeedback(entry, marker, feedback);
  });
  menu_.apply(server_, handle.name);
}

void MarkerDragging::onFeedback(std::size_t entry, const Marker& marker, const Feedback& feedback) {
  if (feedback->event_type != visualization_msgs::InteractiveMarkerFeedback::MOUSE_UP) return;
  attempt("move", [&] {
    const Eigen::Isometry3d map_from_marker = fromMessage(feedback->pose);
    return settings_->editMap([&](MapEditor* map) {
      // The map may have changed while the marker was dragged.
      const bool is_there = entry < map->map().markers.size() &&
                            displayName(map->map().markers[entry]) == displayName(marker);
      if (!is_there) throw InputError("the map has changed meanwhile");
      return map->move(entry, map_from_marker);
    });
  });
}

void MarkerDragging::attempt(const std::string& what, const std::function<std::string()>& work) {
  try {
    inform(name_ + ": edit_map: " + work());
  } catch (const std::exception& error) {
    complain(name_ + ": edit_map: " + what + " refused: " + error.what());
  }
}

}  // namespace omnitag

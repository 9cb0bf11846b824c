#include "ros/map_services.h"

#include <omnitag/AddMarker.h>
#include <omnitag/ChangeMap.h>
#include <omnitag/IgnoreMarkers.h>
#include <omnitag/RemoveMarker.h>
#include <std_srvs/Trigger.h>

#include <utility>

#include "ros/conversions.h"

namespace omnitag {
namespace {

Marker markerOf(const AddMarker::Request& request) {
  Marker marker;
  marker.id = request.id;
  marker.family = request.family;
  marker.name = request.name;
  marker.size = request.size;
  marker.map_from_marker = fromMessage(request.pose);
  marker.deviation = request.deviation;
  marker.orientation_deviation = request.orientation_deviation;
  return marker;
}

}  // namespace

MapServices::MapServices(const ros::NodeHandle& node, std::string name, bool may_change_frame,
                         LocalizerSettings* settings)
    : node_(node), name_(std::move(name)) {
  offer<std_srvs::Trigger>("reload_map", [settings](const auto& /*request*/) {
    return settings->editMap([](MapEditor* map) { return map->reload(); });
  });
  offer<ChangeMap>("change_map", [settings, may_change_frame](const auto& request) {
    return settings->editMap(
        [&](MapEditor* map) { return map->change(request.path, may_change_frame); });
  });
  offer<AddMarker>("add_marker", [settings](const auto& request) {
    return settings->editMap([&](MapEditor* map) { return map->add(markerOf(request)); });
  });
  offer<RemoveMarker>("remove_marker", [settings](const auto& request) {
    return settings->editMap(
        [&](MapEditor* map) { return map->remove(MarkerSelection(request.marker)); });
  });
  offer<IgnoreMarkers>("ignore_markers", [settings](const auto& request) {
    return settings->ignore(request.markers);
  });
}

template <typename Service>
void MapServices::offer(const std::string& service,
                        std::function<std::string(const typename Service::Request&)> work) {
  using Request = typename Service::Request;
  using Response = typename Service::Response;
  const boost::function<bool(Request&, Response&)> callback =
      [this, service, work = std::move(work)](Request& request, Response& response) {
        try {
          response.message = work(request);
          response.success = 1;
        } catch (const std::exception& error) {
          response.message = error.what();
        }
        ROS_INFO_STREAM(name_ << ": " << service << (response.success != 0 ? ": " : " refused: ")
                              << response.message);
        return true;
      };
  servers_.push_back(node_.advertiseService(service, callback));
}

void MapServices::shutdown() {
  for (ros::ServiceServer& server : servers_) server.shutdown();
}

}  // namespace omnitag

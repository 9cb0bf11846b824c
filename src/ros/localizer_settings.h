#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "adjustment/map_editor.h"
#include "marker/marker_selection.h"
#include "omnitag/localization/localizer.h"
#include "ros/parameters.h"

namespace omnitag {

/// A localizer that will take over between two images, and what it was made from.
struct Successor {
  std::unique_ptr<Localizer> localizer;
  /// Without the ignored markers.
  MarkerMap map;
  std::vector<Marker> ignored_markers;
  std::vector<MarkerSelection> ignored;
  LocalizerConfig config;
  bool has_other_map = false;
};

/// The localizer's map and settings, which may change while it runs. A change makes a new localizer
/// beside the running one and hands it over; if that fails, it throws InputError and nothing
/// changes. Changes to the map return in words what they did. Safe to use from several threads.
class LocalizerSettings {
 public:
  /// `take`: receives each successor; of several that have not been used yet, only the last is
  /// needed.
  using Take = std::function<void(std::shared_ptr<Successor>)>;
  LocalizerSettings(const LocalizerParameters& parameters, const CameraModels& cameras, Take take);

  /// Changes the map and says in words what it did.
  using Edit = std::function<std::string(MapEditor*)>;
  std::string editMap(const Edit& edit);

  /// Sets what to ignore from now on; names must be in the map.
  std::string ignore(const std::vector<std::string>& markers);

  void tune(const std::function<void(LocalizerConfig*)>& change);

  /// With the ignored markers.
  MarkerMap map() const;
  std::string mapFile() const;
  std::size_t unsavedChanges() const;

 private:
  void handOver(const MarkerMap& map, const std::vector<MarkerSelection>& ignored,
                const LocalizerConfig& config, bool has_other_map) const;

  std::vector<LocalizerCamera> cameras_;
  Take take_;
  mutable std::mutex mutex_;
  MapEditor editor_;
  std::vector<MarkerSelection> ignored_;
  LocalizerConfig config_;
};

/// The cameras of the parameters, with their models.
std::vector<LocalizerCamera> localizerCameras(const std::vector<CameraParameters>& parameters,
                                              const CameraModels& models);

/// The markers that the texts select. Names must be in the map, and at least one marker must be
/// left. Throws InputError.
std::vector<MarkerSelection> ignoredMarkers(const std::vector<std::string>& texts,
                                            const MarkerMap& map);

}  // namespace omnitag

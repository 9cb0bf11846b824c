#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "omnitag/adjustment/map_editor.h"
#include "omnitag/localization/localizer.h"
#include "omnitag/marker/marker_selection.h"
#include "omnitag/ros/parameters.h"

namespace omnitag {

/// A localizer that is to take over between two images, and what it was made of.
struct Successor {
  std::unique_ptr<Localizer> localizer;
  /// What is ignored is not in it.
  MarkerMap map;
  std::vector<Marker> ignored_markers;
  std::vector<MarkerSelection> ignored;
  LocalizerConfig config;
  bool has_other_map = false;
};

/// The localizer's map and settings as they change while it runs. A change makes a new localizer,
/// beside the one that works, which is then handed over; where that is not possible, InputError is
/// thrown and nothing changes. Every change says in words what it did. Safe to use from several
/// threads.
class LocalizerSettings {
 public:
  /// `take`: gets each successor; of those that were not used yet, only the last is needed.
  using Take = std::function<void(std::shared_ptr<Successor>)>;
  LocalizerSettings(const LocalizerParameters& parameters,
                    std::shared_ptr<const CameraModel> camera, Take take);

  /// Changes the map, and says what it did.
  using Edit = std::function<std::string(MapEditor*)>;
  std::string editMap(const Edit& edit);

  /// What is ignored from now on; names must be in the map.
  std::string ignore(const std::vector<std::string>& markers);

  /// Changes settings.
  void tune(const std::function<void(LocalizerConfig*)>& change);

  /// With what is ignored.
  MarkerMap map() const;
  std::string mapFile() const;
  std::size_t unsavedChanges() const;

 private:
  void handOver(const MarkerMap& map, const std::vector<MarkerSelection>& ignored,
                const LocalizerConfig& config, bool has_other_map) const;

  std::shared_ptr<const CameraModel> camera_;
  Take take_;
  mutable std::mutex mutex_;
  MapEditor editor_;
  std::vector<MarkerSelection> ignored_;
  LocalizerConfig config_;
};

/// What is meant by texts, of which names must be in the map, and one marker must be left besides.
/// Throws InputError.
std::vector<MarkerSelection> ignoredMarkers(const std::vector<std::string>& texts,
                                            const MarkerMap& map);

}  // namespace omnitag

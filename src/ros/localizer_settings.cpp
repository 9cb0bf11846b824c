#include "ros/localizer_settings.h"

#include <algorithm>
#include <utility>

#include "omnitag/common/error.h"

namespace omnitag {
namespace {

bool areSame(const MarkerMap& a, const MarkerMap& b) {
  return std::equal(a.markers.begin(), a.markers.end(), b.markers.begin(), b.markers.end(),
                    [](const Marker& one, const Marker& other) {
                      return one.family == other.family && one.id == other.id &&
                             one.name == other.name && one.size == other.size &&
                             one.deviation == other.deviation &&
                             one.orientation_deviation == other.orientation_deviation &&
                             one.map_from_marker.matrix() == other.map_from_marker.matrix();
                    });
}

/// The map without the ignored markers. Throws InputError if none are left.
MarkerMap usedMap(const MarkerMap& map, const std::vector<MarkerSelection>& ignored) {
  MarkerMap used = withoutMarkers(map, ignored);
  if (used.markers.empty()) {
    throw InputError("expected one marker of the map to be left that is not ignored");
  }
  return used;
}

}  // namespace

std::vector<LocalizerCamera> localizerCameras(const std::vector<CameraParameters>& parameters,
                                              const CameraModels& models) {
  std::vector<LocalizerCamera> cameras;
  for (std::size_t i = 0; i < models.size(); ++i) {
    cameras.push_back({models[i], parameters[i].shutter});
  }
  return cameras;
}

std::vector<MarkerSelection> ignoredMarkers(const std::vector<std::string>& texts,
                                            const MarkerMap& map) {
  std::vector<MarkerSelection> selections;
  for (const std::string& text : texts) {
    selections.emplace_back(text);
    if (selections.back().isName() && selectedEntries(map, selections.back()).empty()) {
      throw InputError("the map has no marker '" + text + "'");
    }
  }
  usedMap(map, selections);
  return selections;
}

LocalizerSettings::LocalizerSettings(const LocalizerParameters& parameters,
                                     const CameraModels& cameras, Take take)
    : cameras_(localizerCameras(parameters.cameras, cameras)),
      take_(std::move(take)),
      editor_(parameters.map_file),
      ignored_(ignoredMarkers(parameters.ignore_markers, editor_.map())),
      config_(parameters.localizer) {}

void LocalizerSettings::handOver(const MarkerMap& map, const std::vector<MarkerSelection>& ignored,
                                 const LocalizerConfig& config, bool has_other_map) const {
  auto successor = std::make_shared<Successor>();
  successor->map = usedMap(map, ignored);
  for (const Marker& marker : map.markers) {
    const bool is_ignored =
        std::any_of(ignored.begin(), ignored.end(),
                    [&marker](const MarkerSelection& each) { return each.matches(marker); });
    if (is_ignored) successor->ignored_markers.push_back(marker);
  }
  successor->ignored = ignored;
  successor->config = config;
  successor->has_other_map = has_other_map;
  successor->localizer = std::make_unique<Localizer>(cameras_, successor->map, config);
  take_(std::move(successor));
}

std::string LocalizerSettings::editMap(const Edit& edit) {
  const std::lock_guard<std::mutex> lock(mutex_);
  MapEditor next = editor_;
  std::string words = edit(&next);
  if (!areSame(next.map(), editor_.map())) handOver(next.map(), ignored_, config_, true);
  editor_ = std::move(next);
  return words;
}

std::string LocalizerSettings::ignore(const std::vector<std::string>& markers) {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<MarkerSelection> next = ignoredMarkers(markers, editor_.map());
  handOver(editor_.map(), next, config_, true);
  ignored_ = std::move(next);
  const std::size_t rest = withoutMarkers(editor_.map(), ignored_).markers.size();
  std::string words;
  for (const MarkerSelection& each : ignored_) words += (words.empty() ? "" : ", ") + each.text();
  return (words.empty() ? "none ignored" : "ignored: " + words) + "; " + std::to_string(rest) +
         " of " + std::to_string(editor_.map().markers.size()) + " markers are used";
}

void LocalizerSettings::tune(const std::function<void(LocalizerConfig*)>& change) {
  const std::lock_guard<std::mutex> lock(mutex_);
  LocalizerConfig next = config_;
  change(&next);
  handOver(editor_.map(), ignored_, next, false);
  config_ = next;
}

MarkerMap LocalizerSettings::map() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return editor_.map();
}

std::string LocalizerSettings::mapFile() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return editor_.path();
}

std::size_t LocalizerSettings::unsavedChanges() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return editor_.unsavedChanges();
}

}  // namespace omnitag

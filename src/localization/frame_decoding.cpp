#include <algorithm>
#include <limits>
#include <utility>

#include "common/stopwatch.h"
#include "localization/frame_tracker.h"
#include "marker/marker_association.h"
#include "view/view_planner.h"

namespace omnitag {
namespace {

/// At most this many markers are decoded if the prediction is too vague to recognize them.
constexpr std::size_t kAnchors = 4;

/// Pixels of the largest view to decode if the prediction is in doubt: decoding must not cost more
/// than a glance.
double largestInDoubt(const cv::Mat& panorama) {
  constexpr double kShareOfSides = 0.25;
  return kShareOfSides * panorama.cols * kShareOfSides * panorama.rows;
}

}  // namespace

void FrameTracker::lookWherePredicted() {
  const std::size_t before = found();
  recognizeAll(predicted_, false);
  std::vector<std::size_t> largest = undecoded();
  largest.resize(std::min(largest.size(), kAnchors));
  decode(largest);
  if (found() > before) solve();
}

void FrameTracker::decodeAnchors() {
  std::vector<std::size_t> anchors = undecided();
  anchors.resize(std::min(anchors.size(), kAnchors));
  for (const std::size_t anchor : anchors) {
    if (found() >= kToStart) return;
    const std::size_t before = found();
    decode({anchor},
           has_prior_ ? std::numeric_limits<double>::infinity() : largestInDoubt(frame_.image));
    if (found() == before) continue;
    solve();
    findOthers();
  }
}

void FrameTracker::decode(const std::vector<std::size_t>& targets, double max_pixels) {
  Stopwatch step;
  std::vector<View> views = viewsOf(targets);
  views.erase(
      std::remove_if(views.begin(), views.end(),
                     [max_pixels](const View& view) { return view.size.area() > max_pixels; }),
      views.end());
  for (const View& view : views) {
    for (const std::size_t target : view.targets) sightings_[target].was_decoded = true;
  }
  result_->timings.predict += step.lap();
  // Views overlap: a marker in one of them may have been expected in another, or be visible
  // there, too.
  for (const MarkerReading& reading : readViews(tools_, std::move(views), result_)) {
    const Association association =
        associate(reading, result_->predicted, tools_.map, tools_.config.association);
    if (association.prediction) {
      Sighting& sighting = sightings_[*association.prediction];
      const std::size_t entry = result_->predicted[*association.prediction].map_entry;
      if (!sighting.observation) {
        sighting.observation = {entry, reading.corners, reading.center,
                                0.0,   reading.hamming, reading.margin};
      }
    } else if (std::none_of(strangers_.begin(), strangers_.end(), [&](const Stranger& other) {
                 return areOfOneMarker(other.reading, reading);
               })) {
      strangers_.push_back({reading, association.reason});
    }
  }
}

std::vector<View> FrameTracker::viewsOf(const std::vector<std::size_t>& targets) const {
  std::vector<ViewTarget> view_targets;
  view_targets.reserve(targets.size());
  for (const std::size_t target : targets) {
    view_targets.push_back(viewTarget(result_->predicted[target], camera_.model()));
  }
  std::vector<View> views =
      planViews(view_targets, tools_.reader.warper().table(), camera_.model().imagePlane().scale(),
                camera_.axisUp(), tools_.config.view);
  for (View& view : views) {
    for (std::size_t& target : view.targets) target = targets[target];
  }
  return views;
}

void FrameTracker::addViews() {
  std::vector<std::size_t> targets;
  for (std::size_t i = 0; i < sightings_.size(); ++i) {
    if (!sightings_[i].was_decoded) targets.push_back(i);
  }
  for (View& view : viewsOf(targets)) {
    result_->view_images.push_back(tools_.reader.warper().warp(frame_.image, view));
    result_->views.push_back(std::move(view));
  }
}

}  // namespace omnitag

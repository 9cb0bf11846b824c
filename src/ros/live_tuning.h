#pragma once

#include <dynamic_reconfigure/Config.h>
#include <dynamic_reconfigure/ConfigDescription.h>
#include <dynamic_reconfigure/Reconfigure.h>
#include <ros/ros.h>

#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "omnitag/localization/localizer_config.h"
#include "ros/localizer_settings.h"

namespace omnitag {

/// What can be tuned while driving: the settings, and whether images are processed.
struct Tunables {
  bool enabled = true;
  LocalizerConfig config;
};

/// One tunable, with what people and the protocol of dynamic_reconfigure need to know about it.
struct Knob {
  std::string name;
  /// bool, int, double or str.
  std::string type;
  std::string description;
  double min = 0.0;
  double max = 1.0;
  /// The values of a str.
  std::vector<std::string> values = {};
  /// A bool is 0 or 1, a str the index of its value.
  std::function<double(const Tunables&)> get;
  std::function<void(Tunables*, double)> set;
};

/// All tunables.
std::vector<Knob> knobs();

dynamic_reconfigure::ConfigDescription describe(const std::vector<Knob>& knobs);
dynamic_reconfigure::Config toMessage(const std::vector<Knob>& knobs, const Tunables& tunables);
/// The tunables with a message's changes, within their limits. Throws InputError for an unknown
/// name or value.
Tunables withChanges(const std::vector<Knob>& knobs, const Tunables& tunables,
                     const dynamic_reconfigure::Config& message);

/// Speaks dynamic_reconfigure's protocol (rqt_reconfigure, dynparam) under `~reconfigure`, without
/// the generated code, which would define the settings and their defaults a second time.
class LiveTuning {
 public:
  /// `settings` must outlive it. `enable`: switches the processing of images on or off.
  LiveTuning(const ros::NodeHandle& private_node, std::string name, const LocalizerConfig& config,
             LocalizerSettings* settings, std::function<void(bool)> enable);

  /// Waits for a running callback; afterwards, none starts.
  void shutdown();

 private:
  /// Makes the change that a message asks for, or logs why not.
  void attempt(const dynamic_reconfigure::Config& message);
  void change(const dynamic_reconfigure::Config& message);

  ros::NodeHandle node_;
  std::string name_;
  LocalizerSettings* settings_;
  std::function<void(bool)> enable_;
  std::vector<Knob> knobs_ = knobs();
  std::mutex mutex_;
  Tunables tunables_;
  ros::Publisher description_publisher_;
  ros::Publisher update_publisher_;
  ros::ServiceServer server_;
};

}  // namespace omnitag

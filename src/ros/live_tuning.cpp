#include "ros/live_tuning.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "omnitag/common/error.h"
#include "ros/log_line.h"

namespace omnitag {
namespace {

using dynamic_reconfigure::Config;

template <typename Field>
Knob numberKnob(const std::string& name, const std::string& type, const std::string& description,
                double min, double max, Field field) {
  Knob knob{name, type, description, min, max, {}, {}, {}};
  knob.get = [field](const Tunables& tunables) {
    Tunables copy = tunables;
    return static_cast<double>(field(&copy));
  };
  knob.set = [field](Tunables* tunables, double value) {
    auto& target = field(tunables);
    target = static_cast<std::decay_t<decltype(target)>>(value);
  };
  return knob;
}

template <typename Field>
Knob realKnob(const std::string& name, const std::string& description, double min, double max,
              Field field) {
  return numberKnob(name, "double", description, min, max, field);
}

Knob estimatorKnob() {
  Knob knob{"estimator", "str", "how a pose is computed from the markers",
            0.0,         2.0,   {"triangulation", "reprojection", "photometric"},
            {},          {}};
  knob.get = [](const Tunables& tunables) {
    return static_cast<double>(tunables.config.estimation.kind);
  };
  knob.set = [](Tunables* tunables, double value) {
    tunables->config.estimation.kind = static_cast<EstimatorKind>(std::lround(value));
  };
  return knob;
}

/// The choices that an editor offers for a str, in the form that dynamic_reconfigure's Python
/// clients read.
std::string editMethod(const Knob& knob) {
  if (knob.values.empty()) return "";
  std::string choices;
  for (const std::string& value : knob.values) {
    if (!choices.empty()) choices += ", ";
    choices += "{'name': '";
    choices += value;
    choices += "', 'type': 'str', 'value': '";
    choices += value;
    choices +=
        "', 'description': '', 'srcline': 0, 'srcfile': '', 'cconsttype': 'const char * const', "
        "'ctype': 'std::string'}";
  }
  return "{'enum_description': '" + knob.description + "', 'enum': [" + choices + "]}";
}

void add(const Knob& knob, double value, Config* message) {
  const auto entry = [&knob](auto parameter, auto content) {
    parameter.name = knob.name;
    parameter.value = content;
    return parameter;
  };
  if (knob.type == "bool") {
    const auto flag = static_cast<std::uint8_t>(value != 0.0);
    message->bools.push_back(entry(dynamic_reconfigure::BoolParameter(), flag));
  } else if (knob.type == "int") {
    const auto integer = static_cast<std::int32_t>(std::lround(value));
    message->ints.push_back(entry(dynamic_reconfigure::IntParameter(), integer));
  } else if (knob.type == "str") {
    const auto index = static_cast<std::size_t>(std::lround(value));
    message->strs.push_back(entry(dynamic_reconfigure::StrParameter(), knob.values.at(index)));
  } else {
    message->doubles.push_back(entry(dynamic_reconfigure::DoubleParameter(), value));
  }
}

/// The only group; all tunables are in it.
Config groupOnly() {
  Config message;
  dynamic_reconfigure::GroupState group;
  group.name = "Default";
  group.state = 1;
  message.groups.push_back(group);
  return message;
}

double valueOf(const Knob& knob, const std::string& text) {
  const auto value = std::find(knob.values.begin(), knob.values.end(), text);
  if (value == knob.values.end()) {
    std::string known;
    for (const std::string& each : knob.values) known += (known.empty() ? "" : ", ") + each;
    throw InputError(knob.name + ": expected one of " + known + ", found '" + text + "'");
  }
  return static_cast<double>(value - knob.values.begin());
}

double valueOf(const Knob& /*knob*/, double value) { return value; }

template <typename Parameters>
void take(const std::vector<Knob>& knobs, const std::string& type, const Parameters& parameters,
          Tunables* tunables) {
  for (const auto& parameter : parameters) {
    const auto knob = std::find_if(knobs.begin(), knobs.end(), [&](const Knob& each) {
      return each.name == parameter.name && each.type == type;
    });
    if (knob == knobs.end()) {
      throw InputError("there is no " + type + " '" + parameter.name + "' to be tuned");
    }
    const double value = valueOf(*knob, parameter.value);
    if (!std::isfinite(value)) throw InputError(knob->name + ": expected a number");
    knob->set(tunables, std::clamp(value, knob->min, knob->max));
  }
}

}  // namespace

std::vector<Knob> knobs() {
  using T = Tunables;
  std::vector<Knob> knobs = {
      numberKnob("enabled", "bool", "whether images are worked on", 0.0, 1.0,
                 [](T* t) -> bool& { return t->enabled; }),
      numberKnob("threads", "int", "how many cores a frame may use at once", 1.0, 64.0,
                 [](T* t) -> int& { return t->config.threads; }),
      estimatorKnob(),
      realKnob("image_time_offset", "s, from an image's stamp to the exposure of its first row",
               -1.0, 1.0, [](T* t) -> double& { return t->config.shutter.image_time_offset; }),
      realKnob("row_readout_time", "s, from a row's exposure to the next one's", -1e-3, 1e-3,
               [](T* t) -> double& { return t->config.shutter.row_readout_time; }),
      realKnob("exposure_time", "s", 0.0, 1.0,
               [](T* t) -> double& { return t->config.shutter.exposure_time; }),
  };
  const auto add = [&knobs](const char* name, const char* description, double max, auto field) {
    knobs.push_back(realKnob(name, description, 0.0, max, field));
  };
  add("floor_lean_deviation", "rad, of roll and pitch each", 0.5,
      [](T* t) -> double& { return t->config.motion.floor.lean_deviation; });
  add("floor_height_deviation", "m, of the height of the base", 1.0,
      [](T* t) -> double& { return t->config.motion.floor.height_deviation; });
  add("acceleration_deviation", "m/s^2, without odometry", 100.0,
      [](T* t) -> double& { return t->config.motion.acceleration_deviation; });
  add("angular_acceleration_deviation", "rad/s^2, without odometry", 100.0,
      [](T* t) -> double& { return t->config.motion.angular_acceleration_deviation; });
  add("odometry_rotation_per_rotation", "rad per rad", 10.0,
      [](T* t) -> double& { return t->config.motion.odometry_rotation_per_rotation; });
  add("odometry_rotation_per_metre", "rad per m", 10.0,
      [](T* t) -> double& { return t->config.motion.odometry_rotation_per_metre; });
  add("odometry_translation_per_metre", "m per m", 10.0,
      [](T* t) -> double& { return t->config.motion.odometry_translation_per_metre; });
  add("odometry_translation_per_rotation", "m per rad", 10.0,
      [](T* t) -> double& { return t->config.motion.odometry_translation_per_rotation; });
  add("attention_hidden_way", "m, after which a hidden marker is looked for again", 100.0,
      [](T* t) -> double& { return t->config.attention.hidden_way; });
  add("attention_hidden_time", "s, after which a hidden marker is looked for again", 1000.0,
      [](T* t) -> double& { return t->config.attention.hidden_time; });
  knobs.push_back(realKnob("attention_period",
                           "s, in which all is looked at for what is not expected", 0.1, 1000.0,
                           [](T* t) -> double& { return t->config.attention.period; }));
  knobs.push_back(realKnob("max_misfit", "standard deviations, beyond which a marker is rejected",
                           0.1, 1000.0,
                           [](T* t) -> double& { return t->config.estimation.max_misfit; }));
  return knobs;
}

Config toMessage(const std::vector<Knob>& knobs, const Tunables& tunables) {
  Config message = groupOnly();
  for (const Knob& knob : knobs) add(knob, knob.get(tunables), &message);
  return message;
}

dynamic_reconfigure::ConfigDescription describe(const std::vector<Knob>& knobs) {
  dynamic_reconfigure::ConfigDescription message;
  dynamic_reconfigure::Group group;
  group.name = "Default";
  message.min = message.max = groupOnly();
  for (const Knob& knob : knobs) {
    dynamic_reconfigure::ParamDescription parameter;
    parameter.name = knob.name;
    parameter.type = knob.type;
    parameter.description = knob.description;
    parameter.edit_method = editMethod(knob);
    group.parameters.push_back(parameter);
    add(knob, knob.min, &message.min);
    add(knob, knob.max, &message.max);
  }
  message.groups.push_back(group);
  message.dflt = toMessage(knobs, Tunables());
  return message;
}

Tunables withChanges(const std::vector<Knob>& knobs, const Tunables& tunables,
                     const Config& message) {
  Tunables changed = tunables;
  take(knobs, "bool", message.bools, &changed);
  take(knobs, "int", message.ints, &changed);
  take(knobs, "str", message.strs, &changed);
  take(knobs, "double", message.doubles, &changed);
  const LocalizerConfig& config = changed.config;
  if (!config.motion.isOnFloor() && config.estimation.kind == EstimatorKind::kTriangulation) {
    throw InputError("estimator: expected reprojection or photometric with pose_model: free");
  }
  return changed;
}

LiveTuning::LiveTuning(const ros::NodeHandle& private_node, std::string name,
                       const LocalizerConfig& config, LocalizerSettings* settings,
                       std::function<void(bool)> enable)
    : node_(private_node, "reconfigure"),
      name_(std::move(name)),
      settings_(settings),
      enable_(std::move(enable)) {
  tunables_.config = config;
  constexpr bool kLatched = true;
  description_publisher_ = node_.advertise<dynamic_reconfigure::ConfigDescription>(
      "parameter_descriptions", 1, kLatched);
  update_publisher_ = node_.advertise<Config>("parameter_updates", 1, kLatched);
  using Request = dynamic_reconfigure::Reconfigure::Request;
  using Response = dynamic_reconfigure::Reconfigure::Response;
  const boost::function<bool(Request&, Response&)> callback = [this](Request& request,
                                                                     Response& response) {
    const std::lock_guard<std::mutex> lock(mutex_);
    attempt(request.config);
    response.config = toMessage(knobs_, tunables_);
    update_publisher_.publish(response.config);
    return true;
  };
  server_ = node_.advertiseService("set_parameters", callback);
  description_publisher_.publish(describe(knobs_));
  update_publisher_.publish(toMessage(knobs_, tunables_));
}

void LiveTuning::attempt(const Config& message) {
  try {
    change(message);
  } catch (const std::exception& error) {
    complain(name_ + ": reconfigure refused: " + error.what());
  }
}

void LiveTuning::change(const Config& message) {
  const Tunables next = withChanges(knobs_, tunables_, message);
  std::string words;
  bool is_tuned = false;
  for (const Knob& knob : knobs_) {
    const double value = knob.get(next);
    if (value == knob.get(tunables_)) continue;
    is_tuned = is_tuned || knob.name != "enabled";
    const std::string text = knob.values.empty() ? std::to_string(value)
                                                 : knob.values.at(static_cast<std::size_t>(value));
    words += (words.empty() ? "" : ", ") + knob.name + ": " + text;
  }
  if (words.empty()) return;
  if (is_tuned) {
    settings_->tune([this, &next](LocalizerConfig* config) {
      Tunables tuned{next.enabled, *config};
      for (const Knob& knob : knobs_) knob.set(&tuned, knob.get(next));
      *config = tuned.config;
    });
  }
  if (next.enabled != tunables_.enabled) enable_(next.enabled);
  tunables_ = next;
  ROS_INFO_STREAM(name_ << ": reconfigure: " << words);
}

void LiveTuning::shutdown() { server_.shutdown(); }

}  // namespace omnitag

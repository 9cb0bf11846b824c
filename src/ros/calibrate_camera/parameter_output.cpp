#include "ros/calibrate_camera/parameter_output.h"

#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <regex>
#include <utility>

#include "adjustment/mapped_entries.h"
#include "common/file_replacement.h"
#include "common/format.h"
#include "marker/marker_map_writer.h"
#include "omnitag/common/error.h"
#include "ros/parameters.h"

namespace omnitag {
namespace {

const char* const kOffset = "image_time_offset";
const char* const kReadout = "row_readout_time";

std::string lineOf(const char* name, const EstimatedTime& time, double factor) {
  const std::string deviation =
      time.held.empty() ? format("%.2g", factor * time.deviation) : "held: " + time.held;
  return format("%-26s %12s %12.4g   ", name, "", factor * time.value) + deviation + "\n";
}

}  // namespace

std::string timeReport(const TimeCalibration& time, int rows) {
  constexpr double kMilliseconds = 1e3;
  constexpr double kMicroseconds = 1e6;
  return lineOf("image_time_offset (ms)", time.image_time_offset, kMilliseconds) +
         lineOf("row_readout_time (us)", time.row_readout_time, kMicroseconds) +
         format("%-26s %12s %12.4g   of %d rows; %zu motions of odometry\n",
                "  the whole image (ms)", "", kMilliseconds * rows * time.row_readout_time.value,
                rows, time.motions);
}

ParameterOutput::ParameterOutput(std::string path) : path_(std::move(path)) {
  if (!std::filesystem::exists(path_)) return;
  text_ = readTextFile(path_);
  // To refuse the file now rather than after reading the whole bag.
  withNumber(withNumber(text_, kOffset, "0.0"), kReadout, "0.0");
}

std::string ParameterOutput::write(const TimeCalibration& time) const {
  std::string text = text_;
  std::string keys;
  // With a decimal point: without one, YAML 1.1 takes 5e-05 for text.
  if (time.image_time_offset.is_observed) {
    text = withNumber(text, kOffset, format("%.6f", time.image_time_offset.value));
    keys = kOffset;
  }
  if (time.row_readout_time.is_observed) {
    text = withNumber(text, kReadout, format("%.4e", time.row_readout_time.value));
    keys += (keys.empty() ? "" : ", ") + std::string(kReadout);
  }
  if (!keys.empty()) replaceFile(path_, text);
  return keys;
}

std::string ParameterOutput::withNumber(const std::string& text, const std::string& key,
                                        const std::string& number) const {
  std::string changed = text;
  const std::regex line("((^|\n)" + key + "[ \t]*:[ \t]*)[^ \t\r\n#]*");
  std::smatch found;
  if (std::regex_search(text, found, line)) {
    changed = found.prefix().str() + found[1].str() + number + found.suffix().str();
  } else {
    if (!text.empty() && text.back() != '\n') changed += '\n';
    changed += key + ": " + number + "\n";
  }
  YAML::Node before;
  YAML::Node after;
  try {
    before = YAML::Load(text);
    after = YAML::Load(changed);
  } catch (const YAML::Exception& error) {
    throw InputError(path_ + ": cannot put " + key + " into it: " + error.what());
  }
  // The rest must not change, whatever the file looks like.
  const bool is_there = after.IsMap() && after[key] && after[key].Scalar() == number;
  if (after.IsMap()) after.remove(key);
  if (before.IsMap()) before.remove(key);
  const bool was_empty = before.IsNull() && after.IsMap() && after.size() == 0;
  if (!is_there || (!was_empty && YAML::Dump(before) != YAML::Dump(after))) {
    throw InputError(path_ + ": cannot put " + key +
                     " into it: expected each key at the beginning of a line of its own");
  }
  readParameters(YamlReader::fromText(changed, path_));
  return changed;
}

}  // namespace omnitag

#include "common/yaml_reader.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <utility>

namespace omnitag {
namespace {

std::string oneLine(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < ' '; }, ' ');
  return text;
}

/// The content of a node, short enough for one line.
std::string found(const YAML::Node& node) {
  if (!node.IsDefined()) return "nothing";
  switch (node.Type()) {
    case YAML::NodeType::Undefined:
    case YAML::NodeType::Null:
      return "an empty value";
    case YAML::NodeType::Sequence:
      return "a list of " + std::to_string(node.size());
    case YAML::NodeType::Map:
      return "a mapping";
    case YAML::NodeType::Scalar:
      break;
  }
  constexpr std::size_t kLongest = 60;
  const std::string text = oneLine(node.Scalar());
  return "'" + (text.size() > kLongest ? text.substr(0, kLongest) + "..." : text) + "'";
}

/// Whether a number has a leading zero, perhaps after a sign: octal in YAML 1.1, decimal in
/// YAML 1.2.
bool isAmbiguous(const std::string& text) {
  const std::size_t first = text.find_first_not_of("+-");
  return first != std::string::npos && text.size() > first + 1 && text[first] == '0' &&
         text.find_first_not_of("0123456789", first) == std::string::npos;
}

bool parse(const YAML::Node& node, bool* value) {
  return node.IsScalar() && YAML::convert<bool>::decode(node, *value);
}

bool parse(const YAML::Node& node, double* value) {
  return node.IsScalar() && !isAmbiguous(node.Scalar()) &&
         YAML::convert<double>::decode(node, *value);
}

/// Decimal integers only: the versions of YAML disagree about the others.
bool parse(const YAML::Node& node, int* value) {
  return node.IsScalar() && !isAmbiguous(node.Scalar()) &&
         node.Scalar().find_first_not_of("+-0123456789") == std::string::npos &&
         YAML::convert<int>::decode(node, *value);
}

std::string format(double value) {
  std::ostringstream out;
  out << value;
  return out.str();
}

}  // namespace

bool Interval::contains(double value) const {
  return std::isfinite(value) && (low_included ? value >= low : value > low) && value <= high;
}

std::string Interval::description(const std::string& kind) const {
  const double unbounded = std::numeric_limits<double>::max();
  std::string text = kind;
  if (low > -unbounded) text += (low_included ? " >= " : " > ") + format(low);
  if (high < unbounded) text += (low > -unbounded ? " and <= " : " <= ") + format(high);
  return text;
}

YamlReader YamlReader::fromFile(const std::string& path) { return fromText(textOf(path), path); }

std::string YamlReader::textOf(const std::string& path) {
  std::ifstream file(path);
  if (!file.is_open() || std::filesystem::is_directory(path)) {
    throw InputError(path + ": expected a readable file, found " +
                     (file.is_open() ? "a directory" : "none"));
  }
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

YamlReader YamlReader::fromText(const std::string& text, const std::string& origin) {
  try {
    return {YAML::Load(text), origin};
  } catch (const YAML::Exception& error) {
    const std::string line = error.mark.is_null() ? "" : ":" + std::to_string(error.mark.line + 1);
    throw InputError(origin + line + ": cannot be parsed as YAML: " + oneLine(error.msg));
  }
}

YamlReader::YamlReader(const YAML::Node& node, std::string origin, std::string path)
    : node_(node), origin_(std::move(origin)), path_(std::move(path)) {
  if (!node_.IsMap()) {
    throw InputError(place(node_) + ": " + (path_.empty() ? "" : path_ + ": ") +
                     "expected a mapping of keys, found " + found(node_));
  }
  std::set<std::string> keys;
  for (const auto& entry : node_) {
    if (!entry.first.IsScalar()) {
      throw InputError(place(entry.first) + ": expected a word as key, found " +
                       found(entry.first));
    }
    if (!keys.insert(entry.first.Scalar()).second) {
      throw InputError(place(entry.first) + ": " + pathOf(entry.first.Scalar()) +
                       ": expected once, found again");
    }
  }
}

bool YamlReader::has(const std::string& key) const { return node_[key].IsDefined(); }

bool YamlReader::isText(const std::string& key) const { return has(key) && node_[key].IsScalar(); }

bool YamlReader::isMapping(const std::string& key) const { return has(key) && node_[key].IsMap(); }

std::vector<std::string> YamlReader::keys() const {
  std::vector<std::string> keys;
  for (const auto& entry : node_) keys.push_back(entry.first.Scalar());
  return keys;
}

void YamlReader::refuseReplaced(const std::string& key, const std::string& replacement) const {
  if (has(key)) throw InputError(where(key) + ": is no more; use " + replacement);
}

void YamlReader::allowOnly(std::initializer_list<std::string_view> keys) const {
  for (const auto& entry : node_) {
    const std::string& key = entry.first.Scalar();
    if (std::find(keys.begin(), keys.end(), key) != keys.end()) continue;
    std::string known;
    for (const std::string_view candidate : keys) {
      known += (known.empty() ? "" : ", ") + std::string(candidate);
    }
    throw InputError(place(entry.first) + ": " + pathOf(key) +
                     ": unknown key; expected one of: " + known);
  }
}

double YamlReader::number(const std::string& key, const Interval& interval) const {
  const std::string expected = interval.description("a number");
  double value = 0.0;
  if (!parse(required(key, expected), &value) || !interval.contains(value)) refuse(key, expected);
  return value;
}

int YamlReader::integer(const std::string& key, const Interval& interval) const {
  const std::string expected = interval.description("an integer");
  int value = 0;
  if (!parse(required(key, expected), &value) || !interval.contains(value)) refuse(key, expected);
  return value;
}

std::string YamlReader::text(const std::string& key) const {
  const YAML::Node child = required(key, "a text");
  if (!child.IsScalar()) refuse(key, "a text");
  return child.Scalar();
}

std::vector<double> YamlReader::numbers(const std::string& key, std::size_t size) const {
  const std::string expected =
      "a list of " + (size > 0 ? std::to_string(size) + " " : std::string()) + "numbers";
  const YAML::Node child = required(key, expected);
  if (!child.IsSequence() || (size > 0 && child.size() != size)) refuse(key, expected);
  std::vector<double> values;
  for (const YAML::Node& item : child) {
    double value = 0.0;
    if (!parse(item, &value) || !std::isfinite(value)) {
      throw InputError(place(item) + ": " + pathOf(key) + ": expected " + expected + ", found " +
                       found(item) + " among them");
    }
    values.push_back(value);
  }
  return values;
}

std::vector<std::string> YamlReader::texts(const std::string& key) const {
  const std::string expected = "a list of words or numbers";
  const YAML::Node child = required(key, expected);
  if (!child.IsSequence()) refuse(key, expected);
  std::vector<std::string> values;
  for (const YAML::Node& item : child) {
    if (!item.IsScalar()) refuse(key, expected);
    values.push_back(item.Scalar());
  }
  return values;
}

std::vector<std::vector<double>> YamlReader::table(const std::string& key,
                                                   std::size_t columns) const {
  const std::string expected = "a list of lists of " + std::to_string(columns) + " numbers";
  const YAML::Node child = required(key, expected);
  if (!child.IsSequence()) refuse(key, expected);
  std::vector<std::vector<double>> rows;
  for (std::size_t i = 0; i < child.size(); ++i) {
    YAML::Node row_mapping;
    const std::string row_key = key + "[" + std::to_string(i) + "]";
    row_mapping[row_key] = child[i];
    rows.push_back(YamlReader(row_mapping, origin_, path_).numbers(row_key, columns));
  }
  return rows;
}

YamlReader YamlReader::mapping(const std::string& key) const {
  const std::string expected = "a mapping of keys";
  const YAML::Node child = required(key, expected);
  if (!child.IsMap()) refuse(key, expected);
  return {child, origin_, pathOf(key)};
}

std::vector<YamlReader> YamlReader::mappings(const std::string& key) const {
  const std::string expected = "a list of mappings";
  const YAML::Node child = required(key, expected);
  if (!child.IsSequence()) refuse(key, expected);
  std::vector<YamlReader> readers;
  for (std::size_t i = 0; i < child.size(); ++i) {
    readers.emplace_back(child[i], origin_, pathOf(key) + "[" + std::to_string(i) + "]");
  }
  return readers;
}

void YamlReader::read(const std::string& key, double* value, const Interval& interval) const {
  if (has(key)) *value = number(key, interval);
}

void YamlReader::read(const std::string& key, int* value, const Interval& interval) const {
  if (has(key)) *value = integer(key, interval);
}

void YamlReader::read(const std::string& key, bool* value) const {
  if (has(key) && !parse(node_[key], value)) refuse(key, "true or false");
}

void YamlReader::read(const std::string& key, std::string* value) const {
  if (has(key)) *value = text(key);
}

void YamlReader::refuse(const std::string& key, const std::string& expected) const {
  throw InputError(where(key) + ": expected " + expected + ", found " + found(node_[key]));
}

void YamlReader::refuse(const std::string& message) const {
  throw InputError(place(node_) + ": " + (path_.empty() ? "" : path_ + ": ") + message);
}

std::string YamlReader::where(const std::string& key) const {
  return placeOf(key) + ": " + pathOf(key);
}

YAML::Node YamlReader::required(const std::string& key, const std::string& expected) const {
  if (!has(key) || node_[key].IsNull()) refuse(key, expected);
  return node_[key];
}

std::string YamlReader::place(const YAML::Node& node) const {
  const YAML::Mark mark = node.Mark();
  return mark.is_null() ? origin_ : origin_ + ":" + std::to_string(mark.line + 1);
}

std::string YamlReader::placeOf(const std::string& key) const {
  for (const auto& entry : node_) {
    if (entry.first.Scalar() != key) continue;
    return place(entry.first.Mark().is_null() ? entry.second : entry.first);
  }
  return place(node_);
}

std::string YamlReader::pathOf(const std::string& key) const {
  return (path_.empty() ? "" : path_ + ".") + oneLine(key);
}

}  // namespace omnitag

#pragma once

#include <yaml-cpp/yaml.h>

#include <initializer_list>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "omnitag/common/error.h"

namespace omnitag {

/// The numbers that a key accepts, never NaN or infinity.
struct Interval {
  double low = -std::numeric_limits<double>::max();
  double high = std::numeric_limits<double>::max();
  bool low_included = true;

  bool contains(double value) const;
  /// In words, for an error message, e.g. "a number > 0".
  std::string description(const std::string& kind) const;
};

constexpr Interval kAnyNumber{};
constexpr Interval kPositive{0.0, std::numeric_limits<double>::max(), false};
constexpr Interval kNonNegative{0.0, std::numeric_limits<double>::max(), true};

/// Reads a YAML mapping key by key and refuses what is not as expected. Every error is an
/// InputError of one line: the origin (a file or a parameter namespace), the line if there is one,
/// the key with its parents, what was expected and what was found.
class YamlReader {
 public:
  /// Reads a file whose top level is a mapping. Throws InputError if it cannot be read or parsed.
  static YamlReader fromFile(const std::string& path);

  /// The text of a file. Throws InputError if it cannot be read.
  static std::string textOf(const std::string& path);

  /// Reads text; `origin` takes the place of the file name in errors.
  static YamlReader fromText(const std::string& text, const std::string& origin);

  /// A mapping that is parsed already; `path` is the key that led to it ("" for the top level).
  /// Throws InputError if it is not a mapping or has a key twice.
  YamlReader(const YAML::Node& node, std::string origin, std::string path = "");

  const std::string& origin() const { return origin_; }
  const YAML::Node& node() const { return node_; }
  /// Whether the key is present, even with an empty value.
  bool has(const std::string& key) const;
  /// Whether the key's value is a single word or number, neither a list nor a mapping.
  bool isText(const std::string& key) const;
  bool isMapping(const std::string& key) const;
  /// In the order of the file.
  std::vector<std::string> keys() const;

  /// Refuses every key that is not listed, so that a misspelt one does not go unnoticed.
  void allowOnly(std::initializer_list<std::string_view> keys) const;

  /// Refuses a key of former versions; `replacement` says in words what replaces it.
  void refuseReplaced(const std::string& key, const std::string& replacement) const;

  /// Required keys. Integers are accepted where reals are meant.
  double number(const std::string& key, const Interval& interval = kAnyNumber) const;
  int integer(const std::string& key, const Interval& interval = kAnyNumber) const;
  std::string text(const std::string& key) const;
  /// Exactly `size` numbers; any count for size 0.
  std::vector<double> numbers(const std::string& key, std::size_t size = 0) const;
  /// A list of words or numbers, as written.
  std::vector<std::string> texts(const std::string& key) const;
  /// A list of lists of exactly `columns` numbers.
  std::vector<std::vector<double>> table(const std::string& key, std::size_t columns) const;
  YamlReader mapping(const std::string& key) const;
  std::vector<YamlReader> mappings(const std::string& key) const;

  /// Optional keys: `value` is left unchanged if the key is absent. A key that is present must have
  /// a value.
  void read(const std::string& key, double* value, const Interval& interval = kAnyNumber) const;
  void read(const std::string& key, int* value, const Interval& interval = kAnyNumber) const;
  void read(const std::string& key, bool* value) const;
  void read(const std::string& key, std::string* value) const;

  /// Refuses the value of a key: "<place>: <key>: expected <expected>, found <its value>".
  [[noreturn]] void refuse(const std::string& key, const std::string& expected) const;

  /// Refuses the mapping as a whole: "<place>: <message>".
  [[noreturn]] void refuse(const std::string& message) const;

  /// The place of a key, with which every error about it begins: "<origin>:<line>: <key>".
  std::string where(const std::string& key) const;

 private:
  YAML::Node required(const std::string& key, const std::string& expected) const;
  std::string place(const YAML::Node& node) const;
  /// The place of the key itself: an empty value would be reported on the next line.
  std::string placeOf(const std::string& key) const;
  std::string pathOf(const std::string& key) const;

  YAML::Node node_;
  std::string origin_;
  std::string path_;
};

}  // namespace omnitag

#include "common/yaml_reader.h"

#include <gtest/gtest.h>

#include <functional>

namespace omnitag {
namespace {

YamlReader reader(const std::string& text) { return YamlReader::fromText(text, "file.yaml"); }

/// The message of the InputError that `action` must throw.
std::string refusal(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(YamlReader, ReadsEveryKind) {
  const YamlReader r = reader(R"(
real: 1.5e-3
whole: 2
text: some words
list: [1, 2.5, -3]
table: [[0, 1], [2, 3.5]]
inner: {depth: 4}
items: [{a: 1}, {a: 2}]
)");
  EXPECT_EQ(r.number("real"), 1.5e-3);
  EXPECT_EQ(r.number("whole"), 2.0);
  EXPECT_EQ(r.integer("whole"), 2);
  EXPECT_EQ(r.text("text"), "some words");
  EXPECT_EQ(r.text("real"), "1.5e-3");
  EXPECT_EQ(r.numbers("list"), (std::vector<double>{1.0, 2.5, -3.0}));
  EXPECT_EQ(r.numbers("list", 3).size(), 3u);
  EXPECT_EQ(r.table("table", 2), (std::vector<std::vector<double>>{{0.0, 1.0}, {2.0, 3.5}}));
  EXPECT_EQ(r.mapping("inner").integer("depth"), 4);
  ASSERT_EQ(r.mappings("items").size(), 2u);
  EXPECT_EQ(r.mappings("items")[1].integer("a"), 2);
  EXPECT_EQ(r.origin(), "file.yaml");
  EXPECT_TRUE(r.has("real"));
  EXPECT_FALSE(r.has("unreal"));
}

TEST(YamlReader, RefusesNumbersThatVersionsOfYamlReadDifferently) {
  const std::string texts[] = {"010", "-010", "08", "00", "0x10", "0o10", "1_000"};
  for (const std::string& text : texts) {
    const YamlReader r = reader("value: " + text);
    EXPECT_EQ(refusal([&] { r.integer("value"); }),
              "file.yaml:1: value: expected an integer, found '" + text + "'");
    EXPECT_EQ(refusal([&] { r.number("value"); }),
              "file.yaml:1: value: expected a number, found '" + text + "'");
  }
  EXPECT_EQ(reader("value: 0").integer("value"), 0);
  EXPECT_EQ(reader("value: -10").integer("value"), -10);
  EXPECT_EQ(reader("value: 0.5").number("value"), 0.5);
  EXPECT_EQ(reader("value: 05.5").number("value"), 5.5);
}

TEST(YamlReader, OptionalKeysKeepTheirDefault) {
  const YamlReader r = reader("{number: 2, integer: 3, flag: false, text: new}");
  double number = 1.0, other_number = 1.0;
  int integer = 1, other_integer = 1;
  bool flag = true, other_flag = true;
  std::string text = "old", other_text = "old";
  r.read("number", &number);
  r.read("integer", &integer);
  r.read("flag", &flag);
  r.read("text", &text);
  r.read("other_number", &other_number);
  r.read("other_integer", &other_integer);
  r.read("other_flag", &other_flag);
  r.read("other_text", &other_text);
  EXPECT_EQ(number, 2.0);
  EXPECT_EQ(integer, 3);
  EXPECT_FALSE(flag);
  EXPECT_EQ(text, "new");
  EXPECT_EQ(other_number, 1.0);
  EXPECT_EQ(other_integer, 1);
  EXPECT_TRUE(other_flag);
  EXPECT_EQ(other_text, "old");
}

TEST(YamlReader, OptionalKeysMustNotBeBlankOrOfAnotherKind) {
  const YamlReader r = reader("blank:\nwords: some words\nlist: [1]\n");
  double number = 1.0;
  int integer = 1;
  bool flag = true;
  std::string text = "old";
  EXPECT_EQ(refusal([&] { r.read("blank", &number); }),
            "file.yaml:1: blank: expected a number, found an empty value");
  EXPECT_EQ(refusal([&] { r.read("blank", &integer); }),
            "file.yaml:1: blank: expected an integer, found an empty value");
  EXPECT_EQ(refusal([&] { r.read("blank", &flag); }),
            "file.yaml:1: blank: expected true or false, found an empty value");
  EXPECT_EQ(refusal([&] { r.read("blank", &text); }),
            "file.yaml:1: blank: expected a text, found an empty value");
  EXPECT_EQ(refusal([&] { r.read("words", &number); }),
            "file.yaml:2: words: expected a number, found 'some words'");
  EXPECT_EQ(refusal([&] { r.read("words", &flag); }),
            "file.yaml:2: words: expected true or false, found 'some words'");
  EXPECT_EQ(refusal([&] { r.read("list", &text); }),
            "file.yaml:3: list: expected a text, found a list of 1");
  EXPECT_EQ(number, 1.0);
  EXPECT_EQ(text, "old");
}

TEST(YamlReader, RefusesWhatIsNoFiniteNumber) {
  for (const std::string value : {".nan", ".inf", "-.inf", "nan", "1e999", "1.0.0", "1,5", "1 m",
                                  "[1]", "{a: 1}", "''", "true"}) {
    const YamlReader r = reader("n: " + value);
    EXPECT_EQ(refusal([&] { r.number("n"); }).rfind("file.yaml:1: n: expected a number, found ", 0),
              0u)
        << value;
  }
}

TEST(YamlReader, RefusesWhatIsNoInteger) {
  for (const std::string value : {"1.5", "1e3", "3000000000", "one", ".nan"}) {
    const YamlReader r = reader("n: " + value);
    EXPECT_EQ(refusal([&] { r.integer("n"); }),
              "file.yaml:1: n: expected an integer, found '" + value + "'");
  }
}

TEST(YamlReader, ChecksIntervals) {
  const YamlReader r = reader("{zero: 0, one: 1, minus: -1}");
  EXPECT_EQ(r.number("zero", kNonNegative), 0.0);
  EXPECT_EQ(refusal([&] { r.number("zero", kPositive); }),
            "file.yaml:1: zero: expected a number > 0, found '0'");
  EXPECT_EQ(refusal([&] { r.integer("minus", kNonNegative); }),
            "file.yaml:1: minus: expected an integer >= 0, found '-1'");
  EXPECT_EQ(r.number("one", {0.0, 1.0}), 1.0);
  EXPECT_EQ(refusal([&] {
              r.number("one", {0.0, 0.5});
            }),
            "file.yaml:1: one: expected a number >= 0 and <= 0.5, found '1'");
}

TEST(YamlReader, NamesTheParentsAndTheLine) {
  const YamlReader r = reader(R"(
lens:
  fx: wide
rows:
  - [1, 2]
  - [3]
items:
  - a: 1
  - a: x
)");
  EXPECT_EQ(refusal([&] { r.mapping("lens").number("fx"); }),
            "file.yaml:3: lens.fx: expected a number, found 'wide'");
  EXPECT_EQ(refusal([&] { r.mapping("lens").number("fy"); }),
            "file.yaml:3: lens.fy: expected a number, found nothing");
  EXPECT_EQ(refusal([&] { r.table("rows", 2); }),
            "file.yaml:6: rows[1]: expected a list of 2 numbers, found a list of 1");
  EXPECT_EQ(refusal([&] { r.mappings("items")[1].integer("a"); }),
            "file.yaml:9: items[1].a: expected an integer, found 'x'");
  EXPECT_EQ(refusal([&] { r.mapping("items"); }),
            "file.yaml:7: items: expected a mapping of keys, found a list of 2");
  EXPECT_EQ(refusal([&] { r.mappings("lens"); }),
            "file.yaml:2: lens: expected a list of mappings, found a mapping");
}

TEST(YamlReader, RefusesListsWithOtherThanNumbers) {
  const YamlReader r = reader("a: [1, x]\nb: [1, [2]]\nc: 1\nd: [.nan]\n");
  EXPECT_EQ(refusal([&] { r.numbers("a"); }),
            "file.yaml:1: a: expected a list of numbers, found 'x' among them");
  EXPECT_EQ(refusal([&] { r.numbers("b", 2); }),
            "file.yaml:2: b: expected a list of 2 numbers, found a list of 1 among them");
  EXPECT_EQ(refusal([&] { r.numbers("c", 2); }),
            "file.yaml:3: c: expected a list of 2 numbers, found '1'");
  EXPECT_EQ(refusal([&] { r.numbers("d"); }),
            "file.yaml:4: d: expected a list of numbers, found '.nan' among them");
}

TEST(YamlReader, RefusesUnknownAndRepeatedKeys) {
  EXPECT_EQ(refusal([] {
              reader("{known: 1, knwon: 2}").allowOnly({"known", "other"});
            }),
            "file.yaml:1: knwon: unknown key; expected one of: known, other");
  EXPECT_EQ(refusal([] { reader("{known: 1}").allowOnly({"known", "other"}); }), "accepted");
  EXPECT_EQ(refusal([] { reader("a: 1\nb: 2\na: 3\n"); }),
            "file.yaml:3: a: expected once, found again");
  EXPECT_EQ(refusal([] { reader("[a, b]: 1\n"); }),
            "file.yaml:1: expected a word as key, found a list of 2");
}

TEST(YamlReader, RefusesTextThatIsNoMapping) {
  EXPECT_EQ(refusal([] { reader("- 1\n"); }),
            "file.yaml:1: expected a mapping of keys, found a list of 1");
  EXPECT_NE(refusal([] { reader(""); }).find("expected a mapping of keys, found an empty value"),
            std::string::npos);
  EXPECT_EQ(refusal([] { reader("a: [1\nb: 2\n"); }).rfind("file.yaml:2: ", 0), 0u);
}

TEST(YamlReader, SaysEverythingInOneLine) {
  const std::string long_text(200, 'x');
  const std::vector<std::string> messages = {
      refusal([] { reader(R"(a: "1\n2")").number("a"); }),
      refusal([] { reader(R"("a\nb": 1)").allowOnly({"a"}); }),
      refusal([&] { reader("a: " + long_text).number("a"); }),
  };
  for (const std::string& message : messages) {
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_LT(message.size(), 150u);
    EXPECT_NE(message, "accepted");
  }
}

TEST(YamlReader, NamesAFileThatCannotBeRead) {
  EXPECT_EQ(refusal([] { YamlReader::fromFile("/nowhere/file.yaml"); }),
            "/nowhere/file.yaml: expected a readable file, found none");
  EXPECT_EQ(refusal([] { YamlReader::fromFile("/"); }),
            "/: expected a readable file, found a directory");
}

TEST(YamlReader, ValuesWithoutAFileHaveNoLine) {
  YAML::Node parameters;
  parameters["size"] = -1.0;
  const YamlReader r(parameters, "/localizer", "detector");
  EXPECT_EQ(refusal([&] { r.number("size", kPositive); }),
            "/localizer: detector.size: expected a number > 0, found '-1'");
  EXPECT_EQ(refusal([&] { r.number("width"); }),
            "/localizer: detector.width: expected a number, found nothing");
  EXPECT_EQ(refusal([&] { r.refuse("too much"); }), "/localizer: detector: too much");
}

TEST(YamlReader, RefusalsAreOneLineWhateverTheTextHolds) {
  for (const std::string text : {"key: \"\\\n\"", "key: \"\\\x01\"", "a: b\n \tc: [\r\n"}) {
    const std::string message = refusal([&] { reader(text).number("key"); });
    EXPECT_EQ(message.rfind("file.yaml:", 0), 0U) << message;
    EXPECT_EQ(message.find_first_of("\n\r\x01"), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace omnitag

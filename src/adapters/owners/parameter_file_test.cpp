#include "owners/parameter_file.h"

#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"

namespace culprit::owners {
namespace {

using testing::HasSubstr;
using Parameters = std::vector<ros2::msg::Parameter>;

Expected<Parameters> parameters_in(const std::string& text, const std::string& node) {
  const test::TestFolder folder;
  const std::string path = (folder.path() / "parameters.yaml").string();
  std::ofstream(path) << text;
  return read_parameter_file(path, node);
}

std::vector<std::string> names_in_file(const std::string& text, const std::string& node) {
  std::vector<std::string> names;
  const auto read = parameters_in(text, node);
  if (!read) return {read.error()};
  for (const auto& each : *read) names.push_back(each.name);
  return names;
}

TEST(ParameterFile, GivesANodeWhatIsItsOwn) {
  const std::string text =
      "/**:\n  ros__parameters: {all: 1}\n"
      "detector:\n  ros__parameters: {bare: 1}\n"
      "/robot/detector:\n  ros__parameters: {full: 1}\n"
      "robot:\n  detector:\n    ros__parameters: {nested: 1}\n"
      "/robot/*:\n  ros__parameters: {one: 1}\n"
      "/**/detector:\n  ros__parameters: {any: 1}\n"
      "tracker:\n  ros__parameters: {other: 1}\n";
  using Names = std::vector<std::string>;
  EXPECT_EQ(names_in_file(text, "/detector"), (Names{"all", "any", "bare"}));
  EXPECT_EQ(names_in_file(text, "/robot/detector"), (Names{"all", "any", "full", "nested", "one"}));
}

TEST(ParameterFile, KnowsTypesAsRosDoes) {
  const auto read = parameters_in(
      "/**:\n  ros__parameters:\n    a: true\n    b: -3\n    c: 0.5\n    d: text\n    e: '7'\n"
      "    f: [1, 2]\n    g: [1, 2.5]\n    h: [x, 'y']\n    i: [on, off]\n    j: {k: {l: 1e3}}\n"
      "    m: []\n    n: .nan\n",
      "/n");
  ASSERT_TRUE(read) << read.error();
  std::vector<int> types;
  for (const auto& each : *read) types.push_back(each.value.type);
  EXPECT_EQ(types, (std::vector<int>{1, 2, 3, 4, 4, 7, 8, 9, 6, 3, 9, 3}));
  EXPECT_EQ((*read)[4].value.string_value, "7");
  EXPECT_EQ((*read)[6].value.double_array_value, (std::vector<double>{1, 2.5}));
  EXPECT_EQ((*read)[9].name, "j.k.l");
}

// Addresses on buses are seldom written otherwise. A node refuses a text for a number, and so is not loaded.
TEST(ParameterFile, ReadsWholeNumbersOfOtherBasesAsRosDoes) {
  const auto read = parameters_in(
      "/**:\n  ros__parameters: {a: 0x29, b: -0x1F, c: 010, d: '0x29', e: 0x, f: [0x601, 2], g: "
      "+5}\n",
      "/n");
  ASSERT_TRUE(read) << read.error();
  ASSERT_EQ(read->size(), 7u);
  EXPECT_EQ((*read)[0].value.integer_value, 0x29);
  EXPECT_EQ((*read)[1].value.integer_value, -0x1F);
  EXPECT_EQ((*read)[2].value.integer_value, 8);
  EXPECT_EQ((*read)[3].value.string_value, "0x29");
  EXPECT_EQ((*read)[4].value.string_value, "0x");
  EXPECT_EQ((*read)[5].value.integer_array_value, (std::vector<std::int64_t>{0x601, 2}));
  EXPECT_EQ((*read)[6].value.integer_value, 5);
}

TEST(ParameterFile, LaterLinesWin) {
  const auto read =
      parameters_in("/**:\n  ros__parameters: {rate: 1}\nn:\n  ros__parameters: {rate: 2}\n", "/n");
  ASSERT_TRUE(read) << read.error();
  ASSERT_EQ(read->size(), 1u);
  EXPECT_EQ(read->front().value.integer_value, 2);
}

TEST(ParameterFile, SaysWhatIsWrongAndWhere) {
  const auto wrong = [](const std::string& text) {
    const auto read = parameters_in(text, "/n");
    return read ? "nothing" : read.error();
  };
  EXPECT_THAT(wrong("n:\n  ros__parameters: 7\n"), HasSubstr(":2: parameters are a mapping"));
  EXPECT_THAT(wrong("n: 7\n"), HasSubstr(":1: expected the names of nodes"));
  EXPECT_THAT(wrong("n:\n  ros__parameters: {a: [1, x]}\n"), HasSubstr("values of one type"));
  EXPECT_THAT(wrong("n:\n  ros__parameters: {a: }\n"), HasSubstr("a has no value"));
  EXPECT_THAT(wrong("n: [\n"), HasSubstr("parameters.yaml:"));
  EXPECT_THAT(wrong(std::string((1 << 20) + 1, ' ')), HasSubstr("longer"));
  EXPECT_THAT(read_parameter_file("/no/such.yaml", "/n").error(),
              HasSubstr("there is no file /no/such.yaml"));
}

// Aliases expand a few lines to a text that would fill the memory.
TEST(ParameterFile, EndsWhereAliasesDoNot) {
  std::string text = "a: &a {x0: 1, x1: 1, x2: 1, x3: 1, x4: 1, x5: 1, x6: 1, x7: 1}\n";
  for (char c = 'b'; c < 'j'; ++c) {
    text += std::string(1, c) + ": &" + c + " {";
    for (int i = 0; i < 8; ++i)
      text += std::string(i == 0 ? "" : ", ") + "y" + std::to_string(i) + ": *" +
              static_cast<char>(c - 1);
    text += "}\n";
  }
  EXPECT_FALSE(parameters_in("n:\n  ros__parameters: {z: *i}\n" + text, "/n"));
  std::string inside = "n:\n  ros__parameters:\n";
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) inside += "    " + line + "\n";
  EXPECT_FALSE(parameters_in(inside, "/n"));
}

TEST(ParameterFile, EndsWhereNeitherNamesNorEmptyMappingsCount) {
  std::string text = "a: &a {}\n";
  for (char c = 'b'; c < 'n'; ++c) {
    text += std::string(1, c) + ": &" + c + " {";
    for (char key = 'p'; key < 'z'; ++key)
      text += std::string(key == 'p' ? "" : ", ") + key + ": *" + static_cast<char>(c - 1);
    text += "}\n";
  }
  const auto expect_too_large = [](const std::string& file) {
    const auto read = parameters_in(file, "/n");
    ASSERT_FALSE(read);
    EXPECT_THAT(read.error(), HasSubstr("larger than 16 MiB"));
  };
  expect_too_large(text);
  std::string inside = "n:\n  ros__parameters:\n";
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) inside += "    " + line + "\n";
  expect_too_large(inside);
  const std::string long_text(100'000, 'x');
  std::string list;
  for (int i = 0; i < 1000; ++i) list += std::string(i == 0 ? "" : ", ") + "*t";
  expect_too_large("n:\n  ros__parameters:\n    t: &t " + long_text + "\n    l: [" + list + "]\n");
  std::string names;
  for (int i = 0; i < 1000; ++i)
    names += std::string(i == 0 ? "" : ", ") + "p" + std::to_string(i) + ": 1";
  expect_too_large("n:\n  ros__parameters:\n    ? " + long_text + "\n    : {" + names + "}\n");
}

TEST(ParameterFile, MatchesAPatternOfAnyNumberOfStars) {
  std::string stars;
  for (int i = 0; i < 100'000; ++i) stars += "/**";
  const auto names_for = [&](const std::string& node) {
    return names_in_file("? \"" + stars + node + "\"\n:\n  ros__parameters: {a: 1}\n", "/x/y/n");
  };
  EXPECT_EQ(names_for("/n"), std::vector<std::string>{"a"});
  EXPECT_EQ(names_for("/m"), std::vector<std::string>{});
}

TEST(ParameterFile, ReadsAndWritesTheValuesOfACommandLine) {
  for (const char* text :
       {"true", "3", "0.5", "[1, 2]", "[0.5, 2]", "[true, false]", "[a, b]", "fast"}) {
    const auto value = parse_parameter_value(text);
    ASSERT_TRUE(value) << text;
    EXPECT_EQ(to_yaml(*value), text);
  }
  EXPECT_EQ(to_yaml(*parse_parameter_value("1.0")), "1") << "one number, however it is written";
  EXPECT_EQ(to_yaml(*parse_parameter_value("'1.0'")), "1.0") << "a text";
  for (const char* wrong : {"", "[1", "{a: 1}", "[1, a]"})
    EXPECT_FALSE(parse_parameter_value(wrong)) << wrong;
}

}  // namespace
}  // namespace culprit::owners

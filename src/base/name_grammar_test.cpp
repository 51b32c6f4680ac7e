#include "base/name_grammar.h"

#include <gtest/gtest.h>

namespace culprit {
namespace {

TEST(NameGrammar, KnowsTypes) {
  EXPECT_TRUE(is_valid_type_name("std_msgs/msg/String"));
  EXPECT_TRUE(is_valid_type_name("tf2_msgs/action/LookupTransform_SendGoal"));
  for (const char* bad : {"", "String", "std_msgs/String", "std_msgs/msg/", "/msg/String",
                          "a/idl/B", "../msg/B", "a/msg/../B", "a/msg/b/c", "a.b/msg/C"}) {
    EXPECT_FALSE(is_valid_type_name(bad)) << bad;
  }
}

TEST(NameGrammar, PrintableHidesControlCharactersAndCuts) {
  EXPECT_EQ(printable("a\x1b[2Jb\n\xc3"), "a?[2Jb??");
  EXPECT_EQ(printable(std::string(81, 'x')), std::string(80, 'x') + "...");
}

TEST(NameGrammar, EscapesWhatSteersATerminal) {
  EXPECT_EQ(escape_controls("ada\x1b[2J\n\x7f"), "ada\\x1b[2J\\x0a\\x7f");
  EXPECT_EQ(escape_controls("a\xc2\x9b"
                            "2J"),
            "a\\x9b2J")
      << "of one character";
  EXPECT_EQ(escape_controls("a\xe2\x80\xae"
                            "b\xe2\x81\xa6"),
            "a\\u202eb\\u2066");
  EXPECT_EQ(escape_controls("Jürgen \xe2\x80\xa6 \xc2"), "Jürgen \xe2\x80\xa6 \xc2")
      << "all else stays";
}

TEST(NameGrammar, EscapesEachLineOfSeveral) {
  EXPECT_EQ(escape_lines("a\x1b[2J\n\tb\r\n\n"), "a\\x1b[2J\n\tb\\x0d\n\n");
  EXPECT_EQ(escape_lines(""), "");
}

TEST(NameGrammar, KnowsTopicsNodesAndNamespaces) {
  EXPECT_TRUE(is_valid_topic_name("/a/b_1"));
  EXPECT_TRUE(is_valid_node_name("camera_2"));
  EXPECT_TRUE(is_valid_namespace("/"));
  EXPECT_TRUE(is_valid_namespace("/robot1/arm"));
  for (const char* bad : {"", "a", "/", "/a/", "//a", "/1", "/a b", "/a-b"})
    EXPECT_FALSE(is_valid_topic_name(bad)) << bad;
  for (const char* bad : {"", "1a", "a/b", "a-b", "\xc3\xa4"})
    EXPECT_FALSE(is_valid_node_name(bad)) << bad;
}

}  // namespace
}  // namespace culprit

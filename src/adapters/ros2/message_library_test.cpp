#include "ros2/message_library.h"

#include <fstream>
#include <sys/stat.h>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/test_folder.h"
#include "ros2/standard_messages.h"

namespace culprit::ros2 {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// A directory of message definitions that is removed after the test.
class MessageDirectory {
 public:
  MessageDirectory& with(const std::string& file, const std::string& text) {
    fs::create_directories((path_ / file).parent_path());
    std::ofstream(path_ / file) << text;
    return *this;
  }
  const fs::path& path() const { return path_; }

 private:
  test::TestFolder own_;
  fs::path path_ = own_.path();
};

TEST(MessageLibrary, KnowsTheStandardTypesAndAllThatTheyNest) {
  MessageLibrary library;
  for (const StandardMessage& message : standard_messages()) {
    const auto definition = library.find(message.type);
    ASSERT_TRUE(definition) << definition.error();
    for (const FieldDefinition& field : (*definition)->fields) {
      if (const auto* nested = std::get_if<std::string>(&field.element)) {
        EXPECT_TRUE(library.find(*nested)) << message.type << " has a " << *nested;
      }
    }
  }
}

TEST(MessageLibrary, FindsFilesInBothLayouts) {
  MessageDirectory directory;
  directory.with("my_msgs/msg/A.msg", "int32 a\n").with("share/my_msgs/msg/B.msg", "int32 b\n");
  MessageLibrary library({directory.path()});
  EXPECT_EQ((*library.find("my_msgs/msg/A"))->fields.front().name, "a");
  EXPECT_EQ((*library.find("my_msgs/msg/B"))->fields.front().name, "b");
}

TEST(MessageLibrary, PrefersFilesToWhatIsBuiltIn) {
  MessageDirectory directory;
  directory.with("std_msgs/msg/String.msg", "string other\n");
  MessageLibrary library({directory.path()});
  EXPECT_EQ((*library.find("std_msgs/msg/String"))->fields.front().name, "other");
}

TEST(MessageLibrary, GivesTheSameDefinitionAgain) {
  MessageLibrary library;
  EXPECT_EQ(*library.find("std_msgs/msg/String"), *library.find("std_msgs/msg/String"));
}

TEST(MessageLibrary, SaysWhatToDoAboutAnUnknownType) {
  MessageLibrary library;
  EXPECT_EQ(library.find("my_msgs/msg/Thing").error(),
            "the message type my_msgs/msg/Thing is not known; give the directory that holds "
            "my_msgs/msg/Thing.msg with --message-path");
}

TEST(MessageLibrary, ReportsTheFileOfASyntaxError) {
  MessageDirectory directory;
  directory.with("my_msgs/msg/Bad.msg", "int32 a\nint32\n");
  MessageLibrary library({directory.path()});
  EXPECT_THAT(library.find("my_msgs/msg/Bad").error(), HasSubstr("my_msgs/msg/Bad.msg:2: "));
}

TEST(MessageLibrary, NeverLooksOutsideItsDirectories) {
  MessageLibrary library({"/"});
  EXPECT_FALSE(library.find("../msg/X"));
  EXPECT_FALSE(library.find("etc/msg/../../etc/passwd"));
}

TEST(MessageLibrary, LearnsATypeWithThoseInIt) {
  MessageLibrary library;
  const std::string line = std::string(80, '=') + "\n";
  library.learn("a/msg/Outer", "Inner one\nb/Other two\n" + line + "MSG: a/Inner\nint8 x\n" + line +
                                   "MSG: b/msg/Other\n" + line + "MSG: a/Inner\nint16 x\n" + line +
                                   "no name");
  library.learn("a/msg/Outer", "int32 other");
  const auto outer = library.find("a/msg/Outer");
  ASSERT_TRUE(outer) << outer.error();
  EXPECT_EQ((*outer)->fields.size(), 2);
  const auto inner = library.find("a/msg/Inner");
  ASSERT_TRUE(inner) << inner.error();
  EXPECT_EQ(std::get<Primitive>((*inner)->fields.at(0).element), Primitive::kInt8);
  EXPECT_TRUE(library.find("b/msg/Other"));
}

TEST(MessageLibrary, SearchesTheGivenDirectoriesBeforeThePrefixPath) {
  EXPECT_THAT(message_directories({"/mine"}, "/a:/b::"), ElementsAre("/mine", "/a", "/b"));
  EXPECT_THAT(message_directories({}, ""), ElementsAre());
}

// A container's process decides what is below its root, and may be hostile.
TEST(MessageLibrary, ReadsNothingAboveItsRoot) {
  MessageDirectory root;
  MessageDirectory outside;
  outside.with("secret.msg", "int32 secret\n");
  root.with("opt/share/my_msgs/msg/Real.msg", "int32 real\n");
  const fs::path messages = root.path() / "opt/share/my_msgs/msg";
  fs::create_symlink("/opt/share/my_msgs/msg/Real.msg", messages / "Linked.msg");
  fs::create_symlink(outside.path() / "secret.msg", messages / "Escaped.msg");
  fs::create_symlink("../../../../../../../.." + (outside.path() / "secret.msg").string(),
                     messages / "Climbed.msg");
  MessageLibrary library({"/opt"}, root.path());
  EXPECT_TRUE(library.find("my_msgs/msg/Real"));
  EXPECT_TRUE(library.find("my_msgs/msg/Linked"));
  EXPECT_FALSE(library.find("my_msgs/msg/Escaped"));
  EXPECT_FALSE(library.find("my_msgs/msg/Climbed"));
}

TEST(MessageLibrary, WaitsForNoPipeAndPassesOverWhatIsVeryLarge) {
  MessageDirectory directory;
  directory.with("my_msgs/msg/Large.msg", std::string(2u << 20, '#'));
  ASSERT_EQ(mkfifo((directory.path() / "my_msgs/msg/Pipe.msg").c_str(), 0600), 0);
  MessageLibrary library({directory.path()});
  EXPECT_FALSE(library.find("my_msgs/msg/Pipe"));
  EXPECT_FALSE(library.find("my_msgs/msg/Large"));
}

TEST(MessageLibrary, GivesATypeWithAllTypesInItOnce) {
  MessageDirectory directory;
  directory.with("my_msgs/msg/A.msg", "B one\nB two\n")
      .with("my_msgs/msg/B.msg", "A[] back\nint32 x\n");
  MessageLibrary library({directory.path()});
  const auto parts = library.with_parts("my_msgs/msg/A");
  ASSERT_TRUE(parts) << parts.error();
  EXPECT_EQ(parts->size(), 2u);
  EXPECT_FALSE(library.with_parts("my_msgs/msg/C"));
}

TEST(MessageLibrary, KnowsWhatItWasToldInPlaceOfWhatItHad) {
  MessageLibrary library;
  const auto before = library.hash_of("std_msgs/msg/String");
  library.define({{"std_msgs/msg/String",
                   {"std_msgs/msg/String", {{.name = "text", .element = Primitive::kString}}}}});
  EXPECT_EQ((*library.find("std_msgs/msg/String"))->fields.front().name, "text");
  EXPECT_NE(*library.hash_of("std_msgs/msg/String"), *before);
}

}  // namespace
}  // namespace culprit::ros2

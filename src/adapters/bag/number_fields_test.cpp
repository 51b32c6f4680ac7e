// Which fields of a type can be drawn.
#include "bag/number_fields.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace culprit::bag {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

constexpr const char* kLine =
    "\n================================================================================\n";

TEST(NumberFields, AreNumbersAndTruthsAlsoOfMessagesInIt) {
  ros2::MessageLibrary library;
  library.learn("a/msg/Wheels", std::string("std_msgs/Header header\nstring name\nbool on\n"
                                            "a/Speed speed\nfloat64[] position\nfloat32[2] pair\n"
                                            "uint8[] picture\na/Speed[] more\nint32 last") +
                                    kLine + "MSG: a/Speed\nfloat64 linear\nfloat64 angular" +
                                    kLine + "MSG: std_msgs/Header\nint32 seq");
  EXPECT_THAT(number_fields(library, "a/msg/Wheels", 100),
              ElementsAre("on", "speed.linear", "speed.angular", "position[0]", "position[1]",
                          "position[2]", "pair[0]", "pair[1]", "last"));
  EXPECT_THAT(number_fields(library, "a/msg/Wheels", 2), ElementsAre("on", "speed.linear"));
}

TEST(NumberFields, AreNoneOfATypeThatNobodyDefines) {
  ros2::MessageLibrary library;
  EXPECT_THAT(number_fields(library, "a/msg/Nowhere", 100), IsEmpty());
  EXPECT_THAT(number_fields(library, "\xff", 100), IsEmpty());
}

TEST(NumberFields, EndInATypeThatIsMadeOfItselfOrMultiplies) {
  ros2::MessageLibrary library;
  library.learn("a/msg/Self", "float64 x\na/Self again");
  EXPECT_THAT(number_fields(library, "a/msg/Self", 100), SizeIs(testing::Le(10u)));
  std::string text = "a/T1 a\na/T1 b\na/T1 c\na/T1 d\na/T1 e\na/T1 f\na/T1 g\na/T1 h";
  for (int i = 1; i < 9; ++i) {
    const std::string next = "a/T" + std::to_string(i + 1);
    text += kLine + std::string("MSG: a/T") + std::to_string(i) + "\n";
    for (const char* name : {" a", " b", " c", " d", " e", " f", " g", " h"})
      text += next + name + "\n";
  }
  text += kLine + std::string("MSG: a/T9\nstring nothing");
  library.learn("a/msg/T0", text);
  EXPECT_THAT(number_fields(library, "a/msg/T0", 100), IsEmpty());
}

}  // namespace
}  // namespace culprit::bag

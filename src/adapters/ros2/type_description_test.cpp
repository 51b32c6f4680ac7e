#include "ros2/type_description.h"

#include <gtest/gtest.h>

#include "ros2/message_library.h"

namespace culprit::ros2 {
namespace {

// As `ros2 topic info -v` of Jazzy prints them.
TEST(TypeHash, IsThatOfIronAndNewer) {
  MessageLibrary library;
  for (const auto& [type, hash] : std::map<std::string, std::string>{
           {"std_msgs/msg/String",
            "df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"},
           {"std_msgs/msg/Empty",
            "20b625256f32d5dbc0d04fee44f43c41e51c70d3502f84b4a08e7a9c26a96312"},
           {"builtin_interfaces/msg/Time",
            "b106235e25a4c5ed35098aa0a61a3ee9c9b18d197f398b0e4206cea9acf9c197"},
           {"std_msgs/msg/Header",
            "f49fb3ae2cf070f793645ff749683ac6b06203e41c891e17701b1cb597ce6a01"},
           {"sensor_msgs/msg/LaserScan",
            "64c191398013af96509d518dac71d5164f9382553fce5c1f8cca5be7924bd828"},
           {"sensor_msgs/msg/Image",
            "d31d41a9a4c4bc8eae9be757b0beed306564f7526c88ea6a4588fb9582527d47"},
           {"geometry_msgs/msg/Twist",
            "9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a"},
           {"nav_msgs/msg/Odometry",
            "3cc97dc7fb7502f8714462c526d369e35b603cfc34d946e3f2eda2766dfec6e0"}}) {
    const auto ours = library.hash_of(type);
    ASSERT_TRUE(ours) << ours.error();
    EXPECT_EQ(*ours, "RIHS01_" + hash) << type;
  }
}

// As rosidl of Jazzy computes them. A service is a type of its own, beside its messages.
TEST(TypeHash, OfServicesIsThatOfIronAndNewer) {
  MessageLibrary library;
  library.learn("p/srv/Find_Request", "string[] names\nbuiltin_interfaces/Time[<=2] when\n");
  library.learn("p/srv/Find_Response", "bool ok\n");
  for (const auto& [type, hash] : std::map<std::string, std::string>{
           {"std_srvs/srv/Trigger_Request",
            "d010825374ce8918e72bfd826c82603e60f45419e932ea976f807b74a863a199"},
           {"std_srvs/srv/Trigger",
            "eeff2cd6fa5ad9d27cdf4dec64818317839b62f212a91e6b5304b634b2062c5f"},
           {"std_srvs/srv/SetBool_Event",
            "3c4c20015afb4303eafd347b1d6a786f171a89c814726961a9593ef10df878cf"},
           {"std_srvs/srv/SetBool",
            "abe9e4bb6b41b40e6789712c00ec8871923e089af3f667a79992a428cff2da0a"},
           {"p/srv/Find", "0f681017a78c53880a21a6f1ee49d1a91958af4e84623cdcd970e6fc2f05ae46"}}) {
    const auto ours = library.hash_of(type);
    ASSERT_TRUE(ours) << ours.error();
    EXPECT_EQ(*ours, "RIHS01_" + hash) << type;
  }
  EXPECT_FALSE(library.hash_of("p/srv/Nothing"));
}

// As rosidl of Jazzy computes them.
TEST(TypeHash, OfActionsIsThatOfIronAndNewer) {
  MessageLibrary library;
  library.learn("example_interfaces/action/Fibonacci_Goal", "int32 order\n");
  library.learn("example_interfaces/action/Fibonacci_Result", "int32[] sequence\n");
  library.learn("example_interfaces/action/Fibonacci_Feedback", "int32[] sequence\n");
  const std::string fibonacci = "example_interfaces/action/Fibonacci_";
  for (const auto& [type, hash] : std::map<std::string, std::string>{
           {"action_msgs/msg/GoalStatus",
            "32f4cfd717735d17657e1178f24431c1ce996c878c515230f6c5b3476819dbb9"},
           {"action_msgs/srv/CancelGoal",
            "573d8b0a534451d7bc2ac8c5ffde8ac14b8593b7001175d0cd6516dcbeb8689a"},
           {fibonacci + "Goal", "226cb437e4355dcd3e914f930382a3b0cc1da81545bd319ed554e95a03255f51"},
           {fibonacci + "SendGoal",
            "d1a57fb2a4afe8c21e34fb10db206f16ce6729b28531141472df92277c55b557"},
           {fibonacci + "SendGoal_Request",
            "3d088942b413247db536576f0286768c6be8fcd5d0c9a5d544f359fba090a238"},
           {fibonacci + "SendGoal_Response",
            "d8c07bb3d5b766fe4b43159c9a5222af5214e2fcc29229b991d826166c512be1"},
           {fibonacci + "GetResult",
            "1b0de0d5d29dc955d92f546706568428632771db13ec84c15ec1c1a59f424a57"},
           {fibonacci + "GetResult_Response",
            "6021dc98ab9b4bbe395e48aa4de81ee5f68eb570f88358affcc648146668b24f"},
           {fibonacci + "FeedbackMessage",
            "c1de71afd52e49a89c53d8262366884185bc0a02f78ce051c4e46b0a7fe59bb2"}}) {
    const auto ours = library.hash_of(type);
    ASSERT_TRUE(ours) << ours.error();
    EXPECT_EQ(*ours, "RIHS01_" + hash) << type;
  }
}

// Bounds are part of a type; constants and defaults are not.
TEST(TypeHash, TellsBoundsApart) {
  const auto hash_of = [](std::string_view text) {
    auto definition = parse_message_definition(text, "a/msg/A", "A.msg");
    return type_hash("a/msg/A", {{"a/msg/A", *definition}});
  };
  EXPECT_NE(hash_of("string<=3 a\n"), hash_of("string a\n"));
  EXPECT_NE(hash_of("int32[<=3] a\n"), hash_of("int32[] a\n"));
  EXPECT_NE(hash_of("int32[3] a\n"), hash_of("int32[4] a\n"));
  EXPECT_EQ(hash_of("int32 A=3\nint32 a 7\n"), hash_of("int32 a\n"));
}

TEST(TypeDescription, OfATypeIsThatTypeAgain) {
  MessageLibrary library;
  for (const std::string type :
       {"sensor_msgs/msg/Image", "nav_msgs/msg/Odometry", "std_msgs/msg/Empty",
        "diagnostic_msgs/msg/DiagnosticArray", "std_srvs/srv/SetBool"}) {
    const auto parts = library.with_parts(type);
    ASSERT_TRUE(parts) << parts.error();
    const auto again = to_definitions(describe(type, *parts));
    ASSERT_TRUE(again) << again.error();
    EXPECT_EQ(type_hash(type, *again), type_hash(type, *parts));
    MessageLibrary reread;
    reread.learn(type, to_text(type, *again));
    EXPECT_EQ(*reread.hash_of(type), type_hash(type, *parts)) << to_text(type, *again);
  }
}

TEST(TypeDescription, ThatNoTypeCouldHaveIsRefused) {
  const auto read = [](const msg::Field& field) {
    return to_definitions({{"a/msg/A", {field}}, {}}).has_value();
  };
  EXPECT_TRUE(read({"x", {6, 0, 0, ""}, ""}));
  EXPECT_FALSE(read({"x\"", {6, 0, 0, ""}, ""}));             // names become part of what is hashed
  EXPECT_FALSE(read({"x", {0, 0, 0, ""}, ""}));               // no type
  EXPECT_FALSE(read({"x", {12, 0, 0, ""}, ""}));              // long double
  EXPECT_FALSE(read({"x", {200, 0, 0, ""}, ""}));             // no shape
  EXPECT_FALSE(read({"x", {54, 0, 0, ""}, ""}));              // an array of nothing
  EXPECT_FALSE(read({"x", {54, 1ull << 40, 0, ""}, ""}));     // an array of too much
  EXPECT_FALSE(read({"x", {21, 0, 0, ""}, ""}));              // a bound that there is not
  EXPECT_FALSE(read({"x", {1, 0, 0, "../etc/passwd"}, ""}));  // no type's name
  EXPECT_FALSE(to_definitions({{"no type", {}}, {}}));
}

}  // namespace
}  // namespace culprit::ros2

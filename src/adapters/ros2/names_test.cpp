#include "ros2/names.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace culprit::ros2 {
namespace {

TEST(Names, MangleTopicsAndServices) {
  EXPECT_EQ(mangle_topic(Channel::kTopic, "/a/b"), "rt/a/b");
  EXPECT_EQ(mangle_topic(Channel::kRequest, "/a/s"), "rq/a/sRequest");
  EXPECT_EQ(mangle_topic(Channel::kReply, "/a/s"), "rr/a/sReply");
}

TEST(Names, MangleTypes) {
  EXPECT_EQ(mangle_type(Channel::kTopic, "std_msgs/msg/String"), "std_msgs::msg::dds_::String_");
  EXPECT_EQ(mangle_type(Channel::kRequest, "std_srvs/srv/Trigger"),
            "std_srvs::srv::dds_::Trigger_Request_");
  EXPECT_EQ(mangle_type(Channel::kReply, "std_srvs/srv/Trigger"),
            "std_srvs::srv::dds_::Trigger_Response_");
}

TEST(Names, DemangleGivesNothingForWhatIsNotRos) {
  EXPECT_FALSE(demangle_topic("ros_discovery_info"));
  EXPECT_FALSE(demangle_topic("rt"));
  EXPECT_FALSE(demangle_topic("rt/"));
  EXPECT_FALSE(demangle_topic("rt/a//b"));
  EXPECT_FALSE(demangle_topic("rt/a/"));
  EXPECT_FALSE(demangle_topic("rq/a/sReply"));
  EXPECT_FALSE(demangle_topic("rq/aReques"));
  EXPECT_FALSE(demangle_topic("rs/a"));
  EXPECT_FALSE(demangle_topic("rqRequest"));
  EXPECT_FALSE(demangle_topic("rt/a\n/b"));
  EXPECT_FALSE(demangle_topic("rt/" + std::string(300, 'a')));
  EXPECT_FALSE(demangle_type(Channel::kTopic, "HelloWorld"));
  EXPECT_FALSE(demangle_type(Channel::kTopic, "dds_::X_"));
  EXPECT_FALSE(demangle_type(Channel::kTopic, "a::msg::dds_::X"));
  EXPECT_FALSE(demangle_type(Channel::kTopic, "a::msg::dds_::_"));
  EXPECT_FALSE(demangle_type(Channel::kTopic, "a::b::msg::dds_::X_"));
  EXPECT_FALSE(demangle_type(Channel::kTopic, "../x::msg::dds_::X_"));
  EXPECT_FALSE(demangle_type(Channel::kRequest, "a::srv::dds_::_Request_"));
  EXPECT_FALSE(demangle_type(Channel::kReply, "a::srv::dds_::S_Request_"));
}

TEST(Names, ResolveWhatANodeMeans) {
  const NodeName camera{"/managed", "camera"};
  EXPECT_EQ(*resolve_name("/rgb", camera), "/rgb");
  EXPECT_EQ(*resolve_name("rgb", camera), "/managed/rgb");
  EXPECT_EQ(*resolve_name("~/rgb", camera), "/managed/camera/rgb");
  EXPECT_EQ(*resolve_name("~", camera), "/managed/camera");
  EXPECT_EQ(*resolve_name("rgb", NodeName{"/", "camera"}), "/rgb");
  EXPECT_EQ(*resolve_name("~/rgb", NodeName{"/", "camera"}), "/camera/rgb");
}

TEST(Names, ResolveRefusesWhatIsNoName) {
  const NodeName camera{"/managed", "camera"};
  for (const char* bad : {"", "/", "a b", "a//b", "a/", "1a", "~x/1", "{ns}/x", "a-b"}) {
    EXPECT_FALSE(resolve_name(bad, camera)) << bad;
  }
  EXPECT_EQ(resolve_name("a b", camera).error(), "'a b' is not the name of a topic or service");
}

TEST(Names, SplitNodeNames) {
  EXPECT_EQ(*parse_node_name("/a/b/node"), (NodeName{"/a/b", "node"}));
  EXPECT_EQ(*parse_node_name("/node"), (NodeName{"/", "node"}));
  EXPECT_EQ(parse_node_name("/a/b/node")->full(), "/a/b/node");
  EXPECT_EQ(parse_node_name("/node")->full(), "/node");
  for (const char* bad : {"", "node", "/", "/a/", "a/b", "/1", "//a"})
    EXPECT_FALSE(parse_node_name(bad)) << bad;
}

rc::Gen<std::string> any_token() {
  return rc::gen::map(rc::gen::nonEmpty(rc::gen::container<std::string>(
                          rc::gen::elementOf(std::string("abzAZ_09")))),
                      [](std::string token) { return "t" + token.substr(0, 20); });
}

RC_GTEST_PROP(Names, DemangleUndoesMangle, ()) {
  std::string name;
  for (int i = *rc::gen::inRange(1, 5); i > 0; --i) name += "/" + *any_token();
  const std::string type = *any_token() + "/srv/" + *any_token();
  const auto channel = *rc::gen::element(Channel::kTopic, Channel::kRequest, Channel::kReply);
  RC_ASSERT(demangle_topic(mangle_topic(channel, name)) == (RosChannel{channel, name}));
  RC_ASSERT(demangle_type(channel, mangle_type(channel, type)) == type);
}

RC_GTEST_PROP(Names, WhateverIsDemangledIsValid, (std::string text)) {
  if (const auto topic = demangle_topic("rt/" + text)) RC_ASSERT(is_valid_topic_name(topic->name));
  const auto type = demangle_type(Channel::kTopic, text + "::msg::dds_::" + text + "_");
  if (type) RC_ASSERT(is_valid_type_name(*type));
}

}  // namespace
}  // namespace culprit::ros2

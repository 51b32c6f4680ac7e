#include "ros_api/culprit_types.h"

#include <fstream>
#include <regex>
#include <set>

#include <gtest/gtest.h>

#include "ros2/type_description.h"

namespace culprit::ros_api {
namespace {

// As rosidl (rosidl_generator_type_description) computes them of the files in ros/culprit_msgs. Another hash is another
// type: nodes that were built with the old one are not to be left behind unawares.
TEST(CulpritTypes, HaveTheHashesOfRosidl) {
  const CulpritTypes types;
  for (const auto& [type, hash] : std::map<std::string, std::string>{
           {"culprit_msgs/msg/Component",
            "085a9a2d7e8d2a7ef9cc43ef693a297cb41d2b847125ffb09848bf9f47ab7ae4"},
           {"culprit_msgs/msg/Decision",
            "898188a7b280dcb25e8d960233c49167143792cee8666f580c3e58b76db1f30b"},
           {"culprit_msgs/msg/Incident",
            "4efb1fc592b7a91e67b3b461a6f9bad748e457ac24be2a8bad2f3eff3a340de4"},
           {"culprit_msgs/msg/Status",
            "429820b7f5bc986cb9d4517c1d346980bc5996cd4069e8420a927292c829f656"},
           {"culprit_msgs/msg/Strategy",
            "f9cc4c921439475a98d064903d1e38db33afbf4d1a0058b33cc5eff5b4b9dc08"},
           {"culprit_msgs/srv/Approve",
            "b23a22b010abad5735bf167eb0588dbdd96161606222bfdc1983d609cb9bb595"},
           {"culprit_msgs/srv/Approve_Request",
            "1fa47cf0f5d738e6edba521abcaeed5bb33eb667af3bc2f8413b2e6fabce47f4"},
           {"culprit_msgs/srv/Approve_Response",
            "fd34482ad5f46b9908d8f68f54d952134b03514dfb89137f435848773e80bbbc"},
           {"culprit_msgs/srv/Pause",
            "f29e0777ad2bb21ca8066c780959358db02e91f6bdc97de74f9ae853ea7b30eb"},
           {"culprit_msgs/srv/Pause_Request",
            "fc21161982fb0db325c32183c0ac99d374bc62fe04f16778bcd62b80cdae9764"},
           {"culprit_msgs/srv/Pause_Response",
            "a966054361c6bfc90013e2156af8ce068520e84eea3ab949404e93c03a129c17"},
           {"culprit_msgs/srv/Resume",
            "cfb3d8e7e7f1411d01ffc59daf6eb66fe34b69df6182e552fc1c2d50f0ff9789"},
           {"culprit_msgs/srv/Resume_Request",
            "35af06165f6e77b1167bc6a6817068c351b5f80c61a96fd16d8fb0578d71dd8c"},
           {"culprit_msgs/srv/Resume_Response",
            "848c10b7dc79827c7aec8d4304bcf565fe9fae10620c4fef4864cac08db0c272"},
           {"culprit_msgs/srv/RunStrategy",
            "bd06a9b1a841eb70c5625aa82799758984d5f25fad1898f66d9072e129764839"},
           {"culprit_msgs/srv/RunStrategy_Request",
            "e8593c89fb1a5ed2184399d3db3477192dd97afd379310178b32da26e876e6a2"},
           {"culprit_msgs/srv/RunStrategy_Response",
            "de456a258980467d22688aeb7e85dc3bd2e896fc3ddd88f40bc72de2ade42707"},
           {"culprit_msgs/srv/Silence",
            "7c02ed7b5d3ed0d852bbd5b85fdd75b2e2ea3027c42ae134ec654adc3c5b8946"},
           {"culprit_msgs/srv/Silence_Request",
            "73def13f1def9db944f287f6bfbc646a756a6fe4b469e38c184db78b44b113e7"},
           {"culprit_msgs/srv/Silence_Response",
            "32c70536dd7defa83a38690a13b5fe95bf01d9710d66c6cc95adf3aa1d7ca6ae"}}) {
    EXPECT_EQ(types.message(type).hash, "RIHS01_" + hash) << type;
  }
  EXPECT_EQ(types.service("culprit_msgs/srv/Pause").hash,
            types.message("culprit_msgs/srv/Pause").hash);
}

TEST(CulpritTypes, HaveTheConstantsOfTheirFiles) {
  const CulpritTypes types;
  EXPECT_EQ(types.constant("culprit_msgs/msg/Component", "HEALTH_OK"), 0);
  EXPECT_EQ(types.constant("culprit_msgs/msg/Component", "HEALTH_EXHAUSTED"), 4);
  EXPECT_EQ(types.constant("culprit_msgs/msg/Decision", "KIND_EXHAUSTED"), 10);
}

TEST(CulpritTypes, AreDescribedToAClientByTheirHash) {
  const CulpritTypes types;
  const MessageType& status = types.message("culprit_msgs/msg/Status");
  const auto told = types.described({status.name, status.hash, true});
  ASSERT_TRUE(told.successful) << told.failure_reason;
  const auto definitions = ros2::to_definitions(told.type_description);
  ASSERT_TRUE(definitions) << definitions.error();
  EXPECT_EQ(ros2::type_hash(status.name, *definitions), status.hash);
  EXPECT_EQ(told.type_sources.size(), 4u) << "Status, Component, Incident and Strategy";
  EXPECT_FALSE(types.described({status.name, "RIHS01_" + std::string(64, '0'), false}).successful);
  EXPECT_FALSE(types.described({"std_msgs/msg/String", status.hash, false}).successful);
}

std::string text_of_file(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

// The topics and fields in packaging/monitoring/foxglove.json must exist.
TEST(CulpritTypes, HaveWhatTheLayoutForFoxgloveShows) {
  const std::string layout = text_of_file("packaging/monitoring/foxglove.json");
  const std::map<std::string, std::string> types = {
      {"status", "Status"}, {"incidents", "Incident"}, {"decisions", "Decision"}};
  std::set<std::string> shown;
  const std::regex path("\"/culprit/([a-z]+)(\\.([a-z_]+))?(\\[:\\])?\"");
  for (std::sregex_iterator i(layout.begin(), layout.end(), path), end; i != end; ++i) {
    const std::string topic = (*i)[1], field = (*i)[3];
    ASSERT_TRUE(types.contains(topic)) << i->str();
    shown.insert(topic);
    if (field.empty()) continue;
    const std::string message = text_of_file("ros/culprit_msgs/msg/" + types.at(topic) + ".msg");
    EXPECT_TRUE(std::regex_search(message, std::regex("\n[A-Za-z0-9_/\\[\\]]+ " + field + "\\b")))
        << i->str();
  }
  EXPECT_EQ(shown.size(), types.size());
}

}  // namespace
}  // namespace culprit::ros_api

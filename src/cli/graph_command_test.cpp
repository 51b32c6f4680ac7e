// culprit graph RULES: what a rule file says of its robot.
#include <filesystem>
#include <fstream>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/commands.h"
#include "cli/test_command.h"
#include "json/json.h"

namespace culprit::cli {
namespace {

using testing::HasSubstr;

constexpr const char* kRover = R"(COMPONENT lidar NODE /lidar
COMPONENT slam  NODE /slam
DEPENDENCY slam ON lidar
SIGNAL mode PARAMETER lidar mode
RULE NoScan
  POLICIES ERROR
  TRIGGER age(/scan) > 1s && mode == "fast" && alive(slam)
    STRATEGY again 90 10
      ADAPTATION lidar restart 10
RULE Tilted
  POLICIES WARNING
  TRIGGER tilt > 3
    STRATEGY level 50 10
      ADAPTATION arm set_parameter level true 5
      ADAPTATION slam restart 5
)";

struct GraphOfRules : testing::Test {
  // Gives the exit code; what was printed is in `out` and `err`.
  int graph(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "graph");
    CommandEnd end = end_of_command(add_graph, std::move(arguments));
    out = std::move(end.out);
    err = std::move(end.err);
    return end.exit_code;
  }
  std::string file(const std::string& name, const std::string& text) {
    const std::string path = testing::TempDir() + "graph_command_test_" + name + ".rules";
    std::ofstream(path, std::ios::binary) << text;
    return path;
  }

  std::string out;
  std::string err;
};

TEST_F(GraphOfRules, IsOfComponentsDependenciesAndRules) {
  ASSERT_EQ(graph({file("rover", kRover)}), kOk) << err;
  EXPECT_EQ(out,
            "lidar  (/lidar)\n"
            "slam  (/slam)\n"
            "  needs lidar\n"
            "arm\n"
            "NoScan  (ERROR)\n"
            "  looks at lidar, slam\n"
            "  adapts lidar\n"
            "  may spread to slam\n"
            "Tilted  (WARNING)\n"
            "  adapts slam, arm\n");
}

TEST_F(GraphOfRules, AsDataSaysWhereEachIsWritten) {
  const std::string path = file("rover", kRover);
  ASSERT_EQ(graph({path, "--json"}), kOk) << err;
  const auto json = parse_json(out);
  EXPECT_EQ(json["components"][1], Json({{"name", "slam"},
                                         {"node", "/slam"},
                                         {"declared", true},
                                         {"file", path},
                                         {"line", 2},
                                         {"column", 11}}));
  const auto& arm = json["components"][2];
  EXPECT_EQ(arm["declared"], false);
  EXPECT_EQ(arm["line"], 14) << "where it is named first";
  EXPECT_EQ(json["dependencies"], parse_json(R"([{"consumer": "slam", "producer": "lidar"}])"));
  EXPECT_EQ(json["rules"][0]["line"], 5);
  EXPECT_EQ(json["rules"][0]["reads"], Json({"lidar", "slam"}));
  EXPECT_EQ(json["rules"][1]["adapts"], Json({"slam", "arm"}));
  EXPECT_EQ(json["rules"][1]["criticality"], "WARNING");
}

TEST_F(GraphOfRules, LeadsToTheFileThatIsIncludedAndToWhereATemplateIsUsed) {
  const std::string included = file("included", "COMPONENT base NODE /base\n");
  const std::string name = std::filesystem::path(included).filename();
  const std::string path = file("including", "INCLUDE \"" + name +
                                                 "\"\nTEMPLATE driver(name)\n"
                                                 "COMPONENT {name} NODE /{name}\nEND\n"
                                                 "USE driver(camera)\n");
  ASSERT_EQ(graph({path, "--json"}), kOk) << err;
  const auto json = parse_json(out);
  ASSERT_EQ(json["components"].size(), 2u);
  EXPECT_EQ(json["components"][0]["file"], included);
  EXPECT_EQ(json["components"][0]["line"], 1);
  EXPECT_EQ(json["components"][1]["name"], "camera");
  EXPECT_EQ(json["components"][1]["file"], path);
  EXPECT_EQ(json["components"][1]["line"], 5);
}

TEST_F(GraphOfRules, OfAFileWithMistakesIsWhatTheCheckSays) {
  EXPECT_EQ(graph({file("wrong", "COMPONENT lidar NODE /lidar\nRULE\n"), "--json"}), kFailed);
  EXPECT_EQ(out, "");
  EXPECT_THAT(err, HasSubstr("wrong.rules has errors"));
  EXPECT_THAT(err, HasSubstr("wrong.rules:2:"));
}

TEST_F(GraphOfRules, NeedsNoRobotAndNoEnvironment) {
  setenv("ROS_DOMAIN_ID", "many", 1);
  EXPECT_EQ(graph({"rules/sunset.rules"}), kOk) << err;
  unsetenv("ROS_DOMAIN_ID");
}

// A rule may be called as a component is.
TEST_F(GraphOfRules, IsDrawnByGraphviz) {
  ASSERT_EQ(graph({file("one_name",
                        "COMPONENT lidar NODE /lidar\nRULE lidar\nPOLICIES ERROR\n"
                        "TRIGGER !alive(lidar)\nSTRATEGY s 50 10\n"
                        "ADAPTATION lidar restart 5\n"),
                   "--dot"}),
            kOk)
      << err;
  EXPECT_EQ(out,
            "digraph rules {\n"
            "  rankdir=LR;\n"
            "  \"component lidar\" [shape=box, label=\"lidar\"];\n"
            "  \"rule lidar\" [shape=ellipse, label=\"lidar\"];\n"
            "  \"component lidar\" -> \"rule lidar\" [style=dotted];\n"
            "  \"rule lidar\" -> \"component lidar\" [style=dashed];\n"
            "}\n");
}

}  // namespace
}  // namespace culprit::cli

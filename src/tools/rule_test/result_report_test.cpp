#include "rule_test/result_report.h"

#include <gtest/gtest.h>

#include "base/xml.h"
#include "rule_test/test_suite.h"

namespace culprit::rule_test {
namespace {

TEST(Report, SaysWhatWasExpectedAndWhatHappenedInstead) {
  const Played played = play("AT 2s camera KILLED\nRUN 5s\nEXPECT CameraDead RESOLVED BY 2.3s\n");
  EXPECT_EQ(played.text(), R"(  FAILED  t (5 s)
    x.test:9: EXPECT CameraDead RESOLVED BY 2.3s: it happened later, at 2.520 s
    what happened:
       2.000  camera is lost: killed by signal 9
       2.010  CameraDead detected (ERROR): camera is known to be down, killed by signal 9
       2.010  camera is held responsible for CameraDead: redeploy camera (camera_redeploy, relative cost 1.10)
       2.250  FusionDead detected (ERROR)
       2.250  FusionDead waits: it depends on camera, which may be the cause (CameraDead)
       2.320  camera is there (process 103)
       2.325  redeploy camera: done
       2.520  CameraDead resolved by camera_redeploy after 0.51 s
       2.520  FusionDead cleared without a repair of its own after 0.27 s
)");
}

TEST(Report, TellsAPassedTestInOneLine) {
  EXPECT_EQ(play("RUN 1500ms\nEXPECT NO STRATEGY\n").text(), "  ok      t (1.5 s)\n");
}

TEST(Report, WritesJunit) {
  const std::vector<SuiteReport> suites = {
      {"a.test with a.rules", {{"well", std::chrono::seconds(2), ""}, {"<\"&\">", {}, "a < b\n"}}}};
  EXPECT_EQ(junit(suites), R"(<?xml version="1.0" encoding="UTF-8"?>
<testsuites tests="2" failures="1" errors="0" time="2.000">
  <testsuite name="a.test with a.rules" tests="2" failures="1" errors="0" time="2.000">
    <testcase classname="a.test with a.rules" name="well" time="2.000"/>
    <testcase classname="a.test with a.rules" name="&lt;&quot;&amp;&quot;&gt;" time="0.000">
      <failure message="an expectation was not met">a &lt; b
</failure>
    </testcase>
  </testsuite>
</testsuites>
)");
}

TEST(Xml, KeepsWhatXmlAllowsAndNothingElse) {
  EXPECT_EQ(xml_escaped("grün 漢 😀"), "grün 漢 😀");
  EXPECT_EQ(xml_escaped(std::string("a\x01\x1b\x7f\0b", 6)), "a????b");
  EXPECT_EQ(xml_escaped("\xff"), "?");
  EXPECT_EQ(xml_escaped("\xc3"), "?") << "cut off";
  EXPECT_EQ(xml_escaped("\xc0\xaf"), "??") << "overlong";
  EXPECT_EQ(xml_escaped("\xed\xa0\x80"), "???") << "a surrogate";
  EXPECT_EQ(xml_escaped("\xef\xbf\xbf"), "???") << "U+FFFF";
  EXPECT_EQ(xml_escaped("\xf4\x90\x80\x80"), "????") << "beyond Unicode";
}

}  // namespace
}  // namespace culprit::rule_test

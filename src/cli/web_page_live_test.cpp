// The web app as people use it: Debian's Chromium (its shell without windows) or Firefox at the page of the real program. Skipped
// where there is no such browser, or the program was built without npm.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/environment.h"
#include "terminal/test_program.h"
#include "web/app.h"

namespace culprit::cli {
namespace {

struct WebPage : testing::Test {
  void SetUp() override {
    if (web::app().empty()) GTEST_SKIP() << "built without npm";
  }
  // `name`: chromium, firefox (light), firefox-dark.
  void passes(const std::string& session, const std::string& name = "chromium") {
    const bool is_chromium = name == "chromium";
    if (!std::filesystem::exists(is_chromium ? "/usr/bin/chromium-headless-shell"
                                             : "/usr/bin/firefox-esr"))
      GTEST_SKIP() << "there is no " << name;
    TestProgram browser(
        world, {"env", "CULPRIT_BROWSER=" + name, "node", "ui/tests/" + session,
                (own_folder() / "culprit").string(), std::filesystem::absolute("build/ui").string(),
                world.folder().string()});
    EXPECT_EQ(browser.wait(std::chrono::seconds(280)), 0) << browser.output();
    EXPECT_THAT(browser.output(), testing::HasSubstr("the session passed"));
  }

  TestWorld world;
};

TEST_F(WebPage, ShowsANewcomerWhatIsBrokenAndWhyAndHowItHeals) { passes("newcomer.mjs"); }

// Rules by the form alone: the paper's, a broken file, every row of the grammar, a task of a person's size; and nothing that
// was written is lost.
TEST_F(WebPage, WritesRules) { passes("rules.mjs"); }

TEST_F(WebPage, TellsEveryStateOnEveryScreenWithoutScrolling) { passes("states.mjs"); }

TEST_F(WebPage, IsUsableOnEveryPage) { passes("pages.mjs"); }

TEST_F(WebPage, GoesOnAfterTrouble) { passes("trouble.mjs"); }

// Firefox draws, focuses, types and saves in its own way: every state, every page, and the editor.
TEST_F(WebPage, TellsEveryStateInFirefox) { passes("states.mjs", "firefox"); }

TEST_F(WebPage, IsUsableOnEveryPageInFirefox) { passes("pages.mjs", "firefox-dark"); }

TEST_F(WebPage, WritesRulesInFirefox) { passes("rules.mjs", "firefox"); }

TEST_F(WebPage, RunsStudiesAndDrawsRulesThatAreInOneAnothersWay) { passes("studies.mjs"); }

TEST_F(WebPage, ObeysTheOperatorOfARobot) {
  const TestProgram camera(world, {"sunset-node", "camera"});
  passes("operator.mjs");
}

}  // namespace
}  // namespace culprit::cli

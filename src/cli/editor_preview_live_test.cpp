// The graph of a rule file in the extension for Visual Studio Code: its panel, with the real program behind it, in Debian's
// Chromium in place of the editor. Skipped where there is no Chromium or npm, as the tests of the web app.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/environment.h"
#include "terminal/test_program.h"
#include "web/app.h"

namespace culprit::cli {
namespace {

TEST(EditorPreview, ShowsTheGraphOfARuleFile) {
  if (web::app().empty()) GTEST_SKIP() << "built without npm";
  if (!std::filesystem::exists("/usr/bin/chromium-headless-shell"))
    GTEST_SKIP() << "there is no Chromium";
  TestWorld world;
  TestProgram browser(
      world, {"node", "editors/vscode/tests/graph_panel.mjs", (own_folder() / "culprit").string(),
              std::filesystem::absolute("build/ui").string(), world.folder().string()});
  EXPECT_EQ(browser.wait(std::chrono::seconds(280)), 0) << browser.output();
  EXPECT_THAT(browser.output(), testing::HasSubstr("the session passed"));
}

}  // namespace
}  // namespace culprit::cli

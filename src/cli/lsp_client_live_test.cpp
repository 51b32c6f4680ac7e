// The language server with a client that is not ours: scripted sessions on the library of Visual
// Studio Code. Skipped unless `npm ci` was run in lsp_client.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/environment.h"
#include "terminal/test_program.h"

namespace culprit::cli {
namespace {

constexpr const char* kClient = "src/cli/lsp_client";

struct LspClient : testing::Test {
  void SetUp() override {
    if (!std::filesystem::exists(std::string(kClient) + "/node_modules"))
      GTEST_SKIP() << "npm ci was not run in " << kClient;
  }
  // Plays the session with `culprit lsp` and these options.
  void passes(const std::string& session, const std::vector<std::string>& options) {
    std::vector<std::string> command{"node", std::string(kClient) + "/" + session,
                                     (own_folder() / "culprit").string(), "lsp"};
    command.insert(command.end(), options.begin(), options.end());
    TestProgram client(world, std::move(command));
    EXPECT_EQ(client.wait(), 0);
    EXPECT_THAT(client.output(), testing::HasSubstr("the session passed"));
  }

  TestWorld world;
};

TEST_F(LspClient, WritesARuleFile) { passes("session.mjs", {}); }

TEST_F(LspClient, WritesARuleFileWhileTheRobotRuns) {
  const TestProgram camera(world, {"sunset-node", "camera"});
  passes("robot_session.mjs", {"--robot"});
}

}  // namespace
}  // namespace culprit::cli

// How commands end: the same everywhere, as the manual says.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cli/commands.h"
#include "cli/culprit_manual.h"
#include "terminal/program.h"

namespace culprit::cli {
namespace {

using testing::HasSubstr;

struct EndOfCommand {
  int code = 0;
  std::string said;
};

EndOfCommand end_of(std::vector<std::string> words) {
  words.insert(words.begin(), "culprit");
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  CLI::App app("culprit");
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  const int code = run_program(
      app, [&](int& exit_code) { add_all(app, "test", exit_code); }, static_cast<int>(words.size()),
      argv.data());
  const std::string out = testing::internal::GetCapturedStdout();
  return {code, testing::internal::GetCapturedStderr() + out};
}

std::vector<std::string> all_commands() {
  CLI::App app("culprit");
  int exit_code = 0;
  add_all(app, "test", exit_code);
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

TEST(ExitStatus, IsTwoWhereAnOptionIsNotKnown) {
  const auto commands = all_commands();
  EXPECT_GE(commands.size(), 30u);
  for (const std::string& command : commands) {
    const EndOfCommand end = end_of({command, "--no-such-option"});
    EXPECT_EQ(end.code, kUsage) << command << ": " << end.said;
    EXPECT_THAT(end.said, HasSubstr("--no-such-option")) << command;
  }
}

TEST(ExitStatus, IsOneWhereAFileCannotBeRead) {
  const std::string missing = testing::TempDir() + "no-such-file-at-all";
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"run", missing},
                                             {"check", missing},
                                             {"fmt", missing},
                                             {"test", missing},
                                             {"import", missing},
                                             {"export", "--json", missing},
                                             {"policy", missing},
                                             {"alerts", missing},
                                             {"run", "--alerts", missing, "rules/sunset.rules"},
                                             {"modes", missing},
                                             {"plan", "--state", missing, "rules/sunset.rules"},
                                             {"plan", "--state", missing, missing},
                                             {"log", "--journal", missing},
                                             {"incident", "--journal", missing},
                                             {"incident", "mfx2kk1c", "--journal", missing},
                                             {"explain", "--last", "--journal", missing},
                                             {"beliefs", "show", "--journal", missing},
                                             {"audit", "verify", "--journal", missing},
                                             {"replay", missing}}) {
    const EndOfCommand end = end_of(words);
    EXPECT_EQ(end.code, kFailed) << words[0] << ": " << end.said;
    EXPECT_THAT(end.said, HasSubstr("no-such-file-at-all")) << words[0];
  }
}

TEST(ExitStatus, IsTwoWhereTheEnvironmentMakesNoSense) {
  setenv("ROS_DOMAIN_ID", "many", 1);
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"doctor"},
                                             {"init"},
                                             {"graph"},
                                             {"check", "--robot", "rules/sunset.rules"},
                                             {"plan", "rules/sunset.rules"},
                                             {"plan", "--robot", "rules/sunset.rules"},
                                             {"run", "--no-journal", "rules/sunset.rules"}}) {
    const EndOfCommand end = end_of(words);
    EXPECT_EQ(end.code, kUsage) << words[0] << ": " << end.said;
    EXPECT_THAT(end.said, HasSubstr("ROS_DOMAIN_ID")) << words[0];
  }
  unsetenv("ROS_DOMAIN_ID");
}

// Before anything is watched or read.
TEST(ExitStatus, IsTwoWhereAnOptionMakesNoSense) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> calls = {
      {{"init", "-o", "no-such-folder-at-all/my.rules"}, "no-such-folder-at-all' to write"},
      {{"run", "--journal", "src", "rules/sunset.rules"}, "'src' is a folder"},
      {{"run", "--state-dir", "Makefile", "rules/sunset.rules"}, "'Makefile' is a file"},
      {{"run", "--record-folder", "Makefile", "rules/sunset.rules"}, "'Makefile' is a file"},
      {{"run", "--address", "localhost:8080", "rules/sunset.rules"}, "--port 8080"},
      {{"drill", "--state-dir", "Makefile", "rules/sunset.rules"}, "'Makefile' is a file"},
      {{"log", "--since", "-1h"}, "'-1h' is negative"},
      {{"silence", "off"}, "write mute NAME --lift"},
      {{"silence", "camera", "off"}, "write mute camera --lift"},
      {{"incident", "--last"}, "incident without an ID lists all"},
      {{"doctor", "--fix"}, "doctor changes nothing"},
      {{"explain", "E012"}, "did you mean 'R012'?"},
      {{"run", "--record-topics", "--print-config", "rules/sunset.rules"},
       "--record-topics needs a value: TOPIC ...; '--print-config' stands in its place"},
      {{"explain", "--last", "--terms"}, "exclude each other"}};
  for (const auto& [words, cause] : calls) {
    const EndOfCommand end = end_of(words);
    EXPECT_EQ(end.code, kUsage) << words[0] << ": " << end.said;
    EXPECT_THAT(end.said, HasSubstr(cause)) << words[0];
  }
}

TEST(ExitStatus, IsOneWhereNoCulpritAnswers) {
  const std::string nobody = "231";  // a domain that nobody can use
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{"status"},
                                             {"pause"},
                                             {"pause", "--all"},
                                             {"resume"},
                                             {"mute", "camera"},
                                             {"silence", "camera"},
                                             {"approve", "R.s"},
                                             {"refuse", "R.s"},
                                             {"run-strategy", "R.s"},
                                             {"revive"}}) {
    std::vector<std::string> with_domain = words;
    with_domain.insert(with_domain.end(), {"--domain", nobody});
    const EndOfCommand end = end_of(with_domain);
    EXPECT_EQ(end.code, kFailed) << words[0];
    EXPECT_THAT(end.said, HasSubstr("no culprit on this machine answers")) << words[0];
  }
}

// Options that programs read have one spelling.
TEST(JsonOption, IsSpeltTheSameEverywhere) {
  CLI::App app("culprit");
  int exit_code = 0;
  add_all(app, "test", exit_code);
  for (const char* name :
       {"run", "check", "doctor", "explain", "test", "plan", "graph", "status", "pause", "resume",
        "mute", "approve", "refuse", "run-strategy", "revive", "alerts", "export", "log", "replay"})
    EXPECT_NE(app.get_subcommand(name)->get_option_no_throw("--json"), nullptr) << name;
  EXPECT_NE(app.get_subcommand("beliefs")->get_subcommand("show")->get_option_no_throw("--json"),
            nullptr);
  EXPECT_NE(app.get_subcommand("audit")->get_subcommand("verify")->get_option_no_throw("--json"),
            nullptr);
}

TEST(Manual, HasEachCommandUnderAHeading) {
  CLI::App app("culprit");
  int exit_code = 0;
  add_all(app, "test", exit_code);
  for (const CLI::App* command : app.get_subcommands({})) {
    if (command->get_group().empty()) continue;
    EXPECT_NE(command->get_group(), "Subcommands") << command->get_name();
    EXPECT_THAT(as_markdown(app, culprit_manual()), HasSubstr("culprit " + command->get_name()));
  }
}

TEST(Manual, LetsNoTextBeTakenForARequest) {
  CLI::App app("x");
  app.add_subcommand("go", ".so /etc/passwd\n'back \\fBslash -- -x")->group("All");
  const std::string page = as_man_page(app, {.name = "x", .purpose = "y"});
  EXPECT_THAT(page, HasSubstr("\n\\&.so /etc/passwd\n.br\n\\&'back \\efBslash \\-\\- \\-x\n"));
}

}  // namespace
}  // namespace culprit::cli

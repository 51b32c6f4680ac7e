#include "terminal/program.h"

#include <cstdio>
#include <unistd.h>

#include "terminal/command.h"
#include "terminal/help.h"
#include "terminal/seconds_option.h"

namespace culprit {
namespace {

using testing::HasSubstr;

struct Ended {
  int code = 0;
  std::string said;
};

// A program with the commands `check --robot --wait` and `test`.
Ended ended(std::vector<std::string> words) {
  words.insert(words.begin(), "culprit");
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  CLI::App app("culprit");
  bool robot = false;
  double wait = 3;
  testing::internal::CaptureStderr();
  const int code = run_program(
      app,
      [&](int&) {
        CLI::App* check = app.add_subcommand("check", "Check");
        check->add_flag("--robot", robot, "Against the robot");
        add_seconds(*check, "--wait", wait, "How long", 0.5, 60);
        check->callback([&] { std::fprintf(stderr, "waits %.3f", wait); });
        app.add_subcommand("test", "Test");
      },
      static_cast<int>(words.size()), argv.data());
  return {code, testing::internal::GetCapturedStderr()};
}

TEST(Program, SaysWhichCommandWasMeant) {
  const Ended end = ended({"chekc"});
  EXPECT_EQ(end.code, kUsage);
  EXPECT_THAT(end.said, HasSubstr("there is no command 'chekc'; did you mean 'check'?"));
  EXPECT_THAT(ended({"quite-another"}).said, HasSubstr("there is no command 'quite-another'\n"));
}

TEST(Program, SaysWhichOptionWasMeant) {
  const Ended end = ended({"check", "--robto"});
  EXPECT_EQ(end.code, kUsage);
  EXPECT_THAT(end.said, HasSubstr("check has no option '--robto'; did you mean '--robot'?"));
}

TEST(Program, AloneShowsItsCommands) {
  const Ended end = ended({});
  EXPECT_EQ(end.code, kUsage);
  EXPECT_THAT(end.said, HasSubstr("check"));
}

TEST(Program, EndsAtOnceWithAllThatItSaid) {
  const auto end = [] {
    dup2(STDERR_FILENO, STDOUT_FILENO);
    std::fputs("as said", stdout);
    end_program(kFailed);
  };
  EXPECT_EXIT(end(), testing::ExitedWithCode(kFailed), "as said");
}

TEST(Help, HasLinesThatFit) {
  EXPECT_EQ(wrapped("one two three", 7), "one two\nthree");
  EXPECT_EQ(wrapped("a line\nand another", 80), "a line\nand another");
  EXPECT_EQ(wrapped("a-word-that-is-too-long", 5), "a-word-that-is-too-long");
  EXPECT_EQ(wrapped("", 5), "");
}

TEST(SecondsOption, TakesUnitsOrSeconds) {
  EXPECT_EQ(ended({"check"}).said, "waits 3.000");
  EXPECT_EQ(ended({"check", "--wait", "8"}).said, "waits 8.000");
  EXPECT_EQ(ended({"check", "--wait", "8s"}).said, "waits 8.000");
  EXPECT_EQ(ended({"check", "--wait=750ms"}).said, "waits 0.750");
  EXPECT_EQ(ended({"check", "--wait", "0.5min"}).said, "waits 30.000");
}

TEST(SecondsOption, SaysWhatIsWrong) {
  EXPECT_THAT(ended({"check", "--wait", "2min"}).said, HasSubstr("is not from 500ms to 1min"));
  EXPECT_THAT(ended({"check", "--wait", "soon"}).said, HasSubstr("--wait: "));
  EXPECT_EQ(ended({"check", "--wait", "nan"}).code, kUsage);
  EXPECT_EQ(ended({"check", "--wait", "-1"}).code, kUsage);
  EXPECT_EQ(ended({"check", "--wait", "1e400"}).code, kUsage);
}

}  // namespace
}  // namespace culprit

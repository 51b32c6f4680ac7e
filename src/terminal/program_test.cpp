#include "terminal/program.h"

#include <cstdio>
#include <unistd.h>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "terminal/command.h"
#include "terminal/help.h"
#include "terminal/manual.h"
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
  int port = 1;
  std::string format, file;
  std::vector<std::string> pair, files;
  testing::internal::CaptureStderr();
  const int ended_with = run_program(
      app,
      [&](int& code) {
        CLI::App* check = app.add_subcommand("check", "Check");
        check->add_flag("--robot", robot, "Against the robot");
        add_seconds(*check, "--wait", wait, "How long", 0.5, 60);
        check->callback([&] { std::fprintf(stderr, "waits %.3f", wait); });
        check->add_option("--format", format, "How")->check(CLI::IsMember({"text", "json"}));
        check->add_option("--port", port, "Where")->check(CLI::Range(1, 9));
        check->add_option("--pair", pair, "Two")->expected(2);
        check->add_option("FILE", file, "A file");
        CLI::App* test = app.add_subcommand("test", "Test");
        test->add_flag("--verbose", robot, "All");
        test->add_option("FILES", files, "Files")->required();
        add_seconds(*test, "--for", wait, "How long", 0.5, 60);
        CLI::App* beliefs = app.add_subcommand("beliefs", "Beliefs")->require_subcommand(1);
        CLI::App* show = beliefs->add_subcommand("show", "Show");
        show->add_flag("--verbose", robot, "All");
        show->callback([] {});
        CLI::App* note = app.add_subcommand("note", "Note");
        note->add_option("--reason", format, "Why");
        note->add_option("--lines", port, "How many");
        note->add_option("--since", format, "Since")->type_name("DURATION");
        note->add_option("--journal", file, "Where");
        note->add_option("--file", file, "What")->check(CLI::ExistingFile);
        note->add_option("--topics", files, "Which");
        note->add_option("--limit-per", format, "How often");
        note->add_option("--disk", port, "How much")->type_name("SIZE");
        note->add_flag("--lift", robot, "Ends it");
        note->callback([&code] { code = fail("the note is empty", kUsage); });
        app.add_subcommand("end-all", "End")->callback([] {});
        app.add_subcommand("mute", "Mute")->callback([] {});
        add_help(app, code);
      },
      static_cast<int>(words.size()), argv.data());
  return {ended_with, testing::internal::GetCapturedStderr()};
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

TEST(Program, SaysHowACommandIsCalled) {
  EXPECT_THAT(
      ended({"test"}).said,
      HasSubstr("FILES is missing (files)\nUsage: culprit test [OPTIONS] FILES ...\nRun 'culprit "
                "help test' for more information."));
}

TEST(Program, ExplainsEachKindOfMistakeInOneLine) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> mistakes = {
      {{"check", "-x"}, "'-x'; it has --robot, --wait, --format, --port, --pair\n"},
      {{"check", "--verbose"}, "'--verbose'; did you mean 'culprit test --verbose'?\n"},
      {{"check", "-robot"}, "check has no option '-robot'; did you mean '--robot'?\n"},
      {{"check", "--no-robot"}, "check has no option '--no-robot'; leave --robot out\n"},
      {{"check", "--web-port", "3"}, "'--web-port'; did you mean '--port'?\n"},
      {{"check", "a", "--", "--robot"},
       "'--robot' stands behind '--', so it is an argument; remove the '--'\n"},
      {{"--check"}, "there is no option '--check'; did you mean 'check'?\n"},
      {{"my.rules"}, "there is no command 'my.rules'; did you mean 'culprit run my.rules'?\n"},
      {{"version"}, "there is no command 'version'; did you mean '--version'?\n"},
      {{"bag", "check"}, "there is no command 'bag'\n"},
      {{"check", "a", "b"}, "'b' is one argument too many"},
      {{"check", "--format", "json", "--format", "text"},
       "--format is given more than once; give it once\n"},
      {{"check", "--domain", "3"}, "check has no option '--domain'; set ROS_DOMAIN_ID"},
      {{"check", "--format", "jsn"}, "'jsn' is none of text, json; did you mean 'json'?\n"},
      {{"check", "--port", "12"}, "--port: '12' is no number from 1 to 9\n"},
      {{"check", "--port", "abc"}, "--port: 'abc' is no number from 1 to 9\n"},
      {{"check", "--format"}, "--format needs a value: {text,json}\n"},
      {{"check", "--robot", "a", "5"}, "'5' is one argument too many; FILE is 'a' already\n"},
      {{"check", "a", "--robot", "5"}, "'5' is one argument too many; --robot takes no value\n"},
      {{"check", "a", "--wait", "5", "minutes"},
       "--wait: a duration is one word; write --wait 5min\n"},
      {{"check", "--wait=5", "s", "a"}, "--wait: a duration is one word; write --wait 5s\n"},
      {{"check", "a", "two words"}, "'two words' is one argument too many"},
      {{"test", "a", "--for", "3", "s"}, "--for: a duration is one word; write --for 3s\n"},
      {{"test", "a", "--for", "1d"}, "--for: 24h is not from 500ms to 1min\n"},
      {{"test", "a", "--for", "10y"}, "--for: '10y' is not a duration; write a number and a unit"},
      {{"note", "--limit", "3"}, "note has no option '--limit'; did you mean '--lines'?\n"},
      {{"note", "--since", "5", "minutes"},
       "--since: a duration is one word; write --since 5min\n"},
      {{"note", "--since", "5", "days"}, "--since: a duration is one word; write --since 5d\n"},
      {{"note", "3"}, "'3' is one argument too many; did you mean --lines 3?\n"},
      {{"note", "a.journal"}, "did you mean --journal 'a.journal'?\n"},
      {{"check", "--werror", "a"}, "check has no option '--werror'; write --fail-on warning\n"},
      {{"note", "--file", "none"}, "--file: there is no file 'none'\n"},
      {{"check", "\u2013\u2013robot", "a", "b"}, "typographic dash; write --robot\n"},
      {{"help", "check", "robot"},
       "check has no command 'robot'; culprit help check lists its options"},
      {{"check", "--robot=5"}, "--robot takes no value; remove '=5'\n"},
      {{"check", "--robot", "true", "a"}, "--robot takes no value; remove 'true'\n"},
      {{"check", "\u2014robot", "a", "b"}, "typographic dash; write --robot\n"},
      {{"check", "robot:=true", "a"}, "'robot:=true' is an argument of ROS; write --robot\n"},
      {{"check", "-r", "a:=b"}, "'-r'; leave it out, for culprit takes no arguments of ROS"},
      {{"help", "beliefs", "list"}, "beliefs has no command 'list'; it has show\n"},
      {{"check", "--seconds", "3"}, "check has no option '--seconds'; did you mean '--wait'?\n"},
      {{"--robot", "check"}, "'--robot' stands in front of the command; write it behind check\n"},
      {{"end"}, "there is no command 'end'; did you mean 'end-all'?\n"},
      {{"culprit", "check"}, "there is no command 'culprit'; write 'culprit' once\n"},
      {{"note", "-f", "a"}, "note has no option '-f'"},
      {{"check", "--pair", "a", "b", "--pair", "c", "d"}, "--pair takes at most 2 values\n"},
      {{"test", "--timeout", "3", "a"}, "did you mean '--for'?\n"},
      {{"lint"}, "there is no command 'lint'; did you mean 'check'?\n"},
      {{"note", "hello"}, "'hello' is one argument too many; note takes no arguments\n"},
      {{"note", "it is hot"}, "; did you mean --reason 'it is hot'?\n"},
      {{"check", "--pair", "a"}, "--pair needs at least 2 values\n"},
      {{"beliefs"}, "beliefs needs a command: show\n"},
      {{"beliefs", "shwo"}, "beliefs has no command 'shwo'; did you mean 'show'?\n"},
      {{"beliefs", "all"}, "beliefs has no command 'all'; it has show\n"},
      {{"beliefs", "--verbose"}, "beliefs has no option '--verbose'; it stands behind show\n"},
      {{"check", "--file", "a"}, "check has no option '--file'; write FILE without it\n"},
      {{"CHECK"}, "there is no command 'CHECK'; did you mean 'check'?\n"},
      {{"-v"}, "there is no option '-v'; did you mean '--version'?\n"},
      {{"--verison"}, "there is no option '--verison'\n"},
      {{"help", "chekc"}, "there is no command 'chekc'; did you mean 'check'?\n"},
      {{"note", "--topics", "--lift"}, "--topics needs a value: TEXT ...; '--lift' stands in"},
      {{"note", "--journal", "--lines=3"}, "--journal needs a value; '--lines=3' stands in its"},
      {{"note", "--journal", "--nothing"}, "--journal needs a value; '--nothing' stands in its"},
      {{"beliefs", "show", "--for", "3", "s"}, "show has no option '--for'"},
      {{"note", "--disk", "5", "GB"}, "--disk: a size is one word; write --disk 5GB\n"},
      {{"note", "--limit-per", "20", "per", "hour"},
       "--limit-per: this value is one word; write --limit-per 20/1h\n"},
      {{"note", "off"}, "'off' is one argument too many; write note NAME --lift\n"},
      {{"check", "-r", "a"}, "check has no option '-r'; did you mean '--robot'?\n"},
      {{"unsilence"}, "there is no command 'unsilence'; did you mean 'mute NAME --lift'?\n"},
      {{"check", "--output", "a"}, "check has no option '--output'; write > FILE behind the"}};
  for (const auto& [words, cause] : mistakes) {
    const Ended end = ended(words);
    EXPECT_EQ(end.code, kUsage) << cause;
    EXPECT_THAT(end.said, HasSubstr(cause));
  }
}

TEST(Program, TakesAValueThatBeginsWithADashIfItIsNoOption) {
  EXPECT_THAT(ended({"note", "--reason", "-5 degrees"}).said, HasSubstr("the note is empty"));
  EXPECT_THAT(ended({"note", "--reason", "--no sign of life"}).said,
              HasSubstr("the note is empty"));
  EXPECT_THAT(ended({"note", "--reason=--lift"}).said, HasSubstr("the note is empty"));
}

TEST(Program, SaysHowACommandIsCalledThatFindsTheMistakeItself) {
  const Ended end = ended({"note"});
  EXPECT_EQ(end.code, kUsage);
  EXPECT_THAT(end.said, HasSubstr("the note is empty\nUsage: culprit note [OPTIONS]\nRun 'culprit "
                                  "help note' for more information."));
}

TEST(Program, ShowsTheHelpOfACommand) {
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"help", "test"}, {"--help", "test"}, {"test", "--help"}}) {
    testing::internal::CaptureStdout();
    EXPECT_EQ(ended(words).code, kOk);
    EXPECT_THAT(testing::internal::GetCapturedStdout(),
                HasSubstr("Usage: culprit test [OPTIONS] FILES"));
  }
}

TEST(Manual, HasAPageForEachCommand) {
  bool is_strict = false;
  CLI::App app("culprit");
  app.add_subcommand("check", "Check rule files\nAll of them")
      ->add_flag("--strict", is_strict, "Every component must be declared");
  const Manual manual{.name = "culprit",
                      .purpose = "keep robots working",
                      .examples = {{"culprit check my.rules", "One file."},
                                   {"culprit checks", "Another command."}}};
  const std::string page = as_man_page_of(*app.get_subcommand("check"), manual);
  EXPECT_THAT(page, HasSubstr(".TH CULPRIT-CHECK 1"));
  EXPECT_THAT(page, HasSubstr(".SH NAME\nculprit\\-check \\- Check rule files\n"));
  EXPECT_THAT(page, HasSubstr(".B culprit check [OPTIONS]"));
  EXPECT_THAT(page, HasSubstr(".B \\-\\-strict\nEvery component"));
  EXPECT_THAT(page, HasSubstr("culprit check my.rules"));
  EXPECT_EQ(page.find("Another command"), std::string::npos);
  EXPECT_THAT(page, HasSubstr("culprit(1)"));
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
  EXPECT_THAT(ended({"check", "--wait", "-5min"}).said, HasSubstr("--wait: -5min is not from"));
  EXPECT_EQ(ended({"check", "--wait", "nan"}).code, kUsage);
  EXPECT_EQ(ended({"check", "--wait", "-1"}).code, kUsage);
  EXPECT_EQ(ended({"check", "--wait", "1e400"}).code, kUsage);
}

}  // namespace
}  // namespace culprit

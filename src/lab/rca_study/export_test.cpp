#include "rca_study/export.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/text_file.h"
#include "json/json.h"
#include "language/checker.h"

namespace culprit::study::rca {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;
using Files = std::map<std::string, std::string>;

RcaSetting noisy(std::size_t components, std::size_t faults) {
  RcaSetting setting;
  setting.components = components;
  setting.faults = faults;
  setting.factors.detector_latency_s = {0, 3};
  setting.factors.unwatched = 0.2;
  setting.factors.hidden = 0.1;
  setting.factors.false_alarms = 0.5;
  return setting;
}

CaseExport small_set() {
  CaseExport wanted;
  wanted.settings = {noisy(12, 1), noisy(14, 2)};
  wanted.cases = 4;
  wanted.hidden_cases = 2;
  wanted.seed = 7;
  wanted.hidden_seed = 987654321987;
  wanted.command = "made by a test";
  return wanted;
}

Files files_of(const CaseExport& wanted) {
  Files files;
  const auto written = export_cases(
      wanted,
      [&](const std::string& path, const std::string& text) -> Expected<void> {
        EXPECT_TRUE(files.emplace(path, text).second) << path;
        return {};
      },
      nullptr);
  EXPECT_TRUE(written) << written.error();
  return files;
}

const Files& small_files() {
  static const Files files = files_of(small_set());
  return files;
}

std::vector<std::vector<std::string>> rows_of(const std::string& csv) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(csv);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream cells(line);
    auto& row = rows.emplace_back();
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(cell);
  }
  return rows;
}

TEST(ExportedCases, AreCompleteAndFitTogether) {
  const Files& files = small_files();
  EXPECT_EQ(files.size(), 2 + 4 * 5 + 2 * 4 + 1 + 2 * 3);
  EXPECT_THAT(files.at("README.md"), HasSubstr("made by a test"));
  for (const std::string folder : {"public/case-0001/", "public/case-0004/", "hidden/case-0002/"}) {
    const Json graph = parse_strict_json(files.at(folder + "graph.json"));
    ASSERT_FALSE(graph.is_discarded());
    std::vector<std::string> columns = {"time_s"};
    std::set<std::string> names;
    for (const Json& component : graph["components"]) {
      names.insert(component["name"]);
      if (component["watched"]) columns.push_back(component["name"]);
    }
    for (const Json& topic : graph["topics"]) {
      for (const char* ends : {"publishers", "subscribers"}) {
        for (const std::string name : topic[ends]) EXPECT_TRUE(names.contains(name)) << name;
      }
    }
    const auto rows = rows_of(files.at(folder + "signals.csv"));
    EXPECT_EQ(rows.front(), columns);
    EXPECT_GT(rows.size(), 60U);
    for (const auto& row : rows) EXPECT_EQ(row.size(), columns.size());
    const Checked checked = check(Source("robot.rules", files.at(folder + "robot.rules")));
    EXPECT_TRUE(checked.rules) << folder;
  }
}

TEST(ExportedCases, HaveAnEffectOfEachFaultThatTheSignalsShow) {
  const Files& files = small_files();
  for (const std::string name : {"case-0001", "case-0002", "case-0003", "case-0004"}) {
    const Json truth = parse_strict_json(files.at("public/" + name + "/truth.json"));
    const auto rows = rows_of(files.at("public/" + name + "/signals.csv"));
    const auto shows = [&](const std::string& component) {
      const auto column = std::find(rows[0].begin(), rows[0].end(), component) - rows[0].begin();
      return std::any_of(rows.begin() + 1, rows.end(), [&](const auto& row) {
        return std::size_t(column) < row.size() && row[std::size_t(column)] == "1";
      });
    };
    ASSERT_FALSE(truth["causes"].empty());
    for (const Json& cause : truth["causes"]) {
      EXPECT_TRUE(shows(cause["component"])) << name;
      EXPECT_FALSE(cause["repairs"].empty()) << name;
      EXPECT_TRUE(std::any_of(truth["effects"].begin(), truth["effects"].end(),
                              [&](const Json& effect) {
                                const auto& causes = effect["causes"];
                                return shows(effect["component"]) &&
                                       std::find(causes.begin(), causes.end(),
                                                 cause["component"]) != causes.end();
                              }))
          << name;
    }
  }
}

// Also for a cause that still waits for another one, which nobody repairs.
TEST(ExportedCases, HaveARepairForEachCauseThatBayesNames) {
  const Json answers = parse_strict_json(small_files().at("answers-bayes.json"));
  for (const auto& [name, answer] : answers.items()) {
    for (const Json& cause : answer["causes"]) {
      EXPECT_TRUE(std::ranges::any_of(
          answer["repairs"], [&](const Json& repair) { return repair["component"] == cause; }))
          << name << " " << cause;
    }
  }
}

TEST(ExportedCases, AreTheSameEachTime) {
  EXPECT_EQ(files_of(small_set()), small_files());
  CaseExport other = small_set();
  other.hidden_seed = 5;
  const Files files = files_of(other);
  EXPECT_EQ(files.at("public/case-0004/signals.csv"),
            small_files().at("public/case-0004/signals.csv"));
  EXPECT_NE(files.at("hidden/case-0001/signals.csv"),
            small_files().at("hidden/case-0001/signals.csv"));
}

TEST(ExportedCases, KeepTheTruthOfHiddenOnesOutOfTheirFolder) {
  const Files& files = small_files();
  const Json truths = parse_strict_json(files.at("hidden-truth.json"));
  ASSERT_EQ(truths.size(), 2U);
  for (const auto& [path, text] : files) {
    EXPECT_THAT(text, Not(HasSubstr("987654321987"))) << path;
    if (path.starts_with("hidden-truth")) continue;
    if (path.starts_with("hidden/")) {
      EXPECT_THAT(path, Not(HasSubstr("truth")));
    }
    if (!path.starts_with("hidden")) continue;
    for (const Json& truth : truths) {
      for (const Json& cause : truth["causes"])
        EXPECT_THAT(text, Not(HasSubstr(to_line(cause["at_s"])))) << path;
    }
  }
  const auto exit = rows_of(files.at("hidden/case-0001/events.csv"));
  EXPECT_THAT(exit.front(), testing::ElementsAre("time_s", "component", "event"));
}

// Exemplars and the like: their hidden cases are as well hidden as those of random robots.
TEST(ExportedCases, OfOtherRobotsHaveAHiddenSplitToo) {
  const auto made_from = [](std::uint64_t seed) {
    for (;; ++seed) {
      auto made = case_of(generate(noisy(12, 1), seed), std::vector<std::string>{"bayes"});
      if (made) return std::move(*made);
    }
  };
  CaseExport wanted = small_set();
  wanted.cases = 1;
  wanted.hidden_cases = 1;
  wanted.others = {{"toy", {made_from(1)}}};
  wanted.hidden_others = {{"toy", {made_from(100), made_from(200)}}};
  const Files files = files_of(wanted);
  EXPECT_TRUE(files.contains("toy/case-0001/truth.json"));
  EXPECT_TRUE(files.contains("toy-answers-bayes.json"));
  EXPECT_FALSE(files.contains("toy-truth.json"));
  EXPECT_TRUE(files.contains("hidden-toy/case-0002/signals.csv"));
  EXPECT_FALSE(files.contains("hidden-toy/case-0001/truth.json"));
  EXPECT_EQ(parse_strict_json(files.at("hidden-toy-answers-bayes.json")).size(), 2U);
  const Json truths = parse_strict_json(files.at("hidden-toy-truth.json"));
  ASSERT_EQ(truths.size(), 2U);
  for (const auto& [path, text] : files) {
    if (!path.starts_with("hidden-toy/")) continue;
    for (const Json& truth : truths)
      EXPECT_THAT(text, Not(HasSubstr(to_line(truth["causes"][0]["at_s"])))) << path;
  }
}

TEST(ExportedCases, ShowNoHiddenDependency) {
  CaseExport wanted = small_set();
  for (RcaSetting& setting : wanted.settings) setting.factors.hidden = 1;
  for (const auto& [path, text] : files_of(wanted)) {
    if (!path.ends_with("graph.json")) continue;
    const Json graph = parse_strict_json(text);
    for (const Json& topic : graph["topics"]) EXPECT_TRUE(topic["subscribers"].empty()) << path;
  }
}

TEST(ExportedCases, AreRefusedWhereNoRobotCounts) {
  CaseExport wanted = small_set();
  wanted.settings = {noisy(2, 2)};  // no component is left for an effect
  const auto written = export_cases(
      wanted, [](const std::string&, const std::string&) { return Expected<void>(); }, nullptr);
  ASSERT_FALSE(written);
  EXPECT_THAT(written.error(), HasSubstr("use fewer faults"));
}

TEST(ExportedCases, AreStoppedByAFileThatCannotBeWritten) {
  const auto written = export_cases(
      small_set(),
      [](const std::string& path, const std::string&) -> Expected<void> {
        if (path.ends_with("signals.csv")) return Error{"the disk is full"};
        return {};
      },
      nullptr);
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error(), "the disk is full");
}

// score.py as others run it: in a folder of its own, with nothing of culprit.
class Scorer : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / ("culprit-cases-" + std::to_string(getpid()));
    fs::remove_all(folder_);
    for (const auto& [path, text] : small_files()) {
      fs::create_directories((folder_ / path).parent_path());
      ASSERT_TRUE(write_text((folder_ / path).string(), text));
    }
    if (run("--help").exit_code == 127) GTEST_SKIP() << "python3 is not installed";
  }
  void TearDown() override { fs::remove_all(folder_); }

  struct Said {
    int exit_code = -1;
    std::string text;
  };
  Said run(const std::string& arguments) const {
    const std::string command =
        "cd '" + folder_.string() + "' && python3 -I -B score.py " + arguments + " 2>&1";
    Said said;
    FILE* pipe = popen(command.c_str(), "r");
    if (pipe == nullptr) return said;
    std::array<char, 4096> buffer{};
    while (const std::size_t n = std::fread(buffer.data(), 1, buffer.size(), pipe))
      said.text.append(buffer.data(), n);
    said.exit_code = WEXITSTATUS(pclose(pipe));
    return said;
  }

  Json scores(const std::string& arguments) const {
    const Said said = run(arguments + " --json");
    EXPECT_EQ(said.exit_code, 0) << said.text;
    return parse_json(said.text);
  }

  void answer(const std::string& text) const {
    ASSERT_TRUE(write_text((folder_ / "answers.json").string(), text));
  }

  // The complaint about these answers.
  std::string complaint(const std::string& text) const {
    answer(text);
    const Said said = run("public answers.json");
    EXPECT_EQ(said.exit_code, 2) << said.text;
    EXPECT_THAT(said.text, Not(HasSubstr("Traceback")));
    return said.text;
  }

  // An answer to each public case.
  static Json answers(const Json& each) {
    Json all = Json::object();
    for (int i = 1; i <= 4; ++i) all["case-000" + std::to_string(i)] = each;
    return all;
  }

  fs::path folder_;
};

TEST_F(Scorer, GivesTheTruthEverything) {
  for (const bool is_hidden : {false, true}) {
    Json all = Json::object();
    const Json truths = parse_json(small_files().at("hidden-truth.json"));
    for (int i = 1; i <= (is_hidden ? 2 : 4); ++i) {
      const std::string name = "case-000" + std::to_string(i);
      const Json truth =
          is_hidden ? truths[name] : parse_json(small_files().at("public/" + name + "/truth.json"));
      Json& answer = all[name] = Json::object();
      for (const Json& cause : truth["causes"]) {
        answer["ranked"].push_back(cause["component"]);
        answer["causes"].push_back(cause["component"]);
        answer["repairs"].push_back({{"component", cause["component"]},
                                     {"repair", cause["repairs"][0]},
                                     {"at_s", cause["at_s"]}});
      }
    }
    answer(all.dump());
    const Json score = scores(is_hidden ? "hidden answers.json --truth hidden-truth.json"
                                        : "public answers.json")["answers"];
    EXPECT_EQ(score["cases"], is_hidden ? 2 : 4);
    for (const char* key : {"top1", "top3", "exact", "repaired"}) EXPECT_EQ(score[key], 1.0) << key;
    EXPECT_EQ(score["wrong_components"], 0.0);
    EXPECT_EQ(score["useless_repairs"], 0.0);
    EXPECT_LT(score["repaired_after_s"], 1.0);
  }
}

TEST_F(Scorer, GivesAnEmptyAnswerNothing) {
  answer(answers(Json::object()).dump());
  const Json score = scores("public answers.json")["answers"];
  for (const char* key : {"top1", "top3", "exact", "repaired", "wrong_components"})
    EXPECT_EQ(score[key], 0.0) << key;
  EXPECT_TRUE(score["repaired_after_s"].is_null());
}

TEST_F(Scorer, CountsWrongAndUselessRepairs) {
  const Json truth = parse_json(small_files().at("public/case-0001/truth.json"));
  const Json& cause = truth["causes"][0];
  const auto repair = [](const Json& component, double at_s) {
    return Json{{"component", component}, {"repair", "redeploy"}, {"at_s", at_s}};
  };
  Json all = answers(Json::object());
  all["case-0001"]["repairs"] = {repair(truth["effects"][0]["component"], 1),
                                 repair(cause["component"], 0), repair(cause["component"], 100),
                                 repair(cause["component"], 101)};
  answer(all.dump());
  const Json score = scores("public answers.json")["answers"]["by_case"]["case-0001"];
  EXPECT_EQ(score["wrong_components"], 1);
  EXPECT_EQ(score["useless_repairs"], 2);
  EXPECT_EQ(score["repaired"], 1.0);
  EXPECT_NEAR(score["repaired_after_s"].get<double>(), 100 - cause["at_s"].get<double>(), 1e-6);
}

TEST_F(Scorer, RunsTheSimpleMethodsBesideOurs) {
  const Json both = scores("public answers-bayes.json answers-paper.json --baseline all");
  EXPECT_EQ(both.size(), 8U);
  for (const auto& [name, score] : both.items()) EXPECT_EQ(score["cases"], 4) << name;
  EXPECT_GE(both["answers-bayes"]["top1"], 0.5);
  EXPECT_EQ(both, scores("public answers-bayes.json answers-paper.json --baseline all"));
  EXPECT_THAT(run("hidden hidden-answers-bayes.json --truth hidden-truth.json").text,
              testing::AllOf(HasSubstr("AC@1"),
                             HasSubstr("2 cases: a share is uncertain by up to 69 points (95 %)")));
}

// A cause that flaps, and an effect that follows it in part. Their failures begin together, so only the dependence tells them
// apart.
TEST_F(Scorer, SeparatesAnEffectFromItsCauseByCausalDiscovery) {
  std::string signals = "time_s,effect,zcause\n";
  for (int i = 0; i < 60; ++i) {
    const bool is_cause_ill = i >= 30 && i % 5 != 0;
    const bool is_effect_ill = is_cause_ill && i % 3 != 0;
    signals += fmt::format("{:.1f},{:d},{:d}\n", i * 0.2, is_effect_ill, is_cause_ill);
  }
  const fs::path chain = folder_ / "chain/case-0001";
  fs::create_directories(chain);
  ASSERT_TRUE(write_text((chain / "signals.csv").string(), signals));
  ASSERT_TRUE(write_text((chain / "graph.json").string(),
                         R"({"components": [{"name": "effect", "watched": true},
                                            {"name": "zcause", "watched": true}], "topics": []})"));
  ASSERT_TRUE(write_text((chain / "truth.json").string(),
                         R"({"causes": [{"component": "zcause", "at_s": 6, "repairs": []}]})"));
  const Json found = scores("chain --baseline causal-discovery --baseline first-failing");
  EXPECT_EQ(found["causal-discovery"]["exact"], 1.0);
  EXPECT_EQ(found["first-failing"]["top1"], 0.0);
}

TEST_F(Scorer, RefusesHostileAnswersWithThePlace) {
  EXPECT_THAT(complaint(""), HasSubstr("answers.json: is not JSON"));
  EXPECT_THAT(complaint("[]"), HasSubstr("answers.json: is not an object"));
  EXPECT_THAT(complaint("{}"), HasSubstr("answers.json: has no answer for 'case-0001'"));
  EXPECT_THAT(complaint(std::string(100'000, '[')), HasSubstr("answers.json: is"));
  EXPECT_THAT(complaint("{\"a\": 1, \"a\": 1}"), HasSubstr("'a' is there twice"));
  EXPECT_THAT(complaint("\xff\xfe"), HasSubstr("answers.json: is not UTF-8"));
  Json more = answers(Json::object());
  more["case-9999"] = Json::object();
  EXPECT_THAT(complaint(more.dump()), HasSubstr("there is no case 'case-9999'"));

  const auto about = [&](const Json& each) { return complaint(answers(each).dump()); };
  EXPECT_THAT(about(3), HasSubstr("answers.json/case-0001: is not an object"));
  EXPECT_THAT(about({{"ranked", {"c1", "nobody"}}}),
              HasSubstr("case-0001/ranked/1: there is no component 'nobody'"));
  EXPECT_THAT(about({{"ranked", {"c1", "c1"}}}), HasSubstr("ranked/1: 'c1' is there twice"));
  EXPECT_THAT(about({{"ranked", {Json::array()}}}), HasSubstr("ranked/0: is not the name"));
  EXPECT_THAT(about({{"causes", "c1"}}), HasSubstr("case-0001/causes: is not a list"));
  EXPECT_THAT(about({{"more", 1}}), HasSubstr("there is no 'more' in an answer"));
  const auto repair = [&](const Json& what, const Json& at_s) {
    return about(
        {{"repairs", Json::array({{{"component", "c1"}, {"repair", what}, {"at_s", at_s}}})}});
  };
  EXPECT_THAT(repair("kick", 1), HasSubstr("repairs/0: its repair is none of configure"));
  EXPECT_THAT(repair("restart", -1), HasSubstr("repairs/0/at_s: is not a time"));
  EXPECT_THAT(repair("restart", true), HasSubstr("repairs/0/at_s: is not a number"));
  EXPECT_THAT(repair("restart", nullptr), HasSubstr("repairs/0/at_s: is not a number"));
  EXPECT_THAT(complaint("{\"case-0001\": NaN}"), HasSubstr("NaN is no JSON number"));
  EXPECT_THAT(complaint("{\"case-0001\": " + std::string(5000, '9') + "}"),
              HasSubstr("answers.json: is not JSON"));
}

TEST_F(Scorer, RefusesWrongUse) {
  EXPECT_EQ(run("public").exit_code, 2);
  EXPECT_EQ(run("nowhere --baseline all").exit_code, 2);
  EXPECT_EQ(run("public --baseline magic").exit_code, 2);
  EXPECT_THAT(run("hidden --baseline all").text, HasSubstr("name the file with --truth"));
  ASSERT_TRUE(write_text((folder_ / "public/case-0002/signals.csv").string(), "time_s,c0\n1,2\n"));
  EXPECT_THAT(run("public --baseline all").text,
              HasSubstr("public/case-0002/signals.csv:1: is not"));
}

}  // namespace
}  // namespace culprit::study::rca

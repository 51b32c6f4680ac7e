#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <vector>

#include <CLI/CLI.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "json/json.h"
#include "laboratory/commands.h"
#include "laboratory/study_report.h"

namespace culprit::lab {
namespace {

using testing::HasSubstr;
using testing::Not;

class StudyCommand : public testing::Test {
 protected:
  StudyCommand() { std::filesystem::create_directories(folder_); }
  ~StudyCommand() override { std::filesystem::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  static std::string text(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static void write(const std::string& path, const std::string& text) {
    std::ofstream(path, std::ios::binary) << text;
  }

  int run(std::vector<std::string> arguments) {
    CLI::App app;
    int exit_code = -1;
    add_study(app, "test", exit_code);
    arguments.insert(arguments.begin(), "study");
    std::reverse(arguments.begin(), arguments.end());
    testing::internal::CaptureStderr();
    testing::internal::CaptureStdout();
    app.parse(arguments);
    said = testing::internal::GetCapturedStdout();
    complaint = testing::internal::GetCapturedStderr();
    return exit_code;
  }

  int run_small(std::vector<std::string> more) {
    std::vector<std::string> arguments = {"sunset", "--ablation", "--runs", "4"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }

  // The same small campaign in two shards, at path("1") and path("2").
  void make_shards() {
    ASSERT_EQ(run_small({"--shard", "1/2", "--shard-file", path("1")}), kOk) << complaint;
    ASSERT_EQ(run_small({"--shard", "2/2", "--shard-file", path("2")}), kOk) << complaint;
  }

  std::string said;
  std::string complaint;

 private:
  std::filesystem::path folder_ = std::filesystem::path(testing::TempDir()) /
                                  testing::UnitTest::GetInstance()->current_test_info()->name();
};

TEST_F(StudyCommand, GivesTheRowsOfAllThreeTables) {
  ASSERT_EQ(run({"sunset", "--runs", "4", "--experiments", "4", "--repetitions", "1", "--json"}),
            kOk)
      << complaint;
  const auto document = parse_json(said);
  EXPECT_EQ(document["rows"].size(), 9);  // eight of the ablation, and the misspecified one
  const auto& row = document["rows"][7];
  EXPECT_TRUE(row["dependencies"] && row["criticality"] && row["impact"]);
  EXPECT_EQ(row["planner"], "paper");
  EXPECT_EQ(row["runs"], 4);
  EXPECT_GT(row["downtime_s"]["mean"], 3);
  EXPECT_GT(row["honest"]["recovery_s"]["mean"], 3);
  ASSERT_EQ(document["learning"].size(), 10);  // strategies of F1 to F5
  const auto& learned = document["learning"][0];
  EXPECT_EQ(learned["strategy"], "rgb_restart");
  for (const char* key : {"believed", "truth", "error", "executed", "counted"})
    EXPECT_TRUE(learned[key].is_number()) << key;
}

TEST_F(StudyCommand, SeesOutagesByTheDetectorsThatAreChosen) {
  ASSERT_EQ(run({"sunset", "--ablation", "--runs", "2", "--planner", "bayes", "--planner", "oracle",
                 "--detectors", "own,phi", "--json"}),
            kOk)
      << complaint;
  const auto rows = parse_json(said)["rows"];
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(rows[0]["profile"], "paper");
  EXPECT_EQ(rows[2]["profile"], "paper:phi");
  EXPECT_EQ(rows[3]["planner"], "oracle");
  EXPECT_LT(rows[2]["honest"]["downtime_s"]["mean"], rows[0]["honest"]["downtime_s"]["mean"]);
}

TEST_F(StudyCommand, GivesTheSameBytesWithAnyNumberOfJobs) {
  ASSERT_EQ(run_small({"--jobs", "1", "--json"}), kOk);
  const std::string one = said;
  ASSERT_EQ(run_small({"--jobs", "5", "--json"}), kOk);
  EXPECT_EQ(said, one);
  ASSERT_EQ(run_small({"--jobs", "5", "--json", "--seed", "2"}), kOk);
  EXPECT_NE(parse_json(said)["rows"], parse_json(one)["rows"]);
}

TEST_F(StudyCommand, ShardsMergeToTheSameBytes) {
  ASSERT_EQ(run_small({"--json"}), kOk);
  const std::string whole = said;
  make_shards();
  ASSERT_EQ(run({"merge", path("2"), path("1"), "--json"}), kOk) << complaint;
  EXPECT_EQ(said, whole);
}

TEST_F(StudyCommand, ShardsOfSuaveMergeToTheSameBytes) {
  const std::vector<std::string> campaign = {"suave", "--stress",   "--runs",
                                             "3",     "--managers", "random,rosa,culprit"};
  const auto run_with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), campaign.begin(), campaign.end());
    return run(more);
  };
  ASSERT_EQ(run_with({"--json", "--html", path("whole.html")}), kOk) << complaint;
  const std::string whole = said;
  for (const std::string number : {"1", "2"})
    ASSERT_EQ(run_with({"--shard", number + "/2", "--shard-file", path(number)}), kOk) << complaint;
  const std::string second = text(path("2"));
  write(path("2"), second.substr(0, second.size() / 2));
  EXPECT_EQ(run({"merge", path("1"), path("2")}), kFailed);
  ASSERT_EQ(run_with({"--shard", "2/2", "--shard-file", path("2")}), kOk);
  EXPECT_THAT(complaint, HasSubstr("runs are there already"));

  ASSERT_EQ(run({"merge", path("2"), path("1"), "--json", "--html", path("merged.html")}), kOk)
      << complaint;
  EXPECT_EQ(said, whole);
  EXPECT_EQ(text(path("merged.html")), text(path("whole.html")));
  EXPECT_EQ(run({"merge", path("2"), path("1"), "--format", "csv"}), kFailed);
  EXPECT_THAT(complaint, HasSubstr("SUAVE has no CSV"));
}

TEST_F(StudyCommand, SaysWhichManagersOfSuaveThereAre) {
  EXPECT_EQ(run({"suave", "--managers", "me"}), kUsage);
  EXPECT_THAT(complaint, HasSubstr("there are none, random, bt, metacontrol, rosa, rebet, "
                                   "rebet-ucb, rebet-greedy, rebet-random, bandit, ac-ros, "
                                   "vogel, ghahremani, culprit"));
  EXPECT_EQ(run({"suave", "--managers", "bt,culprit,bt"}), kUsage);
  EXPECT_THAT(complaint, HasSubstr("manager 'bt' is there twice"));
}

TEST_F(StudyCommand, GoesOnWhereItWasInterrupted) {
  make_shards();
  const std::string whole = text(path("1"));
  write(path("1"), whole.substr(0, whole.size() / 2));
  EXPECT_EQ(run({"merge", path("1"), path("2")}), kFailed);
  ASSERT_EQ(run_small({"--shard", "1/2", "--shard-file", path("1")}), kOk);
  EXPECT_THAT(complaint, HasSubstr("runs are there already"));
  EXPECT_EQ(text(path("1")), whole);
}

TEST_F(StudyCommand, MergesNothingByHalves) {
  make_shards();
  EXPECT_EQ(run({"merge", path("1")}), kFailed);
  EXPECT_EQ(run({"merge", path("1"), path("1"), path("2")}), kFailed);
  EXPECT_EQ(run({"merge", path("1"), path("none")}), kFailed);

  ASSERT_EQ(run_small({"--seed", "2", "--shard", "2/2", "--shard-file", path("other")}), kOk);
  EXPECT_EQ(run({"merge", path("1"), path("other")}), kFailed);
  EXPECT_EQ(said, "");

  std::string damaged = text(path("2"));
  damaged[damaged.size() / 2] ^= 1;
  write(path("2"), damaged);
  write(path("out"), "old");
  EXPECT_EQ(run({"merge", path("1"), path("2"), "--output", path("out")}), kFailed);
  EXPECT_THAT(complaint, HasSubstr(path("2")));
  EXPECT_EQ(text(path("out")), "old");
}

TEST_F(StudyCommand, WritesAReportAndPlots) {
  ASSERT_EQ(run({"sunset", "--runs", "4", "--experiments", "4", "--repetitions", "2", "--html",
                 path("report.html"), "--svg", path("plots")}),
            kOk)
      << complaint;
  const std::string page = text(path("report.html"));
  EXPECT_THAT(page,
              HasSubstr("culprit study sunset --planner paper --profile paper --runs 4 --seed 1"));
  EXPECT_THAT(page, HasSubstr("is held responsible for"));
  for (const char* section :
       {"id=\"agreement\"", "id=\"plot-equivalence-paper-paper\"", "id=\"ablation\"",
        "id=\"effects-paper-paper\"", "id=\"claims\"", "id=\"plot-downtime_s\"",
        "id=\"plot-learning-F1\"", "id=\"timeline-drawing\"", "significantly better"})
    EXPECT_THAT(page, HasSubstr(section));
  EXPECT_THAT(text(path("plots/downtime_s.svg")), HasSubstr("<svg"));
  EXPECT_TRUE(std::filesystem::exists(path("plots/learning-F4.svg")));
}

// A page is opened anywhere: it loads nothing, and what comes from outside stays text.
TEST_F(StudyCommand, WritesAPageThatStandsAlone) {
  const std::string rules = path("<script>.rules");
  std::filesystem::copy("rules/sunset-study.rules", rules);
  ASSERT_EQ(run_small({"--rules", rules, "--html", path("report.html")}), kOk) << complaint;
  const std::string page = text(path("report.html"));
  EXPECT_THAT(page, HasSubstr("&lt;script&gt;.rules"));
  EXPECT_THAT(page, Not(HasSubstr("<script>.rules")));
  for (const char* outside : {" src=", "<link", "@import", "https://", "url(http"})
    EXPECT_THAT(page, Not(HasSubstr(outside)));
}

TEST_F(StudyCommand, WritesAFolderForAPaper) {
  ASSERT_EQ(run_small({"--report", path("paper")}), kOk) << complaint;
  for (const char* file : {"report.html", "study.json", "metrics.csv", "effects.csv", "values.csv",
                           "figures/ratio.svg", "figures/equivalence-paper-paper.svg"})
    EXPECT_TRUE(std::filesystem::exists(path("paper") + "/" + file)) << file;
  const std::string table = text(path("paper/tables/ablation.tex"));
  EXPECT_THAT(table, HasSubstr("\\begin{tabular}{cccrrrr}"));
  EXPECT_THAT(table, HasSubstr("$t_\\text{down}$[s]"));
  ASSERT_EQ(run_small({"--format", "latex"}), kOk) << complaint;
  EXPECT_THAT(said, testing::StartsWith(table));
  EXPECT_THAT(text(path("paper/tables/effects-paper-paper.tex")), HasSubstr("\\cellcolor{green!"));
}

TEST_F(StudyCommand, DrawsItsSweep) {
  ASSERT_EQ(run({"sunset", "--sweep", "--planner", "reference", "--runs", "1", "--report",
                 path("sweep")}),
            kOk)
      << complaint;
  EXPECT_THAT(text(path("sweep/study.json")), HasSubstr("\"relaunch_s\": 0.5"));
  EXPECT_THAT(text(path("sweep/figures/sweep-reference.svg")), HasSubstr("window 7"));
  const std::string page = text(path("sweep/report.html"));
  EXPECT_THAT(page, HasSubstr("--sweep --planner reference --profile paper --runs 1"));
  EXPECT_THAT(page, HasSubstr("id=\"sweep-closest\""));
  EXPECT_EQ(run({"sunset", "--sweep", "--runs", "1", "--format", "csv"}), kFailed);
}

TEST_F(StudyCommand, HasTheStatisticsThatSciPyComputes) {
  ASSERT_EQ(run({"sunset", "--ablation", "--runs", "18", "--planner", "paper", "--planner",
                 "reference", "--report", path("data")}),
            kOk)
      << complaint;
  const auto python = find_report_python();
  ASSERT_TRUE(python) << python.error();
  const std::string check = *python + " -B studies/check_statistics.py '" + path("data") + "'";
  EXPECT_EQ(std::system(check.c_str()), 0);
  EXPECT_THAT(text(path("data/report.html")), HasSubstr("&lt; 0.001"));
  EXPECT_THAT(text(path("data/report.html")), Not(HasSubstr(">0.000<")));
  std::string metrics = text(path("data/metrics.csv"));
  metrics.replace(metrics.find(",downtime_s,18,") + 15, 1, "9");
  write(path("data/metrics.csv"), metrics);
  EXPECT_NE(std::system((check + " 2>/dev/null").c_str()), 0);
}

TEST_F(StudyCommand, HasTheVerdictsThatSciPyComputes) {
  ASSERT_EQ(run_small({"--planner", "paper", "--planner", "reference", "--report", path("data")}),
            kOk)
      << complaint;
  ASSERT_EQ(run({"suave", "--claims", "--runs", "20", "--format", "csv", "-o", path("suave.csv")}),
            kOk)
      << complaint;
  const auto python = find_report_python();
  ASSERT_TRUE(python) << python.error();
  const auto check = [&](const std::string& file) {
    return std::system((*python + " -B studies/check_claims.py '" + file + "'").c_str());
  };
  EXPECT_EQ(check(path("data/claims.csv")), 0);
  EXPECT_EQ(check(path("suave.csv")), 0);
  std::string claims = text(path("suave.csv"));
  const std::size_t verdict = claims.rfind(",open\n");
  ASSERT_NE(verdict, std::string::npos);
  claims.replace(verdict, 6, ",holds\n");
  write(path("suave.csv"), claims);
  EXPECT_NE(check(path("suave.csv")), 0);
}

TEST_F(StudyCommand, KeepsItsTablesIfThereIsNoReport) {
  EXPECT_EQ(run_small({"--html", path("no/report.html")}), kFailed);
  EXPECT_THAT(complaint, HasSubstr("no/report.html: No such file or directory"));
  EXPECT_THAT(said, HasSubstr("Results by configuration"));
}

TEST_F(StudyCommand, SaysWhatCanBeChosen) {
  EXPECT_EQ(run({"sunset", "--profile", "september"}), kUsage);
  EXPECT_THAT(complaint, HasSubstr("there are paper, head, october, live"));
  EXPECT_EQ(run({"sunset", "--planner", "magic"}), kUsage);
  EXPECT_THAT(complaint, HasSubstr("there are paper, reference"));
  EXPECT_EQ(run({"sunset", "--planner", "reference", "--profile", "live"}), kUsage);
  EXPECT_EQ(run({"sunset", "--shard", "3/2", "--shard-file", path("x")}), kUsage);
  EXPECT_EQ(run({"sunset", "--shard", "1/2"}), kUsage);
  EXPECT_EQ(run({"sunset", "--learning", "--shard-file", path("x")}), kUsage);
  EXPECT_EQ(run({"sunset", "--run", "1", "--explain", "--switches", "XYZ"}), kUsage);
}

TEST_F(StudyCommand, TellsWhatHappenedInARun) {
  ASSERT_EQ(run({"sunset", "--run", "37", "--explain"}), kOk) << complaint;
  EXPECT_THAT(said, HasSubstr("run 37 of D C S: image_degradation+sync_issue"));
  EXPECT_THAT(said, HasSubstr("fault: sync_issue"));
  EXPECT_THAT(said, HasSubstr("fusion is held responsible for SensorFusionDead"));
  EXPECT_THAT(said, HasSubstr("SensorFusionDead resolved by fusion_restart"));
}

// All studies but these, as if they were done: a file with this head counts as such.
constexpr std::array<std::pair<const char*, const char*>, 10> kDone = {{
    {"sunset",
     "sunset --planner paper --planner reference --runs 54 --experiments 100 --repetitions 4"},
    {"suave", "suave --runs 30"},
    {"suave-extended", "suave --extended --runs 30"},
    {"suave-stress", "suave --stress --runs 30"},
    {"rca", "rca --components 20 --faults 3 --episodes 40 --planner naive,paper,bayes --seed 2026"},
    {"rca-slow-monitors",
     "rca --components 20 --ignore --episodes 30 --detector-latency 0..3s --not-stated "
     "--planner bayes,patient,informed --seed 2026"},
    {"rca-learning", "rca --components 5 --faults 1 --learn 500 --seed 2026"},
    {"rca-regret", "rca --regret --systems 30 --seed 2026"},
    {"rover", "rover"},
    {"fleet", "fleet --models 4 --robots 3"},
}};

TEST_F(StudyCommand, AllOfItGoesOnWhereItWas) {
  const std::string folder = path("all");
  std::filesystem::create_directories(folder);
  for (const auto& [name, arguments] : kDone)
    write(folder + "/" + name + ".md",
          std::string("<!-- culprit study ") + arguments + " (culprit test) -->\n\nkept");
  ASSERT_EQ(run({"all", "--quick", "--folder", folder}), kOk) << complaint;
  for (const auto& [name, arguments] : kDone)
    EXPECT_THAT(text(folder + "/" + name + ".md"), testing::EndsWith("kept")) << name;
  EXPECT_THAT(complaint, HasSubstr("sunset.md is there already"));
  EXPECT_THAT(complaint, HasSubstr("suave-claims, about"));
  EXPECT_THAT(text(folder + "/suave-claims.md"), HasSubstr("**Claims of the paper on SUAVE**"));

  // Every rival of docs/study-sunset.md, in the quick studies, too.
  const std::string managers = text(folder + "/sunset-managers.md");
  for (const char* rival :
       {"bt", "metacontrol", "rosa", "rebet", "rebet-ucb", "rebet-greedy", "rebet-random", "ac-ros",
        "vogel", "ghahremani", "bandit", "random", "bayes", "oracle"})
    EXPECT_THAT(managers, HasSubstr(std::string("| ") + rival + " |"));
  // A vehicle that was fitted to two rows is judged by the same claims, with other figures.
  const auto tables_of = [&](const std::string& name) {
    const std::string all = text(folder + "/" + name + ".md");
    return all.substr(std::min(all.size(), all.find("**")));
  };
  EXPECT_THAT(tables_of("suave-two-rows"), HasSubstr("**Claims of the paper on SUAVE**"));
  EXPECT_NE(tables_of("suave-two-rows"), tables_of("suave-claims"));
}

TEST_F(StudyCommand, AllOfItScoresTheCasesOfTheBenchmark) {
  if (std::system("python3 -c ''") != 0) GTEST_SKIP() << "python3 is not installed";
  const std::string folder = path("all");
  std::filesystem::create_directories(folder);
  ASSERT_EQ(run({"all", "--quick", "--only", "rca-cases", "--folder", folder}), kOk) << complaint;
  const std::string scores = text(folder + "/rca-cases.md");
  for (const char* part : {"**Scores on random robots**", "**Scores on sunset**",
                           "**Scores on rover**", "\nanswers-bayes ", "\nupstream-first ",
                           "\npagerank ", "\ncausal-discovery ", "\n20 cases: a share"})
    EXPECT_THAT(scores, HasSubstr(part));
  EXPECT_FALSE(std::filesystem::exists(folder + "/sunset.md"));
  EXPECT_EQ(run({"all", "--only", "magic", "--folder", folder}), kUsage);
  EXPECT_THAT(complaint, HasSubstr("there are sunset, sunset-managers"));
}

}  // namespace
}  // namespace culprit::lab

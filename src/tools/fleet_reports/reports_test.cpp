#include "fleet_reports/reports.h"

#include <fstream>

#include <gtest/gtest.h>

#include "fleet/exchange.h"
#include "fleet/journal_tail.h"
#include "fleet/test_journal.h"
#include "fleet/test_postgres.h"
#include "journal/json.h"

namespace culprit::fleet_reports {
namespace {

using namespace fleet;

TEST(TableReport, ShowsNoNameThatSteersATerminal) {
  Report report{"Fleet", {}};
  const TableQuery query{"Robots", "none", "", {{"robot", "robot"}}};
  report.tables.push_back({query,
                           {Row{"a\xc2\x9b"
                                "2J\x1b"}}});
  for (const std::string& shown : {to_text(report, 0), to_html(report, 0)})
    EXPECT_NE(shown.find("a\\x9b2J?"), std::string::npos) << shown;
}

// Nine robots that are alike, and one that differs; the last one fails.
struct FleetReports : testing::Test {
  void SetUp() override {
    if (const std::string why = TestPostgres::why_not(); !why.empty()) GTEST_SKIP() << why;
    postgres = std::make_unique<TestPostgres>();
    postgres->set_up_fleet();
    for (int i = 0; i < 10; ++i) report_as("robot " + std::to_string(i), i == 9);
    server.emplace(postgres->connect());
  }
  void report_as(const std::string& name, bool is_odd) {
    TestJournal journal(folder / name);
    journal.clock(std::chrono::duration_cast<std::chrono::nanoseconds>(
                      std::chrono::system_clock::now().time_since_epoch())
                      .count() -
                  3600'000'000'000);
    journal.begins();
    for (int n = 0; n < 12; ++n) journal.outcome("restart", is_odd == (n == 0));
    journal.event("failure_detected", R"(,"rule":"Silent","criticality":"ERROR")");
    journal.event("strategy_chosen",
                  R"(,"rule":"Silent","strategy":"restart","suspects":[{"component":"<camera>"}])");
    if (!is_odd)
      journal.event("failure_resolved",
                    R"(,"rule":"Silent","strategy":"restart","reaction_s":2.5)");
    auto outbox = Outbox::open(outbox_beside(journal.path()), "");
    JournalTail tail(journal.path());
    const std::atomic<bool> stop = false;
    ASSERT_TRUE(tail.follow(*outbox, stop));
    Postgres robot = postgres->connect("rover");
    ASSERT_TRUE(send(robot, *outbox, {name, *tail.run()}, {}));
  }
  std::string text_of(const std::vector<TableQuery>& queries) {
    const auto report = make_report(*server, "Fleet", queries);
    return report ? to_text(*report, 0) : report.error();
  }
  std::unique_ptr<TestPostgres> postgres;
  std::optional<Postgres> server;
  const test::TestFolder folder;
};

// One test, for each starts a server.
TEST_F(FleetReports, SayWhichRobotsFailWhatIsWorstAndWhichDiffer) {
  const std::string status = text_of(status_queries({}));
  EXPECT_NE(status.find("robot 9"), std::string::npos) << status;
  EXPECT_EQ(status.find("robot 3"), std::string::npos) << status;
  EXPECT_NE(status.find("all are reachable"), std::string::npos) << status;
  Scope other;
  other.model = "other";
  EXPECT_NE(text_of(status_queries(other)).find("no robot has reported"), std::string::npos);

  const std::string incidents = text_of(incident_queries({}));
  EXPECT_NE(incidents.find("2.5 s"), std::string::npos) << incidents;
  EXPECT_NE(incidents.find("90 %"), std::string::npos) << "resolved: " << incidents;
  const std::string beliefs = text_of(belief_queries({}));
  EXPECT_NE(beliefs.find("restart"), std::string::npos) << beliefs;

  const auto compared = compare(*server, {});
  ASSERT_TRUE(compared) << compared.error();
  ASSERT_EQ(compared->tables[0].rows.size(), 1u);
  EXPECT_EQ(text_in(compared->tables[0].rows[0][0]), "robot 9");
  EXPECT_EQ(compared->tables[1].rows.size(), 1u) << "one version";

  const auto report = make_report(*server, "Fleet", incident_queries({}));
  ASSERT_TRUE(report) << report.error();
  const std::string html = to_html(*report, 0);
  EXPECT_NE(html.find("&lt;camera&gt;"), std::string::npos);
  EXPECT_EQ(html.find("<camera>"), std::string::npos);
  const Json json = parse_json(to_json_text(*report));
  EXPECT_EQ(json["tables"][1]["rows"][0]["failures"], 10);
}

// The panels of packaging/fleet/grafana.json, as Grafana fills their macros in.
TEST_F(FleetReports, TheDashboardsQueriesAreTaken) {
  std::ifstream file("packaging/fleet/grafana.json");
  const std::string text(std::istreambuf_iterator<char>(file), {});
  const Json dashboard = parse_json(text);
  ASSERT_TRUE(dashboard.is_object());
  int queries = 0;
  for (const Json& panel : dashboard["panels"]) {
    for (const Json& target : panel["targets"]) {
      std::string sql = target["rawSql"].get<std::string>();
      const std::string macro = "$__timeFilter(f.began)";
      for (auto at = sql.find(macro); at != std::string::npos; at = sql.find(macro))
        sql.replace(at, macro.size(), "f.began > now() - interval '30 days'");
      const auto rows = server->query(sql);
      ASSERT_TRUE(rows) << sql << ": " << rows.error();
      EXPECT_FALSE(rows->empty()) << sql;
      ++queries;
    }
  }
  EXPECT_GE(queries, 6);
}

}  // namespace
}  // namespace culprit::fleet_reports

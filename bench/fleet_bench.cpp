// What a fleet of 10,000 robots costs the one PostgreSQL that all of them report to.
#include <chrono>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <unistd.h>
#include <vector>

#include <benchmark/benchmark.h>

#include "claims.h"
#include "fleet/exchange.h"
#include "fleet/journal_tail.h"
#include "fleet/schema.h"
#include "fleet/test_journal.h"
#include "fleet/test_postgres.h"
#include "fleet_reports/reports.h"
#include "language/checker.h"

namespace culprit::bench {
namespace {

namespace fs = std::filesystem;
using namespace fleet;

constexpr int kRobots = 10'000;
constexpr int kDecisions = 20;         // of a robot in a day
constexpr int kVisitsPerDecision = 3;  // detected, resolved, and later what it proves (member.h)
constexpr int kBeats = 96;             // a day; the fleet's priors are asked for then, too
constexpr int kPools = 144;            // a day: the sums are made anew
constexpr double kDay = 86'400;
constexpr int kCores = 2;

// Seconds of the processor that a process used, and those of its children that have ended.
double used_by(const fs::path& process) {
  std::ifstream file(process / "stat");
  std::string all(std::istreambuf_iterator<char>(file), {});
  if (const auto name = all.rfind(')'); name != std::string::npos) all = all.substr(name + 2);
  std::istringstream fields(all);
  std::string skipped;
  for (int i = 3; i < 14; ++i) fields >> skipped;
  double ticks = 0;
  for (int i = 14; i < 18; ++i) {
    double each = 0;
    fields >> each;
    ticks += each;
  }
  return ticks / static_cast<double>(sysconf(_SC_CLK_TCK));
}

double used_by_server(const TestPostgres& postgres) {
  const std::string pid = std::to_string(postgres.pid());
  double sum = used_by("/proc/" + pid);
  std::ifstream children("/proc/" + pid + "/task/" + pid + "/children");
  for (std::string child; children >> child;) sum += used_by("/proc/" + child);
  return sum;
}

// A month of the fleet: each robot with twenty strategies and a failure each day.
void fill(const TestPostgres& postgres) {
  postgres.run(R"sql(
SET session_replication_role = replica;
INSERT INTO culprit.robot(robot, login, name, model, culprit, rule_set, context, run)
  SELECT md5('r' || i)::uuid, 'rover', 'robot ' || i, 'model ' || i % 5, '0.1.0', 'rules', '', md5('u' || i)::uuid
  FROM generate_series(1, 10000) i;
INSERT INTO culprit.run(run, robot, began, culprit, model, rule_set, context)
  SELECT md5('u' || i)::uuid, md5('r' || i)::uuid, now(), '0.1.0', 'model ' || i % 5, 'rules', ''
  FROM generate_series(1, 10000) i;
INSERT INTO culprit.outcome(robot, run, rule_set, rule, strategy, context, definition, helped, failed, recent_helped, recent_failed)
  SELECT md5('r' || i)::uuid, md5('u' || i)::uuid, 'rules', 'rule ' || s / 2, 'strategy ' || s, '', 'd' || s,
         i % 7 + s, i % 3, i % 7 + s, i % 3
  FROM generate_series(1, 10000) i, generate_series(1, 20) s;
INSERT INTO culprit.failure(robot, run, row, incident, rule, criticality, component, began, ended, repair_s, how, helped_by,
                            strategies, failed, exhausted, rule_set, culprit)
  SELECT md5('r' || i)::uuid, md5('u' || i)::uuid, f, f, 'rule ' || f % 10, 'ERROR', 'component ' || f % 10,
         now() - make_interval(days => f), CASE WHEN f > 1 OR i % 100 > 0 THEN now() - make_interval(days => f) + interval '9 s' END,
         9, CASE WHEN f > 1 OR i % 100 > 0 THEN 'resolved' ELSE '' END, 'strategy 1', 1, 0, false, 'rules', '0.1.0'
  FROM generate_series(1, 10000) i, generate_series(1, 30) f;
ANALYZE;
)sql");
}

struct Member {
  explicit Member(const fs::path& folder) : journal(folder) {
    journal.begins();
    outbox = std::move(*Outbox::open(outbox_beside(journal.path()), ""));
  }
  TestJournal journal;
  std::optional<Outbox> outbox;
};

// Seconds of the server's processors that `visit` takes, of each of them.
template <class Visit>
double cost_of(const TestPostgres& postgres, std::vector<std::unique_ptr<Member>>& members,
               int times, Visit visit) {
  const double before = used_by_server(postgres);
  for (int i = 0; i < times; ++i) {
    for (auto& member : members) visit(*member);
  }
  // What has ended is counted with its parent soon.
  (void)postgres.query("SELECT pg_sleep(0.5)");
  return (used_by_server(postgres) - before) / (times * static_cast<double>(members.size()));
}

// Claims: less than 10 % of two cores for 10,000 robots of 20 decisions a day; status in 200 ms.
void fleet_of_10000(benchmark::State& state) {
  if (!TestPostgres::why_not().empty()) {
    state.SkipWithError("there is no PostgreSQL here");
    return;
  }
  const TestPostgres postgres;
  postgres.set_up_fleet();
  fill(postgres);
  const test::TestFolder folder;
  std::vector<std::unique_ptr<Member>> members;
  for (int i = 0; i < 100; ++i)
    members.push_back(std::make_unique<Member>(folder / ("m" + std::to_string(i))));
  const RuleSet rules = *check(Source("rules", kFleetRules)).rules;
  const std::atomic<bool> stop = false;
  double busy = 0;
  double status_ms = 0;
  const auto tell = [&](Member& member) {
    JournalTail tail(member.journal.path());
    (void)tail.follow(*member.outbox, stop);
    auto server = Server::connect(postgres.address("rover"), stop);
    if (!server || !check_schema(*server)) state.SkipWithError("no connection");
    const auto sent = send(*server, *member.outbox, {"member", *tail.run()}, {});
    if (!sent) state.SkipWithError(sent.error().c_str());
    return std::move(*server);
  };
  for (auto _ : state) {
    const double news = cost_of(postgres, members, 3, [&](Member& member) {
      member.journal.outcome("restart", true);
      member.journal.event("failure_detected", R"(,"rule":"Silent","criticality":"ERROR")");
      (void)tell(member);
    });
    const double beat = cost_of(postgres, members, 3, [&](Member& member) {
      Server server = tell(member);
      (void)ask(server, member.outbox->identity(), rules, "");
    });
    const double before = used_by_server(postgres);
    for (int i = 0; i < 3; ++i) {
      postgres.run("UPDATE culprit.pool_state SET at = 'epoch'");
      (void)postgres.query("SELECT culprit.refresh_pool()");
    }
    (void)postgres.query("SELECT pg_sleep(0.5)");
    const double pool = (used_by_server(postgres) - before) / 3;
    busy = (kRobots * (kDecisions * kVisitsPerDecision * news + kBeats * beat) + kPools * pool) /
           (kCores * kDay);
    state.counters["news_ms"] = 1000 * news;
    state.counters["beat_ms"] = 1000 * beat;
    state.counters["pool_s"] = pool;
    Server reader = postgres.connect();
    (void)make_report(reader, "", status_queries({}));
    constexpr int kTimes = 10;
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < kTimes; ++i) (void)make_report(reader, "", status_queries({}));
    status_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin)
                    .count() /
                kTimes;
  }
  claim("10,000 robots, 20 decisions a day each: PostgreSQL busy, of two cores", 100 * busy, 10,
        "%");
  claim("fleet status of 10,000 robots", status_ms, 200, "ms");
}
BENCHMARK(fleet_of_10000)->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace culprit::bench

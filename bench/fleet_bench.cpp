// The cost of a fleet of 10,000 robots for the one PostgreSQL that all of them report to. Each has a connection of its own, or they share those of pgbouncer.
#include <chrono>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <unistd.h>
#include <vector>

#include <benchmark/benchmark.h>

#include "claims.h"
#include "fleet/exchange.h"
#include "fleet/journal_tail.h"
#include "fleet/postgres.h"
#include "fleet/schema.h"
#include "fleet/test_journal.h"
#include "fleet/test_pooler.h"
#include "fleet/test_postgres.h"
#include "fleet_reports/reports.h"
#include "language/checker.h"

namespace culprit::bench {
namespace {

namespace fs = std::filesystem;
using namespace fleet;

constexpr int kRobots = 10'000;
constexpr int kDecisions = 20;  // of a robot in a day
// A failure, its end and its outcomes are sent together (member.h); one in four lasts longer than they are gathered.
constexpr double kVisitsPerDecision = 1.25;
constexpr int kBeats = 36;   // a day; the fleet's priors are asked for then, too
constexpr int kPools = 144;  // a day: the sums are made anew
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

// The processor time of a visit, in seconds.
struct Costs {
  double news = 0;
  double beat = 0;
};

// Where robots go to, and who works there.
struct Place {
  Address address;
  std::function<double()> used;  // seconds of the processors, by now
};

// Errors are thrown.
Postgres tell(const Place& place, Member& member) {
  static const std::atomic<bool> stop = false;
  JournalTail tail(member.journal.path());
  (void)tail.follow(*member.outbox, stop);
  auto server = Postgres::connect(place.address, stop);
  if (!server) throw std::runtime_error(server.error());
  if (const auto fits = check_schema(*server); !fits) throw std::runtime_error(fits.error());
  const auto sent = send(*server, *member.outbox, {"member", *tail.run()}, {});
  if (!sent) throw std::runtime_error(sent.error());
  return std::move(*server);
}

// The mean over all members, three visits each.
double cost_of(const Place& place, std::vector<std::unique_ptr<Member>>& members,
               const std::function<void(Member&)>& visit) {
  constexpr int kTimes = 3;
  const auto settled = [&] {
    std::this_thread::sleep_for(
        std::chrono::milliseconds(500));  // until what ended is counted with its parent
    return place.used();
  };
  const double before = settled();
  for (int i = 0; i < kTimes; ++i) {
    for (auto& member : members) visit(*member);
  }
  return (settled() - before) / (kTimes * static_cast<double>(members.size()));
}

Costs costs_of(const Place& place, std::vector<std::unique_ptr<Member>>& members) {
  const RuleSet rules = *check(Source("rules", kFleetRules)).rules;
  Costs costs;
  costs.news = cost_of(place, members, [&](Member& member) {
    member.journal.outcome("restart", true);
    member.journal.event("failure_detected", R"(,"rule":"Silent","criticality":"ERROR")");
    (void)tell(place, member);
  });
  costs.beat = cost_of(place, members, [&](Member& member) {
    Postgres server = tell(place, member);
    (void)ask(server, member.outbox->identity(), rules, "");
  });
  return costs;
}

// Seconds of the processors that the sums of the fleet take.
double cost_of_pool(const TestPostgres& postgres) {
  constexpr int kTimes = 3;
  const double before = used_by_server(postgres);
  for (int i = 0; i < kTimes; ++i) {
    postgres.run("UPDATE culprit.pool_state SET at = 'epoch'");
    (void)postgres.query("SELECT culprit.refresh_pool()");
  }
  (void)postgres.query("SELECT pg_sleep(0.5)");
  return (used_by_server(postgres) - before) / kTimes;
}

// Percent of two processors.
double busy(const Costs& costs, double pool) {
  const double visits = kDecisions * kVisitsPerDecision * costs.news + kBeats * costs.beat;
  return 100 * (kRobots * visits + kPools * pool) / (kCores * kDay);
}

double milliseconds_of_status(const TestPostgres& postgres) {
  constexpr int kTimes = 10;
  Postgres reader = postgres.connect();
  (void)fleet_reports::make_report(reader, "", fleet_reports::status_queries({}));
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < kTimes; ++i)
    (void)fleet_reports::make_report(reader, "", fleet_reports::status_queries({}));
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin)
             .count() /
         kTimes;
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
  std::optional<TestPooler> pooler;
  if (TestPooler::why_not().empty()) pooler.emplace(postgres, std::vector<std::string>{"rover"});
  for (auto _ : state) {
    const double pool = cost_of_pool(postgres);
    const Costs direct =
        costs_of({postgres.address("rover"), [&] { return used_by_server(postgres); }}, members);
    state.counters["news_ms"] = 1000 * direct.news;
    state.counters["beat_ms"] = 1000 * direct.beat;
    state.counters["pool_s"] = pool;
    claim("10,000 robots, 20 decisions a day each: PostgreSQL busy, of two cores",
          busy(direct, pool), 10, "%");
    if (!pooler) continue;
    const Costs behind = costs_of({pooler->address("rover"),
                                   [&] {
                                     return used_by_server(postgres) +
                                            used_by("/proc/" + std::to_string(pooler->pid()));
                                   }},
                                  members);
    state.counters["pooled_news_ms"] = 1000 * behind.news;
    state.counters["pooled_beat_ms"] = 1000 * behind.beat;
    claim("the same behind pgbouncer, PostgreSQL and it", busy(behind, pool), 10, "%");
  }
  claim("fleet status of 10,000 robots", milliseconds_of_status(postgres), 200, "ms");
}
BENCHMARK(fleet_of_10000)->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace culprit::bench

#include "fleet/exchange.h"

#include "fleet/clean.h"
#include "fleet/definition.h"
#include "json/json.h"

namespace culprit::fleet {
namespace {

constexpr int kAtOnce = 400;
// Anybody with a robot's login can make up models.
constexpr int kMostSums = 20'000;

// JSON has no integers beyond 2^53 for everybody; PostgreSQL's takes them as they are.
Json json_of(const Run& run) {
  return {{"run", run.id},      {"began", run.began},       {"culprit", run.culprit},
          {"model", run.model}, {"rule_set", run.rule_set}, {"context", run.context}};
}

Json json_of(const Outcome& outcome) {
  return {{"run", outcome.run},
          {"rule", outcome.name.rule},
          {"strategy", outcome.name.strategy},
          {"definition", outcome.definition},
          {"helped", outcome.counts.helped},
          {"failed", outcome.counts.failed}};
}

Json json_of(const RunFailure& failure) {
  const Failure& f = failure.failure;
  return {{"run", failure.run},
          {"row", f.row},
          {"incident", f.incident},
          {"rule", f.rule},
          {"criticality", f.criticality},
          {"component", f.component},
          {"began", f.began},
          {"ended", f.ended},
          {"repair_s", f.repair_seconds},
          {"how", f.how},
          {"helped_by", f.helped_by},
          {"strategies", f.strategies},
          {"failed", f.failed},
          {"exhausted", f.is_exhausted}};
}

template <class T>
std::string texts_of(const std::vector<T>& all) {
  Json json = Json::array();
  for (const T& each : all) json.push_back(json_of(each));
  return to_line(json);
}

constexpr const char* kRobot = R"sql(
INSERT INTO culprit.robot(robot, name, model, culprit, rule_set, context, before, run, dropped)
VALUES ($1::uuid, $2, $3, $4, $5, $6, $7::uuid, $8::uuid, $9::bigint)
ON CONFLICT (robot) DO UPDATE SET name = EXCLUDED.name, model = EXCLUDED.model,
  culprit = EXCLUDED.culprit, rule_set = EXCLUDED.rule_set, context = EXCLUDED.context,
  run = EXCLUDED.run, dropped = greatest(robot.dropped, EXCLUDED.dropped), seen = now()
)sql";

constexpr const char* kRuns = R"sql(
INSERT INTO culprit.run(run, robot, began, culprit, model, rule_set, context)
SELECT run, $2::uuid, to_timestamp(began / 1e9), culprit, model, rule_set, context
FROM jsonb_to_recordset($1::jsonb)
  AS x(run uuid, began double precision, culprit text, model text, rule_set text, context text)
ON CONFLICT (run) DO NOTHING
)sql";

// A run belongs to the robot that reported it first.
constexpr const char* kOutcomes = R"sql(
INSERT INTO culprit.outcome(robot, run, rule_set, rule, strategy, context, definition, helped, failed)
SELECT r.robot, r.run, r.rule_set, x.rule, x.strategy, r.context, x.definition, x.helped, x.failed
FROM jsonb_to_recordset($1::jsonb)
  AS x(run uuid, rule text, strategy text, definition text, helped bigint, failed bigint)
JOIN culprit.run r USING (run)
ON CONFLICT (run, rule, strategy) DO UPDATE
SET helped = greatest(outcome.helped, EXCLUDED.helped),
    failed = greatest(outcome.failed, EXCLUDED.failed)
WHERE outcome.helped < EXCLUDED.helped OR outcome.failed < EXCLUDED.failed
)sql";

constexpr const char* kFailures = R"sql(
INSERT INTO culprit.failure(robot, run, row, incident, rule, criticality, component, began, ended,
  repair_s, how, helped_by, strategies, failed, exhausted, rule_set, culprit)
SELECT r.robot, r.run, x.row, x.incident, x.rule, x.criticality, x.component,
  to_timestamp(x.began / 1e9), CASE WHEN x.ended <> 0 THEN to_timestamp(x.ended / 1e9) END,
  CASE WHEN x.repair_s >= 0 THEN x.repair_s END, x.how, x.helped_by, x.strategies, x.failed,
  x.exhausted, r.rule_set, r.culprit
FROM jsonb_to_recordset($1::jsonb)
  AS x(run uuid, row bigint, incident bigint, rule text, criticality text, component text,
       began double precision, ended double precision, repair_s double precision, how text,
       helped_by text, strategies int, failed int, exhausted boolean)
JOIN culprit.run r USING (run)
ON CONFLICT (began, run, row) DO UPDATE
SET component = EXCLUDED.component, ended = EXCLUDED.ended, repair_s = EXCLUDED.repair_s,
    how = EXCLUDED.how, helped_by = EXCLUDED.helped_by, strategies = EXCLUDED.strategies,
    failed = EXCLUDED.failed, exhausted = EXCLUDED.exhausted
)sql";

Field uuid_or_null(const std::string& id) { return id.empty() ? Field() : Field(id); }

Expected<void> introduce(Postgres& server, const Outbox& outbox, const Introduction& introduction) {
  const Identity& identity = outbox.identity();
  const auto dropped = outbox.dropped();
  if (!dropped) return Error{dropped.error()};
  const Run& run = introduction.run;
  const auto told =
      server.query(kRobot, {identity.robot, clean(introduction.name), run.model, run.culprit,
                            run.rule_set, run.context, uuid_or_null(identity.before),
                            uuid_or_null(run.id), std::to_string(*dropped)});
  if (!told) return Error{told.error()};
  if (const auto begun = server.query(kRuns, {texts_of(std::vector{run}), identity.robot}); !begun)
    return Error{begun.error()};
  const auto heard =
      server.query("UPDATE culprit.run SET last_heard = now() WHERE run = $1::uuid", {run.id});
  if (!heard) return Error{heard.error()};
  return {};
}

Expected<void> write(Postgres& server, const Outbox& outbox, const Introduction& introduction,
                     const Waiting& waiting) {
  if (const auto told = introduce(server, outbox, introduction); !told) return told;
  const std::pair<const char*, std::vector<Field>> statements[] = {
      {kRuns, {texts_of(waiting.runs), outbox.identity().robot}},
      {kOutcomes, {texts_of(waiting.outcomes)}},
      {kFailures, {texts_of(waiting.failures)}}};
  for (const auto& [sql, parameters] : statements) {
    if (parameters[0] == "[]") continue;
    if (const auto done = server.query(sql, parameters); !done) return Error{done.error()};
  }
  return {};
}

Expected<void> in_transaction(Postgres& server, const Outbox& outbox,
                              const Introduction& introduction, const Waiting& waiting) {
  if (const auto begun = server.run("BEGIN"); !begun) return begun;
  auto done = write(server, outbox, introduction, waiting);
  if (done) return server.run("COMMIT");
  const std::string state = server.state();
  if (server.is_usable()) (void)server.run("ROLLBACK");
  server.set_state(state);
  return done;
}

// Those rows alone that are wrong are not sent.
Expected<void> one_by_one(Postgres& server, Outbox& outbox, const Introduction& introduction,
                          const Waiting& waiting,
                          const std::function<void(const std::string&)>& refused) {
  const auto attempt = [&](Waiting one, const std::string& what) -> Expected<void> {
    one.runs = waiting.runs;
    const std::string run = one.outcomes.empty() ? one.failures[0].run : one.outcomes[0].run;
    std::erase_if(one.runs, [&](const Run& each) { return each.id != run; });
    const auto done = in_transaction(server, outbox, introduction, one);
    if (!done && !server.blames_rows()) return done;
    if (!done) refused(what + ": " + done.error());
    return outbox.sent(one);
  };
  for (const Outcome& each : waiting.outcomes) {
    const auto done = attempt({{}, {each}, {}}, "outcomes of " + each.name.strategy);
    if (!done) return done;
  }
  for (const RunFailure& each : waiting.failures) {
    const auto done = attempt({{}, {}, {each}}, "a failure of " + each.failure.rule);
    if (!done) return done;
  }
  return {};
}

}  // namespace

Expected<void> send(Postgres& server, Outbox& outbox, const Introduction& introduction,
                    const std::function<void(const std::string&)>& refused) {
  while (true) {
    const auto waiting = outbox.waiting(kAtOnce);
    if (!waiting) return Error{waiting.error()};
    auto done = in_transaction(server, outbox, introduction, *waiting);
    if (!done && server.blames_rows() && !waiting->empty()) {
      // Not the rows, if the robot itself is not taken.
      const auto alone = in_transaction(server, outbox, introduction, {});
      if (!alone) return alone;
      done = one_by_one(server, outbox, introduction, *waiting, refused);
    } else if (done) {
      done = outbox.sent(*waiting);
    }
    if (!done) return done;
    if (waiting->outcomes.size() < kAtOnce && waiting->failures.size() < kAtOnce) return {};
  }
}

Expected<Twin> find_twin(Postgres& server, const Identity& identity, const Run& run) {
  // Heard again after this one was first: neither is the other's forerunner.
  const auto rows = server.query(
      "SELECT (other.first_heard, other.run) < (mine.first_heard, mine.run) FROM culprit.run mine "
      "JOIN culprit.run other ON other.robot = mine.robot AND other.run <> mine.run WHERE mine.run "
      "= $1::uuid AND mine.robot = $2::uuid AND other.last_heard > mine.first_heard AND "
      "mine.last_heard > other.first_heard AND other.last_heard > now() - interval '1 hour' ORDER "
      "BY 1 DESC LIMIT 1",
      {run.id, identity.robot});
  if (!rows) return Error{rows.error()};
  if (rows->empty()) return Twin::kNone;
  return text_in((*rows)[0][0]) == "t" ? Twin::kElder : Twin::kYounger;
}

Expected<FleetKnowledge> ask(Postgres& server, const Identity& identity, const RuleSet& rules,
                             const std::string& context) {
  if (const auto made = server.query("SELECT culprit.refresh_pool()"); !made)
    return Error{made.error()};
  Json wanted = Json::array();
  for (const auto& [name, definition] : definitions_of(rules))
    wanted.push_back(
        {{"rule", name.rule}, {"strategy", name.strategy}, {"definition", definition}});
  const std::string names = to_line(wanted);
  FleetKnowledge knowledge;
  knowledge.model = clean(rules.robot);
  const auto pool = server.query(
      "SELECT rule, strategy, model, robots, tried, helped, spread, square FROM culprit.pool JOIN "
      "jsonb_to_recordset($1::jsonb) AS x(rule text, strategy text, definition text) USING (rule, "
      "strategy, definition) WHERE context = $2 ORDER BY model <> $3, robots DESC LIMIT " +
          std::to_string(kMostSums),
      {names, context, knowledge.model});
  if (!pool) return Error{pool.error()};
  for (const Row& row : *pool) {
    StrategyKnowledge& known = knowledge.strategies[{text_in(row[0]), text_in(row[1])}];
    known.models[text_in(row[2])] = {real_in(row[3]), real_in(row[4]), real_in(row[5]),
                                     real_in(row[6]), real_in(row[7])};
  }
  // This robot's share of the sums: its outcomes when the sums were made.
  const auto own = server.query(
      "SELECT rule, strategy, sum(helped), sum(failed), coalesce(sum(recent_helped * "
      "culprit.fading(grew, at)) FILTER (WHERE added <= at), 0), coalesce(sum(recent_failed * "
      "culprit.fading(grew, at)) FILTER (WHERE added <= at), 0) FROM culprit.outcome JOIN "
      "jsonb_to_recordset($1::jsonb) AS x(rule text, strategy text, definition text) USING (rule, "
      "strategy, definition), culprit.pool_state WHERE robot = $2::uuid AND context = $3 GROUP BY "
      "1, 2",
      {names, identity.robot, context});
  if (!own) return Error{own.error()};
  for (const Row& row : *own) {
    StrategyKnowledge& known = knowledge.strategies[{text_in(row[0]), text_in(row[1])}];
    known.own = {integer_in(row[2]), integer_in(row[3])};
    known.recent_helped = real_in(row[4]);
    known.recent_failed = real_in(row[5]);
  }
  return knowledge;
}

}  // namespace culprit::fleet

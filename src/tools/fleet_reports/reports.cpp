#include "fleet_reports/reports.h"

#include <algorithm>
#include <map>

#include "knowledge/pooled_prior.h"

namespace culprit::fleet_reports {
namespace {

using Kind = Column::Kind;

constexpr const char* kHeard = "extract(epoch FROM r.seen)";

std::vector<Field> parameters_of(const Scope& scope) {
  return {scope.model, scope.robot, std::to_string(scope.days)};
}

// $1 model, $2 robot, $3 days; each query names all three.
TableQuery in_scope(TableQuery query, const Scope& scope) {
  query.parameters = parameters_of(scope);
  return query;
}

constexpr const char* kOfScope =
    "($1::text = '' OR r.model = $1) AND ($2::text = '' OR r.name = $2)";

std::string where(const std::string& more) {
  return "\nWHERE " + std::string(kOfScope) + (more.empty() ? "" : " AND " + more);
}

const std::string kRecently = "f.began > now() - make_interval(days => $3::int)";
// A parameter that no condition names has no type.
const std::string kNoDays = "$3::int IS NOT NULL";

const std::string kFailures = "\nFROM culprit.failure f JOIN culprit.robot r USING (robot)";
const std::string kRepairs =
    "count(*), count(*) FILTER (WHERE how = 'resolved')::float8 / count(*), count(*) FILTER (WHERE "
    "exhausted), percentile_cont(0.5) WITHIN GROUP (ORDER BY repair_s), percentile_cont(0.9) "
    "WITHIN "
    "GROUP (ORDER BY repair_s), sum(strategies)::float8 / count(*)";

std::vector<Column> with_repairs(std::vector<Column> columns) {
  for (Column each : std::vector<Column>{{"failures", "failures", Kind::kCount},
                                         {"resolved", "resolved", Kind::kPercent},
                                         {"exhausted", "exhausted", Kind::kCount},
                                         {"repair_median_s", "repair, median", Kind::kSeconds},
                                         {"repair_p90_s", "90 %", Kind::kSeconds},
                                         {"strategies", "strategies each", Kind::kNumber}})
    columns.push_back(std::move(each));
  return columns;
}

TableQuery worst(const std::string& title, const std::string& by, std::vector<Column> columns,
                 const Scope& scope, const std::string& condition = "") {
  return in_scope({title, "none",
                   "SELECT " + by + ", " + kRepairs + kFailures +
                       where(kRecently + (condition.empty() ? "" : " AND " + condition)) +
                       "\nGROUP BY " + by + "\nORDER BY count(*) DESC, " + by + "\nLIMIT 20",
                   with_repairs(std::move(columns))},
                  scope);
}

}  // namespace

std::vector<TableQuery> status_queries(const Scope& scope) {
  return {
      in_scope(
          {"Models",
           "no robot has reported yet",
           "SELECT r.model, r.context, count(*), count(*) FILTER (WHERE i.failures > 0), count(*) "
           "FILTER (WHERE i.exhausted), count(*) FILTER (WHERE r.seen < now() - interval '1 "
           "hour'), count(DISTINCT r.culprit), count(DISTINCT r.rule_set), sum(r.dropped)"
           "\nFROM culprit.robot r LEFT JOIN (SELECT robot, run, count(*) AS failures, "
           "bool_or(exhausted) AS exhausted FROM culprit.failure WHERE ended IS NULL GROUP BY "
           "robot, run) i ON i.robot = r.robot AND i.run = r.run" +
               where(kNoDays) + "\nGROUP BY 1, 2\nORDER BY 1, 2",
           {{"model", "model"},
            {"context", "context"},
            {"robots", "robots", Kind::kCount},
            {"ill", "ill", Kind::kCount},
            {"exhausted", "wait for a person", Kind::kCount},
            {"silent", "unreachable for 1 h", Kind::kCount},
            {"versions", "versions", Kind::kCount},
            {"rule_sets", "rule files", Kind::kCount},
            {"dropped", "dropped", Kind::kCount}}},
          scope),
      in_scope(
          {"Failing now",
           "none",
           "SELECT r.name, r.model, f.rule, f.criticality, f.component, extract(epoch FROM "
           "f.began), f.strategies, CASE WHEN f.exhausted THEN 'waits for a person' ELSE '' END, " +
               std::string(kHeard) +
               "\nFROM culprit.failure f JOIN culprit.robot r ON r.robot = f.robot AND r.run = "
               "f.run" +
               where("f.ended IS NULL AND " + kNoDays) +
               "\nORDER BY f.exhausted DESC, f.began\nLIMIT 50",
           {{"robot", "robot"},
            {"model", "model"},
            {"rule", "failure"},
            {"criticality", "criticality"},
            {"component", "responsible"},
            {"began", "since", Kind::kTime},
            {"strategies", "strategies", Kind::kCount},
            {"remark", ""},
            {"seen", "last seen", Kind::kTime}}},
          scope),
      in_scope({"Unreachable for an hour",
                "all are reachable",
                "SELECT r.name, r.model, " + std::string(kHeard) +
                    ", r.culprit, r.robot\nFROM culprit.robot r" +
                    where("r.seen < now() - interval '1 hour' AND " + kNoDays) +
                    "\nORDER BY r.seen DESC\nLIMIT 50",
                {{"robot", "robot"},
                 {"model", "model"},
                 {"seen", "last seen", Kind::kTime},
                 {"culprit", "culprit"},
                 {"number", "number"}}},
               scope)};
}

std::vector<TableQuery> incident_queries(const Scope& scope) {
  std::vector<TableQuery> queries = {in_scope(
      {"Incidents",
       "none",
       "SELECT f.incident, r.name, r.model, extract(epoch FROM min(f.began)), CASE WHEN "
       "bool_and(f.ended IS "
       "NOT "
       "NULL) THEN extract(epoch FROM max(f.ended) - min(f.began)) END, (array_agg(f.rule ORDER BY "
       "f.row))[1], (array_agg(f.component ORDER BY f.row))[1], count(*), sum(f.strategies), "
       "string_agg(DISTINCT nullif(f.helped_by, ''), ', '), CASE WHEN bool_or(f.exhausted) THEN "
       "'exhausted' WHEN bool_or(f.how = 'left') THEN 'culprit ended' ELSE '' END" +
           kFailures + where(kRecently) +
           "\nGROUP BY r.name, r.model, f.run, f.incident\nORDER BY min(f.began) DESC\nLIMIT 50",
       {{"incident", "incident", Kind::kIncident},
        {"robot", "robot"},
        {"model", "model"},
        {"began", "began", Kind::kTime},
        {"lasted_s", "lasted", Kind::kSeconds},
        {"rule", "first failure"},
        {"component", "responsible"},
        {"failures", "failures", Kind::kCount},
        {"strategies", "strategies", Kind::kCount},
        {"helped_by", "helped"},
        {"remark", ""}}},
      scope)};
  queries.push_back(worst("Worst rules", "f.rule", {{"rule", "rule"}}, scope));
  queries.push_back(worst("Worst components", "f.component", {{"component", "component"}}, scope,
                          "f.component <> ''"));
  queries.push_back(worst("Time to repair, by week",
                          "to_char(date_trunc('week', f.began), 'YYYY-MM-DD')",
                          {{"week", "week of"}}, scope));
  return queries;
}

std::vector<TableQuery> belief_queries(const Scope& scope) {
  return {in_scope(
      {"Learned success rates",
       "nothing was learned yet",
       "SELECT model, rule, strategy, context, count(*), sum(helped), sum(failed), "
       "sum(helped)::float8 "
       "/ nullif(sum(helped + failed), 0), min(helped::float8 / (helped + failed)) FILTER (WHERE "
       "helped + failed >= 5), max(helped::float8 / (helped + failed)) FILTER (WHERE helped + "
       "failed "
       ">= 5), definition\nFROM (SELECT r.model, o.rule, o.strategy, o.context, o.definition, "
       "o.robot, sum(o.helped) AS helped, sum(o.failed) AS failed FROM culprit.outcome o JOIN "
       "culprit.robot r USING (robot)" +
           where(kNoDays) +
           " GROUP BY 1, 2, 3, 4, 5, 6) AS of_robot\nGROUP BY model, rule, strategy, context, "
           "definition\nORDER BY 1, 2, 3, 4",
       {{"model", "model"},
        {"rule", "rule"},
        {"strategy", "strategy"},
        {"context", "context"},
        {"robots", "robots", Kind::kCount},
        {"helped", "helped", Kind::kCount},
        {"failed", "did not", Kind::kCount},
        {"rate", "rate", Kind::kPercent},
        {"lowest", "lowest robot", Kind::kPercent},
        {"highest", "highest", Kind::kPercent},
        {"definition", "definition"}}},
      scope)};
}

std::vector<TableQuery> version_queries(const Scope& scope) {
  return {worst("Versions", "r.model, f.culprit, f.rule_set",
                {{"model", "model"}, {"culprit", "culprit"}, {"rule_set", "rule file"}}, scope)};
}

namespace {

struct OfRobot {
  std::string robot;
  double helped = 0;
  double failed = 0;
};

struct Difference {
  double agreement = 1;
  Row row;
};

// One strategy on all robots of a model.
void add_differences(const std::vector<std::string>& key, const std::vector<OfRobot>& robots,
                     std::vector<Difference>& all) {
  constexpr double kFewest = 5;
  constexpr double kHardly = 0.001;
  constexpr Pooling kAll{.most = 1000};
  RobotOutcomes sums;
  for (const OfRobot& each : robots) sums.add(each.helped, each.failed);
  for (const OfRobot& each : robots) {
    if (each.helped + each.failed < kFewest || robots.size() < 2) continue;
    RobotOutcomes others = sums;
    others.remove(each.helped, each.failed);
    // The designer's guess is not known here, so none is used.
    const Belief prior = pooled_prior(initial_belief(percent(50), 1), others, {}, kAll);
    const double agrees = agreement(prior, each.helped, each.failed);
    if (agrees >= kHardly) continue;
    all.push_back({agrees,
                   {each.robot, key[0], key[1], key[2],
                    std::to_string(static_cast<std::int64_t>(each.helped)),
                    std::to_string(static_cast<std::int64_t>(each.failed)),
                    std::to_string(each.helped / (each.helped + each.failed)),
                    std::to_string(prior.mean().value), std::to_string(agrees)}});
  }
}

}  // namespace

Expected<Report> compare(Postgres& server, const Scope& scope) {
  TableQuery query{
      "Robots that are not like the others of their model",
      "none: all are like the others",
      "SELECT r.model, o.rule, o.strategy, o.context, o.definition, r.name, "
      "sum(o.helped), sum(o.failed)\nFROM culprit.outcome o JOIN culprit.robot r USING "
      "(robot)\nWHERE ($1::text = '' OR r.model = $1) AND $2::text IS NOT NULL AND " +
          kNoDays + "\nGROUP BY 1, 2, 3, 4, 5, 6, o.robot\nORDER BY 1, 2, 3, 4, 5, 6",
      {{"robot", "robot"},
       {"model", "model"},
       {"rule", "rule"},
       {"strategy", "strategy"},
       {"helped", "helped", Kind::kCount},
       {"failed", "did not", Kind::kCount},
       {"rate", "here", Kind::kPercent},
       {"others", "others", Kind::kPercent},
       {"agreement", "chance if alike", Kind::kNumber}},
      parameters_of(scope)};
  const auto rows = server.query(query.sql, query.parameters);
  if (!rows) return Error{rows.error()};
  std::map<std::vector<std::string>, std::vector<OfRobot>> groups;
  for (const Row& row : *rows)
    groups[{text_in(row[0]), text_in(row[1]), text_in(row[2]), text_in(row[3]), text_in(row[4])}]
        .push_back({text_in(row[5]), real_in(row[6]), real_in(row[7])});
  std::vector<Difference> all;
  for (const auto& [key, robots] : groups) add_differences(key, robots, all);
  std::ranges::stable_sort(all, {}, &Difference::agreement);
  Table table{query, {}};
  constexpr std::size_t kMost = 50;
  for (Difference& each : all) {
    const bool is_asked_for = scope.robot.empty() || text_in(each.row[0]) == scope.robot;
    if (is_asked_for && table.rows.size() < kMost) table.rows.push_back(std::move(each.row));
  }
  auto report = make_report(server, "Fleet: compared", version_queries(scope));
  if (!report) return report;
  report->tables.insert(report->tables.begin(), std::move(table));
  return report;
}

std::string sql_of(const std::vector<TableQuery>& queries) {
  std::string text = "-- $1 model, $2 robot ('': all), $3 days back\n";
  for (const TableQuery& query : queries) text += "\n-- " + query.title + "\n" + query.sql + ";\n";
  return text;
}

}  // namespace culprit::fleet_reports

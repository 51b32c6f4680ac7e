// The reports of `culprit fleet`: which tables each has, and the queries that make them.
#pragma once

#include <string>
#include <vector>

#include "fleet_reports/table_report.h"

namespace culprit::fleet_reports {

// The scope of a report; empty fields: no limit.
struct Scope {
  std::string model;
  std::string robot;  // its name
  int days = 30;      // back from now
};

// Current failures, unreachable robots, and the state of the models.
std::vector<TableQuery> status_queries(const Scope& scope);
// What happened: the latest incidents, the worst rules, components and versions, and how long
// repairs took, by week.
std::vector<TableQuery> incident_queries(const Scope& scope);
// The fleet's outcomes of each strategy.
std::vector<TableQuery> belief_queries(const Scope& scope);
// Versions beside each other.
std::vector<TableQuery> version_queries(const Scope& scope);
// Robots that are not like the others of their model, and versions beside each other.
Expected<Report> compare(Postgres& server, const Scope& scope);

// The statements as text, for other programs.
std::string sql_of(const std::vector<TableQuery>& queries);

}  // namespace culprit::fleet_reports

// Reports on a fleet: tables, each made by one query, as text, JSON or one HTML file.
#pragma once

#include <string>
#include <vector>

#include "fleet/postgres.h"

namespace culprit::fleet_reports {

using fleet::Field;
using fleet::integer_in;
using fleet::Postgres;
using fleet::real_in;
using fleet::Row;
using fleet::Rows;
using fleet::text_in;

struct Column {
  enum class Kind : std::uint8_t {
    kText,
    kCount,
    kNumber,   // two digits of it
    kSeconds,  // of a duration
    kPercent,  // a share, 0..1
    kTime,     // when: seconds since 1970
    kIncident  // its id (fleet/incident_number.h)
  };
  std::string key;    // in JSON
  std::string title;  // for people
  Kind kind = Kind::kText;
};

struct TableQuery {
  std::string title;
  std::string nothing;  // what is said if there are no rows
  std::string sql;      // one column of its result for each of these
  std::vector<Column> columns;
  std::vector<Field> parameters{};
};

struct Table {
  TableQuery query;
  Rows rows;
};

struct Report {
  std::string title;
  std::vector<Table> tables;
};

Expected<Report> make_report(Postgres& server, const std::string& title,
                             const std::vector<TableQuery>& queries);

// `now`: seconds since 1970, from which ages count. Names come from robots: what is no printable
// text is shown as '?', and what steers a terminal is escaped.
std::string to_text(const Report& report, double now);
std::string to_json_text(const Report& report);
std::string to_html(const Report& report, double now);

}  // namespace culprit::fleet_reports

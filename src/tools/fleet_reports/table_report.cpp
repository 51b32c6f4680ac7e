#include "fleet_reports/table_report.h"

#include <algorithm>

#include <fmt/chrono.h>
#include <fmt/core.h>

#include "base/name_grammar.h"
#include "base/xml.h"
#include "fleet/clean.h"
#include "fleet/incident_number.h"
#include "journal/json.h"
#include "language/source.h"

namespace culprit::fleet_reports {
namespace {

using Kind = Column::Kind;

std::string duration_text(double seconds) {
  if (seconds < 0) return "0 s";
  if (seconds < 10) return fmt::format("{:.1f} s", seconds);
  if (seconds < 120) return fmt::format("{:.0f} s", seconds);
  if (seconds < 120 * 60) return fmt::format("{:.0f} min", seconds / 60);
  if (seconds < 48 * 3600) return fmt::format("{:.0f} h", seconds / 3600);
  return fmt::format("{:.0f} d", seconds / 86400);
}

std::string time_text(double at) {
  constexpr double kYear10000 = 253402300800;
  if (!(at > -kYear10000 && at < kYear10000)) return "?";
  return fmt::format("{:%Y-%m-%d %H:%M:%S}", fmt::gmtime(static_cast<std::time_t>(at)));
}

std::string cell_text(const Field& field, Kind kind, double now) {
  if (!field) return "-";
  switch (kind) {
    case Kind::kText:
      return escape_controls(fleet::clean(*field));
    case Kind::kCount:
      return fmt::format("{}", integer_in(field));
    case Kind::kNumber:
      return fmt::format("{:.2g}", real_in(field));
    case Kind::kSeconds:
      return duration_text(real_in(field));
    case Kind::kPercent:
      return fmt::format("{:.0f} %", 100 * real_in(field));
    case Kind::kTime:
      return time_text(real_in(field)) + " (" + duration_text(now - real_in(field)) + " ago)";
    case Kind::kIncident:
      return fleet::incident_id(integer_in(field));
  }
  return "";
}

bool is_right_aligned(Kind kind) {
  return kind == Kind::kCount || kind == Kind::kNumber || kind == Kind::kSeconds ||
         kind == Kind::kPercent;
}

void append_padded(std::string& line, const std::string& cell, std::size_t width, Kind kind) {
  const std::string blanks(width - std::min<std::size_t>(width, character_count(cell)), ' ');
  line += is_right_aligned(kind) ? blanks + cell : cell + blanks;
  line += "  ";
}

std::string table_text(const Table& table, double now) {
  const auto& columns = table.query.columns;
  std::string text = table.query.title + "\n";
  if (table.rows.empty()) return text + "  " + table.query.nothing + "\n";
  std::vector<std::vector<std::string>> lines(1);
  for (const Column& column : columns) lines[0].push_back(column.title);
  for (const Row& row : table.rows) {
    auto& line = lines.emplace_back();
    for (std::size_t c = 0; c < columns.size(); ++c)
      line.push_back(cell_text(row[c], columns[c].kind, now));
  }
  for (const auto& cells : lines) {
    std::string line = "  ";
    for (std::size_t c = 0; c < columns.size(); ++c) {
      std::size_t width = 0;
      for (const auto& each : lines) width = std::max<std::size_t>(width, character_count(each[c]));
      append_padded(line, cells[c], width, columns[c].kind);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

Json cell_json(const Field& field, Kind kind) {
  if (!field) return {};
  if (kind == Kind::kText) return *field;
  if (kind == Kind::kCount) return integer_in(field);
  if (kind == Kind::kIncident) return fleet::incident_id(integer_in(field));
  return real_in(field);
}

}  // namespace

Expected<Report> make_report(Postgres& server, const std::string& title,
                             const std::vector<TableQuery>& queries) {
  Report report{title, {}};
  for (const TableQuery& query : queries) {
    auto rows = server.query(query.sql, query.parameters);
    if (!rows) return Error{rows.error()};
    for (const Row& row : *rows) {
      if (row.size() != query.columns.size()) return Error{"a table has other columns"};
    }
    report.tables.push_back({query, std::move(*rows)});
  }
  return report;
}

std::string to_text(const Report& report, double now) {
  std::string text;
  for (const Table& table : report.tables)
    text += (text.empty() ? "" : "\n") + table_text(table, now);
  return text;
}

std::string to_json_text(const Report& report) {
  Json json = {{"report", report.title}, {"tables", Json::array()}};
  for (const Table& table : report.tables) {
    Json rows = Json::array();
    for (const Row& row : table.rows) {
      Json object = Json::object();
      for (std::size_t c = 0; c < row.size(); ++c)
        object[table.query.columns[c].key] = cell_json(row[c], table.query.columns[c].kind);
      rows.push_back(std::move(object));
    }
    json["tables"].push_back({{"title", table.query.title}, {"rows", std::move(rows)}});
  }
  return to_indented(json) + "\n";
}

std::string to_html(const Report& report, double now) {
  std::string html = fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{0}</title>\n"
      "<meta name=\"viewport\" content=\"width=device-width\">\n<style>\n"
      "body {{ font: 15px/1.5 system-ui, sans-serif; margin: 2em; color: #1b1f24; background: #fff "
      "}}\n"
      "table {{ border-collapse: collapse; margin-bottom: 2em }}\n"
      "th, td {{ padding: .3em .9em; border-bottom: 1px solid #d0d7de; text-align: left }}\n"
      ".number {{ text-align: right; font-variant-numeric: tabular-nums }}\n"
      "@media (prefers-color-scheme: dark) {{ body {{ color: #e6edf3; background: #0d1117 }} "
      "th, td {{ border-color: #30363d }} }}\n"
      "</style></head><body>\n<h1>{0}</h1>\n<p>{1} UTC</p>\n",
      xml_escaped(report.title), time_text(now));
  for (const Table& table : report.tables) {
    html += "<h2>" + xml_escaped(table.query.title) + "</h2>\n";
    if (table.rows.empty()) {
      html += "<p>" + xml_escaped(table.query.nothing) + "</p>\n";
      continue;
    }
    html += "<table><thead><tr>";
    const auto class_of = [](Kind kind) {
      return is_right_aligned(kind) ? " class=\"number\"" : "";
    };
    for (const Column& column : table.query.columns)
      html += fmt::format("<th scope=\"col\"{}>{}</th>", class_of(column.kind),
                          xml_escaped(column.title));
    html += "</tr></thead><tbody>\n";
    for (const Row& row : table.rows) {
      html += "<tr>";
      for (std::size_t c = 0; c < row.size(); ++c) {
        const Kind kind = table.query.columns[c].kind;
        html +=
            fmt::format("<td{}>{}</td>", class_of(kind), xml_escaped(cell_text(row[c], kind, now)));
      }
      html += "</tr>\n";
    }
    html += "</tbody></table>\n";
  }
  return html + "</body></html>\n";
}

}  // namespace culprit::fleet_reports

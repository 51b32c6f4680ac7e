#include "json/json.h"
#include "study/tables/render.h"

namespace culprit::study {
namespace {

const char* name(Align align) {
  return align == Align::kLeft ? "left" : align == Align::kCentre ? "centre" : "right";
}

Json json(const Column& column) {
  return {{"group", column.group},
          {"title", column.title},
          {"group_latex", column.group_latex},
          {"title_latex", column.title_latex},
          {"align", name(column.align)}};
}

Json json(const Cell& cell) {
  Json json = {{"text", cell.text}};
  if (cell.is_bold) json["bold"] = true;
  if (cell.strength > 0) json["strength"] = cell.strength;
  if (cell.shade == Shade::kNotSignificant) json["shade"] = "not_significant";
  if (cell.shade == Shade::kBetter) json["shade"] = "better";
  if (cell.shade == Shade::kWorse) json["shade"] = "worse";
  return json;
}

Json json(const Table& table) {
  Json document = {{"id", table.id},
                   {"caption", table.caption},
                   {"columns", Json::array()},
                   {"rows", Json::array()},
                   {"notes", table.notes}};
  for (const Column& column : table.columns) document["columns"].push_back(json(column));
  for (const auto& row : table.rows) {
    Json cells = Json::array();
    for (const Cell& cell : row) cells.push_back(json(cell));
    document["rows"].push_back(std::move(cells));
  }
  return document;
}

}  // namespace

std::string tables_json(const std::vector<Table>& tables) {
  Json document = Json::array();
  for (const Table& table : tables) document.push_back(json(table));
  return to_indented(document) + "\n";
}

}  // namespace culprit::study

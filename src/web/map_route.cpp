#include <charconv>
#include <cmath>

#include "web/calls.h"

namespace culprit::web {
namespace {

using link::MapPicture;
using link::PlanePoint;

double rounded(double metres) { return std::round(metres * 1e3) / 1e3; }

Json to_json(const PlanePoint& point) { return Json::array({rounded(point.x), rounded(point.y)}); }

Json to_json(const std::optional<link::GridPicture>& grid) {
  if (!grid) return nullptr;
  const auto& [t, rotation] = grid->origin;
  return {{"width", grid->width},
          {"height", grid->height},
          {"resolution", grid->resolution},
          {"coarser", grid->coarser},
          {"origin", {t.x, t.y, link::yaw_of(rotation)}},
          {"cells", grid->cells}};
}

Json to_json(const std::optional<MapPicture::Line>& line) {
  if (!line) return nullptr;
  Json points = Json::array();
  for (const PlanePoint& point : line->points) points.push_back(to_json(point));
  return {{"topic", line->topic}, {"age", seconds(line->age)}, {"points", std::move(points)}};
}

Json to_json(const MapPicture& map) {
  Json robots = Json::array();
  for (const MapPicture::Robot& robot : map.robots)
    robots.push_back({{"frame", robot.frame},
                      {"at", to_json(robot.at)},
                      {"yaw", rounded(robot.yaw)},
                      {"age", seconds(robot.age)}});
  return {{"topics", map.topics},      {"topic", map.topic},        {"frame", map.frame},
          {"number", map.number},      {"grid", to_json(map.grid)}, {"robots", std::move(robots)},
          {"path", to_json(map.path)}, {"scan", to_json(map.scan)}, {"troubles", map.troubles}};
}

}  // namespace

http::Route map_route(MapOf map_of) {
  return {http::Method::kGet, "/api/map", [map_of = std::move(map_of)](const Json& query) {
            const std::string known = http::text_of(query, "known").value_or("0");
            std::uint64_t number = 0;
            std::from_chars(known.data(), known.data() + known.size(), number);
            const auto map = map_of(http::text_of(query, "topic").value_or(""), number);
            return map ? http::Answer{200, to_json(*map)} : http::refuse(503, map.error());
          }};
}

}  // namespace culprit::web

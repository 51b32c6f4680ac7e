#include "web/name_routes.h"

#include "language/checker.h"

namespace culprit::web {
namespace {

// The nodes of the rules' components; no topic is subscribed to for a form.
LiveInterest interest_in(const std::string& text) {
  const Checked checked = check(Source("rules", text));
  LiveInterest interest;
  if (checked.rules) interest.nodes = interest_of(*checked.rules).nodes;
  return interest;
}

Json value_to_json(const std::optional<Value>& value) {
  if (!value) return nullptr;
  return std::visit([](const auto& plain) { return Json(plain); }, *value);
}

Json to_json(const LiveInventory& inventory) {
  Json json{{"nodes", Json::object()}, {"topics", Json::array()}, {"services", Json::array()}};
  for (const auto& [name, node] : inventory.nodes) {
    Json parameters = Json::object();
    if (node.parameters) {
      for (const auto& [parameter, value] : *node.parameters)
        parameters[parameter] = value_to_json(value);
    }
    json["nodes"][name] = {{"parameters", parameters}};
  }
  for (const auto& [name, topic] : inventory.topics) json["topics"].push_back(name);
  for (const auto& [name, type] : inventory.services) json["services"].push_back(name);
  return json;
}

}  // namespace

std::vector<Route> name_routes(Look look) {
  return {{Method::kPost, "/api/rules/names", [look = std::move(look)](const Json& body) {
             const auto text = text_of(body, "text");
             if (!text) return refuse(400, "send the rules as 'text'");
             const auto inventory = look(interest_in(*text));
             if (!inventory) return refuse(503, inventory.error());
             return Answer{200, to_json(*inventory)};
           }}};
}

}  // namespace culprit::web

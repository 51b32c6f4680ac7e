#include "language/checker.h"
#include "web/calls.h"
#include "web/rule_desk.h"

namespace culprit::web {
namespace {

// The nodes of the rules' components; no topic is subscribed to for a form.
LiveInterest interest_in(const std::string& text, const RuleLoader& load) {
  const Checked checked = check(expand(Source(kTextOfPage, text), load));
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
  for (const auto& [name, node] : inventory.nodes)
    json["nodes"][name] = {{"parameters", parameters_to_json(node)}};
  for (const auto& [name, topic] : inventory.topics) json["topics"].push_back(name);
  for (const auto& [name, type] : inventory.services) json["services"].push_back(name);
  return json;
}

}  // namespace

Json parameters_to_json(const LiveInventory::Node& node) {
  Json parameters = Json::object();
  if (!node.parameters) return parameters;
  for (const auto& [parameter, value] : *node.parameters)
    parameters[parameter] = value_to_json(value);
  return parameters;
}

std::vector<http::Route> name_routes(Look look, RuleLoader load) {
  return {{http::Method::kPost, "/api/rules/names",
           [look = std::move(look), load = std::move(load)](const Json& body) {
             const auto text = http::text_of(body, "text");
             if (!text) return http::refuse(400, "send the rules as 'text'");
             const auto inventory = look(interest_in(*text, load));
             if (!inventory) return http::refuse(503, inventory.error());
             return http::Answer{200, to_json(*inventory)};
           },
           http::Role::kLook}};
}

}  // namespace culprit::web

#include <algorithm>
#include <memory>

#include "web/calls.h"

namespace culprit::web {
namespace {

Json list(const Faults& faults) {
  Json all = Json::array();
  for (const Faults::Fault& fault : faults.all)
    all.push_back({{"name", fault.name}, {"component", fault.component}});
  return {{"faults", all}};
}

Answer inject(const Faults& faults, const Json& body) {
  const auto name = text_of(body, "name");
  if (!name) return refuse(400, "send the fault's 'name'");
  const bool is_known = std::any_of(faults.all.begin(), faults.all.end(),
                                    [&](const Faults::Fault& f) { return f.name == *name; });
  if (!is_known) return refuse(404, "there is no fault '" + *name + "'; GET /api/faults lists all");
  if (const auto done = faults.inject(*name); !done) return refuse(409, done.error());
  return {200, {{"injected", *name}}};
}

Answer clear(const Faults& faults) {
  if (const auto done = faults.clear(); !done) return refuse(409, done.error());
  return {200, {{"cleared", true}}};
}

}  // namespace

std::vector<Route> fault_routes(Faults faults) {
  const auto shared = std::make_shared<const Faults>(std::move(faults));
  return {
      {Method::kGet, "/api/faults",
       [shared](const Json&) {
         return Answer{200, list(*shared)};
       }},
      {Method::kPost, "/api/faults", [shared](const Json& body) { return inject(*shared, body); }},
      {Method::kDelete, "/api/faults", [shared](const Json&) { return clear(*shared); }}};
}

}  // namespace culprit::web

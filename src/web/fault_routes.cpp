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

http::Answer inject(const Faults& faults, const Json& body) {
  const auto name = http::text_of(body, "name");
  if (!name) return http::refuse(400, "send the fault's 'name'");
  const bool is_known = std::any_of(faults.all.begin(), faults.all.end(),
                                    [&](const Faults::Fault& f) { return f.name == *name; });
  if (!is_known)
    return http::refuse(404, "there is no fault '" + *name + "'; GET /api/faults lists all");
  if (const auto done = faults.inject(*name); !done) return http::refuse(409, done.error());
  return {200, {{"injected", *name}}};
}

http::Answer clear(const Faults& faults) {
  if (const auto done = faults.clear(); !done) return http::refuse(409, done.error());
  return {200, {{"cleared", true}}};
}

}  // namespace

std::vector<http::Route> fault_routes(Faults faults) {
  const auto shared = std::make_shared<const Faults>(std::move(faults));
  return {{http::Method::kGet, "/api/faults",
           [shared](const Json&) {
             return http::Answer{200, list(*shared)};
           }},
          {http::Method::kPost, "/api/faults",
           [shared](const Json& body) { return inject(*shared, body); }},
          {http::Method::kDelete, "/api/faults", [shared](const Json&) { return clear(*shared); }}};
}

}  // namespace culprit::web

#include <algorithm>
#include <array>
#include <memory>

#include "web/calls.h"

namespace culprit::web {
namespace {

constexpr std::array<std::string_view, 3> kNames = {"sunset", "suave", "rca"};

// The report is a page with inline scripts and styles. It gets an origin of its own, so that
// nothing in it can speak for the app.
constexpr const char* kReportPolicy =
    "sandbox allow-scripts; default-src 'none'; style-src 'unsafe-inline'; script-src "
    "'unsafe-inline'; img-src data:";

std::optional<std::uint64_t> natural(const Json& body, const char* member, std::uint64_t most) {
  const auto found = body.find(member);
  if (found == body.end() || !found->is_number_integer() || *found < 0) return std::nullopt;
  const auto value = found->get<std::uint64_t>();
  return value <= most ? std::optional(value) : std::nullopt;
}

http::Answer start(const Studies& studies, const Json& body) {
  const std::string name = http::text_of(body, "study").value_or("");
  if (std::find(kNames.begin(), kNames.end(), name) == kNames.end())
    return http::refuse(400, "'study' has to be sunset, suave or rca");
  const auto runs = natural(body, "runs", Studies::kMostRuns);
  if (!runs || *runs == 0)
    return http::refuse(
        400, "'runs' has to be a whole number from 1 to " + std::to_string(Studies::kMostRuns));
  const auto seed = body.contains("seed") ? natural(body, "seed", 1ull << 53) : 1;
  if (!seed) return http::refuse(400, "'seed' has to be a whole number");
  const auto started = studies.start({name, static_cast<std::uint32_t>(*runs), *seed});
  if (!started) return http::refuse(409, started.error());
  return {202, {{"started", name}}};
}

http::Answer progress(const Studies& studies) {
  const auto last = studies.progress();
  if (!last) return {200, {{"study", nullptr}}};
  Json json{{"study", last->campaign.study}, {"runs", last->campaign.runs},
            {"seed", last->campaign.seed},   {"state", last->state},
            {"seconds", last->seconds},      {"has_report", last->has_report}};
  if (last->done) json["done"] = {last->done->first, last->done->second};
  if (!last->trouble.empty()) json["trouble"] = last->trouble;
  return {200, json};
}

http::Answer text(const Expected<std::string>& content, const char* type, const char* policy) {
  if (!content) return http::refuse(404, content.error());
  http::Answer answer;
  answer.text = {type, *content, policy};
  return answer;
}

}  // namespace

std::vector<http::Route> study_routes(Studies studies) {
  const auto shared = std::make_shared<const Studies>(std::move(studies));
  return {{http::Method::kGet, "/api/studies", [shared](const Json&) { return progress(*shared); }},
          {http::Method::kPost, "/api/studies",
           [shared](const Json& body) { return start(*shared, body); }},
          {http::Method::kDelete, "/api/studies",
           [shared](const Json&) {
             shared->stop();
             return progress(*shared);
           }},
          {http::Method::kGet, "/api/studies/result",
           [shared](const Json&) { return text(shared->result(), "application/json", ""); }},
          {http::Method::kGet, "/api/studies/report", [shared](const Json&) {
             return text(shared->report(), "text/html; charset=utf-8", kReportPolicy);
           }}};
}

}  // namespace culprit::web

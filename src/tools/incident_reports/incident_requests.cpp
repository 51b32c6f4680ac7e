#include "incident_reports/incident_requests.h"

#include <algorithm>
#include <map>

#include "journal/json.h"

namespace culprit::incident_reports {
namespace {

constexpr std::int64_t kLater = 1000;  // rows: an answer that comes after the incident

double seconds_of(const journal::Entry& entry) { return 1e-9 * static_cast<double>(entry.at); }

}  // namespace

Expected<std::vector<Request>> requests_of(const journal::Reader& journal, std::int64_t first,
                                           std::int64_t last) {
  auto rows = journal.entries(journal::Which::kReadable, first);
  if (!rows) return Error{rows.error()};
  std::vector<Request> requests;
  std::map<std::int64_t, std::size_t> open;  // by the command's number
  journal::Entry entry;
  auto more = rows->next(entry);
  for (; more && *more && entry.id <= last + kLater; more = rows->next(entry)) {
    if (entry.id > last && open.empty()) break;
    if (entry.kind == journal::kind::kSession) open.clear();  // numbers begin anew
    const bool is_request = entry.kind == journal::kind::kIntent;
    if (!is_request && entry.kind != journal::kind::kOutcome) continue;
    const Json body = parse_json(entry.body);
    const std::int64_t number = journal::integer_of(body, "command", -1);
    if (is_request) {
      if (entry.id > last || requests.size() == kMostRequests) continue;
      open[number] = requests.size();
      requests.push_back({seconds_of(entry), journal::text_of(body, "text")});
    } else if (const auto asked = open.find(number); asked != open.end()) {
      Request& request = requests[asked->second];
      const std::string reason = journal::text_of(body, "reason");
      request.answer = journal::text_of(body, "outcome") + (reason.empty() ? "" : ", " + reason);
      request.seconds = std::max(0.0, seconds_of(entry) - request.clock);
      open.erase(asked);
    }
  }
  if (!more) return Error{more.error()};
  return requests;
}

}  // namespace culprit::incident_reports

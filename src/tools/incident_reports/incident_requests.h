// The requests of culprit to the robot during an incident, and the answers: intents and outcomes of a journal.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "journal/reader.h"

namespace culprit::incident_reports {

struct Request {
  double clock = 0;                 // seconds since 1970
  std::string text{};               // "camera: restart"
  std::string answer{};             // "done", "refused, it is busy"; empty: none is in the journal
  std::optional<double> seconds{};  // until the answer
};

// Those of rows `first` to `last`, the first kMostRequests of them; an answer may come some rows later. Errors: the journal cannot be read.
inline constexpr std::size_t kMostRequests = 1000;
Expected<std::vector<Request>> requests_of(const journal::Reader& journal, std::int64_t first,
                                           std::int64_t last);

}  // namespace culprit::incident_reports

// The incidents of a journal, also while it is being written.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "incident_reports/incident.h"
#include "journal/reader.h"
#include "journal/session.h"

namespace culprit::incident_reports {

struct Found {
  std::vector<Incident> incidents;  // in the order of comes_before()
  double oldest = 0;                // seconds since 1970: from when on the journal tells
  double newest = 0;                // until when; so long what is not over has lasted at least
};

// Those that were not over at `since`, in seconds since 1970, or began after it. `open_now`: ids of incidents that are
// open, of which nothing may have been told for days. Errors: the journal cannot be read.
Expected<Found> incidents_of(const journal::Reader& journal, double since,
                             const std::set<std::string>& open_now = {});

// When the opening of this incident was written, in seconds since 1970; nothing: the journal does not tell it. Errors:
// the journal cannot be read.
Expected<std::optional<double>> opened_at(const journal::Reader& journal, const std::string& id);

// The run of culprit that wrote row `row`; empty: the journal does not say. Errors: the journal cannot be read.
Expected<std::optional<journal::Session>> session_at(const journal::Reader& journal,
                                                     std::int64_t row);

// One event of a journal, in the form for people.
struct ToldEvent {
  std::int64_t row = 0;
  double wall =
      0;  // seconds since 1970, by the robot's clock from the first one on: within an incident it does not jump
  Json event;                           // as the row has it
  std::vector<std::string> components;  // of its strategy, if it is about one
};

inline constexpr std::size_t kMostTold = 5000;  // of one incident

// The events of rows `first` to `last`, the first kMostTold of them.
Expected<std::vector<ToldEvent>> events_of(const journal::Reader& journal, std::int64_t first,
                                           std::int64_t last);

}  // namespace culprit::incident_reports

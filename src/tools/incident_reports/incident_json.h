// Incidents as JSON, for the page and programs (docs/web.md, GET /api/incidents), and for `culprit incident --json`.
#pragma once

#include <vector>

#include "incident_reports/journal_incidents.h"
#include "knowledge/event_words.h"
#include "recorder/recording_folder.h"

namespace culprit::incident_reports {

// Those of `all` that were written while it lasted, or were begun then.
std::vector<recorder::StoredRecording> recordings_of(
    const Incident& incident, const std::vector<recorder::StoredRecording>& all);

// {"id", "first", "last", "clock", "seconds", …, "recordings": [{"name", "path", "bytes"}]}
Json to_json(const Incident& incident, const std::vector<recorder::StoredRecording>& recordings);
// The wording of an event for people: {"type": ..., "label": ..., "severity": ..., "tone": ...}
Json to_json(const EventWords& words);
// As in the stream (web/event_json.h); `t` is `clock`.
Json to_json(ToldEvent told);

}  // namespace culprit::incident_reports

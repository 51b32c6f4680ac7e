// One visit to the database: it sends the waiting rows, in transactions of a few hundred, and takes
// back the fleet's sums.
#pragma once

#include <functional>
#include <string>

#include "fleet/outbox.h"
#include "fleet/postgres.h"
#include "fleet/priors.h"

namespace culprit::fleet {

// How this robot is shown to people.
struct Introduction {
  std::string name;
  Run run;  // that goes on now
};

// Sends everything that waits. If the database rejects it, it is sent row by row. A row that is
// rejected alone is reported to `refused` and not sent again. Errors: the rest waits for the next
// visit.
Expected<void> send(Postgres& server, Outbox& outbox, const Introduction& introduction,
                    const std::function<void(const std::string&)>& refused);

// Whether another process reports under this robot's number, and began to after this one did, or
// did before and still does.
enum class Twin : std::uint8_t { kNone, kElder, kYounger };
Expected<Twin> find_twin(Postgres& server, const Identity& identity, const Run& run);

// The database's knowledge of the strategies of `rules`, in this context.
Expected<FleetKnowledge> ask(Postgres& server, const Identity& identity, const RuleSet& rules,
                             const std::string& context);

}  // namespace culprit::fleet

// An incident's id as the number that the database of a fleet has for it: "mywpiwzf-0k7" by its digits in base 36. Runs of
// older culprits have the row of the first failure there, which is far smaller.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace culprit::fleet {

// 0: it is no id.
std::int64_t incident_number(std::string_view id);
// Empty: an older culprit told no id.
std::string incident_id(std::int64_t number);

}  // namespace culprit::fleet

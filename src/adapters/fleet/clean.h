// Names on their way to a database: no zero bytes, which PostgreSQL has not, valid UTF-8, and no
// longer than any name that people give.
#pragma once

#include <string>
#include <string_view>

namespace culprit::fleet {

std::string clean(std::string_view name);

}  // namespace culprit::fleet

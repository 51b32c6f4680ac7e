// The project's claims about speed, beside the measurements: the table at the end of `make bench`.
#pragma once

#include <string>

namespace culprit::bench {

// `measured` may not exceed `limit`. From any thread.
void claim(std::string what, double measured, double limit, std::string unit);

// Prints the table. Whether all claims held.
bool print_claims();

}  // namespace culprit::bench

// Units behind numbers, where the language has none: only durations have one, without a blank in front.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "language/diagnostic.h"
#include "language/scanner.h"
#include "language/syntax.h"

namespace culprit {

// "500 ms", "5 Hz", "2 GB": `scanner` has the letters `unit` next, behind `number`. Nothing: they are no unit.
std::optional<Diagnostic> unit_behind_blank(const Token& number, std::string_view unit,
                                            const Scanner& scanner);

// "8/s": the operator `op` behind the value `left`; `scanner` has the unit next.
std::optional<Diagnostic> per_second(const syntax::Expression& left, const Token& op,
                                     const Scanner& scanner);

// The meaning of a number with a unit that no duration has: "5Hz", "2GB", "30deg".
struct UnitSlip {
  std::string remedy;
  std::optional<Edit> fix{};
};
UnitSlip slip_of_unit(const Token& token);

}  // namespace culprit

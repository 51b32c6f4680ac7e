#include "language/foreign_units.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <variant>

#include "language/line_reader.h"

namespace culprit {
namespace {

bool is_physical_unit(std::string_view unit) {
  constexpr auto kUnits = std::to_array<std::string_view>(
      {"C",  "F",  "f",   "K",   "V",   "mV", "A",  "mA", "W",  "m",  "cm",
       "mm", "km", "deg", "rad", "rpm", "N",  "Nm", "kg", "dB", "dBm"});
  return std::ranges::find(kUnits, unit) != kUnits.end();
}

// The number in MiB; nothing: `unit` is none of memory.
std::optional<std::string> remedy_of_memory(std::string_view number, std::string_view unit) {
  const std::string upper = upper_case(unit);
  const bool is_mebi = upper == "MB" || upper == "MIB" || unit == "M";
  const bool is_gibi = upper == "GB" || upper == "GIB" || unit == "G";
  if (is_mebi) return std::string(number);
  double gibi = 0;
  const char* end = number.data() + number.size();
  if (!is_gibi || std::from_chars(number.data(), end, gibi).ec != std::errc()) return std::nullopt;
  return std::to_string(static_cast<std::int64_t>(gibi * 1024));
}

}  // namespace

std::optional<Diagnostic> unit_behind_blank(const Token& number, std::string_view unit,
                                            const Scanner& scanner) {
  const auto end = scanner.position() + static_cast<std::uint32_t>(unit.size());
  if (is_hertz(unit))
    return Diagnostic{Code::kSyntax,
                      Severity::kError,
                      {number.span.begin, end},
                      "rates are in Hz and have no unit",
                      "leave the unit out",
                      Edit{{number.span.end, end}, ""}};
  const std::string written(scanner.text(number.span));
  if (const auto remedy = remedy_of_memory(written, unit))
    return Diagnostic{Code::kSyntax,
                      Severity::kError,
                      {number.span.begin, end},
                      "memory is in MiB and has no unit",
                      "write " + *remedy,
                      Edit{{number.span.begin, end}, *remedy}};
  if (unit == "m")
    return Diagnostic{Code::kSyntax,
                      Severity::kError,
                      {number.span.begin, end},
                      "a duration has no blank in it",
                      "write " + written + "min for minutes, or " + written + "ms"};
  const std::string meant(duration_unit(unit));
  if (meant.empty()) return std::nullopt;
  return Diagnostic{Code::kSyntax,
                    Severity::kError,
                    {number.span.begin, end},
                    "a duration has no blank in it",
                    "write " + written + meant,
                    Edit{{number.span.end, end}, meant}};
}

std::optional<Diagnostic> per_second(const syntax::Expression& left, const Token& op,
                                     const Scanner& scanner) {
  const Token& second = scanner.peek();
  const bool is_so = left.kind == syntax::Expression::Kind::kLiteral && op.is("/") &&
                     op.span.begin == left.span.end && second.span.begin == op.span.end &&
                     (second.text == "s" || second.text == "sec" || second.text == "second");
  if (!is_so) return std::nullopt;
  const Span span{left.span.begin, second.span.end};
  const std::string number(scanner.text(left.span));
  return Diagnostic{
      Code::kTypeMismatch, Severity::kError,  span, "rates are in Hz and have no unit",
      "write " + number,   Edit{span, number}};
}

UnitSlip slip_of_unit(const Token& token) {
  UnitSlip slip;
  slip.remedy = "a unit is one of ns, us, ms, s, min and h, as in 500ms";
  const auto number =
      std::get<std::string_view>(token.literal).substr(0, token.span.end - token.span.begin);
  const auto end = number.find_first_not_of(".0123456789");
  if (end == std::string_view::npos) return slip;
  const std::string value(number.substr(0, end));
  const std::string_view unit = number.substr(end);
  if (is_physical_unit(unit)) {
    slip.remedy = "only durations have a unit: write " + value;
    slip.fix = Edit{token.span, value};
  }
  if (is_hertz(unit)) {
    slip.remedy = "rates are in Hz and have no unit: write " + value;
    slip.fix = Edit{token.span, value};
  }
  if (const auto meant = remedy_of_memory(value, unit)) {
    slip.remedy = "memory is in MiB and has no unit: write " + *meant;
    slip.fix = Edit{token.span, *meant};
  }
  return slip;
}

}  // namespace culprit

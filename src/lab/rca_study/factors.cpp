#include "rca_study/factors.h"

#include <charconv>
#include <optional>

#include <fmt/core.h>

#include "base/units.h"
#include "study/json_fields.h"

namespace culprit::study::rca {
namespace {

const RcaFactors kUsual;

std::optional<double> whole_number(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

// The unit may stand at the end of the range only.
std::string_view unit_of(std::string_view text) {
  const std::size_t last = text.find_last_of("0123456789.");
  return last == std::string_view::npos ? "" : text.substr(last + 1);
}

std::string as_option(const RangeOfSeconds& range) {
  return fmt::format("{:g}..{:g}s", range.low, range.high);
}

std::string in_words(const RangeOfSeconds& range) {
  return range.low == range.high ? fmt::format("{:g} s", range.low)
                                 : fmt::format("{:g} to {:g} s", range.low, range.high);
}

Json as_json(const RangeOfSeconds& range) { return Json::array({range.low, range.high}); }

RangeOfSeconds range_of(JsonFields& fields, std::string_view name, RangeOfSeconds usual) {
  if (!fields.has(name)) return usual;
  const std::vector<double> ends = fields.numbers(name);
  if (ends.size() == 2 && ends[0] >= 0 && ends[0] <= ends[1] && ends[1] <= RcaFactors::kLongest_s)
    return {ends[0], ends[1]};
  fields.complain(name, fmt::format("is no range between 0 and {:g}", RcaFactors::kLongest_s));
  return usual;
}

double number_of(JsonFields& fields, std::string_view name, double most, double usual) {
  if (!fields.has(name)) return usual;
  const double value = fields.number(name);
  if (value >= 0 && value <= most) return value;
  fields.complain(name, fmt::format("is not between 0 and {:g}", most));
  return usual;
}

}  // namespace

Expected<RangeOfSeconds> parse_range(std::string_view text) {
  constexpr std::string_view kRemedy = "write a range such as 0..3s or 200ms..1s";
  const std::size_t dots = text.find("..");
  const std::string high(dots == std::string_view::npos ? text : text.substr(dots + 2));
  std::string low(text.substr(0, dots));
  if (unit_of(low).empty()) low += unit_of(high);
  const auto first = parse_duration(low);
  const auto last = parse_duration(high);
  if (!first || !last) return Error{fmt::format("'{}' is no range of time; {}", text, kRemedy)};
  if (*first > *last)
    return Error{
        fmt::format("'{}' ends before it begins; write the smaller value first, as in "
                    "{}..{}",
                    text, culprit::to_string(*last), culprit::to_string(*first))};
  if (*first < Duration::zero() || seconds(*last) > RcaFactors::kLongest_s)
    return Error{
        fmt::format("'{}' is not within 0..{:g}s; {}", text, RcaFactors::kLongest_s, kRemedy)};
  return RangeOfSeconds{seconds(*first), seconds(*last)};
}

Expected<double> parse_share(std::string_view text, double most) {
  const bool is_percent = text.ends_with('%');
  const auto number = whole_number(is_percent ? text.substr(0, text.size() - 1) : text);
  const std::string remedy =
      fmt::format("write a share from 0 to {:g}%, such as 30% or 0.3", 100 * most);
  if (!number) return Error{fmt::format("'{}' is no share; {}", text, remedy)};
  const double share = is_percent ? *number / 100 : *number;
  if (!(share >= 0 && share <= most))
    return Error{fmt::format("'{}' is out of range; {}", text, remedy)};
  return share;
}

std::string describe(const RcaFactors& factors) {
  std::string all;
  const auto add = [&](const std::string& what) { all += (all.empty() ? "" : ", ") + what; };
  if (factors.detector_latency_s != kUsual.detector_latency_s)
    add(fmt::format("detectors {} late", in_words(factors.detector_latency_s)));
  if (factors.states_latency) add("latencies stated in impacts");
  if (factors.pass != kUsual.pass) add(fmt::format("{:g} % pass failures on", 100 * factors.pass));
  if (factors.delay_s != kUsual.delay_s)
    add(fmt::format("failures passed on after {}", in_words(factors.delay_s)));
  if (factors.unwatched > 0)
    add(fmt::format("{:g} % of components unwatched", 100 * factors.unwatched));
  if (factors.hidden > 0) add(fmt::format("{:g} % of dependencies hidden", 100 * factors.hidden));
  if (factors.common_causes > 0) add(fmt::format("common causes: {}", factors.common_causes));
  if (factors.false_alarms > 0)
    add(fmt::format("false alarms: {:g} a minute and detector", factors.false_alarms));
  if (factors.faults_before > 0) add(fmt::format("after {} other faults", factors.faults_before));
  return all;
}

std::string options_of(const RcaFactors& factors) {
  std::string all;
  if (factors.detector_latency_s != kUsual.detector_latency_s)
    all += " --detector-latency " + as_option(factors.detector_latency_s);
  if (factors.states_latency) all += " --stated";
  if (factors.pass != kUsual.pass) all += fmt::format(" --pass {:g}%", 100 * factors.pass);
  if (factors.delay_s != kUsual.delay_s) all += " --delay " + as_option(factors.delay_s);
  if (factors.unwatched > 0) all += fmt::format(" --unwatched {:g}%", 100 * factors.unwatched);
  if (factors.hidden > 0) all += fmt::format(" --hidden {:g}%", 100 * factors.hidden);
  if (factors.common_causes > 0) all += fmt::format(" --common-causes {}", factors.common_causes);
  if (factors.false_alarms > 0) all += fmt::format(" --false-alarms {:g}", factors.false_alarms);
  if (factors.faults_before > 0) all += fmt::format(" --faults-before {}", factors.faults_before);
  return all;
}

Json to_json(const RcaFactors& factors) {
  Json json = Json::object();
  if (factors.detector_latency_s != kUsual.detector_latency_s)
    json["detector_latency_s"] = as_json(factors.detector_latency_s);
  if (factors.states_latency) json["stated"] = true;
  if (factors.pass != kUsual.pass) json["pass"] = factors.pass;
  if (factors.delay_s != kUsual.delay_s) json["delay_s"] = as_json(factors.delay_s);
  if (factors.unwatched > 0) json["unwatched"] = factors.unwatched;
  if (factors.hidden > 0) json["hidden"] = factors.hidden;
  if (factors.common_causes > 0) json["common_causes"] = factors.common_causes;
  if (factors.false_alarms > 0) json["false_alarms"] = factors.false_alarms;
  if (factors.faults_before > 0) json["faults_before"] = factors.faults_before;
  return json;
}

Expected<RcaFactors> factors_from_json(const Json& json) {
  JsonFields fields(json);
  RcaFactors factors;
  factors.detector_latency_s = range_of(fields, "detector_latency_s", kUsual.detector_latency_s);
  factors.states_latency = fields.has("stated") && fields.truth("stated");
  factors.pass = number_of(fields, "pass", 1, kUsual.pass);
  factors.delay_s = range_of(fields, "delay_s", kUsual.delay_s);
  factors.unwatched = number_of(fields, "unwatched", RcaFactors::kMostUnwatched, 0);
  factors.hidden = number_of(fields, "hidden", 1, 0);
  if (fields.has("common_causes"))
    factors.common_causes = fields.natural("common_causes", RcaFactors::kMostCommonCauses);
  factors.false_alarms = number_of(fields, "false_alarms", RcaFactors::kMostFalseAlarms, 0);
  if (fields.has("faults_before"))
    factors.faults_before = fields.natural("faults_before", RcaFactors::kMostFaultsBefore);
  if (const std::string complaint = fields.complaint(); !complaint.empty()) return Error{complaint};
  return factors;
}

}  // namespace culprit::study::rca

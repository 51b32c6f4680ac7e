#include "rule_test/result_report.h"

#include <algorithm>
#include <cstdio>

#include "base/xml.h"
#include "knowledge/describe.h"

namespace culprit::rule_test {
namespace {

std::string in_seconds(Duration d, const char* format) {
  char text[64];
  std::snprintf(text, sizeof text, format, seconds(d));
  return text;
}

std::string disappointment_line(const Disappointment& d, const Source& source) {
  const Position at = source.position(d.expectation.begin);
  return "    " + source.name() + ":" + std::to_string(at.line) + ": " +
         std::string(source.text(d.expectation)) + ": " + d.instead + "\n";
}

// The presence of components at the start is no news.
bool is_beginning(const Event& event) {
  return event.at == Time{} && std::holds_alternative<ComponentFound>(event.what);
}

std::string timeline(const Result& result, const RuleSet& rules) {
  std::string out;
  for (const Event& event : result.events) {
    const std::string text = is_beginning(event) ? "" : describe(event, rules);
    if (!text.empty()) out += in_seconds(event.at.time_since_epoch(), "    %8.3f  ") + text + "\n";
  }
  return out.empty() ? "    nothing happened\n" : "    what happened:\n" + out;
}

std::size_t failures(const SuiteReport& suite) {
  return static_cast<std::size_t>(std::count_if(suite.cases.begin(), suite.cases.end(),
                                                [](const auto& c) { return !c.failure.empty(); }));
}

std::string counts(std::size_t tests, std::size_t failed, Duration time) {
  return " tests=\"" + std::to_string(tests) + "\" failures=\"" + std::to_string(failed) +
         "\" errors=\"0\" time=\"" + in_seconds(time, "%.3f") + "\"";
}

}  // namespace

std::string report(const Result& result, const Source& source, const RuleSet& rules) {
  std::string out = std::string(result.is_ok() ? "  ok      " : "  FAILED  ") + result.name + " (" +
                    in_seconds(result.length, "%g") + " s)\n";
  if (result.is_ok()) return out;
  for (const Disappointment& d : result.disappointments) out += disappointment_line(d, source);
  return out + timeline(result, rules);
}

std::string junit(const std::vector<SuiteReport>& suites) {
  std::size_t all_tests = 0;
  std::size_t all_failed = 0;
  Duration all_time{};
  std::string body;
  for (const SuiteReport& suite : suites) {
    Duration time{};
    std::string cases;
    for (const SuiteReport::Case& test : suite.cases) {
      time += test.length;
      cases += "    <testcase classname=\"" + xml_escaped(suite.name) + "\" name=\"" +
               xml_escaped(test.name) + "\" time=\"" + in_seconds(test.length, "%.3f") + "\"";
      if (test.failure.empty()) {
        cases += "/>\n";
        continue;
      }
      cases += ">\n      <failure message=\"an expectation was not met\">" +
               xml_escaped(test.failure) + "</failure>\n    </testcase>\n";
    }
    body += "  <testsuite name=\"" + xml_escaped(suite.name) + "\"" +
            counts(suite.cases.size(), failures(suite), time) + ">\n" + cases + "  </testsuite>\n";
    all_tests += suite.cases.size();
    all_failed += failures(suite);
    all_time += time;
  }
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites" +
         counts(all_tests, all_failed, all_time) + ">\n" + body + "</testsuites>\n";
}

}  // namespace culprit::rule_test

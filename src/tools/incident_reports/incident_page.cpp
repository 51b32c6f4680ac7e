#include "incident_reports/incident_page.h"

#include <algorithm>
#include <map>

#include <fmt/core.h>

#include "base/joined.h"
#include "base/xml.h"
#include "incident_reports/curve_plot.h"
#include "incident_reports/evidence_part.h"
#include "incident_reports/incident_words.h"
#include "incident_reports/page_parts.h"
#include "journal/json.h"

namespace culprit::incident_reports {
namespace {

// The colours are those of the page (ui/src/app.css).
constexpr std::string_view kStyle =
    R"(:root{color-scheme:light dark;--surface:#fff;--raised:#f4f5f7;--text:#1b1f24;--muted:#59636e;--faint:#d8dee4;--accent:#0a5cc4;--ok:#3f6b50;--note:#2f6fa8;--warning:#8a5a00;--error:#b42318}
@media (prefers-color-scheme:dark){:root{--surface:#12161c;--raised:#1c222b;--text:#e8edf3;--muted:#a3afbd;--faint:#303a46;--accent:#6db0ff;--ok:#6fae86;--note:#73b3ec;--warning:#f0b429;--error:#ff8a7e}}
body{background:var(--surface);color:var(--text);font:15px/1.5 system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem;overflow-wrap:anywhere}
table{border-collapse:collapse;width:100%;margin:.4rem 0 1rem}td,th{text-align:left;vertical-align:top;padding:.2rem .8rem .2rem 0;border-bottom:1px solid var(--faint)}
th{font-weight:600}time,td:first-child,th[scope=row]{font-variant-numeric:tabular-nums;white-space:nowrap}
svg{display:block;width:100%;height:auto;background:var(--raised);border-radius:6px}text{fill:var(--text);font-size:12px}line{stroke:var(--faint)}
.onset{width:40%}.onset line{stroke:var(--muted)}.for{fill:var(--error)}.against{fill:var(--surface);stroke:var(--ok);stroke-width:2}
.ERROR{fill:var(--error)}.WARNING{fill:var(--warning)}.NON_CRITICAL{fill:var(--note)}
figure{margin:0 0 .9rem;break-inside:avoid}figcaption{margin-bottom:.15rem}.why,.note{color:var(--muted)}
.curve{fill:none;stroke:var(--accent);stroke-width:1.6;stroke-linejoin:round;stroke-linecap:round}.limit{stroke:var(--warning);stroke-dasharray:5 4}
.mark line{stroke-width:1.2}.detected line,.given-up line{stroke:var(--error)}.detected text,.given-up text{fill:var(--error)}
.decided line{stroke:var(--note)}.decided text{fill:var(--note)}.no-help line{stroke:var(--warning)}.no-help text{fill:var(--warning)}.resolved line{stroke:var(--ok)}.resolved text{fill:var(--ok)})";

// How it went for each rule: a bar while it failed, and a sign for each decision.
class CourseOfRules {
 public:
  explicit CourseOfRules(const PageContent& content)
      : content_(content),
        end_(content.incident.began + content.incident.seconds),
        margin_(std::max(0.1, 0.05 * content.incident.seconds)) {}

  std::string drawn() const {
    const std::vector<std::string>& rules = content_.incident.rules;
    const double high = kRowHigh * static_cast<double>(rules.size());
    std::string out =
        fmt::format("<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"Failures over time\">",
                    kWide, high + 22);
    constexpr int kTicks = 4;
    for (int i = 0; i <= kTicks; ++i) {
      const double at = end_ * i / kTicks + content_.incident.began * (kTicks - i) / kTicks;
      out += fmt::format(
          "<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"0\" y2=\"{1}\"/><text x=\"{0:.1f}\" y=\"{2}\" "
          "text-anchor=\"middle\">{3}</text>",
          x(at), high, high + 16, on_clock(at));
    }
    for (std::size_t i = 0; i < rules.size(); ++i)
      out += course_of(rules[i], kRowHigh * static_cast<double>(i));
    return out + "</svg>\n";
  }

 private:
  static constexpr double kWide = 900;
  static constexpr double kNames = 200;  // before them
  static constexpr double kEdge = 40;    // behind: half of a time
  static constexpr double kRowHigh = 24;

  double x(double at) const {
    const double begin = content_.incident.began - margin_;
    return kNames + (at - begin) / (end_ + margin_ - begin) * (kWide - kEdge - kNames);
  }
  std::string bar(const Json& from, double to, double y) const {
    const double left = x(clock_of(from));
    return fmt::format(
        "<rect class=\"{}\" x=\"{:.1f}\" y=\"{}\" width=\"{:.1f}\" height=\"{}\" rx=\"2\"/>",
        criticality_class(from), left, y + 5, std::max(3.0, x(to) - left), kRowHigh - 10);
  }
  std::string course_of(const std::string& rule, double y) const {
    std::string bars;
    std::string signs;
    const Json* failing = nullptr;
    for (const Json& event : content_.events) {
      if (journal::text_of(event, "rule") != rule) continue;
      const std::string type = journal::text_of(event, "type");
      if (type == "failure_detected") failing = &event;
      if (failing != nullptr && (type == "failure_resolved" || type == "failure_lost")) {
        bars += bar(*failing, clock_of(event), y);
        failing = nullptr;
      }
      if (type == "strategy_chosen")
        signs +=
            fmt::format("<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
                        x(clock_of(event)), y + 17, journal::flag_of(event, "dry_run") ? "▽" : "▼");
    }
    if (failing != nullptr) bars += bar(*failing, end_, y);
    return fmt::format("<text x=\"8\" y=\"{}\">{}</text>", y + 17, xml_escaped(rule)) + bars +
           signs;
  }

  const PageContent& content_;
  const double end_;
  const double margin_;
};

std::vector<Mark> marks_in(const std::vector<Json>& events) {
  static const std::map<std::string, Mark::Kind> kKinds = {
      {"failure_detected", Mark::Kind::kDetected},
      {"strategy_chosen", Mark::Kind::kDecided},
      {"strategy_failed", Mark::Kind::kNoHelp},
      {"failure_resolved", Mark::Kind::kResolved},
      {"rule_exhausted", Mark::Kind::kGivenUp}};
  std::vector<Mark> marks;
  for (const Json& event : events) {
    const auto kind = kKinds.find(journal::text_of(event, "type"));
    if (kind != kKinds.end())
      marks.push_back({kind->second, clock_of(event), journal::text_of(event, "text")});
  }
  return marks;
}

std::string recorded(const PageContent& content) {
  std::string out = "<h2>What was recorded</h2>\n";
  for (const std::string& remark : content.remarks)
    out += "<p class=\"note\">" + xml_escaped(remark) + "</p>\n";
  if (!content.curves) return out;
  for (const std::string& remark : content.curves->remarks)
    out += "<p class=\"note\">" + xml_escaped(remark) + "</p>\n";
  if (content.curves->curves.empty())
    return out + "<p>There is no number in it that has to do with this incident.</p>\n";
  constexpr double kSecondsPer = 1e-9;  // ns
  const PlotFrame frame{static_cast<double>(content.curves->begin) * kSecondsPer,
                        static_cast<double>(content.curves->end) * kSecondsPer,
                        content.incident.began, marks_in(content.events)};
  out += fmt::format(
      "<p>Times are seconds since {}, at {}. {} a failure was detected, {} decided, {} did not "
      "help, {} resolved, {} exhausted; dashed: a limit of a rule. Where a line is interrupted "
      "nothing came.</p>\n",
      content.whole ? "the recording began" : "the first failure was detected",
      on_clock(content.incident.began), sign_of(Mark::Kind::kDetected),
      sign_of(Mark::Kind::kDecided), sign_of(Mark::Kind::kNoHelp), sign_of(Mark::Kind::kResolved),
      sign_of(Mark::Kind::kGivenUp));
  std::size_t number = 0;
  for (const Curve& curve : content.curves->curves) out += plot_of(curve, frame, ++number);
  return out;
}

std::string candidate_row(const Json& decision, const Json& candidate) {
  const std::string name = journal::text_of(candidate, "strategy");
  const auto excluded = candidate.find("excluded");
  const bool is_excluded = excluded != candidate.end() && !excluded->is_null();
  const double cost = journal::number_of(candidate, "cost");
  const bool is_chosen = journal::text_of(decision, "type") == "strategy_chosen" &&
                         journal::text_of(decision, "strategy") == name;
  std::string why;
  if (is_excluded) why = safe_text(*excluded, "text");
  if (is_chosen) why = "<b>chosen</b>";
  return row_of(
      {xml_escaped(name), is_excluded && cost == 0 ? "–" : fmt::format("{:.2f}", cost), why});
}

std::string decisions(const std::vector<Json>& events) {
  std::string out;
  for (const Json& event : events) {
    const Json& candidates = list_in(event, "candidates");
    if (candidates.empty()) continue;
    std::string suspects;
    for (const Json& each : list_in(event, "suspects"))
      suspects += (suspects.empty() ? "" : ", ") + safe_text(each, "component") +
                  fmt::format(" {:.0f} %", 100 * journal::number_of(each, "probability"));
    out += "<h3><time>" + on_clock(clock_of(event)) + "</time> " + safe_text(event, "text") +
           "</h3>\n";
    if (!suspects.empty()) out += "<p>Possible causes: " + suspects + "</p>\n";
    out += evidence_of(event);
    std::string rows;
    for (const Json& each : candidates) rows += candidate_row(event, each);
    out += table_of({"strategy", "relative cost", "why, or why not"}, rows);
  }
  return out.empty() ? "<p>No decisions.</p>\n" : out;
}

std::string requests(const std::vector<Request>& all) {
  if (all.empty()) return "";
  std::string rows;
  for (const Request& each : all)
    rows += row_of({on_clock(each.clock), xml_escaped(each.text),
                    xml_escaped(each.answer.empty() ? "none was recorded" : each.answer),
                    each.seconds ? lasting_text(*each.seconds) : ""});
  return "<h2>Requests and answers</h2>\n" + table_of({"time", "request", "answer", "after"}, rows);
}

std::string facts_of_incident(const PageContent& content) {
  const Incident& incident = content.incident;
  std::string suffered = xml_escaped(joined(incident.consequences));
  if (suffered.empty()) suffered = "nothing else";
  std::string facts =
      fact("robot", xml_escaped(content.robot)) +
      fact("cause", "<b>" + xml_escaped(cause_of(incident)) + "</b>") +
      fact("what suffered", suffered) +
      fact("lasted", lasting_text(incident.seconds) + (incident.is_over ? "" : " so far")) +
      fact("what helped", xml_escaped(outcome_of(incident)));
  if (!content.recordings.empty())
    facts += fact("recorded", xml_escaped(joined(content.recordings)));
  return facts;
}

std::string facts_of_recording(const PageContent& content) {
  std::string facts;
  if (!content.robot.empty()) facts += fact("robot", xml_escaped(content.robot));
  return facts + fact("length", lasting_text(content.incident.seconds)) +
         fact("rules", xml_escaped(content.whole->rules));
}

std::string incident_table(const PageContent& content) {
  if (content.whole->incidents.empty()) return "";
  std::string rows;
  for (const WholeRecording::Line& each : content.whole->incidents)
    rows += row_of(
        {fmt::format("{:.1f} s, {}", each.began - content.incident.began, on_clock(each.began)),
         "<b>" + xml_escaped(each.headline) + "</b>", xml_escaped(each.effects),
         lasting_text(each.seconds), xml_escaped(each.end)});
  return "<h2>Incidents</h2>\n" + table_of({"from", "incident", "effects", "lasted", "end"}, rows);
}

std::string course_over_time(const PageContent& content) {
  if (content.incident.rules.empty() && content.whole) return "<p>No rule fired.</p>\n";
  return "<h2>When</h2>\n" + CourseOfRules(content).drawn();
}

}  // namespace

std::string incident_page(const PageContent& content) {
  const Incident& incident = content.incident;
  const std::string about = content.whole ? joined(content.recordings) : cause_of(incident);
  const std::string title = xml_escaped(about) + ", " + on_calendar(incident.began) + " " +
                            formatted(incident.began, "%H:%M:%S");
  const std::string facts =
      content.whole ? facts_of_recording(content) : facts_of_incident(content);
  std::string log;
  for (const Json& event : content.events)
    log += row_of({on_clock(clock_of(event)), safe_text(event, "label"), safe_text(event, "text")});
  return "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
         "content=\"width=device-width, initial-scale=1\"><title>" +
         title + "</title><style>" + std::string(kStyle) + "</style></head><body><main>\n<h1>" +
         title + "</h1>\n<table><tbody>" + facts + "</tbody></table>\n" +
         (content.whole ? incident_table(content) : "") + course_over_time(content) +
         onsets_of(content.events, incident.began + incident.seconds) + recorded(content) +
         "<h2>Decisions</h2>\n" + decisions(content.events) + requests(content.requests) +
         "<h2>Event log</h2>\n" + table_of({"time", "what", "in words"}, log) +
         fmt::format(
             "<p class=\"note\">Written by culprit, {} {}. Times are those of the clock of the "
             "computer that wrote this ({}).</p></main></body></html>\n",
             on_calendar(content.written_at), formatted(content.written_at, "%H:%M:%S"),
             time_zone(incident.began));
}

}  // namespace culprit::incident_reports

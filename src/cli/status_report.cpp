#include "cli/status_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <string_view>

#include <fmt/core.h>

#include "base/amount.h"
#include "base/name_grammar.h"
#include "knowledge/describe.h"
#include "terminal/console.h"

namespace culprit::cli {
namespace {

// ---- documents of any form

const Json kNothing = nullptr;

const Json& member_at(const Json& json, const char* name) {
  const auto found = json.is_object() ? json.find(name) : json.end();
  return json.is_object() && found != json.end() ? *found : kNothing;
}
std::string text_at(const Json& json, const char* name) {
  const Json& text = member_at(json, name);
  return text.is_string() ? escape_controls(text.get<std::string>()) : "";
}
bool is_set(const Json& json, const char* name) {
  const Json& flag = member_at(json, name);
  return flag.is_boolean() && flag.get<bool>();
}
std::optional<double> number_at(const Json& json, const char* name) {
  const Json& number = member_at(json, name);
  return number.is_number() ? std::optional(number.get<double>()) : std::nullopt;
}
std::vector<Json> list_at(const Json& json, const char* name) {
  const Json& list = member_at(json, name);
  return list.is_array() ? list.get<std::vector<Json>>() : std::vector<Json>{};
}
std::vector<std::string> texts_at(const Json& json, const char* name) {
  std::vector<std::string> texts;
  for (const Json& each : list_at(json, name)) {
    if (each.is_string()) texts.push_back(escape_controls(each.get<std::string>()));
  }
  return texts;
}

// ---- words

enum class Precision : std::uint8_t { kSecond, kTenth };

// "14:03:12"; with the day if it is another one than that of `now`. Both in seconds since 1970.
std::string by_the_clock(double clock, double now, Precision precision = Precision::kSecond) {
  const auto at = static_cast<std::time_t>(std::floor(clock));
  const auto today = static_cast<std::time_t>(std::floor(now));
  std::tm day{};
  std::tm day_now{};
  localtime_r(&at, &day);
  localtime_r(&today, &day_now);
  const bool is_today = day.tm_yday == day_now.tm_yday && day.tm_year == day_now.tm_year;
  char text[64];
  std::strftime(text, sizeof text, is_today ? "%H:%M:%S" : "%Y-%m-%d %H:%M:%S", &day);
  const auto tenths = static_cast<int>(10 * (clock - std::floor(clock)));
  return precision == Precision::kSecond ? text : fmt::format("{}.{}", text, tenths);
}

// "8.2s", "3min", "2h": as long as it lasts by now.
std::string lasting(double seconds) {
  if (seconds < 60) return fmt::format("{:.1f} s", std::max(0.0, seconds));
  const auto whole = static_cast<long>(seconds);
  if (seconds < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
  return fmt::format("{} h {} min", whole / 3600, whole / 60 % 60);
}

std::string tinted(const std::string& text, Tone tone, Colour colour) {
  return in_tone(text, tone, Weight::kStrong, colour);
}

// The wall clock at culprit's time `t`; empty: unknown.
std::optional<double> clock_at(const WhatCulpritSays& said, double t) {
  const auto now = number_at(said.state, "t");
  const auto clock = number_at(said.state, "clock");
  return now && clock ? std::optional(*clock - (*now - t)) : std::nullopt;
}

std::string since(const WhatCulpritSays& said, const Json& incident) {
  const auto t = number_at(incident, "since");
  const auto now = number_at(said.state, "t");
  const auto clock = number_at(said.state, "clock");
  if (!t || !now || !clock) return "";
  return fmt::format("since {}, for {}", by_the_clock(*clock_at(said, *t), *clock),
                     lasting(*now - *t));
}

// The modes that restrict culprit, in words; empty: none.
std::vector<std::string> modes_of(const Json& control) {
  std::vector<std::string> modes;
  if (is_set(control, "paused")) modes.emplace_back("paused");
  if (control.is_object() && !is_set(control, "hears")) modes.emplace_back("deaf");
  if (is_set(control, "dry_run")) modes.emplace_back("only advises");
  if (!list_at(control, "asked").empty()) modes.emplace_back("asks");
  if (!list_at(control, "silences").empty()) modes.emplace_back("mutes something");
  return modes;
}

std::string robot_name(const WhatCulpritSays& said) {
  const std::string name = text_at(said.robot, "robot");
  return name.empty() ? "the robot" : name;
}

using Lines = std::vector<std::string>;

// A rule that says nothing: its place in the documents, and why.
struct BlindRule {
  std::string name;
  std::string criticality;  // of a rule that is not known: ERROR
  Json blind;
};

std::vector<BlindRule> blind_rules(const WhatCulpritSays& said) {
  const auto rules = list_at(said.state, "rules");
  const auto names = list_at(said.robot, "rules");
  std::vector<BlindRule> all;
  for (std::size_t r = 0; r < rules.size(); ++r) {
    const Json& blind = member_at(rules[r], "blind");
    if (!blind.is_object()) continue;
    const Json& rule = r < names.size() ? names[r] : kNothing;
    const std::string criticality = text_at(rule, "criticality");
    all.push_back({text_at(rule, "name"), criticality.empty() ? "ERROR" : criticality, blind});
  }
  return all;
}

// How the robot is, as the running culprit has decided (web/overview.h).
std::string look_of(const WhatCulpritSays& said) {
  return text_at(member_at(said.state, "overview"), "look");
}

Tone tone_of(const std::string& look) {
  if (look == "OK") return Tone::kRelief;
  if (look == "ERROR" || look == "EXHAUSTED" || look == "MISSING") return Tone::kAlarm;
  return look == "NON_CRITICAL" ? Tone::kAside : Tone::kWarning;
}

void add_incident(const WhatCulpritSays& said, const Json& incident, Colour colour, Lines& lines) {
  const std::string health = text_at(incident, "health");
  const std::string id = text_at(incident, "id");
  lines.push_back(fmt::format(
      "  {}  ({}, rule {}{})", tinted(text_at(incident, "headline"), tone_of(health), colour),
      health, text_at(incident, "rule"), id.empty() ? "" : ", incident " + id));
  if (const std::string when = since(said, incident); !when.empty())
    lines.push_back("      " + when);
  const auto consequences = texts_at(incident, "consequences");
  if (!consequences.empty())
    lines.push_back("      and so " + (consequences.size() == 1 ? "fails " : std::string("fail ")) +
                    listed(consequences));
  lines.push_back("      now: " + text_at(incident, "doing"));
  if (const std::string next = text_at(incident, "next"); !next.empty())
    lines.push_back("      next: " + next);
}

// ERROR rules first.
void add_blind(const WhatCulpritSays& said, Colour colour, Lines& lines) {
  constexpr std::size_t kMost = 8;
  std::vector<BlindRule> blind = blind_rules(said);
  std::stable_partition(blind.begin(), blind.end(),
                        [](const BlindRule& rule) { return rule.criticality == "ERROR"; });
  for (std::size_t i = 0; i < std::min(kMost, blind.size()); ++i) {
    const std::string when = since(said, blind[i].blind);
    lines.push_back(fmt::format(
        "  {}: {}  ({}{}{})", tinted(blind[i].name + " is blind", Tone::kWarning, colour),
        text_at(blind[i].blind, "text"), blind[i].criticality, when.empty() ? "" : ", ", when));
  }
  if (blind.size() > kMost)
    lines.push_back(fmt::format("  {} more rules are blind", blind.size() - kMost));
}

// Lists people's orders and the questions to them.
void add_people(const WhatCulpritSays& said, Lines& lines) {
  const Json& control = said.control;
  const double now = number_at(said.state, "clock").value_or(0);
  if (is_set(control, "paused"))
    lines.emplace_back("  Paused: nothing is changed on the robot until `culprit resume`.");
  if (control.is_object() && !is_set(control, "hears"))
    lines.emplace_back(
        "  Deaf: culprit does not receive the robot's messages, so it judges nothing and does "
        "nothing.");
  if (is_set(control, "dry_run"))
    lines.emplace_back("  It only advises: a dry run, or another culprit manages this robot.");
  for (const Json& each : list_at(control, "asked")) {
    const std::string name = text_at(each, "rule") + "." + text_at(each, "strategy");
    lines.push_back("  Waits for your word: culprit approve " + name + ", or culprit refuse " +
                    name);
  }
  for (const Json& each : list_at(control, "silences")) {
    const std::string name = text_at(each, "component") + text_at(each, "rule");
    const auto until = number_at(each, "until");
    const auto clock = until ? clock_at(said, *until) : std::nullopt;
    const std::string reason = text_at(each, "reason");
    lines.push_back(fmt::format("  Muted: {}{}, by {}{}; culprit mute --lift {}", name,
                                clock ? " until " + by_the_clock(*clock, now) : "",
                                text_at(each, "author"), reason.empty() ? "" : " (" + reason + ")",
                                name));
  }
}

// Lists the components that culprit started, and those that a person ended.
void add_started(const WhatCulpritSays& said, Lines& lines) {
  const double now = number_at(said.state, "clock").value_or(0);
  const bool is_demonstration = said.about.is_object() && text_at(said.about, "version").empty();
  const char* const end =
      is_demonstration ? "; it ends with culprit" : "; it runs on when culprit ends";
  for (const Json& each : list_at(said.control, "started")) {
    const auto since = number_at(each, "since");
    const auto clock = since ? clock_at(said, *since) : std::nullopt;
    const auto launcher = number_at(each, "launcher");
    lines.push_back(fmt::format(
        "  Started by culprit: {} (process {:.0f}){}{}", text_at(each, "component"),
        number_at(each, "pid").value_or(0), clock ? " at " + by_the_clock(*clock, now) : "",
        launcher ? fmt::format(", in place of one of process {:.0f}; it ends with that launch",
                               *launcher)
                 : end));
  }
  for (const Json& each : list_at(said.control, "down"))
    lines.push_back("  Stays down: " + text_at(each, "component") + ": " + text_at(each, "text") +
                    "; culprit revive starts it again");
}

std::string counts_line(const WhatCulpritSays& said) {
  const auto components = list_at(said.state, "components");
  const auto names = list_at(said.robot, "components");
  Lines ill;
  Lines gone;
  Lines unseen;
  for (std::size_t c = 0; c < std::min(components.size(), names.size()); ++c) {
    const std::string name = text_at(names[c], "name");
    const Json& alive = member_at(components[c], "alive");
    if (alive.is_boolean() && !alive.get<bool>()) {
      gone.push_back(name);
    } else if (text_at(components[c], "health") != "OK") {
      ill.push_back(name);
    } else if (text_at(components[c], "condition") == "never seen") {
      unseen.push_back(name);
    }
  }
  std::size_t failing = 0;
  const auto rules = list_at(said.state, "rules");
  for (const Json& rule : rules) failing += text_at(rule, "phase") != "quiet" ? 1 : 0;
  const auto some = [](const Lines& names_of, const char* what) {
    constexpr std::size_t kMost = 8;
    if (names_of.empty()) return std::string();
    Lines first(names_of.begin(),
                names_of.begin() + static_cast<std::ptrdiff_t>(std::min(kMost, names_of.size())));
    if (names_of.size() > kMost) first.push_back(fmt::format("{} more", names_of.size() - kMost));
    return fmt::format(", {} {} ({})", names_of.size(), what, listed(first));
  };
  const std::size_t blind = blind_rules(said).size();
  return fmt::format("{}{}{}{}; {}, {} with a failure{}", amount_of(components.size(), "component"),
                     some(gone, "down"), some(ill, "affected"), some(unseen, "never seen"),
                     amount_of(rules.size(), "rule"), failing,
                     blind == 0 ? "" : fmt::format(", {} blind", blind));
}

std::string event_line(const Json& event, double now, Colour colour) {
  const auto kind = kind_named(text_at(event, "type"));
  EventWords words = kind ? words_of(*kind) : EventWords{};
  const std::string label = text_at(event, "label");
  words.label = label;
  const auto clock = number_at(event, "clock");
  return fmt::format("  {}  {}  {}",
                     clock ? by_the_clock(*clock, now, Precision::kTenth) : "          ",
                     label_of(words, colour), text_at(event, "text"));
}

std::string headline_from(const WhatCulpritSays& said, Colour colour) {
  const auto modes = modes_of(said.control);
  const std::string mode = modes.empty() ? "" : "  [" + listed(modes) + "]";
  const std::string headline = text_at(member_at(said.state, "overview"), "headline");
  if (headline.empty()) return robot_name(said) + ": nothing is known yet" + mode;
  return robot_name(said) + ": " + tinted(headline, tone_of(look_of(said)), colour) + mode;
}

}  // namespace

Verdict verdict_of(const WhatCulpritSays& said) {
  const std::string look = look_of(said);
  const bool may_act = !is_set(said.control, "paused") && is_set(said.control, "hears") &&
                       list_at(said.control, "asked").empty();
  if (!may_act) return Verdict::kNotWell;
  if (look == "OK") return Verdict::kWell;
  constexpr auto kLess = std::to_array<std::string_view>(
      {"BLIND", "TIME_HELD", "NEVER_SEEN", "DEAD", "HUNG", "STOPPED", "UNREACHABLE"});
  return std::ranges::find(kLess, look) != kLess.end() ? Verdict::kSeesLess : Verdict::kNotWell;
}

std::vector<std::string> situation_lines(const WhatCulpritSays& said, Colour colour) {
  Lines lines{headline_from(said, colour)};
  for (const Json& incident : list_at(said.state, "incidents"))
    add_incident(said, incident, colour, lines);
  add_blind(said, colour, lines);
  add_people(said, lines);
  add_started(said, lines);
  lines.push_back(counts_line(said));
  return lines;
}

std::vector<std::string> component_lines(const WhatCulpritSays& said, Colour colour) {
  const auto components = list_at(said.state, "components");
  const auto names = list_at(said.robot, "components");
  Lines well;
  Lines lines{fmt::format("{:<28} {:<12} {:<12} {:<12} now", "component", "health", "process",
                          "lifecycle")};
  for (std::size_t c = 0; c < std::min(components.size(), names.size()); ++c) {
    const Json& each = components[c];
    const std::string look = text_at(each, "look");
    const std::string condition = text_at(each, "condition");
    const std::string process = text_at(each, "process");
    const std::string adapting = text_at(each, "adapting");
    // Its look is its health where rules judge it; a component that is down without a failing rule is not OK.
    std::string health = text_at(each, "health");
    if (!look.empty() && look != health) health = "?";
    std::string line =
        fmt::format("{:<28} {} {:<12} {:<12} {}", text_at(names[c], "name"),
                    tinted(fmt::format("{:<12}", health), tone_of(look), colour),
                    condition.empty() ? process : condition, text_at(each, "lifecycle"),
                    adapting.empty() ? text_at(each, "remark") : adapting);
    (look == "OK" ? well : lines).push_back(std::move(line));
  }
  lines.insert(lines.end(), well.begin(), well.end());
  return lines;
}

std::vector<std::string> event_lines(const WhatCulpritSays& said, std::size_t most, Colour colour) {
  Lines lines;
  const double now = number_at(said.state, "clock").value_or(0);
  std::vector<const Json*> told;  // the others are for programs
  for (const Json& event : said.events) {
    if (!text_at(event, "text").empty()) told.push_back(&event);
  }
  for (std::size_t i = told.size() - std::min(most, told.size()); i < told.size(); ++i)
    lines.push_back(event_line(*told[i], now, colour));
  return lines;
}

std::vector<std::string> about_lines(const WhatCulpritSays& said) {
  const auto domain = number_at(said.about, "domain");
  const auto process = number_at(said.about, "process");
  const std::string version = text_at(said.about, "version");  // a demonstration has none
  Lines lines{fmt::format("culprit{}, process {}, domain {}, node /{}, rules {}",
                          version.empty() ? "" : " " + version,
                          process ? fmt::format("{:.0f}", *process) : "?",
                          domain ? fmt::format("{:.0f}", *domain) : "?",
                          text_at(said.about, "node"), text_at(said.about, "rules"))};
  if (const std::string page = text_at(said.about, "page"); !page.empty())
    lines.push_back("in a browser: " + page);
  return lines;
}

}  // namespace culprit::cli

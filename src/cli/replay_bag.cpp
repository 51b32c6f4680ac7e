#include "cli/replay_bag.h"

#include <algorithm>
#include <cmath>
#include <unistd.h>

#include <fmt/core.h>

#include "bag/bag_file.h"
#include "base/amount.h"
#include "base/environment.h"
#include "base/joined.h"
#include "base/live_clock.h"
#include "base/name_grammar.h"
#include "base/text_file.h"
#include "base/units.h"
#include "cli/bag_words.h"
#include "cli/commands.h"
#include "cli/load_rules.h"
#include "incident_reports/bag_page.h"
#include "incident_reports/foxglove.h"
#include "knowledge/describe.h"
#include "replay/bag_replay.h"
#include "terminal/console.h"
#include "terminal/seconds_option.h"

namespace culprit::cli {
namespace {

using replay::BagReplay;
using replay::RuleOutcome;

double milliseconds_of(Duration duration) { return std::round(seconds(duration) * 1000) / 1000; }

// How often and how long, in words.
std::string firing(const RuleOutcome& outcome, const BagReplay& replay) {
  const std::string first =
      outcome.first ? fmt::format("at {:.3f} s ({})", seconds(*outcome.first - *replay.start()),
                                  clock_text(*outcome.first_clock))
                    : "";
  const std::string end = outcome.is_on ? ", still there at the end" : "";
  if (outcome.times == 1)
    return fmt::format("fired once: {}, for {:.3f} s{}", first, seconds(outcome.total), end);
  return fmt::format("fired {} times: first {}, longest {:.3f} s, {:.3f} s in all{}", outcome.times,
                     first, seconds(outcome.longest), seconds(outcome.total), end);
}

std::string verdict(const RuleOutcome& outcome, const BagReplay& replay) {
  if (outcome.times > 0) return firing(outcome, replay);
  if (outcome.is_on) return fmt::format("was there before, for {:.3f} s", seconds(outcome.total));
  if (!outcome.was_known) {
    return "could not be judged: " +
           (outcome.why_unknown.empty()
                ? "its values never covered the windows that it reads, or had no result"
                : joined(outcome.why_unknown, "; "));
  }
  constexpr double kNearlyAll = 0.99;
  const double known = seconds(outcome.known);
  const double all = replay.start() ? seconds(replay.end() - *replay.start()) : 0;
  std::string text = "never true";
  if (known < kNearlyAll * all)
    text += fmt::format("; it could be judged for {:.3f} of {:.3f} s", known, all);
  if (!outcome.why_unknown.empty()) text += "; " + joined(outcome.why_unknown, "; ");
  return text;
}

const char* state_of(const RuleOutcome& outcome) {
  if (outcome.times > 0 || outcome.is_on) return "fired";
  return outcome.was_known ? "never_true" : "not_judged";
}

class BagOutput {
 public:
  BagOutput(const BagReplayOptions& options, const RuleSet& rules)
      : options_(options), rules_(rules) {}

  BagReplay::Listener listener() {
    return {[this](const Event& event, std::int64_t clock) { tell(event, clock); },
            [this](Time from, Time until, std::int64_t clock) { tell_hole(from, until, clock); }};
  }
  void begin_at(Time start) { start_ = start; }

  void finish(const BagReplay& replay, const bag::BagFile& bag, const bag::BagReading& reading) {
    if (options_.json) return print_document(replay, bag, reading);
    print_bag_troubles(bag, replay.start() ? replay.start()->time_since_epoch().count() : 0);
    for (const std::string& each : reading.undecoded()) fmt::print(stderr, "culprit: {}\n", each);
    std::size_t widest = 0;
    for (const Rule& rule : rules_.rules) widest = std::max(widest, rule.name.size());
    const auto outcomes = replay.outcomes();
    if (!outcomes.empty()) fmt::print("\n");
    for (const RuleOutcome& each : outcomes)
      fmt::print("{:<{}}  {}\n", rules_[each.rule].name, widest,
                 escape_controls(verdict(each, replay)));
    const std::string late =
        bag.out_of_order() > 0 ? fmt::format(" ({} out of order)", bag.out_of_order()) : "";
    fmt::print("{}{} in {:.3f} s, {}\n", amount_of(replay.messages(), "message"), late,
               replay.start() ? seconds(replay.end() - *replay.start()) : 0.0,
               amount_of(replay.decisions(), "decision"));
  }

 private:
  void tell(const Event& event, std::int64_t clock) {
    const std::string text = describe(event, rules_);
    if (text.empty()) return;
    const double at = seconds(event.at - start_);
    if (options_.json) {
      events_.push_back({{"at_s", std::round(at * 1000) / 1000},
                         {"clock", clock_document(clock)},
                         {"type", words_of(event).name},
                         {"text", text}});
      return;
    }
    fmt::print("{:10.3f}  {}  {}  {}\n", at, clock_text(clock),
               label_of(words_of(event), colour_of(STDOUT_FILENO)), escape_controls(text));
  }

  void tell_hole(Time from, Time until, std::int64_t clock) {
    if (options_.json) {
      holes_.push_back({{"at_s", milliseconds_of(from - start_)},
                        {"clock", clock_document(clock)},
                        {"for_s", milliseconds_of(until - from)}});
      return;
    }
    fmt::print("{:10.3f}  {}  {:<10}  the copy lacks messages for {:.3f} s; nothing is judged\n",
               seconds(from - start_), clock_text(clock), "hole", seconds(until - from));
  }

  void print_document(const BagReplay& replay, const bag::BagFile& bag,
                      const bag::BagReading& reading) const {
    Json rules = Json::array();
    for (const RuleOutcome& each : replay.outcomes()) {
      Json rule{{"rule", rules_[each.rule].name},
                {"criticality", to_string(rules_[each.rule].policies.criticality)},
                {"state", state_of(each)},
                {"times", each.times},
                {"longest_s", milliseconds_of(each.longest)},
                {"total_s", milliseconds_of(each.total)},
                {"judged_s", milliseconds_of(each.known)},
                {"is_on", each.is_on},
                {"why_unknown", each.why_unknown}};
      if (each.first) {
        rule["first_s"] = milliseconds_of(*each.first - *replay.start());
        rule["first_clock"] = clock_document(*each.first_clock);
      }
      rules.push_back(std::move(rule));
    }
    Json document{{"bag", options_.bag},
                  {"messages", replay.messages()},
                  {"out_of_order", bag.out_of_order()},
                  {"decisions", replay.decisions()},
                  {"rules", std::move(rules)},
                  {"events", events_},
                  {"holes", holes_},
                  {"undecoded", reading.undecoded()}};
    if (replay.start()) {
      document["start"] = clock_document(replay.start_clock());
      document["duration_s"] = milliseconds_of(replay.end() - *replay.start());
    }
    add_bag_troubles(document, bag,
                     replay.start() ? replay.start()->time_since_epoch().count() : 0);
    fmt::print("{}\n", to_line(document));
  }

  const BagReplayOptions& options_;
  const RuleSet& rules_;
  Time start_{};
  Json events_ = Json::array();
  Json holes_ = Json::array();
};

Expected<void> write_page(const BagReplayOptions& options, const RuleSet& rules) {
  const auto page = incident_reports::bag_page(
      rules, options.planner.planner(),
      {options.bag,
       ros2::message_directories(options.message_path, environment("AMENT_PREFIX_PATH")),
       static_cast<double>(wall_now()) * 1e-9});
  if (!page) return Error{page.error()};
  return write_text(options.html, *page);
}

Expected<void> write_mcap(const BagReplayOptions& options, const RuleSet& rules) {
  const auto written = incident_reports::write_foxglove(
      rules, options.planner.planner(),
      {options.bag,
       ros2::message_directories(options.message_path, environment("AMENT_PREFIX_PATH")),
       options.mcap});
  if (!written) return Error{written.error()};
  return write_text(incident_reports::layout_beside(options.mcap).string(),
                    incident_reports::foxglove_layout(rules));
}

int bag_exit_code(const BagReplayOptions& options, const std::vector<RuleOutcome>& outcomes,
                  const RuleSet& rules, bool is_whole) {
  if (options.fail_on == "never") return kOk;
  if (!is_whole) return kFailed;
  const auto any = [&](const auto& is_it) { return std::ranges::any_of(outcomes, is_it); };
  const auto has_fired = [&](Criticality least) {
    return any([&](const RuleOutcome& each) {
      return (each.times > 0 || each.is_on) && rules[each.rule].policies.criticality >= least;
    });
  };
  const bool has_unjudged =
      any([](const RuleOutcome& each) { return each.times == 0 && !each.was_known; });
  if (options.fail_on == "error") return has_fired(Criticality::kError) ? kFailed : kOk;
  if (options.fail_on == "warning") return has_fired(Criticality::kWarning) ? kFailed : kOk;
  if (options.fail_on == "unjudged")
    return has_unjudged || has_fired(Criticality::kWarning) ? kFailed : kOk;
  return has_unjudged ? kWarnings : kOk;
}

}  // namespace

int replay_bag(const BagReplayOptions& options) {
  const auto rules = load_rules(options.rules);
  if (rules == nullptr) return kFailed;
  std::optional<Duration> since;
  if (!options.since.empty()) {
    const auto parsed = duration_of_option("--since", options.since);
    if (!parsed) return fail(parsed.error(), kUsage);
    since = *parsed;
  }
  auto bag = bag::BagFile::open(std::filesystem::path(options.bag));
  if (!bag) return fail(bag.error());
  ros2::MessageLibrary library(
      ros2::message_directories(options.message_path, environment("AMENT_PREFIX_PATH")));
  bag::BagReading reading(*rules, bag->contents(), library);
  replay::BagStretch stretch;
  if (since) {
    std::int64_t end = 0;
    for (const bag::BagFile::Part& each : bag->parts()) end = std::max(end, each.last);
    stretch.from = Time(Duration(end) - *since);
  }
  BagOutput output(options, *rules);
  BagReplay replay(*rules, options.planner.planner(), reading, output.listener(), stretch);
  for (bag::BagMessage message; bag->next(message);) {
    if (!replay.start()) output.begin_at(Time(Duration(message.at)));
    replay.step(message);
  }
  output.finish(replay, *bag, reading);
  if (!options.html.empty()) {
    if (const auto written = write_page(options, *rules); !written) return fail(written.error());
  }
  if (!options.mcap.empty()) {
    if (const auto written = write_mcap(options, *rules); !written) return fail(written.error());
  }
  const bool is_whole = bag->contents().losses().empty() && reading.undecoded().empty();
  return bag_exit_code(options, replay.outcomes(), *rules, is_whole);
}

}  // namespace culprit::cli

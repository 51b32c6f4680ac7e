#include "cli/check_bag.h"

#include <algorithm>

#include <fmt/format.h>

#include "bag/bag_file.h"
#include "bag/bag_reading.h"
#include "base/environment.h"
#include "plan/paper_planner.h"
#include "replay/bag_replay.h"
#include "terminal/command.h"
#include "terminal/console.h"

namespace culprit::cli {
namespace {

// The judgement of a rule by some bags.
struct Judged {
  Duration known{};
  bool was_known = false;
  std::vector<std::string> why_unknown{};
};

Expected<void> judge(const std::string& path, const RuleSet& rules, const BagCheck& options,
                     std::vector<Judged>& judged, Duration& length) {
  auto bag = bag::BagFile::open(path);
  if (!bag) return Error{bag.error()};
  ros2::MessageLibrary library(
      ros2::message_directories(options.message_path, environment("AMENT_PREFIX_PATH")));
  bag::BagReading reading(rules, bag->contents(), library);
  replay::BagReplay replay(rules, std::make_unique<PaperPlanner>(), reading, {});
  for (bag::BagMessage message; bag->next(message);) replay.step(message);
  if (replay.start()) length += replay.end() - *replay.start();
  for (const replay::RuleOutcome& each : replay.outcomes()) {
    Judged& rule = judged[each.rule.index];
    rule.known += each.known;
    rule.was_known = rule.was_known || each.was_known;
    for (const std::string& why : each.why_unknown) {
      if (std::ranges::find(rule.why_unknown, why) == rule.why_unknown.end())
        rule.why_unknown.push_back(why);
    }
  }
  return {};
}

std::string judgement(const Judged& rule, Duration length) {
  if (!rule.was_known) {
    const std::string why = rule.why_unknown.empty()
                                ? "its windows were never covered"
                                : fmt::format("{}", fmt::join(rule.why_unknown, "; "));
    return "cannot be judged: " + why;
  }
  const double share = length > Duration::zero() ? seconds(rule.known) / seconds(length) : 1;
  const std::string text =
      fmt::format("can be judged, in {:.0f} % of the time", 100 * std::min(share, 1.0));
  return rule.why_unknown.empty()
             ? text
             : fmt::format("{}; in part only: {}", text, fmt::join(rule.why_unknown, "; "));
}

}  // namespace

int check_against_bags(const std::string& name, const RuleSet& rules, const BagCheck& options) {
  std::vector<Judged> judged(rules.rules.size());
  Duration length{};
  for (const std::string& bag : options.bags) {
    if (const auto done = judge(bag, rules, options, judged, length); !done)
      return fail(done.error());
  }
  say(stdout, "{}, with {:.1f} s of recordings:\n", name, seconds(length));
  for (std::size_t r = 0; r < judged.size(); ++r)
    say(stdout, "  {}: {}\n", rules.rules[r].name, judgement(judged[r], length));
  const bool are_all_known = std::ranges::all_of(judged, &Judged::was_known);
  return are_all_known ? kOk : kWarnings;
}

}  // namespace culprit::cli

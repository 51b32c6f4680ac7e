#include "replay/hindsight.h"

#include <algorithm>

#include "replay/replay.h"

namespace culprit::replay {
namespace {

constexpr double kNanosecond = 1e-9;  // s
constexpr int kMostRuns = 50;         // of a culprit that is started again and again, the newest

std::optional<Said> said_by(const Event& event, const RuleSet& rules, double wall) {
  if (const auto* detected = std::get_if<FailureDetected>(&event.what))
    return Said{wall, Said::What::kDetected, rules[detected->rule].name};
  if (const auto* resolved = std::get_if<FailureResolved>(&event.what))
    return Said{wall, Said::What::kGone, rules[resolved->rule].name};
  if (const auto* lost = std::get_if<FailureLost>(&event.what))
    return Said{wall, Said::What::kGone, rules[lost->rule].name};
  if (const auto* chosen = std::get_if<StrategyChosen>(&event.what))
    return Said{wall, Said::What::kChosen, rules[rules[chosen->strategy].rule].name,
                rules[chosen->strategy].name};
  return std::nullopt;
}

// An input that only some runs lack was there at times.
void keep_common(std::vector<std::string>& missing, const std::vector<std::string>& others) {
  std::erase_if(missing, [&](const std::string& each) {
    return std::ranges::find(others, each) == others.end();
  });
}

}  // namespace

Expected<std::vector<journal::Entry>> runs_since(const journal::Reader& journal,
                                                 std::int64_t since) {
  std::vector<journal::Entry> runs;
  std::int64_t before = 0;
  while (runs.size() < kMostRuns) {
    auto row = journal.newest(journal::kind::kSession, before);
    if (!row) return Error{row.error()};
    if (!*row) break;
    before = (*row)->id;
    runs.push_back(std::move(**row));
    if (runs.back().at <= since) break;
  }
  std::ranges::reverse(runs);
  return runs;
}

Expected<Hindsight> hindsight(const journal::Reader& journal, const RuleSet* rules,
                              const PlannerOf& planner_of, std::int64_t since) {
  const auto runs = runs_since(journal, since);
  if (!runs) return Error{runs.error()};
  std::optional<Hindsight> all;
  std::string why = "nothing is recorded of that time";
  for (const journal::Entry& run : *runs) {
    auto recording = Recording::open(journal, run.id);
    if (!recording) {  // of an older culprit, or continued from a file that is gone
      why = recording.error();
      continue;
    }
    auto planner = planner_of(recording->session());
    if (!planner) return Error{planner.error()};
    const Time start = recording->session().start;
    const auto wall_of = [&](Time at) {
      return kNanosecond * static_cast<double>(run.at + (at - start).count());
    };
    const Time from = start + Duration(std::max<std::int64_t>(0, since - run.at));
    const RuleSet& advising = rules != nullptr ? *rules : recording->rules();
    Time newest = kLongAgo;
    std::vector<Said> said;
    const auto missing = advise(*recording, advising, std::move(*planner),
                                [&](const Event& event, const RuleSet& of) {
                                  if (const auto each = said_by(event, of, wall_of(event.at)))
                                    said.push_back(*each);
                                },
                                {from, &newest});
    if (!missing) return Error{missing.error()};
    if (newest < from) continue;
    if (!all) {
      all = Hindsight{wall_of(from), 0, {}, *missing};
    } else {
      keep_common(all->missing, *missing);
    }
    all->until = wall_of(newest);
    all->said.insert(all->said.end(), said.begin(), said.end());
  }
  if (!all) return Error{why};
  return std::move(*all);
}

}  // namespace culprit::replay

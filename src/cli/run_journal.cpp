#include "cli/run_journal.h"

#include <fmt/core.h>

#include "journal/requests.h"

namespace culprit::cli {
namespace {

using journal::Recovery;

void tell(const Recovery& recovery, const RuleSet& rules, std::vector<std::string>& findings) {
  for (const std::string& each : recovery.given_up)
    findings.push_back("the last run left something in the middle: " + each);
  for (const Interrupted& each : recovery.interrupted) {
    const Strategy& strategy = rules[each.strategy];
    const std::string what = strategy.name + " for " + rules[strategy.rule].name;
    if (recovery.was_other_boot) {
      findings.push_back("the last run ended in the middle of " + what +
                         "; the machine was started anew since, so nothing of it is left to do");
    } else {
      findings.push_back("the last run ended in the middle of " + what +
                         " (last: " + rules[each.requests.back().command.component].name + ": " +
                         to_string(each.requests.back().command) +
                         "); it is finished, and its outcome proves nothing");
    }
  }
  if (recovery.had_run && !recovery.was_stopped && recovery.interrupted.empty() &&
      recovery.given_up.empty())
    findings.emplace_back(
        "the last run ended without being asked to; nothing was left in the middle");
}

void take_over(const journal::Reader& reader, const RuleSet& rules, const journal::Moment& now,
               RunBeginning& beginning) {
  const auto learned = reader.learned();
  const auto recovery = journal::recover(reader, rules, now);
  if (learned) beginning.learned = *learned;
  if (!learned || !recovery) {
    beginning.findings.push_back("the journal cannot be read whole: " +
                                 (learned ? recovery.error() : learned.error()));
    return;
  }
  tell(*recovery, rules, beginning.findings);
  beginning.is_paused = recovery->is_paused;
  beginning.is_dry_run = recovery->is_dry_run;
  beginning.past = recovery->past;
  if (!learned->beliefs.empty())
    beginning.findings.push_back(
        fmt::format("what was learned of {} strategies is known", learned->beliefs.size()));
  if (recovery->was_other_boot) return;
  for (const Interrupted& each : recovery->interrupted)
    beginning.interrupted.push_back(journal::to_json(each, rules));
}

}  // namespace

RunBeginning begin_journal(const std::filesystem::path& path, const RuleSet& rules,
                           const journal::Moment& now) {
  RunBeginning beginning;
  auto writer = journal::Writer::open(path, {});
  if (writer) {
    if (!writer->remark().empty()) beginning.findings.push_back(writer->remark());
    beginning.writer = std::move(*writer);
  } else {
    beginning.findings.push_back(writer.error());
    beginning.findings.emplace_back(
        "the robot is managed all the same; what happens is kept and written as soon as that is "
        "possible");
  }
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return beginning;
  if (const auto reader = journal::Reader::open(path)) take_over(*reader, rules, now, beginning);
  return beginning;
}

}  // namespace culprit::cli

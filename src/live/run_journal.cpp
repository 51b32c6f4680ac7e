#include "live/run_journal.h"

#include <fmt/core.h>

#include "base/amount.h"
#include "journal/requests.h"

namespace culprit::live {
namespace {

using journal::Recovery;

void tell(const Recovery& recovery, const RuleSet& rules, std::vector<std::string>& findings) {
  for (const std::string& each : recovery.given_up)
    findings.push_back("the last run left this unfinished: " + each);
  for (const Interrupted& each : recovery.interrupted) {
    const Strategy& strategy = rules[each.strategy];
    const std::string what = strategy.name + " for " + rules[strategy.rule].name;
    if (recovery.is_other_robot()) {
      findings.push_back("the last run ended in the middle of " + what + "; " +
                         (recovery.was_other_boot ? "the machine was rebooted since"
                                                  : "that was in another DDS domain") +
                         ", so nothing of it is left to do");
    } else {
      findings.push_back("the last run ended in the middle of " + what +
                         " (last: " + rules[each.requests.back().command.component].name + ": " +
                         to_string(each.requests.back().command) +
                         "); it is finished, and its outcome proves nothing");
    }
  }
  if (recovery.had_run && !recovery.was_stopped && recovery.interrupted.empty() &&
      recovery.given_up.empty())
    findings.emplace_back("the last run ended unexpectedly; it left nothing unfinished");
}

// It is unknown whether a person wants culprit to wait, so it does.
void pause(RunBeginning& beginning, const std::string& why) {
  beginning.orders.pause = journal::StandingOrders::Said{"culprit", why};
  beginning.findings.push_back(
      why + "; so it is paused until a person resumes it: culprit resume does that");
}

// Orders from the journal's rows, for a culprit that had no file for them.
journal::StandingOrders orders_of(const Recovery& recovery, const RuleSet& rules) {
  journal::StandingOrders orders;
  const journal::StandingOrders::Said said{"the last run", "it was ordered so when it ended"};
  if (recovery.is_paused) orders.pause = said;
  if (recovery.is_dry_run) orders.dry_run = said;
  orders.silences = journal::silences_of(recovery.past, rules);
  return orders;
}

enum class Rows : std::uint8_t { kNone, kRead, kUnreadable };

void find_orders(const std::filesystem::path& path, Rows rows, const Recovery& recovery,
                 const RuleSet& rules, Time now, RunBeginning& beginning) {
  const auto file = journal::orders_beside(path);
  const auto found = journal::read_orders(file, journal::clocks_now(now));
  if (!found) return pause(beginning, found.error());
  if (*found) {
    beginning.orders = **found;
    beginning.are_orders_kept = true;
    if (const auto& pause = beginning.orders.pause)
      beginning.findings.push_back("it was paused by " + pause->author +
                                   (pause->reason.empty() ? "" : ": " + pause->reason) +
                                   "; it stays so until a person resumes it");
    return;
  }
  const std::string missing = "'" + file.string() + "' is missing, where orders are kept";
  if (rows == Rows::kUnreadable) return pause(beginning, missing);
  if (rows == Rows::kNone || !recovery.had_run) return;
  if (recovery.orders_kept) return pause(beginning, missing);
  beginning.orders = orders_of(recovery, rules);
}

std::optional<Recovery> take_over(const journal::Reader& reader,
                                  const std::filesystem::path& intents, const RuleSet& rules,
                                  const journal::Moment& now, std::optional<int> manager_before,
                                  RunBeginning& beginning) {
  const auto learned = reader.learned();
  journal::Unwritten unwritten = journal::unwritten_rows(intents, reader);
  if (!unwritten.remark.empty()) beginning.findings.push_back(unwritten.remark);
  const bool is_sound = beginning.findings.empty();  // else rows may be lost
  const auto recovery = journal::recover(reader, unwritten, rules, now, manager_before);
  beginning.unwritten = std::move(unwritten.rows);
  if (learned) beginning.learned = *learned;
  if (!learned || !recovery) {
    beginning.findings.push_back("the journal cannot be read whole: " +
                                 (learned ? recovery.error() : learned.error()));
    return std::nullopt;
  }
  tell(*recovery, rules, beginning.findings);
  beginning.ended_unexpectedly =
      recovery->had_run && !recovery->was_stopped && !recovery->is_other_robot();
  beginning.past = recovery->past;
  beginning.known_robot = recovery->known_robot;
  beginning.last_rules = recovery->rules_text;
  if (!is_sound) beginning.known_robot.is_whole = false;
  std::erase_if(beginning.past, journal::is_about_silence);
  if (!learned->beliefs.empty())
    beginning.findings.push_back(
        fmt::format("the learned values of {} are known",
                    amount_of(learned->beliefs.size(), "strategy", "strategies")));
  if (recovery->is_other_robot()) return *recovery;
  for (const Interrupted& each : recovery->interrupted)
    beginning.interrupted.push_back(journal::to_json(each, rules));
  return *recovery;
}

bool is_locked(const std::filesystem::path& journal) {
  const auto lock = journal::FileLock::take(journal.string() + "-lock");
  return lock && !*lock;
}

}  // namespace

std::filesystem::path default_journal(const std::filesystem::path& state_folder,
                                      const std::string& robot) {
  return state_folder / ((robot.empty() ? "robot" : robot) + ".journal");
}

RunBeginning begin_journal(const std::filesystem::path& path, const RuleSet& rules,
                           const journal::Moment& now, std::optional<int> manager_before) {
  RunBeginning beginning;
  std::error_code error;
  const bool was_there = std::filesystem::exists(path, error);
  std::filesystem::path rows = path;  // where those of the last run are
  const auto open = [&](journal::Writer::Options options) {
    beginning.writer.reset();
    auto writer = journal::Writer::open(path, options);
    if (!writer) return writer.error();
    if (!writer->remark().empty()) beginning.findings.push_back(writer->remark());
    if (!writer->aside().empty()) rows = writer->aside();
    beginning.writer = std::move(*writer);
    return std::string();
  };
  if (const std::string why = open({}); !why.empty()) {
    beginning.findings.push_back(why);
    beginning.findings.emplace_back(
        "culprit manages the robot all the same; it keeps the events, and writes them later");
    beginning.is_of_another = is_locked(path);
  }
  std::optional<Recovery> recovery;
  if (const auto reader = journal::Reader::open(rows)) {
    recovery =
        take_over(*reader, journal::intents_beside(path), rules, now, manager_before, beginning);
    // A row that cannot be read now can never be dropped either.
    if (!recovery && beginning.writer && rows == path) (void)open({.is_damaged = true});
  }
  // The other one lives, and writes it itself.
  if (beginning.is_of_another) beginning.unwritten.clear();
  // If the journal was set aside, its writer still knows what was learned.
  if (const auto learned = beginning.writer ? beginning.writer->learned() : Error{}; learned)
    beginning.learned = *learned;
  const Rows found = !was_there ? Rows::kNone : recovery ? Rows::kRead : Rows::kUnreadable;
  find_orders(path, found, recovery.value_or(Recovery()), rules, now.robot, beginning);
  return beginning;
}

RunBeginning begin_without_journal(const std::filesystem::path& path, Time now) {
  RunBeginning beginning;
  find_orders(path, Rows::kNone, {}, {}, now, beginning);
  return beginning;
}

}  // namespace culprit::live

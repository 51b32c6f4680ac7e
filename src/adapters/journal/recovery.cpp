#include "journal/recovery.h"

#include <algorithm>
#include <array>

#include "base/invariant.h"
#include "journal/bytes.h"
#include "journal/event_json.h"
#include "journal/requests.h"
#include "knowledge/event_words.h"

namespace culprit::journal {
namespace {

// Follows the strategies of one run through its rows.
class Trail {
 public:
  Trail(const RuleSet& rules, std::vector<std::string>& given_up)
      : rules_(rules), given_up_(given_up) {}

  void begin_with(const Json& session) {
    if (!session.is_object()) return;
    latest_ = Time(Duration(integer_of(session, "start")));
    process_ = static_cast<int>(integer_of(session, "process"));
    past_ = history_from_json(session.value("past", Json()), rules_);
    is_paused_ = flag_of(session, "paused");
    is_dry_run_ = flag_of(session, "dry_run");
    const Json interrupted = session.value("interrupted", Json());
    if (!interrupted.is_array()) return;
    for (const Json& each : interrupted) {
      auto known = interrupted_from_json(each, rules_);
      if (known) {
        open_anew(known->strategy) = std::move(*known);
      } else {
        give_up(each, known.error());
      }
    }
  }

  void lived_at(Time step) { latest_ = std::max(latest_, step); }

  void follow(const Entry& entry) {
    if (entry.kind == kind::kSteps) lived_at(Time(Duration(first_step(entry))));
    const Json body = parse_json(entry.body);
    if (!body.is_object()) return;
    if (entry.kind == kind::kEnd && flag_of(body, "stepped_back")) open_.clear();
    if (entry.kind == kind::kEvent) {
      lived_at(Time(Duration(integer_of(body, "time"))));
      event(body);
    }
    if (entry.kind == kind::kIntent) intent(body);
    if (entry.kind == kind::kOutcome) outcome(body);
  }

  bool is_paused() const { return is_paused_; }
  bool is_dry_run() const { return is_dry_run_; }
  const History& past() const { return past_; }

  // Whether another culprit than the one that wrote these rows managed the robot last.
  bool was_succeeded_by(std::optional<int> manager) const {
    return manager && (*manager == 0 || *manager != process_);
  }

  // When its run lived last, as far as is known.
  Time latest() const { return latest_; }

  // Those that had begun to change anything. Gives none if others may have changed the robot since.
  std::vector<Interrupted> open(Time now, std::optional<int> manager_before) && {
    std::erase_if(open_, [](const Interrupted& each) { return each.requests.empty(); });
    const bool is_long_ago = now - latest_ > kGoneOnWith;
    if (!is_long_ago && !was_succeeded_by(manager_before)) return std::move(open_);
    const std::string why = is_long_ago
                                ? "that was more than " + culprit::to_string(kGoneOnWith) + " ago"
                                : "another culprit has managed the robot since";
    for (const Interrupted& each : open_) {
      const Strategy& strategy = rules_[each.strategy];
      given_up_.push_back(strategy.name + " for " + rules_[strategy.rule].name + ": " + why +
                          ", so it is not continued");
    }
    return {};
  }

 private:
  // Rows of steps begin with the time of their first.
  static std::int64_t first_step(const Entry& steps) { return ByteReader(steps.body).integer(); }

  void event(const Json& body) {
    // An event that ends a strategy does so even if the rules no longer have that strategy. A
    // failure is held back only while no strategy of its own is under way.
    constexpr std::array kEnds = {kKindOf<FailureResolved>, kKindOf<FailureLost>,
                                  kKindOf<FailureHeldBack>, kKindOf<RoundSpent>,
                                  kKindOf<RuleExhausted>,   kKindOf<StrategyAbandoned>,
                                  kKindOf<OrderCarriedOut>};
    const auto kind = kind_named(text_of(body, "type"));
    const auto rule = find_rule(rules_, text_of(body, "rule"));
    if (kind && rule && std::find(kEnds.begin(), kEnds.end(), *kind) != kEnds.end()) close(*rule);
    auto event = event_from_json(body, rules_);
    if (!event) return;
    if (const auto* order = std::get_if<OrderAccepted>(&event->what)) heed(order->order);
    if (const auto* chosen = std::get_if<StrategyChosen>(&event->what)) begin(*chosen);
    if (const auto* done = std::get_if<AdaptationDone>(&event->what)) {
      Interrupted* interrupted = find(done->strategy);
      // Rows may be damaged: no more can be done than there is.
      if (interrupted != nullptr &&
          interrupted->adaptations_done < rules_[done->strategy].adaptations.size())
        ++interrupted->adaptations_done;
    }
    if (const auto* failed = std::get_if<StrategyFailed>(&event->what)) {
      if (Interrupted* interrupted = find(failed->strategy)) interrupted->has_failed = true;
    }
    if (is_remembered(*event)) past_.push_back(std::move(*event));
  }

  void heed(const Order& order) {
    if (std::holds_alternative<Pause>(order.what)) is_paused_ = true;
    if (std::holds_alternative<Resume>(order.what)) is_paused_ = false;
    if (const auto* dry_run = std::get_if<SetDryRun>(&order.what)) is_dry_run_ = dry_run->is_on;
    // No plan chooses what it begins, which goes before a strategy that had failed.
    if (const auto* run = std::get_if<RunStrategy>(&order.what)) close_for(run->strategy);
    if (const auto* approved = std::get_if<Approve>(&order.what)) close_for(approved->strategy);
  }

  void begin(const StrategyChosen& chosen) {
    // A last resort is never continued: it is due again, and begun at once.
    if (chosen.dry_run || rules_[chosen.strategy].is_last_resort) return;
    open_anew(chosen.strategy);
  }

  // A rule has one strategy under way: whatever it had before is over.
  Interrupted& open_anew(StrategyId strategy) {
    close(rules_[strategy].rule);
    Interrupted& opened = open_.emplace_back();
    opened.strategy = strategy;
    return opened;
  }

  Interrupted* find(StrategyId strategy) {
    const auto found = std::find_if(open_.begin(), open_.end(), [&](const Interrupted& each) {
      return each.strategy == strategy;
    });
    return found == open_.end() ? nullptr : &*found;
  }

  void intent(const Json& body) {
    const auto command = command_from_json(body, rules_);
    if (!command) return give_up(body, command.error());
    if (rules_[command->purpose.strategy].is_last_resort) return;
    Interrupted* found = find(command->purpose.strategy);
    // It gives back what a strategy that is over owes, and the next culprit owes that, too.
    if (found == nullptr && command->purpose.undoes) return;
    // A person may have ordered it: then it was not chosen.
    if (found == nullptr) found = &open_anew(command->purpose.strategy);
    found->requests.emplace_back();
    found->requests.back().command = *command;
  }

  void outcome(const Json& body) {
    const auto number = static_cast<std::uint64_t>(integer_of(body, "command"));
    const auto outcome = outcome_from(text_of(body, "outcome"));
    for (Interrupted& each : open_) {
      // Each run numbers its requests from the beginning: the latest is meant.
      const auto request = std::find_if(
          each.requests.rbegin(), each.requests.rend(),
          [&](const Interrupted::Request& r) { return r.command.id.number == number; });
      if (request != each.requests.rend() && !request->outcome) request->outcome = outcome;
    }
  }

  void close_for(StrategyId strategy) {
    if (!rules_[strategy].is_last_resort) close(rules_[strategy].rule);
  }

  void close(RuleId rule) {
    std::erase_if(open_,
                  [&](const Interrupted& each) { return rules_[each.strategy].rule == rule; });
  }

  void give_up(const Json& what, const std::string& why) {
    const std::string line =
        text_of(what, "strategy") + " for " + text_of(what, "rule") + ": " + why;
    if (std::find(given_up_.begin(), given_up_.end(), line) == given_up_.end())
      given_up_.push_back(line);
  }

  const RuleSet& rules_;
  std::vector<std::string>& given_up_;
  std::vector<Interrupted> open_;
  History past_;
  Time latest_{};    // event or step, or the beginning of the run
  int process_ = 0;  // of the culprit that wrote the rows
  bool is_paused_ = false;
  bool is_dry_run_ = false;
};

// The robot's clock counts from the start of the machine: the difference between its present and
// its former reading of the same time.
Duration shift_of_clock(const Entry& begin, Time robot_then, const Moment& now) {
  return (now.robot - robot_then) - Duration(now.wall - begin.at);
}

// The newest row holds everything.
Expected<KnownRobot> find_known_robot(const Reader& journal, const Whereabouts& where,
                                      std::int64_t last_run) {
  const auto newest = journal.newest(kind::kRobot);
  if (!newest) return Error{newest.error()};
  if (!*newest) return KnownRobot{};
  auto rows = journal.entries(Which::kReadable, (*newest)->id);
  if (!rows) return Error{rows.error()};
  Entry entry;
  Hasher hasher;
  const auto row = rows->next(entry);
  if (!row) return Error{row.error()};
  // A row that others changed must not tell culprit what was discovered.
  if (!rows->is_as_written(entry, hasher)) return KnownRobot{};
  KnownRobot known = known_robot_of(parse_json(entry.body), where);
  // The last run may have had other rules, and did not see the robot whole.
  known.is_whole = known.is_whole && entry.id > last_run;
  return known;
}

// A person who stops culprit may stop the robot as well, and another culprit repairs it: a recovery
// after that proves nothing.
void forget_pending_outcomes(std::vector<Event>& past) {
  std::erase_if(
      past, [](const Event& event) { return std::holds_alternative<OutcomePending>(event.what); });
}

}  // namespace

Expected<Recovery> recover(const Reader& journal, const Unwritten& unwritten, const RuleSet& rules,
                           const Moment& now, std::optional<int> manager_before) {
  Recovery recovery;
  const auto last = journal.newest(kind::kSession);
  if (!last) return Error{last.error()};
  auto known_robot = find_known_robot(journal, {now.domain, boot_id()}, *last ? (*last)->id : 0);
  if (!known_robot) return Error{known_robot.error()};
  recovery.known_robot = std::move(*known_robot);
  if (!*last) return recovery;
  recovery.had_run = true;
  auto rows = journal.entries(Which::kReadable, (*last)->id);
  if (!rows) return Error{rows.error()};
  Entry entry;
  auto row = rows->next(entry);
  Hasher hasher;
  const auto is_good = [&] {
    if (rows->is_as_written(entry, hasher)) return true;
    recovery.known_robot.is_whole = false;
    recovery.given_up.push_back("row " + std::to_string(entry.id) + " (" + entry.kind +
                                ") is not what was written; nothing is done because of it");
    recovery.orders_kept = true;  // it may have been one: the rows alone do not count
    return false;
  };
  if (!row) return Error{row.error()};
  // A row that another user could have written must not decide which process belongs to a
  // component.
  if (!is_good()) return recovery;
  const Json begin = parse_json((*last)->body);
  recovery.was_other_boot = text_of(begin, "boot") != boot_id();
  // An older culprit did not write it.
  recovery.was_other_domain = integer_of(begin, "domain", now.domain) != now.domain;
  recovery.orders_kept |= flag_of(begin, "orders_kept");
  recovery.rules_text = text_of(begin, "rules_text");
  Trail trail(rules, recovery.given_up);
  trail.begin_with(begin);
  for (row = rows->next(entry); row && *row; row = rows->next(entry)) {
    recovery.was_stopped = entry.kind == kind::kEnd;
    if (is_good()) trail.follow(entry);
  }
  if (!row) return Error{row.error()};
  for (const Entry& each : unwritten.rows) trail.follow(each);
  trail.lived_at(unwritten.latest);
  const bool is_recent = trail.latest() <= now.robot && now.robot - trail.latest() <= kExpected;
  if (!is_recent || recovery.is_other_robot() || trail.was_succeeded_by(manager_before))
    recovery.known_robot.is_whole = false;
  const Time robot_then = Time(Duration(integer_of(begin, "start")));
  const Duration shift =
      recovery.was_other_boot ? shift_of_clock(**last, robot_then, now) : Duration::zero();
  recovery.past = still_counting(
      recovery.is_other_robot() ? of_people(trail.past(), shift) : trail.past(), now.robot, rules);
  if (recovery.was_stopped || trail.was_succeeded_by(manager_before))
    forget_pending_outcomes(recovery.past);
  recovery.is_paused = trail.is_paused();
  recovery.is_dry_run = trail.is_dry_run();
  recovery.interrupted = std::move(trail).open(now.robot, manager_before);
  for (const Interrupted& each : recovery.interrupted)
    CULPRIT_ASSERT(each.adaptations_done <= rules[each.strategy].adaptations.size());
  return recovery;
}

}  // namespace culprit::journal

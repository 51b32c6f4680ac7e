#include "replay/replay.h"

#include <algorithm>
#include <map>

#include "journal/history.h"
#include "journal/known_robot.h"
#include "journal/recorder.h"
#include "journal/requests.h"
#include "knowledge/describe.h"
#include "replay/translation.h"

namespace culprit::replay {
namespace {

// The texts of the events after row `row`, up to the next steps.
Expected<std::vector<std::string>> said_after(const journal::Reader& journal, std::int64_t row) {
  std::vector<std::string> said;
  auto rows = journal.entries(journal::Which::kAll, row + 1);
  if (!rows) return Error{rows.error()};
  journal::Entry entry;
  auto more = rows->next(entry);
  for (; more && *more && entry.kind != journal::kind::kSteps; more = rows->next(entry)) {
    if (entry.kind == journal::kind::kEvent || entry.kind == journal::kind::kIntent)
      said.push_back(journal::text_of(parse_json(entry.body), "text"));
  }
  if (!more) return Error{more.error()};
  return said;
}

// The observations before the examined part of a run, as if all were made at its beginning. Among repeated readings the last counts; messages of topics,
// requests and replies are over.
class Prelude {
 public:
  void add(std::span<const Observation> observations) {
    for (const Observation& each : observations) {
      if (const auto thing = read_of(each)) {
        read_[{each.what.index(), *thing}] = each;
      } else if (lasts(each)) {
        lasting_.push_back(each);
      }
    }
  }
  std::vector<Observation> as_of(Time begin) const {
    std::vector<Observation> all = lasting_;
    for (const auto& [thing, each] : read_) all.push_back(each);
    for (Observation& each : all) each.at = begin;
    return all;
  }

 private:
  // The number of the thing that was read.
  static std::optional<std::size_t> read_of(const Observation& observation) {
    if (const auto* signal = std::get_if<SignalRead>(&observation.what))
      return signal->signal.index;
    if (const auto* status = std::get_if<DiagnosticRead>(&observation.what))
      return status->diagnostic.index;
    if (const auto* parameter = std::get_if<ParameterRead>(&observation.what))
      return parameter->parameter.index;
    if (const auto* lifecycle = std::get_if<LifecycleRead>(&observation.what))
      return lifecycle->component.index;
    return std::nullopt;
  }
  static bool lasts(const Observation& observation) {
    const auto& what = observation.what;
    return !std::holds_alternative<SampleArrived>(what) && !std::holds_alternative<Probed>(what) &&
           !std::holds_alternative<ProcessWorked>(what) &&
           !std::holds_alternative<Overslept>(what) && !std::holds_alternative<LinkTrouble>(what);
  }

  std::vector<Observation> lasting_;
  std::map<std::pair<std::size_t, std::size_t>, Observation> read_;
};

}  // namespace

void restore(Manager& manager, const journal::Learned& learned, const RuleSet& rules,
             Priors priors) {
  for (const journal::LearnedBelief& each : learned.beliefs) {
    const auto id = journal::find_strategy(rules, each.rule, each.strategy);
    if (!id) continue;
    if (priors == Priors::kAsLearned) {
      manager.set_belief(*id, each.belief, each.prior);
      continue;
    }
    const Belief prior = initial_belief(rules[*id].success, rules[*id].confidence);
    manager.set_belief(*id, journal::grown_from(prior, each));
  }
  for (const journal::LearnedCoupling& each : learned.couplings) {
    const auto cause = journal::find_rule(rules, each.cause);
    const auto effect = journal::find_rule(rules, each.effect);
    if (cause && effect) manager.set_coupling(*cause, *effect, each.coupling);
  }
  for (const journal::LearnedLatency& each : learned.latencies) {
    if (const auto rule = journal::find_rule(rules, each.rule))
      manager.set_latency(*rule, journal::latency_from(each));
    const auto transients = journal::transients_from(each);
    const auto rule = transients ? journal::find_rule(rules, transients->first) : std::nullopt;
    if (rule) manager.add_transients(*rule, transients->second);
  }
  for (const journal::LearnedCoincidence& each : learned.coincidences) {
    const auto rule = journal::find_rule(rules, each.rule);
    const auto other = journal::find_rule(rules, each.other);
    if (rule && other) manager.set_coincidence(*rule, *other, each.count);
  }
}

std::unique_ptr<Manager> manager_for(const journal::Session& session, const RuleSet& rules,
                                     std::unique_ptr<const Planner> planner,
                                     const Freedom& freedom) {
  Manager::Options options;
  options.autonomy = freedom.autonomy;
  options.governor = freedom.governor;
  options.start = session.watched_since.value_or(session.start);
  options.discovery = session.discovery;
  options.forgetting = session.forgetting;
  const std::int64_t start = session.start.time_since_epoch().count();
  options.incidents = {session.wall - start, session.boot + " " + std::to_string(session.process) +
                                                 " " + std::to_string(start)};
  auto manager = std::make_unique<Manager>(rules, std::move(planner), options);
  restore(*manager, session.learned, rules,
          session.fleet_context ? Priors::kAsLearned : Priors::kOfRules);
  manager->remember(journal::history_from_json(session.past, rules));
  manager->remember(journal::known_robot_from_json(session.known_robot));
  if (!session.interrupted.is_array()) return manager;
  for (const Json& each : session.interrupted) {
    if (auto interrupted = journal::interrupted_from_json(each, rules))
      manager->resume(std::move(*interrupted));
  }
  return manager;
}

Expected<Repetition> repeat(Recording& recording, const journal::Reader& journal,
                            std::unique_ptr<const Planner> planner,
                            const Governor::Options& governor, const EventSink& sink) {
  if (const auto ready = recording.rewind(); !ready) return Error{ready.error()};
  const RuleSet& rules = recording.rules();
  const Autonomy autonomy = recording.session().advises ? Autonomy::kAdvise : Autonomy::kAct;
  const auto manager =
      manager_for(recording.session(), rules, std::move(planner), {autonomy, governor});
  Repetition repetition;
  journal::Hasher hasher;
  std::string digests;
  journal::Step step;
  auto more = recording.next(step);
  for (; more && *more; more = recording.next(step)) {
    const std::vector<Command> commands = manager->step(step.now, step.observations);
    ++repetition.steps;
    repetition.observations += step.observations.size();
    const auto digest = journal::digest_of(commands, manager->events(), rules, hasher);
    if (digest) {
      ++repetition.decisions;
      journal::ByteWriter(digests).natural(*digest);
    }
    if (sink) {
      for (const Event& event : manager->events()) sink(event, rules);
    }
    if (digest == step.digest) continue;
    auto recorded = said_after(journal, recording.row());
    if (!recorded) return Error{recorded.error()};
    repetition.difference = {recording.row(), step.now, std::move(*recorded), {}};
    for (const Event& event : manager->events())
      repetition.difference->repeated.push_back(describe(event, rules));
    for (const Command& command : commands)
      repetition.difference->repeated.push_back(rules[command.component].name + ": " +
                                                to_string(command));
    break;
  }
  if (!more) return Error{more.error()};
  repetition.digest = journal::to_hex(hasher.of(digests));
  repetition.has_gap = recording.has_gap();
  return repetition;
}

Expected<std::vector<std::string>> advise(Recording& recording, const RuleSet& rules,
                                          std::unique_ptr<const Planner> planner,
                                          const EventSink& sink, Stretch stretch) {
  if (const auto ready = recording.rewind(); !ready) return Error{ready.error()};
  const Translation translate(recording.rules(), rules);
  journal::Session session = recording.session();
  journal::Step step;
  Prelude prelude;
  auto more = recording.next(step);
  for (; more && *more && step.now < stretch.from; more = recording.next(step))
    prelude.add(step.observations);
  const bool is_whole = session.start >= stretch.from;
  if (!is_whole) {
    session.start = stretch.from;
    session.watched_since.reset();
  }
  const auto manager = manager_for(session, rules, std::move(planner), {Autonomy::kAdvise, {}});
  Time due = manager->next_deadline();
  const auto step_at = [&](Time now, std::span<const Observation> seen) {
    manager->step(now, seen);
    if (sink) {
      for (const Event& event : manager->events()) sink(event, rules);
    }
    due = manager->next_deadline();
    if (stretch.look) due = std::min(due, stretch.look(*manager));
  };
  std::vector<Observation> observations;
  const auto step_with = [&](Time now, std::span<const Observation> recorded) {
    observations.clear();
    for (const Observation& observation : recorded) {
      if (auto translated = translate(observation)) observations.push_back(std::move(*translated));
    }
    step_at(now, observations);
  };
  if (!is_whole) step_with(stretch.from, prelude.as_of(stretch.from));
  for (; more && *more && step.now <= stretch.until; more = recording.next(step)) {
    // Other rules have other deadlines. A damaged clock may leap over millions of them.
    constexpr int kMostDeadlines = 100'000;
    // No decision is made during a sleep.
    const bool has_slept = !step.observations.empty() &&
                           std::holds_alternative<Overslept>(step.observations.front().what);
    for (int i = 0; !has_slept && i < kMostDeadlines && due < step.now; ++i) step_at(due, {});
    step_with(step.now, step.observations);
    if (stretch.newest != nullptr) *stretch.newest = step.now;
  }
  if (!more) return Error{more.error()};
  return translate.missing();
}

}  // namespace culprit::replay

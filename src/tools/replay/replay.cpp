#include "replay/replay.h"

#include "journal/history.h"
#include "journal/known_robot.h"
#include "journal/recorder.h"
#include "journal/requests.h"
#include "knowledge/describe.h"
#include "replay/translation.h"

namespace culprit::replay {
namespace {

// What the events that follow row `row` say, up to the next steps.
Expected<std::vector<std::string>> said_after(const journal::Reader& journal, std::int64_t row) {
  std::vector<std::string> said;
  auto rows = journal.entries(journal::Which::kAll, row + 1);
  if (!rows) return Error{rows.error()};
  journal::Entry entry;
  auto more = rows->next(entry);
  for (; more && *more && entry.kind != journal::kind::kSteps; more = rows->next(entry)) {
    if (entry.kind == journal::kind::kEvent || entry.kind == journal::kind::kIntent)
      said.push_back(journal::text_of(journal::from_text(entry.body), "text"));
  }
  if (!more) return Error{more.error()};
  return said;
}

}  // namespace

void restore(Manager& manager, const journal::Learned& learned, const RuleSet& rules) {
  for (const journal::LearnedBelief& each : learned.beliefs) {
    const auto id = journal::find_strategy(rules, each.rule, each.strategy);
    if (!id) continue;
    const Belief prior = initial_belief(rules[*id].success, rules[*id].confidence);
    manager.set_belief(*id, journal::grown_from(prior, each));
  }
  for (const journal::LearnedCoupling& each : learned.couplings) {
    const auto cause = journal::find_rule(rules, each.cause);
    const auto effect = journal::find_rule(rules, each.effect);
    if (cause && effect) manager.set_coupling(*cause, *effect, each.coupling);
  }
}

std::unique_ptr<Manager> manager_for(const journal::Session& session, const RuleSet& rules,
                                     std::unique_ptr<const Planner> planner,
                                     const Freedom& freedom) {
  Manager::Options options;
  options.autonomy = freedom.autonomy;
  options.governor = freedom.governor;
  options.start = session.start;
  options.discovery = session.discovery;
  options.forgetting = session.forgetting;
  auto manager = std::make_unique<Manager>(rules, std::move(planner), options);
  restore(*manager, session.learned, rules);
  manager->remember(journal::history_from_json(session.past, rules));
  manager->remember(journal::known_robot_from_json(session.known_robot));
  if (!session.interrupted.is_array()) return manager;
  for (const journal::Json& each : session.interrupted) {
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
                                          const EventSink& sink) {
  if (const auto ready = recording.rewind(); !ready) return Error{ready.error()};
  const auto manager =
      manager_for(recording.session(), rules, std::move(planner), {Autonomy::kAdvise, {}});
  const Translation translate(recording.rules(), rules);
  const auto tell = [&] {
    for (const Event& event : manager->events()) sink(event, rules);
  };
  journal::Step step;
  std::vector<Observation> observations;
  auto more = recording.next(step);
  for (; more && *more; more = recording.next(step)) {
    // Other rules have other deadlines. A damaged clock may leap over millions of them.
    constexpr int kMostDeadlines = 100'000;
    // Nobody would have decided anything in a sleep.
    const bool has_slept = !step.observations.empty() &&
                           std::holds_alternative<Overslept>(step.observations.front().what);
    for (int i = 0; !has_slept && i < kMostDeadlines && manager->next_deadline() < step.now; ++i) {
      manager->step(manager->next_deadline(), {});
      tell();
    }
    observations.clear();
    for (const Observation& observation : step.observations) {
      if (auto translated = translate(observation)) observations.push_back(std::move(*translated));
    }
    manager->step(step.now, observations);
    tell();
  }
  if (!more) return Error{more.error()};
  return translate.missing();
}

}  // namespace culprit::replay

#include "journal/recorder.h"

#include <algorithm>

#include "journal/event_json.h"
#include "journal/recovery.h"
#include "journal/requests.h"

namespace culprit::journal {
namespace {

bool changes_something(const Command& command) { return !is_read(command); }

// A person was told that it holds.
bool is_order(const Event& event) { return std::holds_alternative<OrderAccepted>(event.what); }

// What `news` speaks of is now as `news` says.
void replace(Learned& learned, const Learned& news) {
  for (const LearnedBelief& each : news.beliefs) {
    std::erase_if(learned.beliefs, [&](const LearnedBelief& old) {
      return old.rule == each.rule && old.strategy == each.strategy;
    });
    learned.beliefs.push_back(each);
  }
  for (const LearnedCoupling& each : news.couplings) {
    std::erase_if(learned.couplings, [&](const LearnedCoupling& old) {
      return old.cause == each.cause && old.effect == each.effect;
    });
    learned.couplings.push_back(each);
  }
}

bool is_nothing(const Learned& learned) {
  return learned.beliefs.empty() && learned.couplings.empty();
}

}  // namespace

std::optional<Digest> digest_of(std::span<const Command> commands, std::span<const Event> events,
                                const RuleSet& rules, Hasher& hasher) {
  if (commands.empty() && events.empty()) return std::nullopt;
  std::string all;
  for (const Command& command : commands)
    all += std::to_string(command.id.number) + " " + rules[command.component].name + " " +
           culprit::to_string(command) + "\n";
  for (const Event& event : events) all += to_text(to_json(event, rules)) + "\n";
  const Hash hash = hasher.of(all);
  Digest digest = 0;
  for (std::size_t i = 0; i < 8; ++i) digest = digest << 8 | hash[i];
  return digest;
}

Recorder::Recorder(std::optional<Writer> writer, Options options, const Session& session,
                   const Knowledge& knowledge)
    : options_(std::move(options)),
      knowledge_(knowledge),
      rules_(knowledge.rules),
      writer_(std::move(writer)),
      where_{session.domain, session.boot},
      session_(to_json(session)),
      known_(session.learned) {
  for (std::size_t s = 0; s < rules_.strategies.size(); ++s)
    beliefs_.push_back(knowledge.beliefs[StrategyId(s)]);
  for (std::size_t r = 0; r < rules_.rules.size(); ++r) {
    const auto all = knowledge.couplings.of(RuleId(r));
    couplings_.emplace_back(all.begin(), all.end());
  }
  is_failing_ = !writer_;
  add(kind::kSession, options_.wall_clock(), session_);
  (void)write(true);
  thread_ = std::thread([this] { run(); });
}

Recorder::~Recorder() { finish(); }

Expected<void> Recorder::end(Ending ending) {
  hand_over(Urgency::kNone);
  {
    const MutexLock lock(mutex_);
    Pending& pending = queue_.next();
    pending.wall = options_.wall_clock();
    pending.end = ending;
  }
  finish();
  if (!last_error_) return {};
  return Error{last_error_->message + "; " + std::to_string(unsaved_.entries.size()) +
               " rows of this run are lost"};
}

void Recorder::finish() {
  if (!thread_.joinable()) return;
  hand_over(Urgency::kNone);
  {
    const MutexLock lock(mutex_);
    is_ending_ = true;
  }
  work_.notify_one();
  thread_.join();
}

Recorder::Pending& Recorder::Queue::next() {
  if (used == places.size()) places.emplace_back();
  return places[used++];
}

void Recorder::Queue::clear() {
  constexpr std::size_t kSpare = 64;
  for (std::size_t i = 0; i < used; ++i) {
    places[i].observations.clear();
    places[i].decided.reset();
    places[i].end.reset();
  }
  if (places.size() > kSpare) places.resize(kSpare);
  used = 0;
}

void Recorder::hand_over(Pending& step, std::span<const Command> commands,
                         std::span<const Event> events) {
  bool wait = false;
  const bool decides = !commands.empty() || !events.empty();
  if (decides) {
    step.decided = decision_of(commands, events);
    wait = !is_nothing(step.decided->learned) ||
           std::any_of(commands.begin(), commands.end(), changes_something) ||
           std::any_of(events.begin(), events.end(), is_order);
  }
  if (auto robot = newly_known(step.now)) {
    if (step.decided == nullptr) step.decided = std::make_unique<Decided>();
    step.decided->robot = std::move(robot);
  }
  hand_over(wait ? Urgency::kNow : step.decided != nullptr ? Urgency::kSoon : Urgency::kNone);
  if (wait) wait_until_written();
}

void Recorder::hand_over(Urgency urgency) {
  constexpr std::size_t kMaxQueued = 1 << 17;
  if (kept_ == 0) return;
  const auto kept = std::span(places_).first(std::exchange(kept_, 0));
  const std::int64_t wall_offset =
      options_.wall_clock() - kept.back().now.time_since_epoch().count();
  const MutexLock lock(mutex_);
  if (queue_.used == 0) first_queued_ = kept.front().now;
  for (Pending& step : kept) {
    if (queued_observations_ > kMaxQueued && step.decided == nullptr) {
      ++lost_steps_;
      step.observations.clear();
      continue;
    }
    step.wall = step.now.time_since_epoch().count() + wall_offset;
    queued_observations_ += step.observations.size();
    now_of_queue_ = step.now;
    std::swap(queue_.next(), step);
    ++handed_over_;
  }
  const bool is_due = now_of_queue_ - first_queued_ >= kPeriod || queued_observations_ >= kMany;
  urgency_ = std::max({urgency_, urgency, is_due ? Urgency::kSoon : Urgency::kNone});
  if (urgency_ == Urgency::kSoon) work_.notify_one();
}

std::unique_ptr<Recorder::Decided> Recorder::decision_of(std::span<const Command> commands,
                                                         std::span<const Event> events) {
  auto decision = std::make_unique<Decided>();
  decision->commands.assign(commands.begin(), commands.end());
  decision->events.assign(events.begin(), events.end());
  if (!events.empty()) decision->learned = changes();
  return decision;
}

std::optional<KnownRobot> Recorder::newly_known(Time now) {
  const std::uint64_t sightings = knowledge_.sightings.count();
  const std::uint64_t changes = knowledge_.graph.changes() + sightings;
  const bool is_old = robot_written_ != kLongAgo && later(robot_written_, kRobotAtLatest) <= now;
  const bool was_looked_at =
      robot_looked_at_ != kLongAgo && now < later(robot_looked_at_, kRobotPeriod);
  // What is seen for the first time is written at once: who dies together with culprit would never
  // have been there. That is seldom; ends of topics come and go all the time.
  const bool is_first_sight = sightings != robot_sightings_;
  if ((changes == robot_changes_ && !is_old) || (was_looked_at && !is_first_sight))
    return std::nullopt;
  robot_changes_ = changes;
  robot_sightings_ = sightings;
  robot_looked_at_ = now;
  KnownRobot known = knowledge_.known_robot();
  if (known == known_robot_ && !is_old) return std::nullopt;
  robot_written_ = now;
  known_robot_ = known;
  return known;
}

void Recorder::wait_until_written() {
  work_.notify_one();
  MutexLock lock(mutex_);
  const std::uint64_t mine = handed_over_;
  done_.wait_for(lock, kPatience,
                 [&]() CULPRIT_REQUIRES(mutex_) { return written_ >= mine || is_failing_; });
}

Learned Recorder::changes() {
  Learned learned;
  for (std::size_t s = 0; s < beliefs_.size(); ++s) {
    const Belief& belief = knowledge_.beliefs[StrategyId(s)];
    if (belief == beliefs_[s]) continue;
    beliefs_[s] = belief;
    const Strategy& strategy = rules_.strategies[s];
    learned.beliefs.push_back({rules_[strategy.rule].name, strategy.name, belief,
                               knowledge_.beliefs.prior(StrategyId(s))});
  }
  for (std::size_t r = 0; r < couplings_.size(); ++r) {
    const auto all = knowledge_.couplings.of(RuleId(r));
    for (const Couplings::Learned& each : all) {
      const auto is_same = [&](const Couplings::Learned& old) {
        return old.cause == each.cause && old.coupling == each.coupling;
      };
      if (std::any_of(couplings_[r].begin(), couplings_[r].end(), is_same)) continue;
      learned.couplings.push_back({rules_[each.cause].name, rules_.rules[r].name, each.coupling});
    }
    couplings_[r].assign(all.begin(), all.end());
  }
  return learned;
}

void Recorder::run() {
  Queue taken;
  auto written_at = std::chrono::steady_clock::now() - kSoon;
  MutexLock lock(mutex_);
  while (true) {
    const auto is_wanted = [this](Urgency urgency) CULPRIT_REQUIRES(mutex_) {
      return is_ending_ || (urgency_ >= urgency && !is_failing_);
    };
    work_.wait_for(lock, is_failing_ ? kRetry : kPeriod,
                   [&]() CULPRIT_REQUIRES(mutex_) { return is_wanted(Urgency::kSoon); });
    work_.wait_until(lock, written_at + kSoon,
                     [&]() CULPRIT_REQUIRES(mutex_) { return is_wanted(Urgency::kNow); });
    std::swap(taken, queue_);
    queued_observations_ = 0;
    const std::uint64_t upto = handed_over_;
    const bool is_durable = std::exchange(urgency_, Urgency::kNone) == Urgency::kNow;
    if (taken.used > 0) now_ = now_of_queue_;
    gap_steps_ += std::exchange(lost_steps_, 0);
    const bool is_last = is_ending_;
    lock.unlock();

    for (std::size_t i = 0; i < taken.used; ++i) make_rows(taken.places[i]);
    taken.clear();
    close_steps();
    const auto written = write(is_durable || is_last);
    last_error_ = written ? std::nullopt : std::optional(Error{written.error()});
    written_at = std::chrono::steady_clock::now();

    lock.lock();
    written_ = upto;
    done_.notify_all();
    if (is_last && queue_.used == 0) return;
  }
}

void Recorder::make_rows(const Pending& pending) {
  if (pending.end) {
    close_steps();
    if (*pending.end == Ending::kStopped)
      return add(kind::kEnd, pending.wall, {{"text", "culprit was asked to stop"}});
    return add(
        kind::kEnd, pending.wall,
        {{"text", "culprit stepped back: another one manages the robot"}, {"stepped_back", true}});
  }
  if (steps_.empty()) steps_at_ = pending.wall;
  ByteWriter bytes(steps_);
  std::optional<Digest> digest;
  if (pending.decided != nullptr)
    digest = digest_of(pending.decided->commands, pending.decided->events, rules_, hasher_);
  encode(pending.now, pending.observations, digest, bytes);

  for (const Observation& observation : pending.observations) {
    if (const auto* reply = std::get_if<Reply>(&observation.what))
      make_outcome(pending.wall, *reply);
  }
  if (pending.decided != nullptr) make_decision(pending.wall, *pending.decided);
  constexpr std::size_t kLongRow = 1 << 16;
  if (steps_.size() > kLongRow) close_steps();
}

void Recorder::make_outcome(std::int64_t wall, const Reply& reply) {
  const auto asked = asked_.find(reply.command.number);
  if (asked == asked_.end()) return;
  const std::string_view outcome = to_string(reply.outcome);
  add(kind::kOutcome, wall,
      {{"command", reply.command.number},
       {"outcome", outcome},
       {"reason", reply.text},
       {"text", asked->second + ": " + std::string(outcome) +
                    (reply.text.empty() ? "" : ", " + reply.text)}});
  asked_.erase(asked);
}

void Recorder::make_decision(std::int64_t wall, const Decided& decision) {
  for (const Event& event : decision.events) add(kind::kEvent, wall, to_json(event, rules_));
  for (const Command& command : decision.commands) {
    if (is_read(command)) continue;
    const Json body = to_json(command, rules_);
    asked_[command.id.number] = text_of(body, "text");
    add(kind::kIntent, wall, body);
  }
  if (decision.robot) {
    robot_ = robot_row(*decision.robot, where_);
    add(kind::kRobot, wall, robot_);
  }
  replace(unsaved_.learned, decision.learned);
  replace(known_, decision.learned);
}

void Recorder::close_steps() {
  if (steps_.empty()) return;
  unsaved_bytes_ += steps_.size();
  unsaved_.entries.push_back({0, steps_at_, std::string(kind::kSteps), std::move(steps_)});
  steps_.clear();
}

// What a step led to stands behind the row that the step is in.
void Recorder::add(std::string_view kind, std::int64_t at, const Json& body) {
  close_steps();
  unsaved_.entries.push_back({0, at, std::string(kind), to_text(body)});
  unsaved_bytes_ += unsaved_.entries.back().body.size();
}

// In a file that takes the place of one that was removed or damaged, the run goes on.
Expected<void> Recorder::open_anew() {
  Writer::Options options = options_.writer;
  options.is_damaged = is_damaged_;
  auto opened = Writer::open(options_.path, options);
  if (!opened) return Error{opened.error()};
  writer_ = std::move(*opened);
  is_damaged_ = false;
  if (!writer_->remark().empty() && options_.on_trouble) options_.on_trouble(writer_->remark());
  const auto sessions = writer_->database().number(
      "SELECT count(*) FROM entry WHERE kind <> 'steps' AND kind = 'session'");
  if (!is_begun_ || (sessions && *sessions > 0)) return {};
  begin_session_anew(writer_->aside());
  unsaved_.learned = known_;
  return {};
}

// A row from which on the next run finds all that it has to know, without those before it. `rows`:
// the file that they are in; empty: there is none.
void Recorder::begin_session_anew(const std::filesystem::path& rows) {
  const std::int64_t wall = options_.wall_clock();
  std::optional<Recovery> known;
  if (const auto reader = rows.empty() ? Expected<Reader>(Error{}) : Reader::open(rows)) {
    if (auto recovery = recover(*reader, rules_, {now_, wall, where_.domain}))
      known = std::move(*recovery);
  }
  // Without them nobody knows what is under way by now; what was at the beginning is not.
  Json interrupted = Json::array();
  if (known) {
    for (const Interrupted& each : known->interrupted) interrupted.push_back(to_json(each, rules_));
    session_["past"] = to_json(known->past, rules_);
    session_["paused"] = known->is_paused;
    session_["dry_run"] = known->is_dry_run;
  }
  session_["interrupted"] = std::move(interrupted);
  session_["learned"] = to_json(known_);
  session_["start"] = now_.time_since_epoch().count();
  session_["continued"] = true;
  if (!robot_.is_null())
    unsaved_.entries.insert(unsaved_.entries.begin(),
                            {0, wall, std::string(kind::kRobot), to_text(robot_)});
  unsaved_.entries.insert(unsaved_.entries.begin(),
                          {0, wall, std::string(kind::kSession), to_text(session_)});
}

Expected<void> Recorder::write(bool is_durable) {
  if (!writer_) {
    if (const auto opened = open_anew(); !opened) return failed({opened.error()});
  }
  const std::int64_t now = options_.wall_clock();
  if (writer_->wants_new_session()) begin_session_anew(options_.path);
  if (gap_steps_ + gap_rows_ > 0) {
    const std::string text =
        "not recorded, for the journal could not be written: " + std::to_string(gap_steps_) +
        " steps, " + std::to_string(gap_rows_) + " other rows";
    unsaved_.entries.insert(
        unsaved_.entries.begin(),
        {0, now, std::string(kind::kGap),
         to_text({{"steps", gap_steps_}, {"rows", gap_rows_}, {"text", text}})});
    gap_steps_ = gap_rows_ = 0;
  }
  if (unsaved_.entries.empty() && is_nothing(unsaved_.learned)) return {};
  const auto written = writer_->append(
      unsaved_, now, is_durable ? Durability::kPowerFailure : Durability::kProcessEnd);
  if (!written) return failed({written.error()});
  is_begun_ = true;
  unsaved_ = {};
  unsaved_bytes_ = 0;
  bool was_failing = false;
  {
    const MutexLock lock(mutex_);
    was_failing = std::exchange(is_failing_, false);
  }
  if (was_failing && options_.on_trouble) options_.on_trouble("the journal is written again");
  tell_of_copy();
  return {};
}

// Each change once.
void Recorder::tell_of_copy() {
  if (copy_trouble_ == writer_->copy_trouble()) return;
  copy_trouble_ = writer_->copy_trouble();
  if (!options_.on_trouble) return;
  options_.on_trouble(copy_trouble_.empty()
                          ? "the second copy of what was learned is written again"
                          : "what was learned stands in the journal alone, its second copy cannot "
                            "be written: " +
                                copy_trouble_);
}

Expected<void> Recorder::failed(Error error) {
  // A file that cannot be written now may be another one next time: it is opened anew.
  if (writer_) is_damaged_ = writer_->is_damaged();
  writer_.reset();
  bound_unsaved();
  bool is_new = false;
  {
    const MutexLock lock(mutex_);
    is_new = !std::exchange(is_failing_, true);
  }
  if (is_new && options_.on_trouble)
    options_.on_trouble(error.message +
                        "; what happens is kept and written as soon as that is possible");
  return error;
}

void Recorder::bound_unsaved() {
  for (const bool only_steps : {true, false}) {
    std::erase_if(unsaved_.entries, [&](const Entry& entry) {
      const bool is_steps = entry.kind == kind::kSteps;
      if (unsaved_bytes_ <= kMaxUnsaved || (only_steps && !is_steps)) return false;
      unsaved_bytes_ -= entry.body.size();
      ++(is_steps ? gap_steps_ : gap_rows_);
      return true;
    });
  }
}

}  // namespace culprit::journal

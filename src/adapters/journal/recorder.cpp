#include "journal/recorder.h"

#include <algorithm>
#include <set>
#include <string_view>
#include <utility>

#include "base/invariant.h"
#include "journal/event_json.h"
#include "journal/recovery.h"
#include "journal/requests.h"
#include "journal/settled_here.h"

namespace culprit::journal {
namespace {

// A person received a confirmation that it holds.
bool is_order(const Event& event) { return std::holds_alternative<OrderAccepted>(event.what); }

// Replaces each part of `learned` that `news` has.
void replace(Learned& learned, const Learned& news) {
  for (const LearnedBelief& each : news.beliefs) {
    std::erase_if(learned.beliefs, [&](const LearnedBelief& old) {
      return old.rule == each.rule && old.strategy == each.strategy;
    });
    learned.beliefs.push_back(each);
  }
  // One failure that clears may change a thousand of them: its exposure.
  std::set<std::pair<std::string_view, std::string_view>> pairs;
  for (const LearnedCoupling& each : news.couplings) pairs.emplace(each.cause, each.effect);
  std::erase_if(learned.couplings, [&](const LearnedCoupling& old) {
    return pairs.contains({old.cause, old.effect});
  });
  learned.couplings.insert(learned.couplings.end(), news.couplings.begin(), news.couplings.end());
  for (const LearnedLatency& each : news.latencies) {
    std::erase_if(learned.latencies,
                  [&](const LearnedLatency& old) { return old.rule == each.rule; });
    learned.latencies.push_back(each);
  }
  for (const LearnedCoincidence& each : news.coincidences) {
    std::erase_if(learned.coincidences, [&](const LearnedCoincidence& old) {
      return old.rule == each.rule && old.other == each.other;
    });
    learned.coincidences.push_back(each);
  }
}

// Older journals have no such rows, and no decision depends on them.
bool is_no_decision(const Event& event) {
  return std::holds_alternative<RuleBlind>(event.what) ||
         std::holds_alternative<RuleSees>(event.what) ||
         std::holds_alternative<IncidentOpened>(event.what) ||
         std::holds_alternative<IncidentChanged>(event.what) ||
         std::holds_alternative<IncidentClosed>(event.what);
}

}  // namespace

std::optional<Digest> digest_of(std::span<const Command> commands, std::span<const Event> events,
                                const RuleSet& rules, Hasher& hasher) {
  std::string all;
  for (const Command& command : commands)
    all += std::to_string(command.id.number) + " " + rules[command.component].name + " " +
           culprit::to_string(command) + "\n";
  for (const Event& event : events) {
    if (!is_no_decision(event)) all += line_of(event, rules) + "\n";
  }
  if (all.empty()) return std::nullopt;
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
      changes_(knowledge),
      writer_(std::move(writer)),
      where_{session.domain, session.boot},
      session_(to_json(session)),
      known_(session.learned) {
  is_failing_ = !writer_;
  for (Entry& row : options_.unwritten) add(std::move(row));
  options_.unwritten.clear();
  add(kind::kSession, options_.wall_clock(), session_);
  owes_sync_ = true;
  if (write()) open_intents();
  thread_ = std::thread([this] { run(); });
}

Recorder::~Recorder() { finish(); }

Expected<void> Recorder::end(Ending ending) {
  date_kept();
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
  date_kept();
  hand_over(Urgency::kNone);
  {
    const MutexLock lock(mutex_);
    is_ending_ = true;
  }
  work_.notify_one();
  thread_.join();
  if (!last_error_) empty_intents();
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
  CULPRIT_ASSERT(kept_ > 0 && &step == &places_[kept_ - 1]);
  CULPRIT_ASSERT(step.decided == nullptr);  // rows of an earlier step would be written again
  date_kept();
  const bool decides = !commands.empty() || !events.empty();
  if (decides) decide(step, commands, events);
  bool has_to_wait = false;
  bool asks = false;
  if (decides) {
    has_to_wait =
        step.decided->learned.has_outcomes() || std::any_of(events.begin(), events.end(), is_order);
    for (const Command& command : commands) {
      if (is_read(command)) continue;
      asks = true;
      has_to_wait = has_to_wait || !is_settled_here(command, knowledge_);
    }
  }
  if (asks && !has_to_wait) has_to_wait = !is_with_the_kernel(*step.decided, step.now);
  if (auto robot = changes_.robot(step.now)) decided(step).robot = std::move(robot);
  hand_over(has_to_wait               ? Urgency::kNow
            : asks                    ? Urgency::kSynced
            : step.decided != nullptr ? Urgency::kSoon
                                      : Urgency::kNone);
  if (has_to_wait) wait_until_written();
}

// All kept steps happened by now; their results have their own rows.
void Recorder::date_kept() {
  if (kept_ == 0) return;
  const auto kept = std::span(places_).first(kept_);
  const std::int64_t wall_offset =
      options_.wall_clock() - kept.back().now.time_since_epoch().count();
  for (Pending& step : kept) {
    step.wall = step.now.time_since_epoch().count() + wall_offset;
    if (!asked_.empty()) take_outcomes(step);
  }
}

void Recorder::take_outcomes(Pending& step) {
  for (const Observation& observation : step.observations) {
    const auto* reply = std::get_if<Reply>(&observation.what);
    if (reply == nullptr) continue;
    const auto asked = asked_.find(reply->command.number);
    if (asked == asked_.end()) continue;
    const std::string_view outcome = to_string(reply->outcome);
    const Json body = {{"command", reply->command.number},
                       {"outcome", outcome},
                       {"reason", reply->text},
                       {"text", asked->second + ": " + std::string(outcome) +
                                    (reply->text.empty() ? "" : ", " + reply->text)}};
    decided(step).rows.push_back({0, step.wall, std::string(kind::kOutcome), to_line(body)});
    asked_.erase(asked);
  }
  if (step.decided != nullptr && step.decided->number == 0) {
    step.decided->number = ++decisions_;
    keep_rows(*step.decided);
  }
}

void Recorder::hand_over(Urgency urgency) {
  constexpr std::size_t kMaxQueued = 1 << 17;
  if (kept_ == 0) return;
  const auto kept = std::span(places_).first(std::exchange(kept_, 0));
  const MutexLock lock(mutex_);
  if (queue_.used == 0) first_queued_ = kept.front().now;
  for (Pending& step : kept) {
    if (queued_observations_ > kMaxQueued && step.decided == nullptr) {
      ++lost_steps_;
      step.observations.clear();
      continue;
    }
    queued_observations_ += step.observations.size();
    now_of_queue_ = step.now;
    std::swap(queue_.next(), step);
    ++handed_over_;
  }
  const bool is_due = now_of_queue_ - first_queued_ >= kPeriod || queued_observations_ >= kMany;
  urgency_ = std::max({urgency_, urgency, is_due ? Urgency::kSoon : Urgency::kNone});
  // The thread that waits for the rows wakes the writer.
  if (urgency_ == Urgency::kSoon || urgency_ == Urgency::kSynced) is_writer_needed_ = true;
}

void Recorder::wake_writer() {
  if (std::exchange(is_writer_needed_, false)) work_.notify_one();
}

void Recorder::before_commands(Time now, std::vector<Observation>& observations,
                               std::span<const Command> commands, std::span<const Event> events) {
  CULPRIT_ASSERT(kept_ < kMaxKept);
  Pending& place = places_[kept_++];
  place.now = now;
  place.observations.swap(observations);
  hand_over(place, commands, events);
}

Recorder::Decided& Recorder::decided(Pending& step) {
  if (step.decided == nullptr) step.decided = std::make_unique<Decided>();
  return *step.decided;
}

void Recorder::decide(Pending& step, std::span<const Command> commands,
                      std::span<const Event> events) {
  Decided& decision = decided(step);
  decision.commands.assign(commands.begin(), commands.end());
  decision.events.assign(events.begin(), events.end());
  if (!events.empty()) decision.learned = changes_.learned();
  const auto add_row = [&](std::string_view kind, std::string body) {
    decision.rows.push_back({0, step.wall, std::string(kind), std::move(body)});
  };
  for (const Event& event : events) add_row(kind::kEvent, line_of(event, rules_));
  for (const Command& command : commands) {
    if (is_read(command)) continue;
    asked_[command.id.number] = text_of(command, rules_);
    add_row(kind::kIntent, line_of(command, rules_));
  }
  if (decision.rows.empty()) return;
  // Rows that were kept for this step earlier are among them.
  if (decision.number == 0) decision.number = ++decisions_;
  keep_rows(decision);
}

// In case an intent follows before the journal has them.
void Recorder::keep_rows(const Decided& decision) {
  recent_.keep(decision.number, decision.rows, [this] {
    const MutexLock lock(mutex_);
    return saved_;
  });
}

// Writes what an intent of `decision` follows from, and the intent itself, to the intent file. False:
// it is not there, so the journal has to be waited for.
bool Recorder::is_with_the_kernel(const Decided& decision, Time now) {
  std::uint64_t saved = 0;
  IntentFile::Head head;
  {
    const MutexLock lock(mutex_);
    const bool is_stalled =
        writing_since_ && std::chrono::steady_clock::now() - *writing_since_ > kStalled;
    if (is_failing_ || is_stalled) return false;
    if (new_intents_) {
      intents_ = std::move(new_intents_);
      new_intents_.reset();
      in_file_ = 0;
    }
    saved = saved_;
    if (in_file_ <= saved) head = head_;
  }
  if (!intents_ || recent_.forgotten() > saved) return false;
  recent_.forget(saved);
  if (in_file_ <= saved) intents_->begin_after(std::move(head));
  rows_.clear();
  recent_.append_to(rows_);
  CULPRIT_ASSERT(!rows_.empty());  // the request would go out without its row
  if (const auto written = intents_->append(now, rows_); !written) {
    const MutexLock lock(mutex_);
    intents_.reset();
    wants_intents_ = true;
    return false;
  }
  in_file_ = decision.number;
  recent_.forget(decision.number);
  return true;
}

void Recorder::wait_until_written() {
  work_.notify_one();
  MutexLock lock(mutex_);
  const std::uint64_t mine = handed_over_;
  done_.wait_for(lock, kPatience,
                 [&]() CULPRIT_REQUIRES(mutex_) { return written_ >= mine || is_failing_; });
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
    owes_sync_ = std::exchange(urgency_, Urgency::kNone) >= Urgency::kSynced || owes_sync_;
    const bool wants_intents = wants_intents_;
    if (taken.used > 0) now_ = now_of_queue_;
    gap_steps_ += std::exchange(lost_steps_, 0);
    const bool is_last = is_ending_;
    owes_sync_ = owes_sync_ || is_last;
    writing_since_ = std::chrono::steady_clock::now();
    lock.unlock();

    for (std::size_t i = 0; i < taken.used; ++i) make_rows(taken.places[i]);
    taken.clear();
    close_steps();
    const auto written = write();
    last_error_ = written ? std::nullopt : std::optional(Error{written.error()});
    if (written && wants_intents && !is_last) open_intents();
    tell_of_intents();
    written_at = std::chrono::steady_clock::now();

    lock.lock();
    CULPRIT_ASSERT(written_ <= upto);  // steps would count as written that are not
    written_ = upto;
    writing_since_.reset();
    done_.notify_all();
    if (is_last && queue_.used == 0) return;
  }
}

void Recorder::make_rows(Pending& pending) {
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

  if (pending.decided != nullptr) make_decision(pending.wall, *pending.decided);
  constexpr std::size_t kLongRow = 1 << 16;
  if (steps_.size() > kLongRow) close_steps();
}

void Recorder::make_decision(std::int64_t wall, Decided& decision) {
  for (Entry& row : decision.rows) add(std::move(row));
  // An earlier decision would count as saved before it is, and be missing after a crash.
  CULPRIT_ASSERT(decision.number == 0 || decision.number > unsaved_to_);
  unsaved_to_ = std::max(unsaved_to_, decision.number);
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

void Recorder::add(std::string_view kind, std::int64_t at, const Json& body) {
  add({0, at, std::string(kind), to_line(body)});
}

// The results of a step follow the row that holds the step.
void Recorder::add(Entry row) {
  close_steps();
  unsaved_bytes_ += row.body.size();
  unsaved_.entries.push_back(std::move(row));
}

// The run goes on in a file that replaces one that was removed or damaged.
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
    if (auto recovery = recover(*reader, {}, rules_, {now_, wall, where_.domain}))
      known = std::move(*recovery);
  }
  // Without them the strategies under way are unknown; those at the beginning are known.
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
                            {0, wall, std::string(kind::kRobot), to_line(robot_)});
  unsaved_.entries.insert(unsaved_.entries.begin(),
                          {0, wall, std::string(kind::kSession), to_line(session_)});
}

Expected<void> Recorder::write() {
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
         to_line({{"steps", gap_steps_}, {"rows", gap_rows_}, {"text", text}})});
    gap_steps_ = gap_rows_ = 0;
  }
  if (unsaved_.entries.empty() && unsaved_.learned.is_empty()) return {};
  const auto written = writer_->append(
      unsaved_, now, owes_sync_ ? Durability::kPowerFailure : Durability::kProcessEnd);
  if (!written) return failed({written.error()});
  is_begun_ = true;
  unsaved_ = {};
  unsaved_bytes_ = 0;
  owes_sync_ = false;
  bool was_failing = false;
  IntentFile::Head head(writer_->newest());
  {
    const MutexLock lock(mutex_);
    was_failing = std::exchange(is_failing_, false);
    saved_ = unsaved_to_;
    head_ = std::move(head);
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
  options_.on_trouble(
      copy_trouble_.empty()
          ? "culprit writes the second copy of its learned values again"
          : "culprit cannot write the second copy of its learned values, so only the "
            "journal has it: " +
                copy_trouble_);
}

// Only once the journal has all that such a file may have: it is emptied.
void Recorder::open_intents() {
  auto opened = IntentFile::open(options_.path);
  const MutexLock lock(mutex_);
  wants_intents_ = !opened;
  intents_trouble_ = opened ? "" : opened.error();
  if (opened) new_intents_ = std::move(*opened);
}

// Each change once.
void Recorder::tell_of_intents() {
  std::string trouble;
  {
    const MutexLock lock(mutex_);
    trouble = intents_trouble_;
  }
  if (told_of_intents_ == trouble) return;
  told_of_intents_ = trouble;
  if (!options_.on_trouble) return;
  options_.on_trouble(trouble.empty()
                          ? "requests are saved beside the journal again before they go out"
                          : "each request waits for the journal now, which is slower: " + trouble);
}

// The journal has all.
void Recorder::empty_intents() {
  const MutexLock lock(mutex_);
  if (intents_) intents_->empty();
  intents_.reset();
  new_intents_.reset();
}

Expected<void> Recorder::failed(Error error) {
  // A file that cannot be written now may be another one next time: it is opened again.
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

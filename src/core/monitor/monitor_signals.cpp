// The monitor's part about signals: declared ones, diagnostics and parameters.
#include <algorithm>
#include <cmath>

#include "monitor/interval.h"
#include "monitor/monitor.h"
#include "robot/unreadable.h"

namespace culprit {

namespace {

using Kind = Input::Kind;

// A number, also one that a diagnostic has as a text. Empty: it is no number.
std::optional<double> number_in(const Value& value) {
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return static_cast<double>(*whole);
  if (const auto* number = std::get_if<double>(&value)) return *number;
  const auto* text = std::get_if<std::string>(&value);
  const Value read = text != nullptr ? value_from_text(*text) : Value(false);
  if (const auto* number = std::get_if<double>(&read)) return *number;
  if (const auto* whole = std::get_if<std::int64_t>(&read)) return static_cast<double>(*whole);
  return std::nullopt;
}

bool is_nan(const Value& value) {
  const auto number = number_in(value);
  return number && std::isnan(*number);
}

}  // namespace

using monitor::smoothed;
using monitor::usual_gap;
using monitor::usual_latency;

void Monitor::on(Time at, const SignalRead& seen) { read_signal(seen.signal, seen.value, at); }

void Monitor::read_signal(SignalId signal, const Value& value, Time at) {
  const culprit::Signal& declared = knowledge_.rules[signal];
  Signal& state = signals_[signal.index];
  const bool had_rhythm = state.interval > Duration::zero();
  const bool is_after_gap =
      !state.last || (declared.stale && later(*state.last, *declared.stale) < at);
  const std::optional<Time> before = state.last;
  if (state.last) state.interval = smoothed(state.interval, at - *state.last);
  const bool has_rhythm = state.interval > Duration::zero();
  state.last = at;
  write_.discovered.read(signal);
  std::string text;
  const Slot slot = as_type(value, declared.type, text);
  note_number(signal, value, slot, at);
  for (const InputId id : state.inputs) {
    const Input& input = knowledge_.rules[id];
    write_.signals.set_latency(id, latency_of(signal, id) + input.window);
    write_.signals.set_read_at(id, at);
    note_arrival(id, at);
    if (has_rhythm && !had_rhythm) write_.signals.touch(id);
    switch (input.kind) {
      case Kind::kSignal:
        note_reading(id, slot);
        put(id, slot, state);
        break;
      case Kind::kIsNan:
        put(id, number_in(value) ? Slot::of(is_nan(value)) : Slot(), state);
        break;
      case Kind::kChanged:
        note_change(id, value, at, is_after_gap);
        update_changed(id, at);
        continue;
      case Kind::kFrozen:
        note_change(id, value, at, !before || later(*before, pause_of(input)) < at);
        update_frozen(id, at);
        continue;
      default: {
        Derived& derived = derived_[id.index];
        if (state.unusable) {
          derived.values->begin_anew();
        } else if (!derived.values->add(at, slot.d)) {
          note_overflow(id, at);
        }
        update_window(id, at);
        continue;
      }
    }
    if (declared.stale) deadlines_.set(id.index, later(at, *declared.stale));
  }
}

// Notes whether the reading is a number, and reports NaN.
void Monitor::note_number(SignalId signal, const Value& value, const Slot& slot, Time at) {
  Signal& state = signals_[signal.index];
  state.unusable.reset();
  if (slot.known) return;
  state.unusable = is_nan(value) ? WhyUnknown::kNotANumber : WhyUnknown::kUnreadable;
  if (!is_nan(value)) return;
  const bool is_news = !state.nan || later(*state.nan, kTellAgain) <= at;
  state.nan = at;
  const auto reads_number = [&](InputId id) { return knowledge_.rules[id].kind != Kind::kIsNan; };
  const auto reader = std::ranges::find_if(state.inputs, reads_number);
  if (is_news && reader != state.inputs.end())
    write_.events.tell(at, ValueUnknown{*reader, WhyUnknown::kNotANumber});
}

void Monitor::put(InputId id, const Slot& value, const Signal& signal) {
  if (value.known) return write_.signals.set(id, value);
  write_.signals.forget(id, signal.unusable.value_or(WhyUnknown::kUnreadable));
}

bool Monitor::is_stale(SignalId signal, Time now) const {
  const auto& last = signals_[signal.index].last;
  const auto& stale = knowledge_.rules[signal].stale;
  return last && stale && later(*last, *stale) <= now;
}

// Why a window, or whether a signal changed, is unknown.
WhyUnknown Monitor::why_unknown(SignalId signal, Time now) const {
  const Signal& state = signals_[signal.index];
  if (!state.last) return WhyUnknown::kNoValue;
  if (is_stale(signal, now)) return WhyUnknown::kStale;
  return state.unusable.value_or(WhyUnknown::kNotCovered);
}

bool Monitor::has_sender_begun_since(Time before, InputId id) const {
  const Input& input = knowledge_.rules[id];
  if (input.subject() != Input::Subject::kSignal) return false;
  const auto* field = std::get_if<TopicField>(&knowledge_.rules[input.signal].source);
  if (field != nullptr) return has_begun_since(before, field->topic);
  const auto& publisher = knowledge_.signal_publishers[input.signal.index];
  return publisher && has_begun_since(before, *publisher);
}

void Monitor::note_arrival(InputId id, Time at) {
  SignalStore::Arrivals arrivals = knowledge_.signals.arrivals(id);
  const bool is_heard = arrivals.last != kLongAgo && arrivals.last >= awake_;
  const Duration pause = is_heard ? at - arrivals.last : Duration::zero();
  const bool is_longer = pause > arrivals.longest;
  // A sender that begins anew is silent for a while.
  if (is_heard && !(is_longer && has_sender_begun_since(arrivals.last, id))) {
    arrivals.gap = usual_gap(arrivals.gap, pause);
    arrivals.longest = std::max(arrivals.longest, pause);
  }
  arrivals.last = at;
  arrivals.count = std::min(arrivals.count + 1, SignalStore::kRegular);
  write_.signals.set_arrivals(id, arrivals);
}

Duration Monitor::latency_of(SignalId signal, InputId id) const {
  // Nodes report at once when a parameter changes.
  if (std::holds_alternative<ParameterId>(knowledge_.rules[signal].source))
    return knowledge_.rules.cycle;
  // After one reading the time of the next one is unknown.
  const Duration interval = signals_[signal.index].interval;
  if (interval == Duration::zero()) return monitor::kLongestLatency;
  // A status that comes seldom shows nothing before it comes again.
  const SignalStore::Arrivals& arrivals = knowledge_.signals.arrivals(id);
  const bool is_known = arrivals.count >= SignalStore::kRegular;
  const Duration seldom =
      is_known ? std::min(2 * arrivals.gap, monitor::kLongestOfSeldom) : Duration::zero();
  return seldom > monitor::kLongestLatency ? seldom : usual_latency(interval);
}

// A new extreme, or nearer to a threshold than it ever was lately?
void Monitor::note_reading(InputId id, const Slot& slot) {
  const Input& input = knowledge_.rules[id];
  const bool is_number = input.type == Type::kInt || input.type == Type::kDouble;
  if (!is_number || input.thresholds.empty() || !slot.known) return;
  const double value = input.type == Type::kInt ? static_cast<double>(slot.i) : slot.d;
  if (!std::isfinite(value)) return;
  monitor::LongQueue<double>& usual = derived_[id.index].usual;
  bool is_unusual = false;
  if (usual.size() >= kLeastReadings) {
    double least = usual[0];
    double most = usual[0];
    for (std::size_t i = 1; i < usual.size(); ++i) {
      least = std::min(least, usual[i]);
      most = std::max(most, usual[i]);
    }
    is_unusual = (value < least && input.thresholds.front() <= value) ||
                 (value > most && input.thresholds.back() >= value);
  }
  write_.signals.set_unusual(id, is_unusual);
  if (usual.full()) usual.pop_front();
  usual.push_back(value);
}

void Monitor::update_window(InputId id, Time now) {
  Derived& derived = derived_[id.index];
  const std::optional<double> value = derived.values->value(now);
  if (value && !std::isnan(*value)) {
    derived.is_overflow_told = false;
    write_.signals.set(id, Slot::of(*value));
  } else if (value) {
    write_.signals.forget(id, WhyUnknown::kNotANumber);
  } else if (derived.is_overflow_told) {
    write_.signals.forget(id, WhyUnknown::kOverflow);
  } else {
    write_.signals.forget(id, why_unknown(knowledge_.rules[id].signal, now));
  }
  deadlines_.set(id.index, derived.values->next_change(now));
}

// The input is unknown until its samples fit again: a window never counts a part of them.
void Monitor::note_overflow(InputId id, Time at) {
  Derived& derived = derived_[id.index];
  derived.overflowed = at;
  if (!derived.is_overflow_told) write_.events.tell(at, ValueUnknown{id, WhyUnknown::kOverflow});
  derived.is_overflow_told = true;
}

// The first reading after a gap is no change: the values in between are unknown.
void Monitor::note_change(InputId id, const Value& value, Time at, bool is_after_gap) {
  Derived& derived = derived_[id.index];
  const bool is_unknown = is_nan(value) || is_unreadable(value);
  if (is_after_gap || is_unknown) derived.known_since.reset();
  if (is_unknown) return;
  if (!derived.known_since) {
    derived.known_since = at;
    derived.changed.reset();
  } else if (derived.last_value != value) {
    derived.changed = at;
  }
  derived.last_value = value;
}

void Monitor::update_changed(InputId id, Time now) {
  const SignalId signal = knowledge_.rules[id].signal;
  const Derived& derived = derived_[id.index];
  const Duration cycle = knowledge_.rules.cycle;
  const auto& stale = knowledge_.rules[signal].stale;
  const auto& last = signals_[signal.index].last;
  if (!derived.known_since || is_stale(signal, now)) {
    deadlines_.clear(id.index);
    return write_.signals.forget(id, why_unknown(signal, now));
  }
  const Time covered = later(*derived.known_since, cycle);
  const Time ends = derived.changed ? later(*derived.changed, cycle) : kLongAgo;
  Time next = last && stale ? later(*last, *stale) : kNever;
  if (now < covered) {
    write_.signals.forget(id, WhyUnknown::kNotCovered);
    next = std::min(next, covered);
  } else {
    write_.signals.set(id, Slot::of(now < ends));
    if (now < ends) next = std::min(next, ends);
  }
  deadlines_.set(id.index, next);
}

// If a pause between two samples is longer, the value in between is unknown.
Duration Monitor::pause_of(const Input& input) const {
  return knowledge_.rules[input.signal].stale.value_or(input.window);
}

// Only repeated readings show that a value is frozen: a signal without readings is silent.
void Monitor::update_frozen(InputId id, Time now) {
  const Input& input = knowledge_.rules[id];
  const Derived& derived = derived_[id.index];
  const auto& last = signals_[input.signal.index].last;
  if (!derived.known_since || later(*last, pause_of(input)) <= now) {
    deadlines_.clear(id.index);
    const bool has_paused = derived.known_since.has_value();
    return write_.signals.forget(
        id, has_paused ? WhyUnknown::kNotCovered : why_unknown(input.signal, now));
  }
  if (*last < later(*derived.known_since, input.window)) {
    write_.signals.forget(id, WhyUnknown::kNotCovered);
  } else {
    const Time same_since = std::max(*derived.known_since, derived.changed.value_or(kLongAgo));
    write_.signals.set(id, Slot::of(later(same_since, input.window) <= *last));
  }
  deadlines_.set(id.index, later(*last, pause_of(input)));
}

// Samples from before a gap in hearing no longer count. A value that changed in the gap changes when it
// is read next: many are published only when they change.
void Monitor::begin_windows_anew(Time now) {
  for (std::size_t i = 0; i < derived_.size(); ++i) {
    Derived& derived = derived_[i];
    if (derived.values) {
      derived.values->begin_anew();
      update_window(InputId(i), now);
    } else if (derived.known_since) {
      derived.changed.reset();
      if (knowledge_.rules.inputs[i].kind == Kind::kFrozen) {
        derived.known_since.reset();
        update_frozen(InputId(i), now);
      } else {
        derived.known_since = now;
        update_changed(InputId(i), now);
      }
    }
  }
}

void Monitor::on(Time, const StatusHeard& seen) { write_.reported_names.statuses.push_back(seen); }

void Monitor::on(Time, const ParametersListed& seen) {
  write_.reported_names.parameters[seen.component] = seen.names;
}

void Monitor::on(Time at, const DiagnosticRead& seen) {
  write_.discovered.read(seen.diagnostic);
  for (const InputId id : diagnostic_inputs_[seen.diagnostic.index]) {
    note_arrival(id, at);
    write_.signals.set(id, Slot::of(std::int64_t{seen.level}));
  }
}

void Monitor::on(Time at, const ParameterRead& seen) {
  write_.components[seen.parameter] = seen.value;
  write_.discovered.read(seen.parameter);
  for (const SignalId signal : parameter_signals_[seen.parameter.index])
    read_signal(signal, seen.value, at);
  for (const InputId id : parameter_inputs_[seen.parameter.index]) {
    std::string text;
    const Slot slot = as_type(seen.value, knowledge_.rules[id].type, text);
    if (slot.known) {
      write_.signals.set(id, slot);
      continue;
    }
    const auto why = is_nan(seen.value) ? WhyUnknown::kNotANumber : WhyUnknown::kUnreadable;
    const bool is_news = knowledge_.signals.why_unknown(id) != why;
    write_.signals.forget(id, why);
    if (is_news && why == WhyUnknown::kNotANumber) write_.events.tell(at, ValueUnknown{id, why});
  }
}

}  // namespace culprit

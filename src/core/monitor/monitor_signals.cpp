// The monitor's part about signals: declared ones, diagnostics and parameters.
#include <algorithm>
#include <cmath>

#include "monitor/interval.h"
#include "monitor/monitor.h"

namespace culprit {

namespace {

using Kind = Input::Kind;

}  // namespace

using monitor::smoothed;
using monitor::usual_latency;

void Monitor::on(Time at, const SignalRead& seen) { read_signal(seen.signal, seen.value, at); }

void Monitor::read_signal(SignalId signal, const Value& value, Time at) {
  const culprit::Signal& declared = knowledge_.rules[signal];
  Signal& state = signals_[signal.index];
  const bool is_first = !state.last;
  const bool had_rhythm = state.interval > Duration::zero();
  if (!is_first) state.interval = smoothed(state.interval, at - *state.last);
  const bool has_rhythm = state.interval > Duration::zero();
  state.last = at;
  write_.sightings.read(signal);
  std::string text;
  const Slot slot = as_type(value, declared.type, text);
  for (const InputId id : state.inputs) {
    const Input& input = knowledge_.rules[id];
    write_.signals.set_latency(id, latency_of(signal) + input.window);
    write_.signals.set_read_at(id, at);
    if (has_rhythm && !had_rhythm) write_.signals.touch(id);
    if (input.kind == Kind::kSignal) {
      note_reading(id, slot);
      write_.signals.set(id, slot);
      if (declared.stale) deadlines_.set(id.index, later(at, *declared.stale));
    } else if (input.kind == Kind::kChanged) {
      Derived& derived = derived_[id.index];
      const bool differs = !is_first && derived.last_value != value;
      derived.last_value = value;
      if (differs) deadlines_.set(id.index, later(at, knowledge_.rules.cycle));
      if (differs || is_first) write_.signals.set(id, Slot::of(differs));
    } else if (slot.known) {
      derived_[id.index].values.add(at, slot.d);
      update_window(id, at);
    }
  }
}

Duration Monitor::latency_of(SignalId signal) const {
  // Nodes tell at once when a parameter changes.
  if (std::holds_alternative<ParameterId>(knowledge_.rules[signal].source))
    return knowledge_.rules.cycle;
  // After one reading nobody knows when the next will come.
  const Duration interval = signals_[signal.index].interval;
  return interval > Duration::zero() ? usual_latency(interval) : monitor::kLongestLatency;
}

// A new extreme, or nearer to a threshold than it ever was lately?
void Monitor::note_reading(InputId id, const Slot& slot) {
  const Input& input = knowledge_.rules[id];
  const bool is_number = input.type == Type::kInt || input.type == Type::kDouble;
  if (!is_number || input.thresholds.empty() || !slot.known) return;
  const double value = input.type == Type::kInt ? static_cast<double>(slot.i) : slot.d;
  if (!std::isfinite(value)) return;
  monitor::Ring<double>& usual = derived_[id.index].usual;
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
  derived.values.advance(now);
  const auto summary = derived.values.summary();
  Slot value;
  if (summary) {
    switch (knowledge_.rules[id].kind) {
      case Kind::kMean:
        value = Slot::of(summary->mean);
        break;
      case Kind::kMin:
        value = Slot::of(summary->min);
        break;
      case Kind::kMax:
        value = Slot::of(summary->max);
        break;
      default:
        value = Slot::of(summary->stddev);
        break;
    }
  }
  write_.signals.set(id, value);
  deadlines_.set(id.index, derived.values.next_change());
}

void Monitor::on(Time, const StatusHeard& seen) { write_.heard_names.statuses.push_back(seen); }

void Monitor::on(Time, const ParametersListed& seen) {
  write_.heard_names.parameters[seen.component] = seen.names;
}

void Monitor::on(Time, const DiagnosticRead& seen) {
  write_.sightings.read(seen.diagnostic);
  for (const InputId id : diagnostic_inputs_[seen.diagnostic.index]) {
    write_.signals.set(id, Slot::of(std::int64_t{seen.level}));
  }
}

void Monitor::on(Time at, const ParameterRead& seen) {
  write_.components[seen.parameter] = seen.value;
  write_.sightings.read(seen.parameter);
  for (const SignalId signal : parameter_signals_[seen.parameter.index])
    read_signal(signal, seen.value, at);
  for (const InputId id : parameter_inputs_[seen.parameter.index]) {
    std::string text;
    write_.signals.set(id, as_type(seen.value, knowledge_.rules[id].type, text));
  }
}

}  // namespace culprit

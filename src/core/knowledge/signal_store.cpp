#include "knowledge/signal_store.h"

#include <algorithm>

#include "robot/unreadable.h"

namespace culprit {

SignalStore::SignalStore(const RuleSet& rules)
    : rules_(rules),
      slots_(rules.inputs.size()),
      texts_(rules.inputs.size()),
      why_unknown_(rules.inputs.size(), WhyUnknown::kNoValue),
      latencies_(rules.inputs.size()),
      read_at_(rules.inputs.size(), kLongAgo),
      arrivals_(rules.inputs.size()),
      is_unusual_(rules.inputs.size()),
      rhythms_(rules.topics.size()),
      is_touched_(rules.rules.size()) {
  touched_.reserve(rules.rules.size());
  taken_.reserve(rules.rules.size());
}

SignalStore::SignalStore(const RuleSet& rules, const SignalStore& other)
    : rules_(rules),
      slots_(other.slots_),
      texts_(other.texts_),
      why_unknown_(other.why_unknown_),
      latencies_(other.latencies_),
      read_at_(other.read_at_),
      arrivals_(other.arrivals_),
      hears_since_(other.hears_since_),
      is_unusual_(other.is_unusual_),
      rhythms_(other.rhythms_),
      touched_(other.touched_),
      is_touched_(other.is_touched_) {
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    if (rules_.inputs[i].type == Type::kString) slots_[i].s = texts_[i];
  }
}

void SignalStore::set(InputId id, const Slot& value) {
  if (same(slots_[id.index], value, rules_[id].type)) return;
  set_quietly(id, value);
  touch(id);
}

void SignalStore::set_quietly(InputId id, const Slot& value) {
  Slot& slot = slots_[id.index];
  slot = value;
  if (value.known) why_unknown_[id.index] = WhyUnknown::kNoValue;
  if (rules_[id].type != Type::kString || !value.known) return;
  texts_[id.index] = value.s;
  slot.s = texts_[id.index];
}

void SignalStore::forget(InputId id, WhyUnknown why) {
  set(id, Slot());
  why_unknown_[id.index] = why;
}

void SignalStore::touch(InputId id) {
  for (const RuleId reader : rules_[id].readers) touch(reader);
}

void SignalStore::touch(RuleId id) {
  if (is_touched_[id.index]) return;
  is_touched_[id.index] = true;
  touched_.push_back(id);
}

Duration SignalStore::latency(RuleId id) const {
  Duration latency{};
  for (const InputId input : rules_[id].inputs)
    latency = std::max(latency, latencies_[input.index]);
  return latency;
}

Time SignalStore::heard_again_by(RuleId id) const {
  using Kind = Input::Kind;
  Time by = kLongAgo;
  for (const InputId each : rules_[id].inputs) {
    const Input& input = rules_[each];
    const bool is_rhythm = input.kind == Kind::kAge || input.kind == Kind::kRate ||
                           input.kind == Kind::kPhi || input.kind == Kind::kLoss;
    if (is_rhythm) by = std::max(by, rhythm(input.topic).heard_again_by);
  }
  return by;
}

Time SignalStore::confirmed_by(InputId id) const {
  constexpr Duration kUsuallyThen = std::chrono::seconds(2);  // if values come irregularly
  const Input& input = rules_.inputs[id.index];
  const bool is_age = input.kind == Input::Kind::kAge || input.kind == Input::Kind::kPhi;
  if (is_age) return age_confirmed_by(input);
  const Arrivals& values = arrivals_[id.index];
  const bool is_missed =
      hears_since_ != kLongAgo && values.last != kLongAgo && values.last < hears_since_;
  return is_missed ? later(hears_since_, values.gap + kUsuallyThen) : kLongAgo;
}

// A silence that is counted anew is shorter than it is, so it proves nothing before it is longer than all that it is
// compared with.
Time SignalStore::age_confirmed_by(const Input& input) const {
  const Rhythm& samples = rhythms_[input.topic.index];
  const bool is_missed = hears_since_ != kLongAgo && samples.last && *samples.last < hears_since_;
  if (!is_missed) return kLongAgo;
  if (input.kind == Input::Kind::kPhi || input.thresholds.empty()) return kNever;
  const Time since = std::max(samples.silent_since(), samples.heard_again_by);
  return later(since, from_seconds(input.thresholds.back()));
}

bool SignalStore::is_read_since(RuleId id, Time since) const {
  const auto& inputs = rules_[id].inputs;
  return std::all_of(inputs.begin(), inputs.end(),
                     [&](InputId input) { return read_at_[input.index] > since; });
}

std::span<const RuleId> SignalStore::take_touched() {
  taken_.swap(touched_);
  touched_.clear();
  for (const RuleId id : taken_) is_touched_[id.index] = false;
  return taken_;
}

bool same(const Slot& a, const Slot& b, Type type) {
  if (!a.known || !b.known) return a.known == b.known;
  switch (type) {
    case Type::kBool:
      return a.b == b.b;
    case Type::kInt:
    case Type::kDuration:
      return a.i == b.i;
    case Type::kDouble:
      return a.d == b.d;
    case Type::kString:
      return a.s == b.s;
  }
  return false;
}

Slot as_type(const Value& value, Type type, std::string& text) {
  if (is_unreadable(value)) return {};
  if (type == Type::kString) {
    const auto* already = std::get_if<std::string>(&value);
    text = already != nullptr ? *already : to_string(value);
    return Slot::of(std::string_view(text));
  }
  if (const auto* written = std::get_if<std::string>(&value)) {
    const Value read = value_from_text(*written);
    return std::holds_alternative<std::string>(read) ? Slot() : as_type(read, type, text);
  }
  const auto* whole = std::get_if<std::int64_t>(&value);
  if (type == Type::kBool) {
    if (const auto* b = std::get_if<bool>(&value)) return Slot::of(*b);
    return whole != nullptr && (*whole == 0 || *whole == 1) ? Slot::of(*whole == 1) : Slot();
  }
  const auto* number = std::get_if<double>(&value);
  if (type == Type::kDouble) {
    if (whole != nullptr) return Slot::of(static_cast<double>(*whole));
    return number != nullptr ? Slot::of(*number) : Slot();
  }
  return type == Type::kInt && whole != nullptr ? Slot::of(*whole) : Slot();
}

}  // namespace culprit

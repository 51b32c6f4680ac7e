// The fields of observations as bytes. FieldWriter and FieldReader have the same functions, so that one list of fields
// (step_codec.cpp) serves both directions.
#pragma once

#include <climits>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "journal/bytes.h"
#include "language/rule_set.h"
#include "robot/observation.h"

namespace culprit::journal {

// Before a value. Files hold these numbers: they must not change.
enum class ValueTag : std::uint8_t {
  kNone = 0,
  kFalse = 1,
  kTrue = 2,
  kInteger = 3,
  kReal = 4,
  kText = 5,
  kLifecycle = 6
};

// Beside a state of the lifecycle.
constexpr std::uint8_t kShutDown = 0x80;

class FieldWriter {
 public:
  template <class T>
  using Field = const T&;

  explicit FieldWriter(ByteWriter& out) : out_(out) {}

  void byte(std::uint8_t number) { out_.byte(number); }
  void natural(std::uint64_t number) { out_.natural(number); }
  void natural_below(std::uint64_t, std::uint64_t number) { out_.natural(number); }
  void pid(int number) { out_.integer(number); }
  void real(double number) { out_.real(number); }
  void duration(Duration duration) { out_.integer(duration.count()); }
  void text(const std::string& text) { out_.text(text); }
  void truth(bool truth) { byte(truth ? 1 : 0); }
  template <class... Truths>
  void truths(const Truths&... truths) {
    unsigned bits = 0;
    int place = 0;
    ((bits |= truths ? 1u << place : 0u, ++place), ...);
    byte(static_cast<std::uint8_t>(bits));
  }
  // As truths(), with a number below 128 in the other bits.
  void truth_and_number(bool truth, std::uint8_t number) {
    byte(static_cast<std::uint8_t>((number & 0x7f) << 1 | (truth ? 1 : 0)));
  }
  template <class Id>
  void id(Id id) {
    out_.natural(id.index);
  }
  template <class Enum>
  void word(Enum value, Enum) {
    byte(static_cast<std::uint8_t>(value));
  }
  void log_level(LogLevel level) { byte(static_cast<std::uint8_t>(level)); }
  void goal_status(GoalStatus status) { byte(static_cast<std::uint8_t>(status)); }
  void lifecycle(Lifecycle state, bool is_shut_down) {
    byte(static_cast<std::uint8_t>(static_cast<std::uint8_t>(state) |
                                   (is_shut_down ? kShutDown : 0)));
  }
  void silenced(const Silenceable& what) {
    byte(static_cast<std::uint8_t>(what.index()));
    std::visit([this](auto each) { id(each); }, what);
  }
  template <class T, class Each>
  void list(const std::vector<T>& all, Each each) {
    out_.natural(all.size());
    for (const T& one : all) each(one);
  }
  template <class T, class Each>
  void optional(const std::optional<T>& some, Each each) {
    truth(some.has_value());
    if (some) each(*some);
  }
  void value(const Value& value) {
    if (const auto* truth = std::get_if<bool>(&value)) {
      tag(*truth ? ValueTag::kTrue : ValueTag::kFalse);
    } else if (const auto* whole = std::get_if<std::int64_t>(&value)) {
      tag(ValueTag::kInteger);
      out_.integer(*whole);
    } else if (const auto* number = std::get_if<double>(&value)) {
      tag(ValueTag::kReal);
      out_.real(*number);
    } else {
      tag(ValueTag::kText);
      out_.text(std::get<std::string>(value));
    }
  }
  void answer(const decltype(Reply::value)& answer) {
    if (const auto* read = std::get_if<Value>(&answer)) {
      value(*read);
    } else if (const auto* state = std::get_if<Lifecycle>(&answer)) {
      tag(ValueTag::kLifecycle);
      word(*state, Lifecycle::kTransition);
    } else {
      tag(ValueTag::kNone);
    }
  }

 private:
  void tag(ValueTag tag) { byte(static_cast<std::uint8_t>(tag)); }

  ByteWriter& out_;
};

// Damaged bytes may hold anything: a field that cannot be is a failure of the ByteReader.
class FieldReader {
 public:
  template <class T>
  using Field = T&;

  FieldReader(ByteReader& in, const RuleSet& rules) : in_(in), rules_(rules) {}

  void fail() { in_.fail(); }

  void byte(std::uint8_t& number) { number = in_.byte(); }
  void natural(std::uint64_t& number) { number = in_.natural(); }
  template <class Number>
  void natural_below(std::uint64_t limit, Number& number) {
    number = static_cast<Number>(below(limit));
  }
  void pid(int& number) {
    const std::int64_t read = in_.integer();
    if (read < 0 || read > INT32_MAX) in_.fail();
    number = static_cast<int>(read);
  }
  void real(double& number) { number = in_.real(); }
  void duration(Duration& duration) { duration = Duration(in_.integer()); }
  void text(std::string& text) { text = in_.text(); }
  void truth(bool& truth) { truth = in_.byte() != 0; }
  template <class... Truths>
  void truths(Truths&... truths) {
    const unsigned bits = in_.byte();
    int place = 0;
    ((truths = (bits >> place++ & 1u) != 0), ...);
  }
  void truth_and_number(bool& truth, std::uint8_t& number) {
    const std::uint8_t both = in_.byte();
    truth = (both & 1) != 0;
    number = static_cast<std::uint8_t>(both >> 1);
  }
  void id(TopicId& id) { id = read_id<TopicId>(rules_.topics.size()); }
  void id(SignalId& id) { id = read_id<SignalId>(rules_.signals.size()); }
  void id(DiagnosticId& id) { id = read_id<DiagnosticId>(rules_.diagnostics.size()); }
  void id(ParameterId& id) { id = read_id<ParameterId>(rules_.parameters.size()); }
  void id(ComponentId& id) { id = read_id<ComponentId>(rules_.components.size()); }
  void id(RuleId& id) { id = read_id<RuleId>(rules_.rules.size()); }
  void id(StrategyId& id) { id = read_id<StrategyId>(rules_.strategies.size()); }
  template <class Enum>
  void word(Enum& value, Enum last) {
    const std::uint8_t number = in_.byte();
    if (number > static_cast<std::uint8_t>(last)) in_.fail();
    value = number > static_cast<std::uint8_t>(last) ? Enum{} : static_cast<Enum>(number);
  }
  void log_level(LogLevel& level) { level = culprit::log_level(in_.byte()); }
  void goal_status(GoalStatus& status) { status = GoalStatus(in_.byte() % 7); }
  void lifecycle(Lifecycle& state, bool& is_shut_down) {
    const std::uint8_t both = in_.byte();
    const auto primary = static_cast<std::uint8_t>(both & ~kShutDown);
    if (primary > static_cast<std::uint8_t>(Lifecycle::kTransition)) in_.fail();
    state = static_cast<Lifecycle>(primary);
    is_shut_down = (both & kShutDown) != 0;
  }
  void silenced(Silenceable& what) {
    what = in_.byte() == 0 ? Silenceable(read_id<ComponentId>(rules_.components.size()))
                           : Silenceable(read_id<RuleId>(rules_.rules.size()));
  }
  template <class T, class Each>
  void list(std::vector<T>& all, Each each) {
    for (std::uint64_t left = in_.natural(); left > 0 && in_.is_good(); --left)
      each(all.emplace_back());
  }
  template <class T, class Each>
  void optional(std::optional<T>& some, Each each) {
    if (in_.byte() != 0) each(some.emplace());
  }
  void value(Value& value) { value = read_value(static_cast<ValueTag>(in_.byte())); }
  void answer(decltype(Reply::value)& answer) {
    const auto tag = static_cast<ValueTag>(in_.byte());
    if (tag == ValueTag::kLifecycle) {
      word(answer.emplace<Lifecycle>(), Lifecycle::kTransition);
    } else if (tag != ValueTag::kNone) {
      answer = read_value(tag);
    }
  }

 private:
  std::uint64_t below(std::uint64_t limit) {
    const std::uint64_t number = in_.natural();
    if (number >= limit) in_.fail();
    return number < limit ? number : 0;
  }
  template <class Id>
  Id read_id(std::size_t count) {
    return Id(static_cast<std::size_t>(below(count)));
  }
  Value read_value(ValueTag tag) {
    switch (tag) {
      case ValueTag::kFalse:
        return false;
      case ValueTag::kTrue:
        return true;
      case ValueTag::kInteger:
        return in_.integer();
      case ValueTag::kReal:
        return in_.real();
      case ValueTag::kText:
        return in_.text();
      case ValueTag::kNone:
      case ValueTag::kLifecycle:
        break;
    }
    in_.fail();
    return false;
  }

  ByteReader& in_;
  const RuleSet& rules_;
};

}  // namespace culprit::journal

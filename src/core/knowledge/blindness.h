// Which rules are blind: culprit cannot tell whether their failure is present.
//
// A blind rule is neither quiet nor failing. It never counts as health, and it is never a reason to
// act. The analysis decides which rules are blind (analyze/blind_watch.h).
//
//     if (const auto since = knowledge.blind_since(rule)) ...   // it says nothing about its components
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/time.h"
#include "language/rule_set.h"

namespace culprit {

// The reason why a trigger has no value.
enum class Unseen : std::uint8_t {
  kNeverSeen,   // the robot never had the component, topic, diagnostic, parameter or value
  kStale,       // no new value comes, and the last one is too old to count
  kUnknown,     // it was seen and has no value
  kNotCovered,  // samples come, but never enough to cover its window
  kUnreadable,  // values come that cannot be compared: NaN, or of another type
  kNoResult     // all inputs have values, but their expression has no result
};
inline constexpr std::size_t kUnseens = 6;

std::string_view to_string(Unseen why);  // "never_seen", "stale" ...: in journals and JSON
std::optional<Unseen> unseen_named(std::string_view word);

struct Blind {
  Time since{};  // when the trigger lost its value, or when watching began
  Unseen why{};  // of the input that matters most
  std::string
      input;         // "battery", "age(/scan)"; of what was never seen its name: "camera", "/scan".
                     // Empty: kNoResult
  std::string near;  // a name of the robot that may be meant; empty: none is near
};

class Blindness {
 public:
  explicit Blindness(const RuleSet& rules)
      : by_rule_(rules.rules.size()),
        has_required_(std::any_of(rules.components.begin(), rules.components.end(),
                                  [](const Component& c) { return c.is_required; })) {}

  // Empty: the rule can see, or did not have its time yet.
  const std::optional<Blind>& operator[](RuleId id) const { return by_rule_[id.index]; }
  std::size_t count() const { return count_; }
  // No rule can see; or there is none, and no REQUIRED component either. Nothing is watched.
  bool is_total() const { return by_rule_.empty() ? !has_required_ : count_ == by_rule_.size(); }
  // Ascending.
  std::vector<RuleId> rules() const {
    std::vector<RuleId> blind;
    for (std::size_t r = 0; r < by_rule_.size(); ++r) {
      if (by_rule_[r]) blind.emplace_back(r);
    }
    return blind;
  }

  void set(RuleId id, Blind blind) {
    count_ += by_rule_[id.index] ? 0 : 1;
    by_rule_[id.index] = std::move(blind);
  }
  void clear(RuleId id) {
    count_ -= by_rule_[id.index] ? 1 : 0;
    by_rule_[id.index].reset();
  }

 private:
  std::vector<std::optional<Blind>> by_rule_;
  bool has_required_;
  std::size_t count_ = 0;
};

// "battery was never seen; did you mean 'battery_level'?"
std::string describe(const Blind& blind);

}  // namespace culprit

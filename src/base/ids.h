// Dense numbers for things that have names: an index into the table that the rule set keeps of
// them.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>

namespace culprit {

template <class Tag>
struct Id {
  std::uint32_t index = 0;

  constexpr Id() = default;
  constexpr explicit Id(std::size_t i) : index(static_cast<std::uint32_t>(i)) {}
  auto operator<=>(const Id&) const = default;
};

using ComponentId = Id<struct ComponentTag>;    // RuleSet::components
using TopicId = Id<struct TopicTag>;            // RuleSet::topics
using SignalId = Id<struct SignalTag>;          // RuleSet::signals
using ParameterId = Id<struct ParameterTag>;    // RuleSet::parameters
using DiagnosticId = Id<struct DiagnosticTag>;  // RuleSet::diagnostics
using InputId = Id<struct InputTag>;            // RuleSet::inputs
using RuleId = Id<struct RuleTag>;              // RuleSet::rules
using StrategyId = Id<struct StrategyTag>;      // RuleSet::strategies
using GroupId = Id<struct GroupTag>;            // RuleSet::groups

}  // namespace culprit

template <class Tag>
struct std::hash<culprit::Id<Tag>> {
  std::size_t operator()(culprit::Id<Tag> id) const noexcept { return id.index; }
};

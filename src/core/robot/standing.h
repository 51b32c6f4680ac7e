// Which orders hold until somebody says otherwise, and what they do as long as they hold.
#pragma once

#include "robot/order.h"

namespace culprit {

enum class Standing : std::uint8_t {
  kNot,
  kRestrains,  // culprit does less: in force at once
  kFrees       // culprit does more again: in force once the next process would know it
};

inline Standing standing_of(const Order& order) {
  if (std::holds_alternative<Pause>(order.what) || std::holds_alternative<Silence>(order.what))
    return Standing::kRestrains;
  if (std::holds_alternative<Resume>(order.what) || std::holds_alternative<LiftSilence>(order.what))
    return Standing::kFrees;
  if (const auto* dry_run = std::get_if<SetDryRun>(&order.what))
    return dry_run->is_on ? Standing::kRestrains : Standing::kFrees;
  return Standing::kNot;
}

}  // namespace culprit

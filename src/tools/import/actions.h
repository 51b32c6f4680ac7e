// The reference's names of adaptations.
#pragma once

#include <optional>
#include <string_view>

#include "language/syntax.h"

namespace culprit::foreign {

// "action_restart", or as in the paper "restart". The reference starts and stops nothing by itself.
std::optional<syntax::AdaptationType> action(std::string_view word);

// "known: action_activate ..."
inline constexpr std::string_view kKnownActions =
    "known: action_activate action_deactivate action_restart action_redeploy action_set_parameter "
    "action_increase_parameter action_decrease_parameter action_change_communication "
    "action_change_mode";

bool takes_value(syntax::AdaptationType type);

}  // namespace culprit::foreign

#include "import/actions.h"

namespace culprit::foreign {

using enum syntax::AdaptationType;

std::optional<syntax::AdaptationType> action(std::string_view word) {
  constexpr std::string_view kPrefix = "action_";
  if (word.starts_with(kPrefix)) word.remove_prefix(kPrefix.size());
  // The reference's own rule builder writes it so.
  if (word == "decrease_paramter") return kDecreaseParameter;
  const auto type = syntax::adaptation_type(word);
  const bool is_ours = type == kStart || type == kStop || type == kCall;
  return is_ours ? std::nullopt : type;
}

bool takes_value(syntax::AdaptationType type) {
  return type == kSetParameter || type == kIncreaseParameter || type == kDecreaseParameter ||
         type == kChangeCommunication;
}

}  // namespace culprit::foreign

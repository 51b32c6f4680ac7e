#include "knowledge/undoes.h"

#include <algorithm>

namespace culprit {
namespace {

using Type = AdaptationType;

enum class Kind : std::uint8_t { kValue, kCall, kMode, kState, kRestart, kReplacement, kEnd };

Kind kind_of(const Adaptation& adaptation) {
  switch (adaptation.type) {
    case Type::kActivate:
    case Type::kDeactivate:
      return Kind::kState;
    case Type::kRestart:
      return Kind::kRestart;
    case Type::kRedeploy:
    case Type::kStart:
      return Kind::kReplacement;
    case Type::kStop:
      return Kind::kEnd;
    case Type::kChangeMode:
      return Kind::kMode;
    case Type::kCall:
      return Kind::kCall;
    case Type::kSetParameter:
    case Type::kIncreaseParameter:
    case Type::kDecreaseParameter:
    case Type::kChangeCommunication:
    case Type::kStartGroup:
      break;
  }
  return Kind::kValue;
}

bool undoes(const Adaptation& after, const Adaptation& before) {
  if (after.component != before.component) return false;
  const Kind what = kind_of(before);
  switch (kind_of(after)) {
    case Kind::kEnd:
      return true;
    case Kind::kReplacement:
      return what == Kind::kValue || what == Kind::kCall || what == Kind::kMode ||
             what == Kind::kEnd;
    case Kind::kRestart:
    case Kind::kState:
      return what == Kind::kState || what == Kind::kCall;
    case Kind::kMode:
      return what == Kind::kMode;
    case Kind::kValue:
      return what == Kind::kValue && after.parameter == before.parameter;
    case Kind::kCall:
      return false;
  }
  return true;
}

}  // namespace

bool undoes(const Strategy& after, const Strategy& before) {
  return std::any_of(after.adaptations.begin(), after.adaptations.end(), [&](const Adaptation& a) {
    return std::any_of(before.adaptations.begin(), before.adaptations.end(),
                       [&](const Adaptation& b) { return undoes(a, b); });
  });
}

}  // namespace culprit

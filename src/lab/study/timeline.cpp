#include "study/timeline.h"

namespace culprit::study {

std::string_view name(Happening happening) {
  switch (happening) {
    case Happening::kFault:
      return "fault";
    case Happening::kFailure:
      return "failure";
    case Happening::kBlame:
      return "blame";
    case Happening::kAdaptation:
      return "adaptation";
    case Happening::kResolved:
      return "resolved";
    case Happening::kGaveUp:
      return "gave up";
    case Happening::kNote:
      return "note";
  }
  return "note";
}

}  // namespace culprit::study

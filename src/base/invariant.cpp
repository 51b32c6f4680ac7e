#include "base/invariant.h"

#include <cstdio>
#include <cstdlib>

namespace culprit {

void invariant_violated(const char* condition, const char* file, int line) {
  std::fprintf(stderr,
               "culprit: internal error at %s:%d: '%s' does not hold. culprit exits and leaves the "
               "robot as it is; please report this.\n",
               file, line, condition);
  std::abort();
}

}  // namespace culprit

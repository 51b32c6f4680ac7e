#include "web/openapi.h"

#include "web/app.h"

namespace culprit::web {

std::string_view openapi() { return kOpenApi; }

}  // namespace culprit::web

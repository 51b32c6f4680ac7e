#include "http/routes.h"

namespace culprit::http {

Answer refuse(int status, const std::string& message) { return {status, {{"error", message}}}; }

std::string_view to_string(Method method) {
  constexpr std::string_view kNames[] = {"get", "post", "put", "delete"};
  return kNames[static_cast<std::size_t>(method)];
}

std::optional<std::string> text_of(const Json& body, const char* member) {
  if (!body.is_object()) return std::nullopt;
  const auto found = body.find(member);
  if (found == body.end() || !found->is_string()) return std::nullopt;
  return found->get<std::string>();
}

}  // namespace culprit::http

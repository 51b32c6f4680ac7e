// A call of a service of any type, as a person writes it: the request, and how its response is
// read.
//
// The request is YAML, as `ros2 service call` takes it: `data: true`, `{name: arm, target_state: {label:
// active}}`. Omitted fields are 0, false or empty.
//
// An answer is a refusal if one of these fields is false: `success`, `ok`, `successful` or
// `result.successful`. If it has none of these fields, any answer counts as success.
#pragma once

#include <optional>
#include <string>

#include "ros2/field_reader.h"
#include "ros2/message_library.h"

namespace culprit::link {

class ServiceCall {
 public:
  // `type` is "package/srv/Type", `library` what knows both its messages as the server means them
  // (type_finder.h). Errors: it does not know them, or the request does not fit.
  static Expected<ServiceCall> prepare(const std::string& type, const std::string& request,
                                       ros2::MessageLibrary& library);

  // A whole payload.
  const rtps::Bytes& request() const { return request_; }

  struct Verdict {
    bool is_done = false;
    std::string text;  // the server's message; may be empty
  };
  // Nothing: the payload is no answer of that type.
  std::optional<Verdict> judge(rtps::ByteView answer) const;

 private:
  ServiceCall() = default;

  rtps::Bytes request_;
  std::optional<ros2::FieldReader> success_;
  std::optional<ros2::FieldReader> text_;
};

}  // namespace culprit::link

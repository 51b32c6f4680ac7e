// Payloads of every message type that the ROS 2 link speaks. The first byte says which type; the
// rest is the payload.
//
// A message that was read must survive being written and read again. Bytes are not compared with
// the input: it may be padded, and big-endian.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "ros2/messages.h"
#include "ros2/service_mapping.h"
#include "ros2/services.h"
#include "rtps/cdr.h"

namespace {

using namespace culprit::ros2;
namespace rtps = culprit::rtps;

void require(bool condition) {
  if (!condition) std::abort();
}

template <class Message>
void check(rtps::ByteView payload) {
  const auto message = rtps::decode<Message>(payload);
  if (!message) return;
  const rtps::Bytes written = rtps::encode(*message);
  const auto again = rtps::decode<Message>(written);
  require(again.has_value());
  require(rtps::encode(*again) == written);
}

void check_header(rtps::ByteView payload) {
  const auto split = split_header(payload);
  if (!split) return;
  const auto again = split_header(with_header(split->payload, split->header));
  require(again && again->header == split->header);
  const auto body = [](const rtps::Bytes& bytes) {
    return rtps::ByteView(bytes).subspan(rtps::kEncapsulationSize);
  };
  require(std::ranges::equal(body(again->payload), body(split->payload)));
}

using Check = void (*)(rtps::ByteView);
constexpr Check kChecks[] = {
    check<msg::DiagnosticArray>,
    check<msg::Image>,
    check<msg::Log>,
    check<msg::TransitionEvent>,
    check<msg::ParameterEvent>,
    check<msg::String>,
    check<msg::Float64>,
    check<srv::GetState::Response>,
    check<srv::ChangeState::Request>,
    check<srv::GetAvailableTransitions::Response>,
    check<srv::SetParameters::Request>,
    check<srv::SetParameters::Response>,
    check<srv::DescribeParameters::Response>,
    check<srv::ListParameters::Request>,
    check<srv::Trigger::Response>,
    check<srv::GetMode::Response>,
    check_header,
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  kChecks[data[0] % std::size(kChecks)](rtps::ByteView(data + 1, size - 1));
  return 0;
}

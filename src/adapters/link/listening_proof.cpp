#include "link/listening_proof.h"

#include "base/live_clock.h"
#include "ros2/messages.h"
#include "ros2/services.h"

namespace culprit::ros2 {
namespace {

constexpr Duration kPeriod = std::chrono::milliseconds(100);

}  // namespace

void ListeningProof::seek(Time until) {
  tasks_.post([this, until] {
    until_ = until;
    looking_ = std::make_unique<Timer>(executor_, kPeriod, [this] { look(); });
  });
}

void ListeningProof::look() {
  const Time now = live_now();
  if (now >= until_) {
    asked_.clear();
    tasks_.post([this] { looking_.reset(); });
    return;
  }
  for (const Silent& silent : find_()) {
    if (!asked_.contains(silent.topic)) ask(silent, until_ - now);
  }
}

void ListeningProof::ask(const Silent& silent, Duration patience) {
  auto client = ServiceClient::create(
      self_, {silent.publisher + "/get_parameters", std::string(srv::GetParameters::kType)},
      qos::kParameterServices);
  if (!client) return;  // a secured domain need not allow it
  if (silent.participant) (*client)->ask_only(*silent.participant);
  (*client)->call(encode(srv::GetParameters::Request{}), Repeat::kUntilAnswered, patience,
                  [this, topic = silent.topic](const CallResult& result) {
                    if (result.outcome == CallOutcome::kAnswered) inbox_.put(ListenerKnown{topic});
                  });
  asked_.emplace(silent.topic, std::move(*client));
}

}  // namespace culprit::ros2

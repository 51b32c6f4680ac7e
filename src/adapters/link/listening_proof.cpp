#include "link/listening_proof.h"

#include "base/live_clock.h"
#include "ros2/messages.h"
#include "ros2/services.h"

namespace culprit::link {
namespace {

constexpr Duration kPeriod = std::chrono::milliseconds(100);

}  // namespace

void ListeningProof::seek(Time until) {
  tasks_.post([this, until] {
    until_ = until;
    looking_ = std::make_unique<ros2::Timer>(executor_, kPeriod, [this] { look(); });
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
  auto client = ros2::ServiceClient::create(
      self_, {silent.publisher + "/get_parameters", std::string(ros2::srv::GetParameters::kType)},
      rtps::qos::kParameterServices);
  if (!client) return;  // a secured domain need not allow it
  if (silent.participant) (*client)->ask_only(*silent.participant);
  (*client)->call(rtps::encode(ros2::srv::GetParameters::Request{}), ros2::Repeat::kUntilAnswered,
                  patience, [this, topic = silent.topic](const ros2::CallResult& result) {
                    if (result.outcome == ros2::CallOutcome::kAnswered)
                      inbox_.put(ListenerKnown{topic});
                  });
  asked_.emplace(silent.topic, std::move(*client));
}

}  // namespace culprit::link

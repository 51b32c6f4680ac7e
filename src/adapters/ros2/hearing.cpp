#include "ros2/hearing.h"

#include <cstring>
#include <random>
#include <utility>

#include "base/live_clock.h"

namespace culprit::ros2 {
namespace {

constexpr rtps::Qos kQos{.reliability = rtps::Reliability::kBestEffort, .depth = 1};

rtps::Bytes payload_of(std::uint64_t secret) {
  rtps::Bytes bytes{0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
  std::memcpy(bytes.data() + rtps::kEncapsulationSize, &secret, sizeof secret);
  return bytes;
}

}  // namespace

Expected<std::unique_ptr<Hearing>> Hearing::begin(Participant& participant, Executor& executor) {
  std::unique_ptr<Hearing> hearing(new Hearing(participant));
  std::random_device random;
  hearing->secret_ = (std::uint64_t{random()} << 32) | random();
  const Time first = later(live_now(), kFirstPatience - kPatience);
  hearing->heard_ = std::make_shared<std::atomic<std::int64_t>>(first.time_since_epoch().count());
  auto reader = participant.create_reader(
      {.topic = kTopic, .type = kType, .qos = kQos, .user_data = {}, .on_match = {}},
      [heard = hearing->heard_, own = payload_of(hearing->secret_)](const Sample& sample) {
        const bool is_own = sample.payload.size() >= own.size() &&
                            std::memcmp(sample.payload.data(), own.data(), own.size()) == 0;
        if (is_own) heard->store(live_now().time_since_epoch().count());
      });
  if (!reader) return Error{reader.error()};
  hearing->reader_ = std::move(*reader);
  auto writer = participant.create_writer(
      {.topic = kTopic, .type = kType, .qos = kQos, .user_data = {}, .on_match = {}});
  if (!writer) return Error{writer.error()};
  hearing->writer_ = std::move(*writer);
  hearing->timer_ =
      std::make_unique<Timer>(executor, kPeriod, [raw = hearing.get()] { raw->say(); });
  hearing->look_ = std::make_unique<Timer>(
      executor, kLookPeriod, [&participant] { participant.look_at_receivers(live_now()); });
  return hearing;
}

const char* Hearing::doubt(Time now) const {
  const bool hangs = later(participant_.receivers_attended(), kReceivePatience) <= now;
  return hangs ? "datagrams lie unread, since the thread that receives them hangs"
               : "culprit's own messages over the network do not come back";
}

void Hearing::say() { writer_->write(payload_of(secret_)); }

}  // namespace culprit::ros2

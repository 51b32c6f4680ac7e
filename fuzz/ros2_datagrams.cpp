// Datagrams into a whole participant: our filter, and behind it all of the middleware.
//
// The input is a list of datagrams, each a byte of flags, two of length, and so many bytes. Bit 0
// of the flags: it goes to the port of discovery instead of that of samples. Bit 1: it claims to
// come from a participant which the victim knows and listens to. After each input another one
// speaks, and must be heard: nothing may make the victim deaf, end it, or make it grow (libFuzzer's
// -rss_limit_mb).
#include <algorithm>
#include <arpa/inet.h>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <string_view>
#include <sys/socket.h>

#include "ros2/domain_lock.h"
#include "ros2/participant.h"

namespace {

using namespace culprit::ros2;
namespace rtps = culprit::rtps;

template <class T>
T must(culprit::Expected<T> value) {
  if (value) return std::move(*value);
  std::fprintf(stderr, "%s\n", value.error().c_str());
  std::abort();
}

class Arena {
 public:
  void send(std::uint8_t flags, rtps::ByteView bytes) {
    rtps::Bytes datagram(bytes.begin(), bytes.end());
    if ((flags & 2) != 0 && datagram.size() >= 20)
      std::copy_n(robot_->guid().bytes.begin(), 12, datagram.begin() + 8);
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    // The victim came first.
    const std::uint32_t port = 7400 + 250 * domain_.domain() + ((flags & 1) != 0 ? 10 : 11);
    to.sin_port = htons(static_cast<std::uint16_t>(port));
    sendto(socket_, datagram.data(), datagram.size(), 0, reinterpret_cast<sockaddr*>(&to),
           sizeof to);
  }

  // The datagrams before it have been looked at, too.
  void speak() {
    const auto sequence = writer_->write(rtps::Bytes{0, 1, 0, 0, 1, 2, 3, 4});
    std::unique_lock lock(mutex_);
    const bool is_heard = heard_changed_.wait_for(lock, std::chrono::seconds(20),
                                                  [&] { return sequence && heard_ >= *sequence; });
    if (!is_heard) std::abort();
  }

 private:
  // None of them meets anything but "t": what else is announced goes past the middleware.
  static ParticipantOptions options(std::uint32_t domain) {
    ParticipantOptions options;
    options.domain = domain;
    options.reach = Reach::kLocalhost;
    options.never_meets = [](std::string_view topic, rtps::EndpointRole) { return topic != "t"; };
    return options;
  }
  std::unique_ptr<Participant> join() {
    return must(Participant::create(options(domain_.domain()), [](DiscoveryEvent) {}));
  }

  DomainLock domain_ = must(DomainLock::reserve());
  const int socket_ = socket(AF_INET, SOCK_DGRAM, 0);
  std::mutex mutex_;
  std::condition_variable heard_changed_;
  std::int64_t heard_ = 0;
  std::unique_ptr<Participant> victim_ = join();
  std::unique_ptr<Participant> robot_ = join();
  std::unique_ptr<Participant> speaker_ = join();
  std::unique_ptr<Reader> reader_ = must(
      victim_->create_reader({.topic = "t",
                              .type = "T",
                              .qos = rtps::qos::kDiscoveryInfoReader,
                              .user_data = {},
                              .on_match = {}},
                             [this](const Sample& sample) {
                               const std::lock_guard lock(mutex_);
                               if (sample.identity.writer.prefix() != speaker_->guid().prefix())
                                 return;
                               heard_ = std::max(heard_, sample.identity.sequence);
                               heard_changed_.notify_all();
                             }));
  std::unique_ptr<Writer> writer_ =
      must(speaker_->create_writer({.topic = "t",
                                    .type = "T",
                                    .qos = rtps::qos::kDiscoveryInfoWriter,
                                    .user_data = {},
                                    .on_match = {}}));
  std::unique_ptr<Writer> robot_writer_ =
      must(robot_->create_writer({.topic = "t",
                                  .type = "T",
                                  .qos = rtps::qos::kDiscoveryInfoWriter,
                                  .user_data = {},
                                  .on_match = {}}));
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static Arena* const arena = new Arena;  // its threads run until the program ends
  while (size >= 3) {
    const std::uint8_t flags = data[0];
    const std::size_t length =
        std::min<std::size_t>(static_cast<std::size_t>(data[1]) | (data[2] << 8), size - 3);
    arena->send(flags, rtps::ByteView(data + 3, length));
    data += 3 + length;
    size -= 3 + length;
  }
  arena->speak();
  return 0;
}

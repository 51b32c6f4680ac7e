// A transport over another one, which spares a participant some faults of Fast DDS, and writes down
// where datagrams come from.
//
// It is quiet until it can hear. Fast DDS announces a participant while its receivers are still
// being opened. Whoever answers at once, as every peer on the same machine does, answers into the
// void, and repeats itself only when a heartbeat comes round, 1 to 3 s later. So nothing is sent
// before create_participant() has returned; the announcements that follow are the first ones heard.
//
// It passes on only what the filter lets through (datagram_filter.h), and tells on which ports
// threads receive (receive_watch.h).
//
// In a secured domain it hears one datagram at a time. A goodbye goes to a participant's unicast
// and multicast ports, each of which has a thread; Fast DDS 2.9 frees what it knows of whoever
// leaves under a lock that both may hold (SecurityManager::remove_participant), and so frees it
// twice.
#pragma once

#include <atomic>
#include <cstring>
#include <memory>
#include <mutex>
#include <utility>

#include <fastdds/rtps/network/SenderResource.h>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>

#include "base/live_clock.h"
#include "ros2/datagram_filter.h"
#include "ros2/datagram_sources.h"
#include "ros2/receive_watch.h"

namespace culprit::ros2::fast_dds {

// True once the participant's receivers listen. Shared by the participant and its transport.
using Listens = std::shared_ptr<std::atomic<bool>>;

// What a participant and its transport share.
struct Reception {
  Listens listens = std::make_shared<std::atomic<bool>>(false);
  std::shared_ptr<DatagramSources> sources = std::make_shared<DatagramSources>();
  std::shared_ptr<DatagramFilter> filter = std::make_shared<DatagramFilter>();
  std::shared_ptr<ReceiveWatch> watch = std::make_shared<ReceiveWatch>();
};

class CarefulTransport final : public eprosima::fastdds::rtps::ChainingTransport {
 public:
  CarefulTransport(const eprosima::fastdds::rtps::ChainingTransportDescriptor& descriptor,
                   Reception reception, bool is_secured)
      : ChainingTransport(descriptor), reception_(std::move(reception)), is_secured_(is_secured) {}

  eprosima::fastdds::rtps::TransportDescriptorInterface* get_configuration() override {
    return low_level_transport_->get_configuration();
  }

  bool OpenInputChannel(const eprosima::fastrtps::rtps::Locator_t& locator,
                        eprosima::fastdds::rtps::TransportReceiverInterface* receiver,
                        std::uint32_t largest) override {
    if (!ChainingTransport::OpenInputChannel(locator, receiver, largest)) return false;
    reception_.watch->opened(static_cast<std::uint16_t>(locator.port));
    return true;
  }

  bool send(eprosima::fastrtps::rtps::SenderResource* sender,
            const eprosima::fastrtps::rtps::octet* bytes, std::uint32_t size,
            eprosima::fastrtps::rtps::LocatorsIterator* begin,
            eprosima::fastrtps::rtps::LocatorsIterator* end,
            const std::chrono::steady_clock::time_point& timeout) override {
    return !*reception_.listens || sender->send(bytes, size, begin, end, timeout);
  }

  void receive(eprosima::fastdds::rtps::TransportReceiverInterface* next,
               const eprosima::fastrtps::rtps::octet* bytes, std::uint32_t size,
               const eprosima::fastrtps::rtps::Locator_t& local,
               const eprosima::fastrtps::rtps::Locator_t& remote) override {
    reception_.sources->heard({bytes, size}, address_of(remote));
    std::unique_lock lock(one_at_a_time_, std::defer_lock);
    if (is_secured_) lock.lock();
    // The buffer is the receiving thread's, which is here.
    const std::span<std::uint8_t> datagram{const_cast<std::uint8_t*>(bytes), size};
    const ByteView passed = reception_.filter->pass(datagram, DatagramFilter::Clock::now());
    if (passed.empty()) return;
    next->OnDataReceived(passed.data(), static_cast<std::uint32_t>(passed.size()), local, remote);
    // Not what comes by multicast: it goes away with a network interface, and nothing is wrong.
    const bool is_multicast = local.address[12] >= 224 && local.address[12] < 240;
    if (!is_multicast)
      reception_.sources->came_through(passed, static_cast<std::uint16_t>(local.port), live_now());
  }

 private:
  static UdpAddress address_of(const eprosima::fastrtps::rtps::Locator_t& locator) {
    UdpAddress address;
    std::memcpy(address.ip.data(), locator.address + 12, address.ip.size());
    address.port = static_cast<std::uint16_t>(locator.port);
    return address;
  }

  const Reception reception_;
  const bool is_secured_;
  std::mutex one_at_a_time_;
};

struct CarefulTransportDescriptor final : eprosima::fastdds::rtps::ChainingTransportDescriptor {
  CarefulTransportDescriptor(
      std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> transport,
      Reception shared, bool secured)
      : ChainingTransportDescriptor(std::move(transport)),
        reception(std::move(shared)),
        is_secured(secured) {}

  eprosima::fastdds::rtps::TransportInterface* create_transport() const override {
    return new CarefulTransport(*this, reception, is_secured);
  }

  const Reception reception;
  const bool is_secured;
};

}  // namespace culprit::ros2::fast_dds

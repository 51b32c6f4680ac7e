// Keeps a participant quiet until it can hear: a transport over another one.
//
// Fast DDS announces a participant while its receivers are still being opened. Whoever answers at
// once, as every peer on the same machine does, answers into the void, and repeats itself only when
// a heartbeat comes round, 1 to 3 s later. So nothing is sent before create_participant() has
// returned; the announcements that follow are the first ones heard.
#pragma once

#include <atomic>
#include <memory>
#include <utility>

#include <fastdds/rtps/network/SenderResource.h>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>

namespace culprit::ros2::fast_dds {

// True once the participant's receivers listen. Shared by the participant and its transport.
using Listens = std::shared_ptr<std::atomic<bool>>;

class QuietStart final : public eprosima::fastdds::rtps::ChainingTransport {
 public:
  QuietStart(const eprosima::fastdds::rtps::ChainingTransportDescriptor& descriptor,
             Listens listens)
      : ChainingTransport(descriptor), listens_(std::move(listens)) {}

  eprosima::fastdds::rtps::TransportDescriptorInterface* get_configuration() override {
    return low_level_transport_->get_configuration();
  }

  bool send(eprosima::fastrtps::rtps::SenderResource* sender,
            const eprosima::fastrtps::rtps::octet* bytes, std::uint32_t size,
            eprosima::fastrtps::rtps::LocatorsIterator* begin,
            eprosima::fastrtps::rtps::LocatorsIterator* end,
            const std::chrono::steady_clock::time_point& timeout) override {
    return !*listens_ || sender->send(bytes, size, begin, end, timeout);
  }

  void receive(eprosima::fastdds::rtps::TransportReceiverInterface* next,
               const eprosima::fastrtps::rtps::octet* bytes, std::uint32_t size,
               const eprosima::fastrtps::rtps::Locator_t& local,
               const eprosima::fastrtps::rtps::Locator_t& remote) override {
    next->OnDataReceived(bytes, size, local, remote);
  }

 private:
  const Listens listens_;
};

struct QuietStartDescriptor final : eprosima::fastdds::rtps::ChainingTransportDescriptor {
  QuietStartDescriptor(
      std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> transport,
      Listens flag)
      : ChainingTransportDescriptor(std::move(transport)), listens(std::move(flag)) {}

  eprosima::fastdds::rtps::TransportInterface* create_transport() const override {
    return new QuietStart(*this, listens);
  }

  const Listens listens;
};

}  // namespace culprit::ros2::fast_dds

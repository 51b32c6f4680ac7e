#include "bare_reader.h"

#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <memory>
#include <vector>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>

namespace culprit::bench {
namespace {

namespace dds = eprosima::fastdds::dds;
namespace fastrtps = eprosima::fastrtps::rtps;

// One copy of the payload, as a generated type of an unbounded message makes it.
class ImageType final : public dds::TopicDataType {
 public:
  ImageType() {
    setName("sensor_msgs::msg::dds_::Image_");
    m_typeSize = 64;
  }
  bool serialize(void*, fastrtps::SerializedPayload_t*) override { return false; }
  bool deserialize(fastrtps::SerializedPayload_t* payload, void* data) override {
    auto& bytes = *static_cast<std::vector<unsigned char>*>(data);
    bytes.assign(payload->data, payload->data + payload->length);
    return true;
  }
  std::function<uint32_t()> getSerializedSizeProvider(void*) override {
    return [] { return 0u; };
  }
  bool getKey(void*, fastrtps::InstanceHandle_t*, bool) override { return false; }
  void* createData() override { return new std::vector<unsigned char>; }
  void deleteData(void* data) override { delete static_cast<std::vector<unsigned char>*>(data); }
};

class Counter final : public dds::DataReaderListener {
 public:
  void on_data_available(dds::DataReader* reader) override {
    dds::SampleInfo info;
    while (reader->take_next_sample(&bytes_, &info) ==
           eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK)
      ++count;
  }
  std::atomic<int> count = 0;

 private:
  std::vector<unsigned char> bytes_;
};

dds::DomainParticipantQos loopback_qos(int domain) {
  auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList.emplace_back("127.0.0.1");
  udp->receiveBufferSize = 4 << 20;
  dds::DomainParticipantQos out;
  out.transport().use_builtin_transports = false;
  out.transport().user_transports.push_back(udp);
  fastrtps::Locator_t everyone;
  everyone.kind = LOCATOR_KIND_UDPv4;
  fastrtps::IPLocator::setIPv4(everyone, "239.255.0.1");
  everyone.port = static_cast<uint32_t>(7400 + 250 * domain);
  out.wire_protocol().builtin.initialPeersList.push_back(everyone);
  return out;
}

}  // namespace

void read_bare() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigprocmask(SIG_BLOCK, &signals, nullptr);

  const int domain = std::atoi(std::getenv("ROS_DOMAIN_ID"));
  auto* factory = dds::DomainParticipantFactory::get_instance();
  auto* participant =
      factory->create_participant(static_cast<uint32_t>(domain), loopback_qos(domain));
  dds::TypeSupport(new ImageType).register_type(participant);
  auto* topic = participant->create_topic("rt/bench/image", "sensor_msgs::msg::dds_::Image_",
                                          dds::TOPIC_QOS_DEFAULT);
  auto* subscriber = participant->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
  dds::DataReaderQos qos;
  qos.reliability().kind = dds::BEST_EFFORT_RELIABILITY_QOS;
  qos.endpoint().history_memory_policy = fastrtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  Counter counter;
  auto* reader = subscriber->create_datareader(topic, qos, &counter);

  int received = 0;
  sigwait(&signals, &received);
  reader->set_listener(nullptr);
  participant->delete_contained_entities();
  factory->delete_participant(participant);
  std::printf("%d\n", counter.count.load());
}

}  // namespace culprit::bench

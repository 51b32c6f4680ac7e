// Everything that differs between the generations of Fast DDS; participant.cpp is its only user.
//
// Written for 2.9 (Debian 12). The differences of 2.6, 2.14 and 3.x are in docs and would be
// decided here, and only here: names of headers and namespaces, the shape of a TopicDataType, the
// discovery callbacks, a few members of QoS.
#pragma once

#include <algorithm>
#include <charconv>
#include <cstring>
#include <string>
#include <string_view>
#include <utility>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <fastdds/rtps/common/WriteParams.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/attributes/LibrarySettingsAttributes.h>
#include <fastrtps/utils/IPLocator.h>
#include <fastrtps/xmlparser/XMLProfileManager.h>

#include "ros2/participant.h"
#include "ros2/type_description.h"
#include "rtps/careful_transport.h"

namespace culprit::ros2::fast_dds {

namespace dds = eprosima::fastdds::dds;
namespace fastrtps = eprosima::fastrtps::rtps;
namespace transport = eprosima::fastdds::rtps;
using DdsDuration = eprosima::fastrtps::Duration_t;

inline bool ok(const eprosima::fastrtps::types::ReturnCode_t& code) {
  return code == eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK;
}

inline rtps::Guid to_guid(const fastrtps::GUID_t& guid) {
  rtps::Guid out;
  std::memcpy(out.bytes.data(), guid.guidPrefix.value, 12);
  std::memcpy(out.bytes.data() + 12, guid.entityId.value, 4);
  return out;
}

inline fastrtps::GUID_t from_guid(const rtps::Guid& guid) {
  fastrtps::GUID_t out;
  std::memcpy(out.guidPrefix.value, guid.bytes.data(), 12);
  std::memcpy(out.entityId.value, guid.bytes.data() + 12, 4);
  return out;
}

inline std::int64_t to_sequence(const fastrtps::SequenceNumber_t& number) {
  if (number == fastrtps::SequenceNumber_t::unknown()) return 0;
  return (static_cast<std::int64_t>(number.high) << 32) | number.low;
}

inline rtps::SampleIdentity to_identity(const fastrtps::SampleIdentity& identity) {
  return {to_guid(identity.writer_guid()), to_sequence(identity.sequence_number())};
}

inline fastrtps::SampleIdentity from_identity(const rtps::SampleIdentity& identity) {
  fastrtps::SampleIdentity out;  // unknown by default, which is what is sent for "none"
  if (identity == rtps::SampleIdentity{}) return out;
  out.writer_guid(from_guid(identity.writer));
  if (identity.sequence != 0) {
    out.sequence_number(
        fastrtps::SequenceNumber_t(static_cast<std::int32_t>(identity.sequence >> 32),
                                   static_cast<std::uint32_t>(identity.sequence)));
  }
  return out;
}

inline rtps::SystemTime to_time(const fastrtps::Time_t& time) {
  return rtps::SystemTime(std::chrono::nanoseconds(time.to_ns()));
}

// A hostile peer can make us keep no more.
inline std::string cut(std::string_view text) {
  return std::string(text.substr(0, rtps::kLongestSaid));
}

// The buffer that a DataReader fills.
struct Incoming {
  PayloadUse use = PayloadUse::kWhole;
  rtps::Bytes bytes;
  std::size_t size = 0;
};

// The payload that a DataWriter sends.
struct Outgoing {
  rtps::ByteView payload;
};

// A type of which only the name is known; its samples are payloads, passed on as they are.
class RawType final : public dds::TopicDataType {
 public:
  explicit RawType(const std::string& name, rtps::Keys keys = rtps::Keys::kNone) {
    setName(name.c_str());
    m_typeSize = 256;  // of the first allocation only; the memory policy grows it
    m_isGetKeyDefined = keys == rtps::Keys::kSome;
    auto_fill_type_object(false);
    auto_fill_type_information(false);
  }

  bool serialize(void* data, fastrtps::SerializedPayload_t* payload) override {
    const rtps::ByteView bytes = static_cast<const Outgoing*>(data)->payload;
    if (bytes.size() < rtps::kEncapsulationSize || payload->max_size < bytes.size()) return false;
    std::memcpy(payload->data, bytes.data(), bytes.size());
    payload->length = static_cast<std::uint32_t>(bytes.size());
    payload->encapsulation = bytes[1] == 0 ? CDR_BE : CDR_LE;
    return true;
  }

  bool deserialize(fastrtps::SerializedPayload_t* payload, void* data) override {
    auto& incoming = *static_cast<Incoming*>(data);
    incoming.size = payload->length;
    incoming.bytes.assign(payload->data, payload->data + given_of(incoming.use, incoming.size));
    return true;
  }

  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    const auto size =
        static_cast<std::uint32_t>(static_cast<const Outgoing*>(data)->payload.size());
    return [size] { return size; };
  }

  void* createData() override { return new Incoming; }
  void deleteData(void* data) override { delete static_cast<Incoming*>(data); }
  // The place of the key in a payload is unknown, and does not matter to a reader that takes each
  // sample: they are of one instance, unless the writer announces which.
  bool getKey(void*, fastrtps::InstanceHandle_t* handle, bool) override {
    handle->value.clear();
    handle->value[0] = 1;
    return m_isGetKeyDefined;
  }
  bool is_bounded() const override { return false; }
};

inline std::optional<std::int64_t> write(dds::DataWriter& writer, rtps::ByteView payload,
                                         const rtps::SampleIdentity& related) {
  Outgoing outgoing{payload};
  fastrtps::WriteParams params;
  params.related_sample_identity(from_identity(related));
  if (!writer.write(&outgoing, params)) return std::nullopt;
  return to_sequence(params.sample_identity().sequence_number());
}

inline void forget_unacknowledged(dds::DataWriter& writer) {
  std::size_t removed = 0;
  writer.clear_history(&removed);
}

inline bool is_acknowledged(dds::DataWriter& writer) {
  return ok(writer.wait_for_acknowledgments({0, 0}));
}

inline DdsDuration to_duration(Duration d) {
  if (d == rtps::kInfinite) return eprosima::fastrtps::c_TimeInfinite;
  return {static_cast<std::int32_t>(d.count() / 1'000'000'000),
          static_cast<std::uint32_t>(d.count() % 1'000'000'000)};
}

inline Duration from_duration(const DdsDuration& d) {
  if (d == eprosima::fastrtps::c_TimeInfinite) return rtps::kInfinite;
  return std::chrono::seconds(d.seconds) + std::chrono::nanoseconds(d.nanosec);
}

// The QoS that readers and writers have in common. They are built up from nothing rather than from
// the factory's defaults, which an XML file named by FASTRTPS_DEFAULT_PROFILES_FILE could have
// changed.
template <class EntityQos>
void apply(EntityQos& entity, const rtps::Qos& qos, const std::string& user_data) {
  entity.reliability().kind = qos.reliability == rtps::Reliability::kReliable
                                  ? dds::RELIABLE_RELIABILITY_QOS
                                  : dds::BEST_EFFORT_RELIABILITY_QOS;
  entity.durability().kind = qos.durability == rtps::Durability::kTransientLocal
                                 ? dds::TRANSIENT_LOCAL_DURABILITY_QOS
                                 : dds::VOLATILE_DURABILITY_QOS;
  const bool keeps_all = qos.history == rtps::History::kKeepAll;
  entity.history().kind = keeps_all ? dds::KEEP_ALL_HISTORY_QOS : dds::KEEP_LAST_HISTORY_QOS;
  const auto depth = static_cast<std::int32_t>(qos.depth);
  entity.history().depth = depth;
  // When there are too many keys, those without an unread sample are dropped first.
  const std::int32_t instances = qos.keys == rtps::Keys::kSome ? 16 : 1;
  const std::int32_t samples = keeps_all ? 0 : std::max(5000 / instances, depth);  // 0: no limit
  entity.resource_limits().max_instances = instances;
  entity.resource_limits().max_samples = instances * samples;
  entity.resource_limits().max_samples_per_instance = samples;
  entity.resource_limits().allocated_samples = std::min(10, depth);
  entity.deadline().period = to_duration(qos.deadline);
  entity.lifespan().duration = to_duration(qos.lifespan);
  entity.liveliness().kind = qos.liveliness == rtps::Liveliness::kManualByTopic
                                 ? dds::MANUAL_BY_TOPIC_LIVELINESS_QOS
                                 : dds::AUTOMATIC_LIVELINESS_QOS;
  entity.liveliness().lease_duration = to_duration(qos.liveliness_lease);
  entity.ownership().kind = qos.ownership == rtps::Ownership::kExclusive
                                ? dds::EXCLUSIVE_OWNERSHIP_QOS
                                : dds::SHARED_OWNERSHIP_QOS;
  entity.endpoint().history_memory_policy = fastrtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  entity.data_sharing().off();
  const std::string said = user_data.empty() ? type_user_data({}) : user_data;
  entity.user_data().setValue({said.begin(), said.end()});
}

inline fastrtps::Locator_t locator(const std::string& ip, std::uint32_t port) {
  fastrtps::Locator_t out;
  out.kind = LOCATOR_KIND_UDPv4;
  fastrtps::IPLocator::setIPv4(out, ip);
  out.port = port;
  return out;
}

// How often a reader repeats its request for a writer's history, and a writer its heartbeat, until the other end answers, in
// nanoseconds; and the defaults of Fast DDS. Each repetition costs a receiver as much as an answer does. At 10 and 20 ms, those
// of a robot of seventeen processes filled the socket of a node on a busy computer, and the answers never came through.
constexpr std::uint32_t kRequestsAgain = 70'000'000;      // default
constexpr std::uint32_t kHeartbeatAgain = 100'000'000;    // default: 3 s; a late joiner may wait
constexpr std::uint32_t kPatientHeartbeat = 250'000'000;  // not before acknowledgements were read

// `port`: where it receives, at all addresses of this machine; 0: where its participant does.
inline dds::DataReaderQos reader_qos(const rtps::Qos& qos, const std::string& user_data,
                                     std::uint16_t port) {
  dds::DataReaderQos out;
  apply(out, qos, user_data);
  if (port != 0) out.endpoint().unicast_locator_list.push_back(locator("0.0.0.0", port));
  out.reliable_reader_qos().times.initialAcknackDelay = {0, kRequestsAgain};
  return out;
}

inline dds::DataWriterQos writer_qos(const rtps::Qos& qos, const std::string& user_data,
                                     std::uint16_t port = 0) {
  dds::DataWriterQos out;
  apply(out, qos, user_data);
  out.publish_mode().kind = dds::SYNCHRONOUS_PUBLISH_MODE;
  out.reliable_writer_qos().times.heartbeatPeriod = {
      0, port == 0 ? kHeartbeatAgain : kPatientHeartbeat};
  if (port != 0) out.endpoint().unicast_locator_list.push_back(locator("0.0.0.0", port));
  if (qos.liveliness_lease != rtps::kInfinite)
    out.liveliness().announcement_period = to_duration(qos.liveliness_lease * 2 / 3);
  return out;
}

// Otherwise participants of one process, and the endpoints of one, would pass each other their
// samples without any socket, and the sockets would go untested. Before the first participant.
inline void speak_through_sockets() {
  eprosima::fastrtps::LibrarySettingsAttributes settings;
  settings.intraprocess_delivery = eprosima::fastrtps::INTRAPROCESS_OFF;
  eprosima::fastrtps::xmlparser::XMLProfileManager::library_settings(settings);
}

// A super client receives everything that the servers know; a mere client receives only what it
// uses.
inline void find_through(const std::vector<DiscoveryServer>& servers,
                         fastrtps::BuiltinAttributes& builtin) {
  builtin.discovery_config.discoveryProtocol = fastrtps::DiscoveryProtocol::SUPER_CLIENT;
  for (const DiscoveryServer& server : servers) {
    fastrtps::RemoteServerAttributes remote;
    fastrtps::get_server_client_default_guidPrefix(server.id, remote.guidPrefix);
    remote.metatrafficUnicastLocatorList.push_back(locator(server.host, server.port));
    builtin.discovery_config.m_DiscoveryServers.push_back(std::move(remote));
  }
}

// `peers`, and the hosts of servers, are IPv4 addresses. Datagrams are received through `reception`
// (careful_transport.h).
inline dds::DomainParticipantQos participant_qos(const ParticipantOptions& options,
                                                 const std::vector<std::string>& peers,
                                                 const rtps::Reception& reception) {
  dds::DomainParticipantQos out;
  out.name(options.enclave);
  const std::string user_data = "enclave=" + options.enclave + ";";
  out.user_data().setValue({user_data.begin(), user_data.end()});

  if (options.security) {
    for (auto& [name, value] : properties_of(*options.security))
      out.properties().properties().emplace_back(name, value);
  }

  // Each buffer has 64 KiB. By default there is one for each thread that could send at the same
  // time; most of these never do.
  out.allocation().send_buffers.preallocated_number = 1;
  out.allocation().send_buffers.dynamic = true;

  auto& builtin = out.wire_protocol().builtin;
  // Many nodes in one process make discovery data larger than the default of 5 kB.
  builtin.readerHistoryMemoryPolicy = fastrtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  builtin.writerHistoryMemoryPolicy = fastrtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  // The first announcements come in quick succession, for those that had not opened their ports.
  builtin.discovery_config.initial_announcements = {6, {0, 20'000'000}};
  builtin.discovery_config.leaseDuration_announcementperiod = {
      1, 0};  // 3 s by default: how long we may stay unseen

  // A list of peers replaces the multicast announcement, so that is part of it; its port must be
  // explicit, for 0 means the unicast ports. This machine is always a peer: Cyclone does not listen
  // to multicast on a loopback interface without that flag.
  auto& announce_to = builtin.initialPeersList;
  announce_to.push_back(locator("239.255.0.1", 7400 + 250 * options.domain));
  announce_to.push_back(locator("127.0.0.1", 0));
  for (const std::string& peer : peers) announce_to.push_back(locator(peer, 0));
  if (!options.servers.empty()) find_through(options.servers, builtin);

  auto udp = std::make_shared<transport::UDPv4TransportDescriptor>();
  if (options.reach == Reach::kLocalhost) udp->interfaceWhiteList.emplace_back("127.0.0.1");
  udp->receiveBufferSize = options.socket_buffer_bytes;
  udp->sendBufferSize = options.socket_buffer_bytes;
  udp->maxInitialPeersRange = rtps::kAnnouncedTo;
  out.transport().use_builtin_transports = false;
  out.transport().user_transports.push_back(std::make_shared<rtps::CarefulTransportDescriptor>(
      std::move(udp), reception, options.domain));
  return out;
}

inline Vendor to_vendor(const fastrtps::VendorId_t& id) {
  if (id[0] != 0x01) return Vendor::kOther;
  if (id[1] == 0x0f) return Vendor::kFastDds;
  return id[1] == 0x10 ? Vendor::kCyclone : Vendor::kOther;
}

inline ParticipantInfo to_info(const fastrtps::ParticipantProxyData& data) {
  ParticipantInfo out;
  out.guid = to_guid(data.m_guid);
  out.vendor = to_vendor(data.m_VendorId);
  for (const auto& property : data.m_properties) {
    const std::string name = property.first();
    const std::string value = property.second();
    if (name == "fastdds.physical_data.host") {
      out.host = cut(value.substr(0, value.find(':')));  // "<host>:<number>"
    } else if (name == "__Hostname") {
      out.host = cut(value);
    } else if (name == "fastdds.physical_data.process" || name == "__Pid") {
      std::from_chars(value.data(), value.data() + value.size(), out.pid);
    }
  }
  for (const fastrtps::Locator_t& at : data.default_locators.unicast)
    out.shares_memory = out.shares_memory || at.kind == LOCATOR_KIND_SHM;
#if HAVE_SECURITY
  out.is_secured = !data.identity_token_.class_id().empty();
#endif
  for (const fastrtps::Locator_t& at : data.metatraffic_locators.unicast) {
    if (at.kind != LOCATOR_KIND_UDPv4) continue;
    rtps::UdpAddress address;
    std::memcpy(address.ip.data(), at.address + 12, address.ip.size());
    address.port = static_cast<std::uint16_t>(at.port);
    out.metatraffic.push_back(address);
  }
  return out;
}

// The description of a reader or of a writer.
template <class ProxyData>
rtps::EndpointInfo to_info(const ProxyData& data) {
  rtps::EndpointInfo out;
  out.guid = to_guid(data.guid());
  out.topic = cut(data.topicName().to_string());
  out.type = cut(data.typeName().to_string());
  const auto& user_data = data.m_qos.m_userData.getValue();
  out.user_data = cut({reinterpret_cast<const char*>(user_data.data()), user_data.size()});
  const auto& qos = data.m_qos;
  out.qos.reliability = qos.m_reliability.kind == dds::RELIABLE_RELIABILITY_QOS
                            ? rtps::Reliability::kReliable
                            : rtps::Reliability::kBestEffort;
  out.qos.durability = qos.m_durability.kind >= dds::TRANSIENT_LOCAL_DURABILITY_QOS
                           ? rtps::Durability::kTransientLocal
                           : rtps::Durability::kVolatile;
  out.qos.deadline = from_duration(qos.m_deadline.period);
  out.qos.lifespan = from_duration(qos.m_lifespan.duration);
  out.qos.keys = out.guid.has_keys() ? rtps::Keys::kSome : rtps::Keys::kNone;
  // ROS 2 knows two kinds; by participant is manual, too.
  out.qos.liveliness = qos.m_liveliness.kind == dds::AUTOMATIC_LIVELINESS_QOS
                           ? rtps::Liveliness::kAutomatic
                           : rtps::Liveliness::kManualByTopic;
  out.qos.liveliness_lease = from_duration(qos.m_liveliness.lease_duration);
  out.qos.ownership = qos.m_ownership.kind == dds::EXCLUSIVE_OWNERSHIP_QOS
                          ? rtps::Ownership::kExclusive
                          : rtps::Ownership::kShared;
  for (const std::string& partition : qos.m_partition.getNames()) {
    if (out.partitions.size() < rtps::kMostPartitions) out.partitions.push_back(cut(partition));
  }
  return out;
}

// Translates the callbacks of a DomainParticipant. The receive thread and the one that lets leases
// run out can be in here at once.
class DiscoveryListener final : public dds::DomainParticipantListener {
 public:
  explicit DiscoveryListener(DiscoveryCallback callback) : callback_(std::move(callback)) {}

  void on_participant_discovery(dds::DomainParticipant*,
                                fastrtps::ParticipantDiscoveryInfo&& found) noexcept override {
    using Found = fastrtps::ParticipantDiscoveryInfo;
    if (found.status == Found::REMOVED_PARTICIPANT || found.status == Found::DROPPED_PARTICIPANT) {
      callback_(
          ParticipantGone{to_guid(found.info.m_guid), found.status == Found::DROPPED_PARTICIPANT});
    } else {
      callback_(to_info(found.info));
    }
  }
  void on_subscriber_discovery(dds::DomainParticipant*,
                               fastrtps::ReaderDiscoveryInfo&& found) noexcept override {
    if (found.status == fastrtps::ReaderDiscoveryInfo::REMOVED_READER) {
      callback_(rtps::EndpointGone{to_guid(found.info.guid())});
    } else {
      callback_(to_info(found.info));
    }
  }
  void on_publisher_discovery(dds::DomainParticipant*,
                              fastrtps::WriterDiscoveryInfo&& found) noexcept override {
    if (found.status == fastrtps::WriterDiscoveryInfo::REMOVED_WRITER) {
      callback_(rtps::EndpointGone{to_guid(found.info.guid())});
    } else {
      callback_(to_info(found.info));
    }
  }

 private:
  const DiscoveryCallback callback_;
};

}  // namespace culprit::ros2::fast_dds

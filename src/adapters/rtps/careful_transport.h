// A transport over another one, which spares a participant some faults of Fast DDS, and writes down
// where datagrams come from.
//
// It is silent until it can receive. Fast DDS announces a participant while its receivers are still
// being opened. A peer on the same machine answers at once. It would answer a closed port, and
// would repeat itself only with its next heartbeat, 1 to 3 s later. So nothing is sent before
// create_participant() has returned; the announcements that follow are the first ones that peers
// receive. Nor is anything sent while a participant is taken apart before its goodbye
// (Participant::leave()).
//
// It receives in a thread of its own (receive_thread.h), the same for all ports, so that datagrams
// are handed on one at a time. Fast DDS has a thread for each port. In a secured domain two of them
// free the data of a leaving participant twice: a goodbye comes to a unicast and to a multicast
// port (2.9, SecurityManager::remove_participant).
//
// It passes on a datagram only if it comes from where its participant is (origins.h), and if the
// filter admits it (datagram_filter.h).
//
// Readers that have time (Haste::kSoon) have a port of their own. Its number is from the upper end
// of those that RTPS 2.3 §9.6.1 gives to the domain's participants. Only the last of many
// participants on one machine would have it.
#pragma once

#include <algorithm>
#include <arpa/inet.h>
#include <atomic>
#include <cstring>
#include <ifaddrs.h>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fastdds/rtps/common/Locator.h>
#include <fastdds/rtps/network/SenderResource.h>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <net/if.h>

#include "base/live_clock.h"
#include "base/mutex.h"
#include "rtps/announcement.h"
#include "rtps/announcement_fragments.h"
#include "rtps/claims.h"
#include "rtps/datagram_filter.h"
#include "rtps/datagram_sources.h"
#include "rtps/newcomers.h"
#include "rtps/origins.h"
#include "rtps/receive_thread.h"
#include "rtps/speakers.h"
#include "rtps/stuck_requests.h"
#include "rtps/udp_sockets.h"

namespace culprit::rtps {

// The number of participants of one machine that get announcements, as in ROS 2 Iron and newer.
inline constexpr std::uint32_t kAnnouncedTo = 32;

// State that a participant and its transport share.
struct Reception {
  // Whether anything is sent.
  std::shared_ptr<std::atomic<bool>> speaks = std::make_shared<std::atomic<bool>>(false);
  // How many holds forbid sending now (Participant::Hold).
  std::shared_ptr<std::atomic<int>> holds = std::make_shared<std::atomic<int>>(0);
  // A discovery server may announce others than itself.
  std::shared_ptr<std::atomic<bool>> relays = std::make_shared<std::atomic<bool>>(false);
  std::shared_ptr<DatagramSources> sources = std::make_shared<DatagramSources>();
  std::shared_ptr<Origins> origins = std::make_shared<Origins>();
  std::shared_ptr<DatagramFilter> filter = std::make_shared<DatagramFilter>();
  std::shared_ptr<Newcomers> newcomers = std::make_shared<Newcomers>();
  std::shared_ptr<AnnouncementFragments> fragments = std::make_shared<AnnouncementFragments>();
  std::shared_ptr<StuckRequests> requests = std::make_shared<StuckRequests>();
  std::shared_ptr<ReceiveThread> thread = std::make_shared<ReceiveThread>();
  // Where readers that have time are sent to; 0: there is no such port.
  std::shared_ptr<std::atomic<std::uint16_t>> patient_port =
      std::make_shared<std::atomic<std::uint16_t>>(std::uint16_t{0});
};

class CarefulTransport final : public eprosima::fastdds::rtps::ChainingTransport {
  using Locator = eprosima::fastrtps::rtps::Locator_t;
  using IpLocator = eprosima::fastrtps::rtps::IPLocator;
  using Receiver = eprosima::fastdds::rtps::TransportReceiverInterface;

 public:
  CarefulTransport(const eprosima::fastdds::rtps::ChainingTransportDescriptor& descriptor,
                   Reception reception, std::uint32_t domain)
      : ChainingTransport(descriptor), reception_(std::move(reception)), domain_(domain) {}
  // Closes the ports that the middleware left open.
  ~CarefulTransport() override {
    for (const std::uint16_t port : ports_) reception_.thread->close(port);
  }

  eprosima::fastdds::rtps::TransportDescriptorInterface* get_configuration() override {
    return low_level_transport_->get_configuration();
  }

  bool init(const eprosima::fastrtps::rtps::PropertyPolicy* properties) override {
    if (!ChainingTransport::init(properties)) return false;
    open_for_patient();
    return true;
  }

  bool IsInputChannelOpen(const Locator& locator) const override {
    const std::uint16_t port = IpLocator::getPhysicalPort(locator);
    if (port == *reception_.patient_port) return patient_ != nullptr;
    return IsLocatorSupported(locator) && reception_.thread->is_open(port);
  }

  // Told to stay on this machine, nodes of Iron and newer listen at all its addresses, and announce only those in
  // the network. We have no other than the loopback address then, so we send to them there.
  bool transform_remote_locator(const Locator& remote, Locator& result) const override {
    if (ChainingTransport::transform_remote_locator(remote, result)) return true;
    if (udp().interfaceWhiteList.empty()) return false;
    // Locators of shared memory are announced too; the test whether one is local must not be made
    // for them.
    if (!IsLocatorSupported(remote) || !is_local_locator(remote)) return false;
    result = remote;
    return IpLocator::setIPv4(result, udp().interfaceWhiteList.front());
  }

  // As UDPv4Transport does, whose sockets would have threads of their own.
  bool OpenInputChannel(const Locator& locator, Receiver* receiver,
                        std::uint32_t largest) override {
    if (!is_locator_allowed(locator)) return false;
    const std::uint16_t port = IpLocator::getPhysicalPort(locator);
    const bool is_multicast = IpLocator::isMulticast(locator);
    const bool is_new = !IsInputChannelOpen(locator);
    if (is_new && port == *reception_.patient_port) {
      patient_locator_ = locator;
      patient_ = receiver;
      return true;
    }
    if (is_new && !open(locator, receiver, largest)) return false;
    if (is_multicast) {
      groups_.push_back(locator);
      join(locator);
    }
    return is_new;
  }

  bool CloseInputChannel(const Locator& locator) override {
    if (!IsInputChannelOpen(locator)) return false;
    const std::uint16_t port = IpLocator::getPhysicalPort(locator);
    if (port == *reception_.patient_port) patient_ = nullptr;
    reception_.thread->close(port);
    return true;
  }

  // Asked for each reader that has time, and the answer asks the system for all its interfaces.
  eprosima::fastrtps::rtps::LocatorList_t NormalizeLocator(const Locator& locator) override {
    constexpr Duration kLasts = std::chrono::seconds(1);
    const MutexLock lock(mutex_);
    const Time now = live_now();
    if (!(locator == normalized_) || later(normalized_at_, kLasts) <= now) {
      normal_ = low_level_transport_->NormalizeLocator(locator);
      normalized_ = locator;
      normalized_at_ = now;
    }
    return normal_;
  }

  void update_network_interfaces() override {
    {
      const MutexLock lock(mutex_);
      normalized_ = {};
    }
    ChainingTransport::update_network_interfaces();
    for (const Locator& group : groups_) join(group);
  }

  bool send(eprosima::fastrtps::rtps::SenderResource* sender,
            const eprosima::fastrtps::rtps::octet* bytes, std::uint32_t size,
            eprosima::fastrtps::rtps::LocatorsIterator* begin,
            eprosima::fastrtps::rtps::LocatorsIterator* end,
            const std::chrono::steady_clock::time_point& timeout) override {
    if (!*reception_.speaks || *reception_.holds > 0) return true;
    std::vector<Locator> wanted;
    for (; *begin != *end; ++*begin) wanted.push_back(**begin);
    if (wanted.size() > kAnnouncedTo) wanted = in_use(wanted);
    Locators first(wanted.cbegin());
    Locators last(wanted.cend());
    const Bytes mended = reception_.requests->mended({bytes, size});
    return sender->send(mended.empty() ? bytes : mended.data(), size, &first, &last, timeout);
  }

  // The thread is our own: nothing comes this way.
  void receive(Receiver*, const eprosima::fastrtps::rtps::octet*, std::uint32_t, const Locator&,
               const Locator&) override {}

 private:
  using Locators = eprosima::fastdds::rtps::Locators;

  // An announcement goes to each port that a participant of this machine may have, most of which
  // are unused; the system needs as long for those as for others. Unused ports are left out if the
  // system lists the used ones, and ours among them. A port that is opened meanwhile gets it a
  // moment later.
  std::vector<Locator> in_use(const std::vector<Locator>& all) {
    constexpr Duration kLasts = std::chrono::milliseconds(200);
    const MutexLock lock(mutex_);
    const Time now = live_now();
    if (later(bound_at_, kLasts) <= now) {
      bound_ = bound_udp_ports();
      bound_at_ = now;
    }
    if (!bound_.contains(*reception_.patient_port)) return all;
    std::vector<Locator> those;
    for (const Locator& each : all) {
      const bool is_here = each.kind == LOCATOR_KIND_UDPv4 && IpLocator::isLocal(each);
      if (!is_here || bound_.contains(IpLocator::getPhysicalPort(each))) those.push_back(each);
    }
    return those;
  }

  const eprosima::fastdds::rtps::UDPv4TransportDescriptor& udp() const {
    return *static_cast<const eprosima::fastdds::rtps::UDPv4TransportDescriptor*>(
        low_level_transport_->get_configuration());
  }

  // Where sockets are bound.
  std::vector<in_addr> own_addresses() const {
    std::vector<in_addr> all;
    for (const std::string& each : udp().interfaceWhiteList) {
      in_addr address{};
      if (inet_pton(AF_INET, each.c_str(), &address) == 1) all.push_back(address);
    }
    if (all.empty()) all.push_back({htonl(INADDR_ANY)});
    return all;
  }

  bool open(const Locator& locator, Receiver* receiver, std::uint32_t largest) {
    const bool is_multicast = IpLocator::isMulticast(locator);
    std::vector<in_addr> addresses = own_addresses();
    // A socket that is bound to one interface's address does not get what is sent to a group.
    if (is_multicast && !udp().interfaceWhiteList.empty()) addresses.push_back(address_of(locator));
    const std::uint16_t port = IpLocator::getPhysicalPort(locator);
    ports_.push_back(port);
    for (const in_addr& address : addresses) {
      // Multicast datagrams have time: they repeat that a participant is there. A datagram for us
      // comes by unicast as well.
      const Haste haste = is_multicast ? Haste::kSoon : Haste::kNow;
      ReceiveThread::Place place{address, port, is_multicast, udp().receiveBufferSize, largest,
                                 haste,   {}};
      // Unicast announcements that a participant is still there have time, too, while nothing else
      // comes to that port: it is the one for discovery.
      if (!is_multicast)
        place.has_time = [sources = reception_.sources](std::span<const std::uint8_t> datagram) {
          return sources->is_still_there(datagram);
        };
      const auto opened = reception_.thread->open(
          place, [this, receiver, locator, haste](const ReceiveThread::Datagram& datagram) {
            came(*receiver, datagram, locator, haste);
          });
      if (opened) continue;
      reception_.thread->close(port);
      return false;
    }
    return true;
  }

  // Before there is a reader for it, so that no other process can take the port until then.
  void open_for_patient() {
    constexpr std::uint32_t kFirst = 60;
    constexpr std::uint32_t kLast = 119;
    for (std::uint32_t participant = kLast; participant >= kFirst; --participant) {
      const std::uint32_t port = 7400 + 250 * domain_ + 11 + 2 * participant;
      if (port > 65'535) continue;
      const ReceiveThread::Place place{
          own_addresses().front(), static_cast<std::uint16_t>(port), false,
          udp().receiveBufferSize, max_recv_buffer_size(),           Haste::kSoon};
      const auto opened =
          reception_.thread->open(place, [this](const ReceiveThread::Datagram& datagram) {
            if (Receiver* receiver = patient_)
              came(*receiver, datagram, patient_locator_, Haste::kSoon);
          });
      if (!opened) continue;
      *reception_.patient_port = place.port;
      ports_.push_back(place.port);
      return;
    }
  }

  // Joins on each existing interface.
  void join(const Locator& group) const {
    const std::uint16_t port = IpLocator::getPhysicalPort(group);
    if (!udp().interfaceWhiteList.empty()) {
      for (const in_addr& address : own_addresses())
        reception_.thread->join(port, address_of(group), address);
      return;
    }
    ifaddrs* all = nullptr;
    if (getifaddrs(&all) != 0) return;
    const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> owner(all, &freeifaddrs);
    for (const ifaddrs* each = all; each != nullptr; each = each->ifa_next) {
      if (each->ifa_addr == nullptr || each->ifa_addr->sa_family != AF_INET) continue;
      if ((each->ifa_flags & IFF_UP) == 0) continue;
      reception_.thread->join(port, address_of(group),
                              reinterpret_cast<const sockaddr_in*>(each->ifa_addr)->sin_addr);
    }
  }

  void came(Receiver& receiver, const ReceiveThread::Datagram& datagram, const Locator& local,
            Haste haste) const {
    const UdpAddress& from = datagram.from;
    if (!counts(datagram)) return;
    for (Bytes& whole : reception_.fragments->take(datagram.bytes, from))
      came(receiver, {whole, from, datagram.received}, local, haste);
    if (is_for_discovery(local)) discover_again(receiver, local);
    reception_.sources->heard(datagram.bytes, from, live_now());
    const ByteView passed =
        reception_.filter->pass(datagram.bytes, DatagramFilter::Clock::now(), datagram.received);
    if (passed.empty()) return;
    Locator remote;
    remote.kind = LOCATOR_KIND_UDPv4;
    std::memcpy(remote.address + 12, from.ip.data(), from.ip.size());
    remote.port = from.port;
    receiver.OnDataReceived(passed.data(), static_cast<std::uint32_t>(passed.size()), local,
                            remote);
    // Not what comes by multicast: it goes away with a network interface, and nothing is wrong. Not
    // where it depends on what is read whether anything of our own comes. Both have time.
    if (haste == Haste::kNow)
      reception_.sources->came_through(passed, static_cast<std::uint16_t>(local.port), live_now());
  }

  bool is_for_discovery(const Locator& local) const {
    return (IpLocator::getPhysicalPort(local) - 7400 - 250 * domain_) % 2 == 0;  // RTPS 2.3 §9.6.1
  }

  // For the middleware the participant has left, and comes back with its next announcement: earlier
  // claims of others in its name are dropped.
  void discover_again(Receiver& receiver, const Locator& local) const {
    constexpr std::int64_t kLater = std::int64_t{1} << 30;  // than all that it has written
    const auto doubtful = reception_.origins->take_doubtful();
    if (!doubtful) return;
    const Bytes bytes = farewell_of(*doubtful, kLater);
    receiver.OnDataReceived(bytes.data(), static_cast<std::uint32_t>(bytes.size()), local, local);
  }

  bool counts(const ReceiveThread::Datagram& datagram) const {
    const Time now = live_now();
    if (has_too_many_submessages(datagram.bytes)) {
      reception_.filter->note_refused("a datagram has thousands of submessages");
      return false;
    }
    if (has_too_many_speakers(datagram.bytes)) {
      reception_.filter->note_refused("a datagram speaks for many participants");
      return false;
    }
    if (!reception_.origins->counts(datagram.bytes, datagram.from, now)) return false;
    if (*reception_.relays) return true;
    const std::vector<GuidPrefix> others = others_announced(datagram.bytes);
    if (others.size() > kMostOthers) {
      reception_.filter->note_refused("a datagram announces many participants");
      return false;
    }
    if (!may_introduce(datagram, others, now)) return false;
    for (const GuidPrefix& other : others) {
      const bool has_spoken = reception_.sources->may_speak_from(other, datagram.from);
      if (!reception_.origins->may_tell_of(other, datagram.from, has_spoken, now)) return false;
    }
    return true;
  }

  // `others`: those that it announces in its sender's name. A known participant may make them up, too.
  bool may_introduce(const ReceiveThread::Datagram& datagram, const std::vector<GuidPrefix>& others,
                     Time now) const {
    if (!is_rtps(datagram.bytes) || !introduces(datagram.bytes)) return true;
    int unknown = 0;
    const auto count = [&](const GuidPrefix& each) {
      unknown += reception_.filter->knows(each) || reception_.newcomers->is_self(each) ? 0 : 1;
    };
    for_each_speaker(datagram.bytes, count);
    std::ranges::for_each(others, count);
    for (; unknown > 0; --unknown) {
      if (reception_.newcomers->admits(datagram.from, now)) continue;
      reception_.filter->note_refused("one source introduces too many participants");
      return false;
    }
    return true;
  }

  static in_addr address_of(const Locator& locator) {
    in_addr address{};
    std::memcpy(&address, locator.address + 12, sizeof address);
    return address;
  }

  const Reception reception_;
  const std::uint32_t domain_;
  std::vector<std::uint16_t> ports_;  // that were opened
  std::vector<Locator> groups_;       // that were joined
  Mutex mutex_;
  Locator normalized_ CULPRIT_GUARDED_BY(mutex_);  // what was asked for last, and when
  Time normalized_at_ CULPRIT_GUARDED_BY(mutex_){};
  eprosima::fastrtps::rtps::LocatorList_t normal_ CULPRIT_GUARDED_BY(mutex_);
  std::set<std::uint16_t> bound_
      CULPRIT_GUARDED_BY(mutex_);  // ports of this machine, and since when
  Time bound_at_ CULPRIT_GUARDED_BY(mutex_){};
  // The port for readers that have time; written before the receiver.
  Locator patient_locator_;
  std::atomic<Receiver*> patient_ = nullptr;
};

struct CarefulTransportDescriptor final : eprosima::fastdds::rtps::ChainingTransportDescriptor {
  CarefulTransportDescriptor(
      std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> transport,
      Reception shared, std::uint32_t in_domain)
      : ChainingTransportDescriptor(std::move(transport)),
        reception(std::move(shared)),
        domain(in_domain) {}

  eprosima::fastdds::rtps::TransportInterface* create_transport() const override {
    return new CarefulTransport(*this, reception, domain);
  }

  const Reception reception;
  const std::uint32_t domain;
};

}  // namespace culprit::rtps

#include "ros2/participant.h"

#include <map>
#include <set>
#include <unistd.h>
#include <utility>
#include <variant>

#include "base/environment.h"
#include "base/live_clock.h"
#include "base/mutex.h"
#include "ros2/fast_dds.h"
#include "ros2/gate.h"
#include "ros2/helper_participant.h"
#include "ros2/names.h"
#include "ros2/participant_impl.h"
#include "rtps/receive_watch.h"

namespace culprit::ros2 {

namespace dds = fast_dds::dds;

namespace {

// The topics of a participant. Fast DDS has one object for each name, with one type; readers and
// writers share it.
class Topics {
 public:
  explicit Topics(dds::DomainParticipant& participant) : participant_(participant) {}

  Expected<dds::Topic*> acquire(const std::string& name, const std::string& type, rtps::Keys keys) {
    const MutexLock lock(mutex_);
    if (const auto found = topics_.find(name); found != topics_.end()) {
      if (found->second.keys != keys)
        return Error{"the topic " + printable(name) + " is in use " + of(found->second.keys) +
                     ", not " + of(keys)};
      if (found->second.topic->get_type_name() != type) {
        return Error{"the topic " + printable(name) + " is in use with the type " +
                     printable(found->second.topic->get_type_name()) + ", not " + printable(type)};
      }
      ++found->second.users;
      return found->second.topic;
    }
    if (auto has_type = know(type, keys); !has_type) return Error{has_type.error()};
    dds::Topic* topic = participant_.create_topic(name, type, dds::TopicQos());
    if (topic == nullptr) return Error{"the topic " + printable(name) + " cannot be created"};
    topics_.emplace(name, Entry{topic, 1, keys});
    return topic;
  }

  void release(const std::string& name) {
    const MutexLock lock(mutex_);
    const auto found = topics_.find(name);
    if (--found->second.users > 0) return;
    participant_.delete_topic(found->second.topic);
    topics_.erase(found);
  }

 private:
  struct Entry {
    dds::Topic* topic;
    int users;
    rtps::Keys keys;
  };
  static std::string of(rtps::Keys keys) {
    return keys == rtps::Keys::kSome ? "with keys" : "without keys";
  }

  // A type has keys or not, for all topics that it has at the same time.
  Expected<void> know(const std::string& type, rtps::Keys keys) {
    const dds::TypeSupport known = participant_.find_type(type);
    if (known && known->m_isGetKeyDefined == (keys == rtps::Keys::kSome)) return {};
    if (known && !fast_dds::ok(participant_.unregister_type(type)))
      return Error{"the type " + printable(type) + " is in use on another topic, not " + of(keys)};
    dds::TypeSupport(new fast_dds::RawType(type, keys)).register_type(&participant_);
    return {};
  }

  dds::DomainParticipant& participant_;
  Mutex mutex_;
  std::map<std::string, Entry> topics_ CULPRIT_GUARDED_BY(mutex_);
};

// The writers that one reader receives, which the filter must know.
class HeardWriters {
 public:
  HeardWriters(rtps::DatagramFilter& filter, const rtps::Qos& qos, std::function<void()> on_unheard,
               rtps::DatagramFilter::OnWhole on_whole)
      : filter_(filter),
        how_(qos.reliability == rtps::Reliability::kReliable
                 ? rtps::DatagramFilter::Reading::kReliable
                 : rtps::DatagramFilter::Reading::kBestEffort),
        on_unheard_(on_unheard
                        ? std::make_shared<const std::function<void()>>(
                              [gate = gate_, call = std::move(on_unheard)] { gate->pass(call); })
                        : nullptr),
        on_whole_(std::move(on_whole)) {}
  ~HeardWriters() {
    gate_->close();
    end();
  }
  HeardWriters(const HeardWriters&) = delete;

  // Matches of two threads at once are reported as one (Fast DDS 2.9,
  // DataReaderImpl::update_subscription_matched_status): then it is unclear which writers are
  // matched. `reader` is always the same.
  void note(const rtps::Guid& writer, const rtps::Guid& reader, int change) {
    const MutexLock lock(mutex_);
    reader_ = reader;
    if (change == 1) {
      begin(writer);
    } else if (change == -1) {
      if (writers_.erase(writer) > 0) filter_.end_hearing(writer, reader);
    } else if (!unclear_) {
      unclear_.emplace(filter_);
    }
  }
  void end() {
    const MutexLock lock(mutex_);
    for (const rtps::Guid& writer : writers_) filter_.end_hearing(writer, reader_);
    writers_.clear();
  }
  // A writer whose sample is delivered is matched, whether that was reported or not.
  void delivered(const rtps::Guid& writer, const rtps::Guid& reader) {
    {
      const MutexLock lock(mutex_);
      reader_ = reader;
      begin(writer);
    }
    if (on_unheard_) filter_.delivered(writer);
  }

 private:
  void begin(const rtps::Guid& writer) CULPRIT_REQUIRES(mutex_) {
    if (writers_.insert(writer).second)
      filter_.begin_hearing(writer, reader_, how_, on_unheard_, on_whole_);
  }

  rtps::DatagramFilter& filter_;
  const rtps::DatagramFilter::Reading how_;
  const std::shared_ptr<Gate> gate_ = std::make_shared<Gate>();
  const rtps::DatagramFilter::OnUnheard on_unheard_;
  const rtps::DatagramFilter::OnWhole on_whole_;
  Mutex mutex_;
  rtps::Guid reader_ CULPRIT_GUARDED_BY(mutex_);
  std::set<rtps::Guid> writers_ CULPRIT_GUARDED_BY(mutex_);
  std::optional<rtps::DatagramFilter::Change> unclear_ CULPRIT_GUARDED_BY(mutex_);
};

// The likely reason why the middleware refused a reader or writer.
std::string likely_refusal(const std::optional<Security>& security) {
  if (!security) return "";
  return "; do the permissions of the enclave " + security->enclave +
         " allow it? culprit policy writes what a rule file needs";
}

template <class Status>
Match match_of(const Status& status) {
  return status.current_count_change > 0 ? Match::kMade : Match::kLost;
}

}  // namespace

class DdsReader final : public Reader::Impl, public dds::DataReaderListener {
 public:
  DdsReader(dds::Subscriber& subscriber, Topics& topics, rtps::DatagramFilter& filter,
            std::uint16_t patient_port, ReaderOptions options, SampleCallback on_sample)
      : subscriber_(subscriber),
        topics_(topics),
        filter_(filter),
        port_(has_time(options.payload) ? patient_port : std::uint16_t{0}),
        heard_(filter, options.qos, options.on_unheard, on_whole(options)),
        options_(std::move(options)),
        on_sample_(std::move(on_sample)) {
    incoming_.use = options_.payload;
  }

  // The destructor undoes the part of this that succeeded.
  Expected<void> open(const std::string& likely_refusal) {
    const auto topic = topics_.acquire(options_.topic, options_.type, options_.qos.keys);
    if (!topic) return Error{topic.error()};
    has_topic_ = true;
    // With the listener from the start: known writers match, and may send, before this returns.
    const rtps::DatagramFilter::Change change(filter_);
    reader_ = subscriber_.create_datareader(
        *topic, fast_dds::reader_qos(options_.qos, options_.user_data, port_), this,
        dds::StatusMask::data_available() << dds::StatusMask::subscription_matched());
    if (reader_ == nullptr)
      return Error{"no reader of " + printable(options_.topic) + " can be created" +
                   likely_refusal};
    guid_ = fast_dds::to_guid(reader_->guid());
    return {};
  }

  ~DdsReader() override {
    gate_->close();
    if (reader_ != nullptr) {
      const rtps::DatagramFilter::Change change(filter_);
      reader_->set_listener(nullptr);
      subscriber_.delete_datareader(reader_);
      heard_.end();
    }
    if (has_topic_) topics_.release(options_.topic);
  }

  void on_data_available(dds::DataReader* reader) noexcept override {
    gate_->pass([&] {
      dds::SampleInfo info;
      while (fast_dds::ok(reader->take_next_sample(&incoming_, &info))) {
        if (info.valid_data) deliver(info, fast_dds::to_guid(reader->guid()));
      }
    });
  }

  void on_subscription_matched(dds::DataReader* reader,
                               const dds::SubscriptionMatchedStatus& status) noexcept override {
    const rtps::Guid writer =
        fast_dds::to_guid(fast_dds::fastrtps::iHandle2GUID(status.last_publication_handle));
    heard_.note(writer, fast_dds::to_guid(reader->guid()), status.current_count_change);
    if (!options_.on_match) return;
    gate_->pass([&] { options_.on_match(writer, match_of(status)); });
  }

  const rtps::Guid& guid() const override { return guid_; }

 private:
  // If the reader has time, samples bypass the middleware, which would do nothing for them: it
  // would be most of the cost of receiving them.
  rtps::DatagramFilter::OnWhole on_whole(const ReaderOptions& options) {
    const rtps::Qos& qos = options.qos;
    const bool is_plain =
        qos.reliability == rtps::Reliability::kBestEffort && qos.keys == rtps::Keys::kNone &&
        qos.ownership == rtps::Ownership::kShared && qos.liveliness_lease == rtps::kInfinite;
    if (!has_time(options.payload) || !is_plain) return nullptr;
    return std::make_shared<const std::function<void(const rtps::DatagramFilter::Whole&)>>(
        [this, gate = gate_](const rtps::DatagramFilter::Whole& sample) {
          gate->pass([&] { hand(sample); });
        });
  }

  void hand(const rtps::DatagramFilter::Whole& sample) {
    on_sample_({.payload = sample.payload.first(given_of(options_.payload, sample.payload.size())),
                .size = sample.payload.size(),
                .sent = sample.sent,
                .received = sample.received,
                .identity = {sample.writer, sample.sequence},
                .related = {}});
  }

  void deliver(const dds::SampleInfo& info, const rtps::Guid& guid) {
    heard_.delivered(fast_dds::to_identity(info.sample_identity).writer, guid);
    on_sample_({.payload = options_.payload == PayloadUse::kHeader
                               ? rtps::ByteView()
                               : rtps::ByteView(incoming_.bytes),
                .size = incoming_.size,
                .sent = fast_dds::to_time(info.source_timestamp),
                .received = fast_dds::to_time(info.reception_timestamp),
                .identity = fast_dds::to_identity(info.sample_identity),
                .related = fast_dds::to_identity(info.related_sample_identity)});
  }

  dds::Subscriber& subscriber_;
  Topics& topics_;
  rtps::DatagramFilter& filter_;
  const std::uint16_t port_;
  const std::shared_ptr<Gate> gate_ = std::make_shared<Gate>();
  HeardWriters heard_;  // outlives the middleware's reader
  const ReaderOptions options_;
  const SampleCallback on_sample_;
  fast_dds::Incoming incoming_;  // inside the gate; keeps its capacity from sample to sample
  bool has_topic_ = false;
  dds::DataReader* reader_ = nullptr;
  rtps::Guid guid_;
};

Reader::Reader(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Reader::~Reader() = default;
const rtps::Guid& Reader::guid() const { return impl_->guid(); }

class DdsWriter final : public Writer::Impl, public dds::DataWriterListener {
 public:
  DdsWriter(dds::Publisher& publisher, Topics& topics, std::uint16_t patient_port,
            WriterOptions options)
      : publisher_(publisher),
        topics_(topics),
        port_(options.haste == rtps::Haste::kSoon ? patient_port : std::uint16_t{0}),
        options_(std::move(options)) {}

  Expected<void> open(const std::string& likely_refusal) {
    const auto topic = topics_.acquire(options_.topic, options_.type, options_.qos.keys);
    if (!topic) return Error{topic.error()};
    has_topic_ = true;
    writer_ = publisher_.create_datawriter(
        *topic, fast_dds::writer_qos(options_.qos, options_.user_data, port_), this,
        dds::StatusMask::publication_matched());
    if (writer_ == nullptr)
      return Error{"no writer of " + printable(options_.topic) + " can be created" +
                   likely_refusal};
    guid_ = fast_dds::to_guid(writer_->guid());
    return {};
  }

  ~DdsWriter() override {
    gate_.close();
    if (writer_ != nullptr) {
      writer_->set_listener(nullptr);
      publisher_.delete_datawriter(writer_);
    }
    if (has_topic_) topics_.release(options_.topic);
  }

  void on_publication_matched(dds::DataWriter*,
                              const dds::PublicationMatchedStatus& status) noexcept override {
    if (!options_.on_match) return;
    const rtps::Guid reader =
        fast_dds::to_guid(fast_dds::fastrtps::iHandle2GUID(status.last_subscription_handle));
    gate_.pass([&] { options_.on_match(reader, match_of(status)); });
  }

  std::optional<std::int64_t> write(rtps::ByteView payload,
                                    const rtps::SampleIdentity& related) override {
    return fast_dds::write(*writer_, payload, related);
  }

  void forget_unacknowledged() override { fast_dds::forget_unacknowledged(*writer_); }

  bool is_acknowledged() const override { return fast_dds::is_acknowledged(*writer_); }

  const rtps::Guid& guid() const override { return guid_; }

 private:
  dds::Publisher& publisher_;
  Topics& topics_;
  const std::uint16_t port_;
  const WriterOptions options_;
  Gate gate_;
  bool has_topic_ = false;
  dds::DataWriter* writer_ = nullptr;
  rtps::Guid guid_;
};

Writer::Writer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Writer::~Writer() = default;
const rtps::Guid& Writer::guid() const { return impl_->guid(); }
std::optional<std::int64_t> Writer::write(rtps::ByteView payload,
                                          const rtps::SampleIdentity& related) {
  return impl_->write(payload, related);
}
void Writer::forget_unacknowledged() { impl_->forget_unacknowledged(); }
bool Writer::is_acknowledged() const { return impl_->is_acknowledged(); }

class DdsParticipant final : public Participant::Impl {
 public:
  explicit DdsParticipant(DiscoveryCallback on_discovery)
      : on_discovery_(std::move(on_discovery)),
        listener_([this](DiscoveryEvent event) { on_event(std::move(event)); }) {}

  Expected<void> open(ParticipantOptions options) {
    std::vector<std::string> peers;
    for (const std::string& peer : options.peers) {
      auto address = resolve_peer(peer);
      if (!address && !options.on_missing_peer) return Error{address.error()};
      if (!address) {
        options.on_missing_peer(address.error());
        continue;
      }
      peers.push_back(std::move(*address));
    }
    for (DiscoveryServer& server : options.servers) {
      auto address = resolve_peer(server.host);
      if (!address) return Error{address.error()};
      server.host = std::move(*address);
    }
    // Fast DDS reads the variable itself where the options name no server.
    *reception_.relays = !options.servers.empty() || !environment("ROS_DISCOVERY_SERVER").empty();
    static std::once_flag is_set_up;
    std::call_once(is_set_up, fast_dds::speak_through_sockets);
    participant_ = dds::DomainParticipantFactory::get_instance()->create_participant(
        options.domain, fast_dds::participant_qos(options, peers, reception_), &listener_,
        dds::StatusMask::none());
    if (participant_ == nullptr) {
      return Error{"cannot join DDS domain " + std::to_string(options.domain) +
                   (options.security
                        ? " with the keys of " + options.security->folder.string() +
                              "; are they of one keystore, signed and not expired?"
                        : "; is there a network interface, and a free UDP port for it?")};
    }
    guid_ = fast_dds::to_guid(participant_->guid());
    never_meets_ = options.never_meets;
    if (never_meets_ && !options.security && options.servers.empty()) discover_past_middleware();
    reception_.newcomers->begin(guid_.prefix());
    *reception_.speaks = true;
    if (!options.security) reception_.filter->begin_to_address();
    is_secured_ = options.security.has_value();
    likely_refusal_ = likely_refusal(options.security);
    reception_.sources->begin(guid_.prefix());
    reception_.origins->prove(guid_.prefix(), getpid(), {});
    if (!is_secured_) reception_.origins->begin_to_bind(guid_.prefix());
    if (!is_secured_) reception_.requests->begin();
    if (!is_secured_) reception_.fragments->begin();
    publisher_ = participant_->create_publisher(dds::PublisherQos());
    subscriber_ = participant_->create_subscriber(dds::SubscriberQos());
    topics_.emplace(*participant_);
    return {};
  }

  ~DdsParticipant() override {
    gate_->close();
    if (participant_ == nullptr) return;
    participant_->set_listener(nullptr);
    participant_->delete_contained_entities();
    *reception_.speaks = true;
    dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }

  Expected<std::unique_ptr<Reader>> create_reader(ReaderOptions options,
                                                  SampleCallback on_sample) override {
    if (never_meets_ && never_meets_(options.topic, rtps::EndpointRole::kWriter))
      return Error{"this participant was to read nothing of " + printable(options.topic)};
    auto reader = std::make_unique<DdsReader>(*subscriber_, *topics_, *reception_.filter,
                                              *reception_.patient_port, std::move(options),
                                              std::move(on_sample));
    if (auto opened = reader->open(likely_refusal_); !opened) return Error{opened.error()};
    return std::make_unique<Reader>(std::move(reader));
  }

  Expected<std::unique_ptr<Writer>> create_writer(WriterOptions options) override {
    if (never_meets_ && never_meets_(options.topic, rtps::EndpointRole::kReader))
      return Error{"this participant was to write nothing to " + printable(options.topic)};
    auto writer = std::make_unique<DdsWriter>(*publisher_, *topics_, *reception_.patient_port,
                                              std::move(options));
    if (auto opened = writer->open(likely_refusal_); !opened) return Error{opened.error()};
    return std::make_unique<Writer>(std::move(writer));
  }

  void leave() override { *reception_.speaks = false; }
  void hold() override { *reception_.holds += is_secured_ ? 0 : 1; }
  void release() override { *reception_.holds -= is_secured_ ? 0 : 1; }
  void begin_hurry() override { reception_.thread->begin_hurry(); }
  void end_hurry() override { reception_.thread->end_hurry(); }
  void on_round(std::function<void()> on_round) override {
    reception_.thread->on_round(std::move(on_round));
  }

  const rtps::Guid& guid() const override { return guid_; }
  rtps::DatagramSources::Origin origin_of(const rtps::GuidPrefix& participant) const override {
    return reception_.sources->of(participant);
  }
  void prove(const rtps::GuidPrefix& participant, int pid) override {
    // Datagrams from elsewhere in its name prove nothing about it.
    if (!origins().prove(participant, pid, origin_of(participant).addresses))
      reception_.sources->forget(participant);
  }
  rtps::Origins& origins() override { return *reception_.origins; }
  Time heard_last(const rtps::GuidPrefix& participant) const override {
    return reception_.sources->last_of(participant);
  }
  Time own_came_through() const override { return reception_.sources->own_came_through(); }
  void look_at_receivers(Time now) override {
    reception_.thread->look_at_sockets(
        [&](std::span<const int> sockets) { watch_.look(sockets, now); });
  }
  Time receivers_attended() const override { return watch_.attended(); }
  rtps::DatagramFilter::Refused refused() const override { return reception_.filter->refused(); }
  std::uint64_t dropped_here() const override { return reception_.thread->dropped(); }

 private:
  // A participant announces itself again and again, mostly unchanged.
  void on_event(DiscoveryEvent event) {
    if (const auto* there = std::get_if<ParticipantInfo>(&event)) {
      reception_.sources->keep(there->guid.prefix());
      reception_.filter->know(there->guid.prefix());
      reception_.origins->discovered(there->guid.prefix(), there->metatraffic, live_now());
    }
    if (const auto* gone = std::get_if<ParticipantGone>(&event)) {
      reception_.sources->forget(gone->guid.prefix());
      reception_.filter->forget(gone->guid.prefix());
      reception_.origins->forget(gone->guid.prefix());
    }
    gate_->pass([&] {
      if (const auto* there = std::get_if<ParticipantInfo>(&event)) {
        ParticipantInfo& told = told_[there->guid];
        if (told == *there) return;
        told = *there;
      }
      if (const auto* gone = std::get_if<ParticipantGone>(&event)) told_.erase(gone->guid);
      on_discovery_(std::move(event));
    });
  }

  void discover_past_middleware() {
    reception_.filter->discover(
        guid_.prefix(), never_meets_, [this, gate = gate_](const rtps::EndpointNews& news) {
          gate->pass([&] { std::visit([this](const auto& each) { on_discovery_(each); }, news); });
        });
  }

  const std::shared_ptr<Gate> gate_ = std::make_shared<Gate>();
  const DiscoveryCallback on_discovery_;
  std::map<rtps::Guid, ParticipantInfo> told_;  // of those that are there; inside the gate
  std::function<bool(std::string_view, rtps::EndpointRole)> never_meets_;
  const rtps::Reception reception_;
  rtps::ReceiveWatch watch_;
  fast_dds::DiscoveryListener listener_;
  dds::DomainParticipant* participant_ = nullptr;
  dds::Publisher* publisher_ = nullptr;
  dds::Subscriber* subscriber_ = nullptr;
  std::optional<Topics> topics_;
  std::string likely_refusal_;
  bool is_secured_ = false;
  rtps::Guid guid_;
};

Participant::Hold::Hold(Participant& participant) : participant_(*participant.impl_) {
  participant_.hold();
}
Participant::Hold::~Hold() { participant_.release(); }

Participant::Hurry::Hurry(Participant& participant) : participant_(*participant.impl_) {
  participant_.begin_hurry();
}
Participant::Hurry::~Hurry() { participant_.end_hurry(); }

Participant::Participant(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Participant::~Participant() = default;
void Participant::leave() { impl_->leave(); }
const rtps::Guid& Participant::guid() const { return impl_->guid(); }
void Participant::on_round(std::function<void()> on_round) { impl_->on_round(std::move(on_round)); }
rtps::DatagramSources::Origin Participant::origin_of(const rtps::GuidPrefix& participant) const {
  return impl_->origin_of(participant);
}
void Participant::prove(const rtps::GuidPrefix& participant, int pid) {
  impl_->prove(participant, pid);
}
rtps::Origins& Participant::origins() { return impl_->origins(); }
Time Participant::heard_last(const rtps::GuidPrefix& participant) const {
  return impl_->heard_last(participant);
}
Time Participant::own_came_through() const { return impl_->own_came_through(); }
void Participant::look_at_receivers(Time now) { impl_->look_at_receivers(now); }
Time Participant::receivers_attended() const { return impl_->receivers_attended(); }
rtps::DatagramFilter::Refused Participant::refused() const { return impl_->refused(); }
std::uint64_t Participant::dropped_here() const { return impl_->dropped_here(); }

Expected<std::unique_ptr<Participant>> Participant::create(const ParticipantOptions& options,
                                                           DiscoveryCallback on_discovery) {
  if (options.helper) {
    auto helped = HelperParticipant::join(*options.helper, std::move(on_discovery));
    if (!helped) return Error{helped.error()};
    return std::make_unique<Participant>(std::move(*helped));
  }
  auto impl = std::make_unique<DdsParticipant>(std::move(on_discovery));
  if (auto opened = impl->open(options); !opened) return Error{opened.error()};
  return std::make_unique<Participant>(std::move(impl));
}

Expected<std::unique_ptr<Reader>> Participant::create_reader(ReaderOptions options,
                                                             SampleCallback on_sample) {
  return impl_->create_reader(std::move(options), std::move(on_sample));
}

Expected<std::unique_ptr<Writer>> Participant::create_writer(WriterOptions options) {
  return impl_->create_writer(std::move(options));
}

}  // namespace culprit::ros2

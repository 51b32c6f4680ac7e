#include "ros2/participant.h"

#include <atomic>
#include <map>
#include <netinet/in.h>
#include <numeric>
#include <poll.h>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "ros2/fast_dds.h"
#include "ros2/live_test.h"
#include "ros2/service_server.h"
#include "ros2/type_description.h"

namespace culprit::ros2 {
namespace {

using ::testing::HasSubstr;

struct Received {
  rtps::Bytes payload;
  std::size_t size;
  rtps::SystemTime sent;
  rtps::SystemTime received;
  rtps::SampleIdentity identity;
  rtps::SampleIdentity related;
};

SampleCallback into(rtps::EventLog<Received>& log) {
  return [&log](const Sample& sample) {
    log.add({{sample.payload.begin(), sample.payload.end()},
             sample.size,
             sample.sent,
             sample.received,
             sample.identity,
             sample.related});
  };
}

struct MatchEvent {
  rtps::Guid remote;
  Match match;
};

// A writer and a reader in two participants, matched in both directions.
struct Pair {
  explicit Pair(const rtps::Qos& qos = {}, PayloadUse use = PayloadUse::kWhole) {
    auto w =
        sender->create_writer({"t", "T", qos, "w", [this](const rtps::Guid& remote, Match match) {
                                 writer_matches.add({remote, match});
                               }});
    writer = std::move(*w);
    auto r = receiver->create_reader({"t", "T", qos, use, "r",
                                      [this](const rtps::Guid& remote, Match match) {
                                        reader_matches.add({remote, match});
                                      }},
                                     into(received));
    reader = std::move(*r);
    EXPECT_TRUE(writer_matches.wait_for_count(1));
    EXPECT_TRUE(reader_matches.wait_for_count(1));
  }

  rtps::EventLog<Received> received;
  rtps::EventLog<MatchEvent> writer_matches, reader_matches;
  TestDomain domain;
  std::unique_ptr<Participant> sender = join(domain);
  std::unique_ptr<Participant> receiver = join(domain);
  std::unique_ptr<Writer> writer;
  std::unique_ptr<Reader> reader;
};

TEST(Participant, BytesArriveAsTheyWereWritten) {
  Pair pair;
  const auto sequence = pair.writer->write(kSmallPayload);
  ASSERT_TRUE(sequence);
  ASSERT_TRUE(pair.received.wait_for_count(1));
  const Received sample = pair.received.all().front();
  EXPECT_EQ(sample.payload, kSmallPayload);
  EXPECT_EQ(sample.size, kSmallPayload.size());
  EXPECT_EQ(sample.identity, (rtps::SampleIdentity{pair.writer->guid(), *sequence}));
  EXPECT_EQ(sample.related, rtps::SampleIdentity{});
  EXPECT_LE(sample.sent, sample.received);
  const auto now =
      std::chrono::time_point_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now());
  EXPECT_LT(now - sample.sent, rtps::kPatience);
}

TEST(Participant, ALeavingParticipantSaysOneGoodbyeForAllThatItHad) {
  const TestDomain domain;
  rtps::EventLog<rtps::Guid> gone;
  const auto stays = join(domain, [&gone](DiscoveryEvent event) {
    if (const auto* participant = std::get_if<ParticipantGone>(&event)) {
      EXPECT_FALSE(participant->was_lost);
      gone.add(participant->guid);
    }
    if (const auto* endpoint = std::get_if<rtps::EndpointGone>(&event)) gone.add(endpoint->guid);
  });
  auto leaves = join(domain);
  const rtps::Guid participant = leaves->guid();
  rtps::EventLog<MatchEvent> matches;
  const auto writer =
      stays->create_writer({"t", "T", {}, "", [&matches](const rtps::Guid& remote, Match match) {
                              matches.add({remote, match});
                            }});
  auto reader =
      leaves->create_reader({"t", "T", {}, PayloadUse::kWhole, "", {}}, [](const Sample&) {});
  ASSERT_TRUE(writer && reader);
  ASSERT_TRUE(matches.wait_for_count(1));
  leaves->leave();
  reader->reset();
  leaves.reset();
  ASSERT_TRUE(matches.wait_for_count(2));
  EXPECT_EQ(matches.all().back().match, Match::kLost);
  ASSERT_TRUE(gone.wait_for_one([&](const rtps::Guid& each) { return each == participant; }));
}

TEST(Participant, TheRelatedIdentityTravelsAlong) {
  Pair pair;
  const rtps::SampleIdentity related{pair.reader->guid(), (std::int64_t{5} << 32) | 7};
  pair.writer->write(kSmallPayload, related);
  ASSERT_TRUE(pair.received.wait_for_count(1));
  EXPECT_EQ(pair.received.all().front().related, related);
}

TEST(Participant, SequenceNumbersCountWhatWasWritten) {
  Pair pair;
  for (int i = 0; i < 5; ++i) pair.writer->write(kSmallPayload);
  ASSERT_TRUE(pair.received.wait_for_count(5));
  const auto samples = pair.received.all();
  EXPECT_EQ(samples.back().identity.sequence - samples.front().identity.sequence, 4);
}

TEST(Participant, AReaderOfHeadersCopiesNoPayload) {
  Pair pair({}, PayloadUse::kHeader);
  pair.writer->write(kSmallPayload);
  ASSERT_TRUE(pair.received.wait_for_count(1));
  EXPECT_TRUE(pair.received.all().front().payload.empty());
  EXPECT_EQ(pair.received.all().front().size, kSmallPayload.size());
}

TEST(Participant, AReaderOfBeginningsCopiesOnlyThose) {
  Pair pair({}, PayloadUse::kBeginning);
  rtps::Bytes large(5000, 7);
  large[0] = 0;
  pair.writer->write(large);
  pair.writer->write(kSmallPayload);
  ASSERT_TRUE(pair.received.wait_for_count(2));
  large.resize(kBeginningSize);
  EXPECT_EQ(pair.received.all()[0].payload, large);
  EXPECT_EQ(pair.received.all()[0].size, 5000u);
  EXPECT_EQ(pair.received.all()[1].payload, kSmallPayload);
}

// Most of it comes past the middleware, and as it would come through it.
void hears_all_in_its_order(PayloadUse use, std::size_t given_of_large) {
  Pair pair({.reliability = rtps::Reliability::kBestEffort}, use);
  rtps::Bytes large(5000, 7);
  large[0] = 0;
  const rtps::SystemTime before = std::chrono::system_clock::now();
  for (int i = 0; i < 50; ++i) pair.writer->write(i % 2 == 0 ? large : kSmallPayload);
  ASSERT_TRUE(pair.received.wait_for_count(50));
  const rtps::SystemTime after = std::chrono::system_clock::now();
  large.resize(given_of_large);
  const auto all = pair.received.all();
  for (std::size_t i = 0; i < all.size(); ++i) {
    EXPECT_EQ(all[i].payload, i % 2 == 0 ? large : kSmallPayload);
    EXPECT_EQ(all[i].size, i % 2 == 0 ? 5000u : kSmallPayload.size());
    EXPECT_EQ(all[i].identity.writer, pair.writer->guid());
    EXPECT_EQ(all[i].identity.sequence, static_cast<std::int64_t>(i + 1));
    EXPECT_LE(before, all[i].sent + std::chrono::microseconds(1));
    EXPECT_LE(before, all[i].received);
    EXPECT_LE(all[i].received, after);
  }
  EXPECT_EQ(all.size(), 50u);
}

TEST(Participant, AReaderWithTimeReceivesAllThatIsWrittenInItsOrder) {
  hears_all_in_its_order(PayloadUse::kBeginningLater, kBeginningSize);
  hears_all_in_its_order(PayloadUse::kWholeLater, 5000);
}

TEST(Participant, AReaderWithTimeReceivesFragments) {
  Pair pair({.reliability = rtps::Reliability::kBestEffort}, PayloadUse::kWholeLater);
  rtps::Bytes large(100'000, 7);
  large[0] = 0;
  pair.writer->write(large);
  ASSERT_TRUE(pair.received.wait_for_count(1));
  EXPECT_EQ(pair.received.all().front().payload, large);
}

TEST(Participant, WhatIsCreatedWhileItIsHeldIsDiscoveredAllTheSame) {
  const TestDomain domain;
  rtps::EventLog<rtps::EndpointInfo> endpoints;
  const auto watcher = join(domain, [&](const DiscoveryEvent& event) {
    if (const auto* endpoint = std::get_if<rtps::EndpointInfo>(&event)) endpoints.add(*endpoint);
  });
  const auto sender = join(domain);
  auto first = sender->create_writer({"first", "T", {}, "", {}});
  ASSERT_TRUE(endpoints.wait_for_one([](const auto& each) { return each.topic == "first"; }));
  std::vector<std::unique_ptr<Reader>> readers;
  std::optional<Participant::Hold> hold(*sender);
  for (int i = 0; i < 20; ++i) {
    if (i == 19) hold.reset();
    readers.push_back(std::move(*sender->create_reader(
        {"t" + std::to_string(i), "T", {}, PayloadUse::kWhole, "", {}}, [](const Sample&) {})));
  }
  for (int i = 0; i < 20; ++i) {
    EXPECT_TRUE(endpoints.wait_for_one(
        [&](const auto& each) { return each.topic == "t" + std::to_string(i); }));
  }
}

TEST(Participant, LargePayloadsArriveWhole) {
  Pair pair;
  rtps::Bytes large(4'000'000);
  std::iota(large.begin(), large.end(), std::uint8_t{0});
  large[0] = 0, large[1] = 1;
  pair.writer->write(large);
  pair.writer->write(kSmallPayload);  // a reader's buffer that has grown does not show
  ASSERT_TRUE(pair.received.wait_for_count(2));
  EXPECT_EQ(pair.received.all()[0].payload, large);
  EXPECT_EQ(pair.received.all()[1].payload, kSmallPayload);
}

TEST(Participant, APayloadWithoutEncapsulationIsRefused) {
  Pair pair;
  EXPECT_FALSE(pair.writer->write(rtps::Bytes{0, 1}));
}

TEST(Participant, ABestEffortReaderMatchesAReliableWriter) {
  Pair pair;
  rtps::EventLog<Received> received;
  rtps::EventLog<MatchEvent> matches;
  auto watcher =
      pair.receiver->create_reader({"t", "T", rtps::qos::kSensorData, PayloadUse::kWhole, "",
                                    [&](const rtps::Guid& remote, Match match) {
                                      matches.add({remote, match});
                                    }},
                                   into(received));
  ASSERT_TRUE(watcher);
  ASSERT_TRUE(matches.wait_for_count(1));
  ASSERT_TRUE(pair.writer_matches.wait_for_count(2));
  pair.writer->write(kSmallPayload);
  EXPECT_TRUE(received.wait_for_count(1));
}

TEST(Participant, TransientLocalSamplesReachLateReaders) {
  const TestDomain domain;
  const auto sender = join(domain);
  const auto writer = sender->create_writer({"t", "T", rtps::qos::kDiscoveryInfoWriter, "", {}});
  ASSERT_TRUE(writer);
  (*writer)->write(kSmallPayload);
  const auto receiver = join(domain);
  rtps::EventLog<Received> received;
  const auto reader = receiver->create_reader(
      {"t", "T", rtps::qos::kDiscoveryInfoReader, PayloadUse::kWhole, "", {}}, into(received));
  ASSERT_TRUE(reader);
  EXPECT_TRUE(received.wait_for_count(1));
}

// A starting robot has hundreds of readers and writers that repeat themselves at once.
TEST(Participant, ItsEndpointsRepeatThemselvesAtMostFifteenTimesASecond) {
  const rtps::Qos qos;
  const auto reader = fast_dds::reader_qos(qos, "", 0).reliable_reader_qos().times;
  EXPECT_GE(reader.initialAcknackDelay.to_ns(), 1'000'000'000 / 15);
  const auto writer = fast_dds::writer_qos(qos, "").reliable_writer_qos().times;
  EXPECT_GE(writer.heartbeatPeriod.to_ns(), 1'000'000'000 / 15);
}

// Else the reply may be announced by the same heartbeat as its greeting, and Cyclone drops both.
TEST(Participant, ItsHeartbeatsAskFiveTimesWhetherAGreetingCame) {
  const auto writer = fast_dds::writer_qos(rtps::qos::kServices, "").reliable_writer_qos().times;
  EXPECT_LE(5 * writer.heartbeatPeriod.to_ns(),
            std::chrono::nanoseconds(ServiceServer::kLongestGreeting).count());
}

TEST(Participant, MatchesAreToldAndLost) {
  Pair pair;
  EXPECT_EQ(pair.writer_matches.all().front().remote, pair.reader->guid());
  EXPECT_EQ(pair.reader_matches.all().front().remote, pair.writer->guid());
  pair.reader.reset();
  ASSERT_TRUE(pair.writer_matches.wait_for_count(2));
  EXPECT_EQ(pair.writer_matches.all().back().match, Match::kLost);
}

TEST(Participant, ATopicHasOneType) {
  const TestDomain domain;
  const auto participant = join(domain);
  const auto first = participant->create_writer({"t", "T", {}, "", {}});
  ASSERT_TRUE(first);
  const auto second = participant->create_writer({"t", "Other", {}, "", {}});
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error(), HasSubstr("the topic t is in use with the type T, not Other"));
}

TEST(Participant, AReaderWithKeysHearsAllSamplesOfAWriterWithKeys) {
  Pair pair({.keys = rtps::Keys::kSome});
  EXPECT_TRUE(pair.writer->guid().has_keys());
  EXPECT_TRUE(pair.reader->guid().has_keys() && pair.reader->guid().is_reader());
  for (int i = 0; i < 5; ++i) pair.writer->write(kSmallPayload);
  ASSERT_TRUE(pair.received.wait_for_count(5));
  EXPECT_EQ(pair.received.all().back().payload, kSmallPayload);
}

TEST(Participant, WhetherATopicHasKeysIsPartOfWhatItIs) {
  const TestDomain domain;
  const auto participant = join(domain);
  const auto keyed = participant->create_writer({"t", "T", {.keys = rtps::Keys::kSome}, "", {}});
  ASSERT_TRUE(keyed);
  const auto other = participant->create_writer({"t", "T", {}, "", {}});
  ASSERT_FALSE(other);
  EXPECT_THAT(other.error(), HasSubstr("the topic t is in use with keys, not without keys"));
  const auto elsewhere = participant->create_writer({"u", "T", {}, "", {}});
  ASSERT_FALSE(elsewhere);
  EXPECT_THAT(elsewhere.error(), HasSubstr("the type T is in use on another topic"));
}

TEST(Participant, ATopicIsFreeAgainWhenItsLastUserIsGone) {
  const TestDomain domain;
  const auto participant = join(domain);
  for (const rtps::Keys keys : {rtps::Keys::kNone, rtps::Keys::kSome, rtps::Keys::kNone}) {
    for (const char* type : {"T", "Other", "T"}) {
      const rtps::Qos qos{.keys = keys};
      const auto writer = participant->create_writer({"t", type, qos, "", {}});
      const auto reader = participant->create_reader({"t", type, qos, PayloadUse::kWhole, "", {}},
                                                     [](const Sample&) {});
      EXPECT_TRUE(writer);
      EXPECT_TRUE(reader);
    }
  }
}

TEST(Participant, DiscoversOthersTheirEndpointsAndTheirEnd) {
  const TestDomain domain;
  rtps::EventLog<DiscoveryEvent> events;
  const auto watcher = join(domain, [&](DiscoveryEvent event) { events.add(std::move(event)); });
  auto other = join(domain);
  const rtps::Qos qos{.durability = rtps::Durability::kTransientLocal,
                      .lifespan = std::chrono::seconds(10),
                      .liveliness = rtps::Liveliness::kManualByTopic,
                      .liveliness_lease = std::chrono::seconds(3),
                      .ownership = rtps::Ownership::kExclusive};
  auto writer = other->create_writer({"t", "T", qos, "key=value;", {}});
  ASSERT_TRUE(writer);
  const rtps::Guid guid = (*writer)->guid();
  ASSERT_TRUE(events.wait_for_one([&](const DiscoveryEvent& event) {
    const auto* info = std::get_if<rtps::EndpointInfo>(&event);
    return info != nullptr && info->guid == guid;
  }));
  for (const DiscoveryEvent& event : events.all()) {
    if (const auto* info = std::get_if<rtps::EndpointInfo>(&event)) {
      EXPECT_EQ(info->topic, "t");
      EXPECT_EQ(info->type, "T");
      EXPECT_EQ(info->user_data, "key=value;");
      EXPECT_EQ(info->qos.durability, rtps::Durability::kTransientLocal);
      EXPECT_EQ(info->qos.reliability, rtps::Reliability::kReliable);
      EXPECT_EQ(info->qos.lifespan, std::chrono::seconds(10));
      EXPECT_EQ(info->qos.deadline, rtps::kInfinite);
      EXPECT_EQ(info->qos.liveliness, rtps::Liveliness::kManualByTopic);
      EXPECT_EQ(info->qos.liveliness_lease, std::chrono::seconds(3));
      EXPECT_EQ(info->qos.ownership, rtps::Ownership::kExclusive);
    }
    if (const auto* info = std::get_if<ParticipantInfo>(&event)) {
      EXPECT_EQ(info->vendor, Vendor::kFastDds);
      EXPECT_EQ(info->pid, getpid());
      EXPECT_FALSE(info->host.empty());
      ASSERT_FALSE(info->metatraffic.empty());
      EXPECT_EQ(info->metatraffic.front().ip, (std::array<std::uint8_t, 4>{127, 0, 0, 1}));
    }
  }
  writer = Error{"gone"};
  EXPECT_TRUE(events.wait_for_one([&](const DiscoveryEvent& event) {
    const auto* gone = std::get_if<rtps::EndpointGone>(&event);
    return gone != nullptr && gone->guid == guid;
  }));
  const rtps::Guid participant = other->guid();
  other.reset();
  EXPECT_TRUE(events.wait_for_one([&](const DiscoveryEvent& event) {
    const auto* gone = std::get_if<ParticipantGone>(&event);
    return gone != nullptr && gone->guid == participant && !gone->was_lost;
  }));
}

// ---- what it never meets

ParticipantOptions meeting_only(const TestDomain& domain, std::string_view met) {
  ParticipantOptions options = domain.options();
  options.never_meets = [met](std::string_view topic, rtps::EndpointRole) { return topic != met; };
  return options;
}

std::unique_ptr<Participant> join(const ParticipantOptions& options,
                                  DiscoveryCallback on_discovery) {
  auto participant = Participant::create(options, std::move(on_discovery));
  if (!participant) throw std::runtime_error(participant.error());
  return std::move(*participant);
}

// The endpoints of all others, as known now.
class Known {
 public:
  DiscoveryCallback listener() {
    return [this](const DiscoveryEvent& event) {
      const MutexLock lock(mutex_);
      if (const auto* info = std::get_if<rtps::EndpointInfo>(&event)) all_[info->guid] = *info;
      if (const auto* gone = std::get_if<rtps::EndpointGone>(&event)) all_.erase(gone->guid);
      changed_.notify_all();
    };
  }
  std::map<rtps::Guid, rtps::EndpointInfo> wait_for_count(std::size_t count) {
    MutexLock lock(mutex_);
    changed_.wait_for(lock, rtps::kPatience,
                      [&]() CULPRIT_REQUIRES(mutex_) { return all_.size() == count; });
    return all_;
  }

 private:
  Mutex mutex_;
  ConditionVariable changed_;
  std::map<rtps::Guid, rtps::EndpointInfo> all_ CULPRIT_GUARDED_BY(mutex_);
};

// Nodes on rmw_cyclonedds of Jazzy warn of each endpoint without user data.
TEST(Participant, NoEndpointOfItsSaysNothing) {
  const TestDomain domain;
  rtps::EventLog<DiscoveryEvent> events;
  const auto watcher = join(domain, [&](DiscoveryEvent event) { events.add(std::move(event)); });
  const auto other = join(domain);
  const auto writer = other->create_writer({"t", "T", {}, "", {}});
  ASSERT_TRUE(writer);
  EXPECT_TRUE(events.wait_for_one([](const DiscoveryEvent& event) {
    const auto* info = std::get_if<rtps::EndpointInfo>(&event);
    return info != nullptr && is_of_culprit(info->user_data);
  }));
}

TEST(Participant, WhatItNeverMeetsIsDiscoveredAsAllElse) {
  const TestDomain domain;
  Known past, through;
  const auto others = join(domain);
  std::vector<std::unique_ptr<Writer>> writers;
  std::vector<std::unique_ptr<Reader>> readers;
  const rtps::Qos full{.durability = rtps::Durability::kTransientLocal,
                       .deadline = std::chrono::milliseconds(123),
                       .lifespan = std::chrono::seconds(10),
                       .keys = rtps::Keys::kSome,
                       .liveliness = rtps::Liveliness::kManualByTopic,
                       .liveliness_lease = std::chrono::milliseconds(3100),
                       .ownership = rtps::Ownership::kExclusive};
  const auto create = [&] {
    for (const rtps::Qos& qos : {rtps::Qos{}, rtps::qos::kSensorData, rtps::qos::kRosout, full}) {
      const std::string topic = "t" + std::to_string(writers.size());
      const std::string type = "T" + std::to_string(writers.size());
      writers.push_back(std::move(*others->create_writer({topic, type, qos, "key=value;", {}})));
      readers.push_back(std::move(*others->create_reader(
          {topic, type, qos, PayloadUse::kWhole, "", {}}, [](const Sample&) {})));
    }
  };
  create();  // before, and after it comes
  const auto never = join(meeting_only(domain, "met"), past.listener());
  const auto may = join(domain.options(), through.listener());
  create();
  EXPECT_EQ(past.wait_for_count(16).size(), 16u);
  EXPECT_EQ(past.wait_for_count(16), through.wait_for_count(16));
  writers.pop_back();
  readers.pop_back();
  EXPECT_EQ(past.wait_for_count(14).size(), 14u);
  EXPECT_EQ(past.wait_for_count(14), through.wait_for_count(14));
}

// Announcements are taken in by the middleware in the order of their numbers: nothing may be missing.
TEST(Participant, WhatItNeverMeetsHoldsUpNothingElse) {
  const TestDomain domain;
  const auto sender = join(domain);
  const auto receiver = join(meeting_only(domain, "met"), [](DiscoveryEvent) {});
  rtps::EventLog<Received> received;
  rtps::EventLog<MatchEvent> matches;
  const auto reader =
      receiver->create_reader({"met", "T", rtps::qos::kDiscoveryInfoReader, PayloadUse::kWhole, "",
                               [&](const rtps::Guid& remote, Match match) {
                                 matches.add({remote, match});
                               }},
                              into(received));
  ASSERT_TRUE(reader);
  std::vector<std::unique_ptr<Writer>> writers;
  for (std::size_t i = 1; i <= 5; ++i) {
    for (const char* topic : {"never", "more", "met"})
      writers.push_back(
          std::move(*sender->create_writer({topic, "T", rtps::qos::kDiscoveryInfoWriter, "", {}})));
    writers.back()->write(kSmallPayload);
    EXPECT_TRUE(received.wait_for_count(i)) << i;
    writers.erase(writers.begin(), writers.begin() + 2);
  }
  EXPECT_TRUE(matches.wait_for_count(5));
}

TEST(Participant, WhatItIsNeverToMeetCannotBeCreated) {
  const TestDomain domain;
  ParticipantOptions options = domain.options();
  options.never_meets = [](std::string_view topic, rtps::EndpointRole role) {
    return topic == "read" && role == rtps::EndpointRole::kReader;
  };
  const auto participant = join(options, [](DiscoveryEvent) {});
  EXPECT_TRUE(participant->create_reader({"read", "T", {}, PayloadUse::kWhole, "", {}},
                                         [](const Sample&) {}));
  const auto writer = participant->create_writer({"read", "T", {}, "", {}});
  ASSERT_FALSE(writer);
  EXPECT_THAT(writer.error(), HasSubstr("this participant was to write nothing to read"));
  EXPECT_TRUE(participant->create_writer({"written", "T", {}, "", {}}));
}

// It announces itself every second.
TEST(Participant, AParticipantThatStaysAsItIsIsReportedOnce) {
  const TestDomain domain;
  rtps::EventLog<rtps::Guid> told;
  const auto watcher = join(domain, [&](const DiscoveryEvent& event) {
    if (const auto* info = std::get_if<ParticipantInfo>(&event)) told.add(info->guid);
  });
  const auto other = join(domain);
  ASSERT_TRUE(told.wait_for_count(1));
  const Time joined = live_now();
  const auto announced = [&] { return watcher->heard_last(other->guid().prefix()); };
  for (int i = 0; i < 2; ++i) {  // without endpoints it sends nothing else
    const Time before = std::max(joined, announced());
    const Time end = later(live_now(), rtps::kPatience);
    while (later(before, std::chrono::milliseconds(500)) >= announced() && live_now() < end)
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    EXPECT_LT(before, announced());
  }
  EXPECT_EQ(told.all().size(), 1u);
}

// A port where a participant of this machine may be found (RTPS 2.3 §9.6.1.1), held by a mere
// listener.
class Eavesdropper {
 public:
  // Binds the port of `participant`, or the next lower free one. Fast DDS numbers the participants
  // of a process, with those of earlier tests, and the eavesdropped one may have the first.
  Eavesdropper(std::uint32_t domain, int participant) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    int bound = -1;
    for (int last = participant - 2; bound != 0 && participant > last; --participant) {
      address.sin_port =
          htons(static_cast<std::uint16_t>(7400 + 250 * domain + 10 + 2 * participant));
      bound = bind(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address);
    }
    EXPECT_EQ(bound, 0);
  }
  ~Eavesdropper() { close(descriptor_); }
  Eavesdropper(const Eavesdropper&) = delete;
  Eavesdropper& operator=(const Eavesdropper&) = delete;

  // Waits until something comes. False if nothing does.
  bool hears() const {
    pollfd what{descriptor_, POLLIN, 0};
    return poll(&what, 1, static_cast<int>(std::chrono::milliseconds(rtps::kPatience).count())) ==
           1;
  }

 private:
  const int descriptor_ = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
};

// Whether it was there before the participant, or comes when that has announced itself for a while.
TEST(Participant, IsAnnouncedToEachPortOfThisMachineThatSomebodyHas) {
  const TestDomain domain;
  const Eavesdropper before(domain.options().domain, 29);
  const auto participant = join(domain);
  EXPECT_TRUE(before.hears());
  const Eavesdropper after(domain.options().domain, 31);
  EXPECT_TRUE(after.hears());
}

TEST(Participant, DomainsDoNotHearEachOther) {
  const TestDomain one, other;
  rtps::EventLog<DiscoveryEvent> events;
  const auto watcher = join(one, [&](DiscoveryEvent event) { events.add(std::move(event)); });
  const auto stranger = join(other);
  const auto friendly = join(one);
  ASSERT_TRUE(events.wait_for_count(1));
  for (const DiscoveryEvent& event : events.all()) {
    if (const auto* info = std::get_if<ParticipantInfo>(&event)) {
      EXPECT_EQ(info->guid, friendly->guid());
    }
  }
}

TEST(Participant, AnUnknownPeerIsAnError) {
  const TestDomain domain;
  ParticipantOptions options = domain.options();
  options.peers = {"no such host"};
  EXPECT_FALSE(Participant::create(options, [](DiscoveryEvent) {}));
}

TEST(Participant, GoesWithoutAnUnknownPeerWhereThatIsReported) {
  const TestDomain domain;
  ParticipantOptions options = domain.options();
  options.peers = {"no such host", "127.0.0.1"};
  std::string told;
  options.on_missing_peer = [&](const std::string& why) { told += why; };
  EXPECT_TRUE(Participant::create(options, [](DiscoveryEvent) {}));
  EXPECT_THAT(told, testing::HasSubstr("the peer 'no such host' cannot be found"));
}

TEST(Participant, TheSourcesOfAnotherAreItsSockets) {
  const TestDomain domain;
  LiveContext watcher(domain.options()), robot(domain.options());
  const NodeEntry node(*robot, {"/", "a"});
  ASSERT_TRUE(watcher.sees_node("/a"));
  const auto origin = watcher->participant().origin_of(robot->participant().guid().prefix());
  EXPECT_TRUE(origin.is_complete);
  ASSERT_FALSE(origin.addresses.empty());
  for (const rtps::UdpAddress& each : origin.addresses) {
    EXPECT_EQ(each.ip, (std::array<std::uint8_t, 4>{127, 0, 0, 1}));
    EXPECT_GE(each.port, 1024);
  }
}

TEST(Participant, ReadersComeAndGoWhileSamplesFlow) {
  Pair pair;
  std::atomic<bool> stop = false;
  std::thread writing([&] {
    while (!stop) pair.writer->write(kSmallPayload);
  });
  for (int i = 0; i < 20; ++i) {
    rtps::EventLog<Received> received;
    const auto reader =
        pair.receiver->create_reader({"t", "T", {}, PayloadUse::kWhole, "", {}}, into(received));
    ASSERT_TRUE(reader);
    EXPECT_TRUE(received.wait_for_count(1));
  }
  stop = true;
  writing.join();
}

}  // namespace
}  // namespace culprit::ros2

// For tests: what any participant of the domain can learn about the others.
#pragma once

#include <algorithm>
#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "base/live_clock.h"
#include "ros2/discovery_info.h"
#include "ros2/participant.h"
#include "rtps/test_event_log.h"
#include "rtps/test_hostile_process.h"

namespace culprit::ros2 {

// Listens to the discovery of participants, their endpoints and addresses. Each participant counts as of the process
// that it says it is.
class Eavesdropper {
 public:
  explicit Eavesdropper(const ParticipantOptions& options)
      : participant_(std::move(
            *Participant::create(options, [this](const DiscoveryEvent& event) { note(event); }))) {}

  struct Learned {
    rtps::Guid participant;
    rtps::Guid info_writer;  // of ros_discovery_info
    std::vector<rtps::EndpointInfo> endpoints;
  };
  // Waits until that is known. The process has nodes.
  Learned of(int pid) {
    EXPECT_TRUE(waits_until([&] { return has(pid, 12); }));
    const std::lock_guard lock(mutex_);
    const rtps::Guid guid = participants_[pid].guid;
    return {guid, info_writers_[guid.prefix()], endpoints_of(pid)};
  }
  // The lies that remove the node of the process.
  std::vector<rtps::Bytes> farewells_of(int pid) {
    const Learned learned = of(pid);
    std::vector<rtps::Guid> endpoints;
    for (const rtps::EndpointInfo& each : learned.endpoints) endpoints.push_back(each.guid);
    return rtps::farewells(
        learned.participant, endpoints, learned.info_writer,
        encode_discovery_info({learned.participant, {}}, GidSize::kHumbleAndOlder));
  }
  // Where the process listens: for discovery, and for samples.
  std::vector<rtps::UdpAddress> ports_of(int pid) {
    EXPECT_TRUE(waits_until([&] { return has(pid, 1); }));
    const std::lock_guard lock(mutex_);
    std::vector<rtps::UdpAddress> all = participants_[pid].metatraffic;
    for (rtps::UdpAddress each : participants_[pid].metatraffic) {
      ++each.port;
      all.push_back(each);
    }
    return all;
  }

 private:
  template <class Done>
  static bool waits_until(Done done) {
    for (const Time end = later(live_now(), rtps::kPatience); !done();) {
      if (live_now() > end) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return true;
  }
  bool has(int pid, std::size_t endpoints) {
    const std::lock_guard lock(mutex_);
    return participants_.contains(pid) && endpoints_of(pid).size() >= endpoints;
  }
  void note(const DiscoveryEvent& event) {
    const std::lock_guard lock(mutex_);
    if (const auto* info = std::get_if<ParticipantInfo>(&event)) {
      participants_[info->pid] = *info;
    } else if (const auto* endpoint = std::get_if<rtps::EndpointInfo>(&event)) {
      endpoints_.push_back(*endpoint);
      if (endpoint->topic == kDiscoveryInfoTopic && !endpoint->guid.is_reader())
        info_writers_[endpoint->guid.prefix()] = endpoint->guid;
    }
  }
  std::vector<rtps::EndpointInfo> endpoints_of(int pid) {
    std::vector<rtps::EndpointInfo> all;
    for (const rtps::EndpointInfo& each : endpoints_) {
      if (each.guid.prefix() == participants_[pid].guid.prefix()) all.push_back(each);
    }
    return all;
  }

  std::mutex mutex_;
  std::map<int, ParticipantInfo> participants_;  // by process
  std::vector<rtps::EndpointInfo> endpoints_;
  std::map<rtps::GuidPrefix, rtps::Guid> info_writers_;
  std::unique_ptr<Participant> participant_;
};

}  // namespace culprit::ros2

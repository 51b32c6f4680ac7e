#include "ros2/helper_endpoints.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "base/name_grammar.h"

namespace culprit::ros2 {
namespace {

using Purpose = HelperEndpoint::Purpose;

}  // namespace

rtps::Guid HelperEndpoints::guid(std::uint32_t id, std::uint8_t kind) const {
  rtps::Guid made;
  std::ranges::copy(prefix_.bytes, made.bytes.begin());
  made.bytes[12] = static_cast<std::uint8_t>(id >> 16);
  made.bytes[13] = static_cast<std::uint8_t>(id >> 8);
  made.bytes[14] = static_cast<std::uint8_t>(id);
  made.bytes[15] = kind;
  return made;
}

Expected<HelperEndpoints::Ptr> HelperEndpoints::add(rtps::EndpointRole role,
                                                    const std::string& topic,
                                                    const std::string& type, const rtps::Qos& qos,
                                                    PayloadUse use, SampleCallback on_sample,
                                                    MatchCallback on_match) {
  auto meaning = HelperEndpoint::meaning_of(topic, type);
  if (!meaning) return Error{printable(topic) + " is no topic of ROS 2"};
  auto ours = std::make_shared<HelperEndpoint>();
  ours->role = role;
  ours->meaning = std::move(*meaning);
  ours->topic = topic;
  ours->use = use;
  ours->on_sample = std::move(on_sample);
  ours->on_match = std::move(on_match);
  const MutexLock lock(mutex_);
  ours->id = ++last_id_;
  ours->guid = guid(ours->id, ours->reads() ? 0x04 : 0x03);
  ours->wish = ours->asks_for(qos);
  ours_.emplace(ours->id, ours);
  if (ours->wish) outbox_.queue(*ours->wish);
  return ours;
}

void HelperEndpoints::remove(const HelperEndpoint& ours) {
  const MutexLock lock(mutex_);
  ours_.erase(ours.id);
  if (ours.wish) outbox_.queue(culprit_link::Remove{ours.id});
}

std::optional<std::int64_t> HelperEndpoints::write(const HelperEndpoint& ours,
                                                   rtps::ByteView payload,
                                                   const rtps::SampleIdentity& related) {
  const MutexLock lock(mutex_);
  const std::int64_t number = ++last_number_;
  culprit_link::Bytes bytes(payload.begin(), payload.end());
  switch (ours.meaning.purpose) {
    case Purpose::kTopic:
      if (!outbox_.queue(culprit_link::Publish{ours.id, std::move(bytes)})) return std::nullopt;
      break;
    case Purpose::kRequest:
      if (!outbox_.queue(culprit_link::Request{ours.id, number, std::move(bytes)}))
        return std::nullopt;
      break;
    case Purpose::kReply:
      for (const auto& [id, each] : ours_) {
        if (each->reads(Purpose::kRequest, ours.meaning.name))
          outbox_.queue(culprit_link::Respond{id, related.sequence, bytes});
      }
      break;
    case Purpose::kOwn: {
      culprit_link::Bytes echo(sizeof ours.id);
      std::memcpy(echo.data(), &ours.id, sizeof ours.id);
      echo.insert(echo.end(), payload.begin(), payload.end());
      if (!outbox_.queue(culprit_link::Echo{std::move(echo)})) return std::nullopt;
      break;
    }
    case Purpose::kInfos:  // the helper's middleware announces its node
      break;
  }
  return number;
}

HelperEndpoints::Ptr HelperEndpoints::find(std::uint32_t id) {
  const MutexLock lock(mutex_);
  const auto found = ours_.find(id);
  return found == ours_.end() ? nullptr : found->second;
}

std::vector<HelperEndpoints::Ptr> HelperEndpoints::all() {
  const MutexLock lock(mutex_);
  std::vector<Ptr> all;
  for (const auto& [id, ours] : ours_) all.push_back(ours);
  return all;
}

std::vector<HelperEndpoints::Ptr> HelperEndpoints::readers_of(HelperEndpoint::Purpose purpose,
                                                              const std::string& name) {
  const MutexLock lock(mutex_);
  std::vector<Ptr> found;
  for (const auto& [id, ours] : ours_) {
    if (ours->reads(purpose, name)) found.push_back(ours);
  }
  return found;
}

void HelperEndpoints::greet(const culprit_link::Frame& first) {
  const MutexLock lock(mutex_);
  outbox_.greet(first);
}

void HelperEndpoints::begin() {
  const MutexLock lock(mutex_);
  outbox_.begin();
  for (const auto& [id, ours] : ours_) {
    if (ours->wish) outbox_.queue(*ours->wish);
  }
}

void HelperEndpoints::close() {
  const MutexLock lock(mutex_);
  outbox_.close();
}

void HelperEndpoints::queue(const culprit_link::Frame& frame) {
  const MutexLock lock(mutex_);
  outbox_.queue(frame);
}

bool HelperEndpoints::send(int socket) {
  const MutexLock lock(mutex_);
  return outbox_.send(socket);
}

bool HelperEndpoints::has_waiting() {
  const MutexLock lock(mutex_);
  return outbox_.has_waiting();
}

bool HelperEndpoints::is_stuck() {
  const MutexLock lock(mutex_);
  return outbox_.is_stuck();
}

}  // namespace culprit::ros2

#include "link/lease_link.h"

#include <algorithm>

#include "base/live_clock.h"
#include "link/neighbour_hosts.h"
#include "rtps/cdr.h"

namespace culprit::link {
namespace {

constexpr rtps::Qos kLeaseQos{.reliability = rtps::Reliability::kBestEffort, .depth = 10};

}  // namespace

Expected<std::unique_ptr<LeaseLink>> LeaseLink::open(ros2::Context& context,
                                                     const ros2::Hearing& hearing,
                                                     ros2::Executor& executor, Options options) {
  std::unique_ptr<LeaseLink> link(new LeaseLink(context, hearing, std::move(options)));
  const std::vector<std::string> announcements =
      ManagerLease(link->options_.claim, context.participant().guid().prefix()).announcements();
  auto announced = link->announce(announcements);
  if (!announced) return Error{announced.error()};
  link->writers_ = std::move(*announced);
  if (auto listening = link->listen(); !listening) return Error{listening.error()};
  link->timer_ = std::make_unique<ros2::Timer>(executor, ManagerLease::kPeriod,
                                               [link = link.get()] { link->say(); });
  return link;
}

LeaseLink::LeaseLink(ros2::Context& context, const ros2::Hearing& hearing, Options options)
    : options_(std::move(options)),
      context_(context),
      hearing_(hearing),
      lease_(options_.claim, context.participant().guid().prefix()),
      manages_(options_.manages) {}

Expected<std::vector<std::unique_ptr<ros2::Writer>>> LeaseLink::announce(
    const std::vector<std::string>& announcements) {
  std::vector<std::unique_ptr<ros2::Writer>> writers;
  for (const std::string& announcement : announcements) {
    auto writer = context_.participant().create_writer({.topic = ManagerLease::kTopic,
                                                        .type = ManagerLease::kType,
                                                        .qos = kLeaseQos,
                                                        .user_data = announcement,
                                                        .on_match = {}});
    if (!writer) return Error{writer.error()};
    writers.push_back(std::move(*writer));
  }
  return writers;
}

// If a participant makes several claims, the one with the highest rank counts.
Expected<void> LeaseLink::take_over(std::int64_t term) {
  LeaseClaim claim = options_.claim;
  claim.term = term;
  auto announced = announce(
      ManagerLease(std::move(claim), context_.participant().guid().prefix()).announcements());
  if (!announced) return Error{announced.error()};
  of_new_term_ = std::move(*announced);
  {
    const MutexLock lock(mutex_);
    lease_.take_over(term);
    manages_ = true;
  }
  say();
  return {};
}

// Without a key no beat counts.
Expected<void> LeaseLink::listen() {
  if (options_.claim.key.empty()) return {};
  auto reader =
      context_.participant().create_reader({.topic = ManagerLease::kTopic,
                                            .type = ManagerLease::kType,
                                            .qos = kLeaseQos,
                                            .user_data = {},
                                            .on_match = {}},
                                           [this](const ros2::Sample& sample) { on_beat(sample); });
  if (!reader) return Error{reader.error()};
  reader_ = std::move(*reader);
  return {};
}

// ---- messages of others

void LeaseLink::on_discovery(const ros2::DiscoveryEvent& event) {
  constexpr std::size_t kMost = 1000;
  const MutexLock lock(mutex_);
  lease_.apply(event, live_now());
  if (const auto* info = std::get_if<ros2::ParticipantInfo>(&event)) {
    const rtps::GuidPrefix prefix = info->guid.prefix();
    if (neighbours_.size() >= kMost && !neighbours_.contains(prefix)) return;
    neighbours_[prefix] = {printable(info->host), is_on_this_machine(*info)};
  } else if (const auto* gone = std::get_if<ros2::ParticipantGone>(&event)) {
    neighbours_.erase(gone->guid.prefix());
  }
}

void LeaseLink::on_beat(const ros2::Sample& sample) {
  rtps::CdrReader message(sample.payload);
  const std::string_view beat = message.read_string();
  const MutexLock lock(mutex_);
  lease_.hear(sample.identity.writer.prefix(), beat, live_now());
}

bool LeaseLink::is_here(const rtps::GuidPrefix& participant) const {
  const auto found = neighbours_.find(participant);
  return found != neighbours_.end() && found->second.is_here;
}

std::string LeaseLink::host_of(const rtps::GuidPrefix& participant) const {
  const auto found = neighbours_.find(participant);
  const bool is_known = found != neighbours_.end() && !found->second.host.empty();
  return is_known ? found->second.host : "another machine";
}

std::optional<std::string> LeaseLink::elder() const {
  const MutexLock lock(mutex_);
  const auto elder = lease_.elder(live_now(), [this](const rtps::GuidPrefix& p)
                                                  CULPRIT_REQUIRES(mutex_) { return is_here(p); });
  return elder ? std::optional(host_of(*elder)) : std::nullopt;
}

std::optional<std::string> LeaseLink::elder_at(const std::string& node) const {
  const MutexLock lock(mutex_);
  const auto elder = lease_.elder_at(node, live_now(),
                                     [this](const rtps::GuidPrefix& p)
                                         CULPRIT_REQUIRES(mutex_) { return is_here(p); });
  return elder ? std::optional(host_of(*elder)) : std::nullopt;
}

std::vector<std::string> LeaseLink::strangers() const {
  const MutexLock lock(mutex_);
  std::vector<std::string> hosts;
  for (const rtps::GuidPrefix& each : lease_.strangers(
           [this](const rtps::GuidPrefix& p) CULPRIT_REQUIRES(mutex_) { return is_here(p); }))
    hosts.push_back(host_of(each));
  return hosts;
}

std::optional<std::string> LeaseLink::told_orders() const {
  const MutexLock lock(mutex_);
  return lease_.told_orders();
}

std::optional<ManagerLease::ToldState> LeaseLink::told_state() const {
  const MutexLock lock(mutex_);
  return lease_.told_state();
}

void LeaseLink::tell_state(std::string state) {
  const MutexLock lock(mutex_);
  lease_.tell_state(std::move(state));
}

std::int64_t LeaseLink::highest_term() const {
  const MutexLock lock(mutex_);
  return lease_.highest_term();
}

Time LeaseLink::sure_until(Time now) const {
  const MutexLock lock(mutex_);
  return lease_.sure_until(now);
}

// ---- own messages

void LeaseLink::say() {
  const bool hears = hearing_.doubtful() > live_now();
  const std::string orders = options_.told_orders ? options_.told_orders() : "";
  std::vector<std::string> messages;
  {
    const MutexLock lock(mutex_);
    const Time now = live_now();
    if (auto beat = lease_.beat(now, hears, manages_, orders)) {
      messages = lease_.state_parts(now);
      messages.insert(messages.begin(), std::move(*beat));
    }
  }
  for (const std::string& each : messages) {
    rtps::CdrWriter message;
    message.write_string(each);
    writers_.front()->write(message.take());
  }
}

}  // namespace culprit::link

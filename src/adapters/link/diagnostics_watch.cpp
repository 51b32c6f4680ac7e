#include "link/diagnostics_watch.h"

#include <utility>

#include "base/live_clock.h"
#include "robot/unreadable.h"

namespace culprit::link {

Expected<std::unique_ptr<DiagnosticsWatch>> DiagnosticsWatch::create(ros2::NodeEntry& self,
                                                                     const RuleSet& rules,
                                                                     Inbox& inbox,
                                                                     ComponentOf component_of) {
  std::unique_ptr<DiagnosticsWatch> watch(
      new DiagnosticsWatch(self, rules, inbox, std::move(component_of)));
  if (!watch->is_wanted()) return watch;
  constexpr rtps::Qos kQos{.reliability = rtps::Reliability::kBestEffort, .depth = 1};
  auto subscription = ros2::RawSubscription::create(
      self, "/diagnostics", ros2::msg::DiagnosticArray::kType, kQos, ros2::PayloadUse::kWholeLater,
      [raw = watch.get()](const ros2::Sample& sample) { raw->on_sample(sample); });
  if (!subscription) return Error{subscription.error()};
  watch->subscription_ = std::move(*subscription);
  return watch;
}

DiagnosticsWatch::DiagnosticsWatch(ros2::NodeEntry& self, const RuleSet& rules, Inbox& inbox,
                                   ComponentOf component_of)
    : self_(self),
      inbox_(inbox),
      reading_(rules),
      component_of_(std::move(component_of)),
      tasks_(self.context().executor()) {
  for (const Signal& signal : rules.signals) {
    const auto* key = std::get_if<DiagnosticKey>(&signal.source);
    if (key != nullptr && key->publisher)
      publishers_.declare(key->status == "*" ? key->key : key->status, *key->publisher,
                          rules[*key->publisher].name);
  }
  reading_.on_level = [this](DiagnosticId id, std::uint8_t level)
                          CULPRIT_REQUIRES(mutex_) { on_level(id, level); };
  reading_.on_signal = [this](SignalId id, const std::string& text)
                           CULPRIT_REQUIRES(mutex_) { on_signal(id, text); };
  reading_.on_status = [this](StatusHeard heard) { inbox_.put(std::move(heard), Urgency::kSoon); };
}

bool DiagnosticsWatch::is_wanted() const {
  const MutexLock lock(mutex_);
  return reading_.is_wanted();
}

void DiagnosticsWatch::remember(const std::string& status, const std::string& node) {
  const MutexLock lock(mutex_);
  publishers_.remember(status, node);
}

void DiagnosticsWatch::node_joined(const std::string& node) {
  const MutexLock lock(mutex_);
  nodes_.insert(node);
  writers_.clear();
}

void DiagnosticsWatch::node_left(const std::string& node) {
  const MutexLock lock(mutex_);
  nodes_.erase(node);
  writers_.clear();
}

std::map<std::string, std::string> DiagnosticsWatch::conflicts() const {
  const MutexLock lock(mutex_);
  return publishers_.conflicts();
}

void DiagnosticsWatch::on_sample(const ros2::Sample& sample) {
  // culprit's own messages are not read.
  const rtps::Guid writer = sample.identity.writer;
  if (writer.prefix() == self_.context().participant().guid().prefix()) return;
  const std::size_t size = sample.payload.size();
  if (size > ros2::msg::DiagnosticArray::kLargest) return;
  auto message = rtps::decode<ros2::msg::DiagnosticArray>(sample.payload);
  if (!message) return;
  const MutexLock lock(mutex_);
  const auto known = writers_.find(writer);
  if (known != writers_.end()) return read(*message, known->second);
  const auto room = waiting_.admit(writer, size);
  if (room == WaitingLookups::Room::kNone) return;
  if (room == WaitingLookups::Room::kWriterOnly) message->status.clear();
  tasks_.post([this, writer, size, room, message = std::move(*message)] {
    look_up(writer, size, room, message);
  });
}

// A writer that no node claims yet is looked up again with its next message.
void DiagnosticsWatch::look_up(const rtps::Guid& writer, std::size_t size,
                               WaitingLookups::Room room,
                               const ros2::msg::DiagnosticArray& message) {
  constexpr std::size_t kMostWriters = 10'000;  // the network decides how many there are
  const ros2::Graph::Owner owner = self_.context().graph().owner_of(writer);
  SignalPublishers::Publisher by{owner.node, owner.pid != 0, owner.node.empty() || owner.counts,
                                 component_of_(owner.node)};
  const MutexLock lock(mutex_);
  waiting_.done(writer, size, room);
  if (by.node.empty()) {
    if (unclaimed_.size() >= kMostWriters) unclaimed_.clear();
    const Time now = live_now();
    const Time first = unclaimed_.try_emplace(writer, now).first->second;
    by.is_new = now < later(first, SignalPublishers::kClaimed);
  } else {
    unclaimed_.erase(writer);
  }
  if (!by.node.empty() && writers_.size() < kMostWriters) writers_.insert_or_assign(writer, by);
  read(message, by);
}

void DiagnosticsWatch::read(const ros2::msg::DiagnosticArray& message,
                            const SignalPublishers::Publisher& by) {
  reading_.read(message, [&](const std::string& status, std::optional<ComponentId> publisher)
                             CULPRIT_REQUIRES(mutex_) { return may_say(status, publisher, by); });
}

bool DiagnosticsWatch::may_say(const std::string& status, std::optional<ComponentId> publisher,
                               const SignalPublishers::Publisher& by) {
  SignalPublishers::Answer answer = publishers_.judge(
      status, by, live_now(),
      [this](const std::string& node) CULPRIT_REQUIRES(mutex_) { return nodes_.contains(node); });
  if (answer.is_learned) inbox_.put(PublisherKnown{status, by.node});
  if (!answer.conflict.empty()) inbox_.put(LinkTrouble{std::move(answer.conflict)});
  return answer.is_used && (!publisher || publisher == by.component);
}

void DiagnosticsWatch::on_level(DiagnosticId diagnostic, std::uint8_t level) {
  const auto [last, is_new] = last_level_.try_emplace(diagnostic.index, level);
  const Urgency urgency = !is_new && last->second == level ? Urgency::kSoon : Urgency::kNow;
  last->second = level;
  inbox_.put(DiagnosticRead{diagnostic, level}, urgency);
}

void DiagnosticsWatch::on_signal(SignalId signal, const std::string& text) {
  std::string& last = last_[signal.index];
  const Urgency urgency = last == text ? Urgency::kSoon : Urgency::kNow;
  last = text;
  inbox_.put(SignalRead{signal, readable(text)}, urgency);
}

}  // namespace culprit::link

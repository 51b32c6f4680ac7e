#include "link/topic_watch.h"

#include <algorithm>
#include <chrono>

#include "base/live_clock.h"
#include "link/goals.h"
#include "robot/unreadable.h"
#include "ros2/messages.h"
#include "rtps/receive_thread.h"

namespace culprit::link {

namespace {

// It may have lain in its socket for a moment. If the wall clock was set meanwhile, it came just now.
Time arrival_of(const ros2::Sample& sample) {
  constexpr Duration kLongest = 2 * Duration(rtps::ReceiveThread::kSoon);
  const Duration ago = std::chrono::system_clock::now() - sample.received;
  const bool is_plausible = ago >= Duration::zero() && ago <= kLongest;
  return live_now() - (is_plausible ? ago : Duration::zero());
}

}  // namespace

TopicWatch::TopicWatch(ros2::NodeEntry& self, TopicId topic, const RuleSet& rules, Inbox& inbox)
    : self_(self), topic_(topic), rules_(rules), inbox_(inbox) {
  for (std::size_t t = 0; t < rules.topics.size(); ++t) {
    const Topic& each = rules.topics[t];
    const bool is_counted =
        std::any_of(rules.inputs.begin(), rules.inputs.end(), [&](const Input& input) {
          using enum Input::Kind;
          return (input.kind == kRate || input.kind == kAge || input.kind == kPhi ||
                  input.kind == kLoss) &&
                 input.topic == TopicId(t);
        });
    if (each.name != rules[topic].name || !is_counted) continue;
    if (each.publisher)
      of_publishers_.push_back({TopicId(t), *each.publisher});
    else
      whole_ = TopicId(t);
  }
  counts_ = whole_ || !of_publishers_.empty();
  reads_goals_ = std::any_of(rules.inputs.begin(), rules.inputs.end(), [&](const Input& input) {
    using enum Input::Kind;
    return (input.kind == kGoals || input.kind == kGoalAge) && input.topic == topic;
  });
}

void TopicWatch::knows_writers(Writers writers) {
  const MutexLock lock(mutex_);
  writers_ = std::move(writers);
  std::deque<std::pair<rtps::Guid, rtps::Bytes>> waiting = std::exchange(waiting_, {});
  for (auto& [writer, payload] : waiting) {
    const auto known = writers_.find(writer);
    if (known == writers_.end()) {
      waiting_.emplace_back(writer, std::move(payload));
      continue;
    }
    for (Field& field : fields_) {
      if (field.publisher == known->second) read(field, payload);
    }
  }
}

bool TopicWatch::waits_for_writers() const {
  const MutexLock lock(mutex_);
  return !waiting_.empty();
}

// Empty while the writer is not known, or if its node is no component.
std::optional<ComponentId> TopicWatch::publisher_of(const rtps::Guid& writer) {
  {
    const MutexLock lock(mutex_);
    const auto known = writers_.find(writer);
    if (known != writers_.end()) return known->second;
  }
  ask();
  return std::nullopt;
}

void TopicWatch::ask() {
  constexpr Duration kLookedUpAgain = std::chrono::seconds(1);
  {
    const MutexLock lock(mutex_);
    const Time now = live_now();
    if (later(asked_, kLookedUpAgain) > now || !ask_for_writers_) return;
    asked_ = now;
  }
  ask_for_writers_();
}

void TopicWatch::on_arrival(const ros2::Sample& sample) {
  has_heard_ = true;
  if (!counts_) return;
  const Time at = arrival_of(sample);
  const ros2::SampleGaps::Step step = gaps_.next(sample.identity.writer, sample.identity.sequence,
                                                 self_.context().participant().dropped_here());
  const auto put = [&](TopicId topic) {
    inbox_.put({at, SampleArrived{topic, step.published, step.lost_here}}, Urgency::kSoon);
  };
  if (whole_) put(*whole_);
  if (of_publishers_.empty()) return;
  const auto publisher = publisher_of(sample.identity.writer);
  for (const auto& [topic, wanted] : of_publishers_) {
    if (wanted == publisher) put(topic);
  }
}

bool TopicWatch::reads_fields() const {
  return std::any_of(rules_.signals.begin(), rules_.signals.end(), [&](const Signal& signal) {
    const auto* field = std::get_if<TopicField>(&signal.source);
    return field != nullptr && rules_[field->topic].name == rules_[topic_].name;
  });
}

void TopicWatch::publisher_seen(const std::string& type, const rtps::Qos& offered,
                                const Expected<ros2::MessageLibrary*>& library) {
  const std::string& name = rules_[topic_].name;
  if (listener_ && type != type_)
    return tell_once(name + " is published as " + type + " too; only its " + type_ +
                     " messages are watched");
  if (listener_ && offered.keys != listener_->keys())
    return tell_once(name + " is published with keys and without; only those " +
                     (listener_->keys() == rtps::Keys::kSome ? "with" : "without") +
                     " them, which came first, are watched");
  if (!listener_) {
    if (reads_goals_ && type != ros2::msg::GoalStatusArray::kType)
      return tell_once(name + " is published as " + type + ", which is no status of an action");
    const bool has_fields = compile_fields(type, library);
    if (!has_fields && !counts_ && !reads_goals_) return;
    const ros2::PayloadUse use =
        has_fields || reads_goals_ ? ros2::PayloadUse::kWhole : ros2::PayloadUse::kHeader;
    if (const auto listening = listen(type, offered.keys, use); !listening) {
      return tell_once("cannot watch " + name + ": " + listening.error());
    }
  }
  if (const auto latched = listener_->publisher_offers(offered); !latched)
    tell_once("cannot read the transient local messages of " + name + ": " + latched.error());
}

Expected<void> TopicWatch::listen(const std::string& type, rtps::Keys keys, ros2::PayloadUse use) {
  auto listener =
      TopicListener::open(self_, rules_[topic_].name, type, keys, use,
                          {.on_arrival = [this](const ros2::Sample& sample) { on_arrival(sample); },
                           .on_message = [this](const ros2::Sample& sample) { on_message(sample); },
                           .on_unheard = [this] { on_unheard(); }});
  if (!listener) return Error{listener.error()};
  type_ = type;
  listener_ = std::move(*listener);
  return {};
}

// Gives whether there is one to read.
bool TopicWatch::compile_fields(const std::string& type,
                                const Expected<ros2::MessageLibrary*>& library) {
  std::vector<Field> fields;
  for (std::size_t s = 0; s < rules_.signals.size(); ++s) {
    const auto* field = std::get_if<TopicField>(&rules_.signals[s].source);
    if (field == nullptr || rules_[field->topic].name != rules_[topic_].name) continue;
    const std::string signal = "signal " + rules_.signals[s].name + ": ";
    if (!library) {
      tell_once(signal + library.error());
      continue;
    }
    auto reader = ros2::FieldReader::compile(**library, type, field->field);
    if (reader) {
      fields.push_back({SignalId(s), std::move(*reader), rules_[field->topic].publisher, {}});
    } else {
      tell_once(signal + reader.error());
    }
  }
  const MutexLock lock(mutex_);
  fields_ = std::move(fields);
  return !fields_.empty();
}

void TopicWatch::tell_once(std::string trouble) {
  constexpr std::size_t kMost = 100;  // the network decides which there are
  if (told_.size() < kMost && told_.insert(trouble).second)
    inbox_.put(LinkTrouble{std::move(trouble)});
}

void TopicWatch::on_message(const ros2::Sample& sample) {
  if (reads_goals_) {
    if (auto goals = goals_in(topic_, sample.payload)) inbox_.put(std::move(*goals));
  }
  {
    const MutexLock lock(mutex_);
    const auto known = writers_.find(sample.identity.writer);
    const bool is_known = known != writers_.end();
    bool is_of_publisher = false;
    for (Field& field : fields_) {
      is_of_publisher = is_of_publisher || field.publisher;
      if (!field.publisher || (is_known && field.publisher == known->second))
        read(field, sample.payload);
    }
    if (is_known || !is_of_publisher) return;
    keep(sample);
  }
  ask();
}

void TopicWatch::read(Field& field, rtps::ByteView payload) {
  Value value;
  if (field.reader.read(payload, value, wall_now()) != ros2::FieldStatus::kRead)
    value = unreadable_value();
  value = readable(std::move(value));
  // The same value again changes no trigger; it only proves that the signal is not stale.
  const Urgency urgency = field.last == value ? Urgency::kSoon : Urgency::kNow;
  field.last = value;
  inbox_.put(SignalRead{field.signal, std::move(value)}, urgency);
}

void TopicWatch::keep(const ros2::Sample& sample) {
  if (sample.payload.size() > kLargestWaiting) return;
  const rtps::Guid& writer = sample.identity.writer;
  std::erase_if(waiting_, [&](const auto& message) { return message.first == writer; });
  if (waiting_.size() >= kMostWaiting) waiting_.pop_front();
  waiting_.emplace_back(writer, rtps::Bytes(sample.payload.begin(), sample.payload.end()));
}

// Samples that cannot be reassembled were published all the same: the topic is not silent.
void TopicWatch::on_unheard() {
  has_heard_ = true;
  if (!told_unheard_.exchange(true)) {
    inbox_.put(LinkTrouble{"messages of " + rules_[topic_].name +
                           " cannot be put together: they are too large, or lost in part; "
                           "culprit knows only that they come"});
  }
  if (whole_) inbox_.put(SampleArrived{*whole_, 1}, Urgency::kSoon);
}

}  // namespace culprit::link

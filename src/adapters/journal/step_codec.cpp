#include "journal/step_codec.h"

namespace culprit::journal {
namespace {

// Files hold these numbers: they must not change.
enum class Tag : std::uint8_t {
  kNodeAppeared = 1,
  kNodeVanished = 2,
  kEndpointAppeared = 3,
  kEndpointVanished = 4,
  kSampleArrived = 5,
  kSignalRead = 6,
  kDiagnosticRead = 7,
  kParameterRead = 8,
  kLifecycleRead = 9,
  kProcessSeen = 10,
  kProbed = 11,
  kReply = 12,
  kLinkTrouble = 13,
  kOrder = 14,
  kNamesakesSeen = 15,
  kHearingLost = 16,
  kHearingRegained = 17,
  kOverslept = 18,
  kStatusHeard = 19,
  kParametersListed = 20,
  kProcessWorked = 21,
  kHostReached = 22,
  kEndsWith = 23,
  kProcessSeenWithCause = 24,
  kLauncherSeen = 25,
  kPriorsTold = 26,
  kLivesOn = 27,
  kHostHeard = 28,
  kListenerKnown = 29,
  kStartedHere = 30,
  kUsageSeen = 31,
  kStartBarred = 32,
  kPublisherKnown = 33,
  kGoalsSeen = 34,
  kLogSeen = 35
};

enum class OrderTag : std::uint8_t {
  kPause = 1,
  kResume = 2,
  kSetDryRun = 3,
  kApprove = 4,
  kRefuse = 5,
  kSilence = 6,
  kLiftSilence = 7,
  kRunStrategy = 8,
  kForget = 9,
  kRevive = 10,
  kEndStarted = 11,
  kPropose = 12
};

// Flags of a launcher; together.
constexpr std::uint8_t kEnded = 1;
constexpr std::uint8_t kCrashed = 2;
constexpr std::uint8_t kRanOthers = 4;

// Beside a state of the lifecycle.
constexpr std::uint8_t kShutDown = 0x80;

enum class ValueTag : std::uint8_t {
  kNone = 0,
  kFalse = 1,
  kTrue = 2,
  kInteger = 3,
  kReal = 4,
  kText = 5,
  kLifecycle = 6
};

// Robots' clocks count from the start of the machine, or from 1970. A time beyond that by a century
// is damage, and must not enter calculations.
bool is_plausible(Time time) {
  constexpr Duration kCentury = std::chrono::hours(24 * 365 * 100);
  return time.time_since_epoch() > -kCentury && time.time_since_epoch() < 2 * kCentury;
}

class Encoder {
 public:
  explicit Encoder(ByteWriter& out) : out_(out) {}

  void operator()(const Observation& observation, Time now) {
    const Duration age = now - observation.at;
    std::visit([&](const auto& what) { write(what, age); }, observation.what);
  }

 private:
  void head(Tag tag, Duration age) {
    out_.byte(static_cast<std::uint8_t>(tag));
    out_.integer(age.count());
  }
  void tag(ValueTag t) { out_.byte(static_cast<std::uint8_t>(t)); }
  template <class Enum>
  void word(Enum value) {
    out_.byte(static_cast<std::uint8_t>(value));
  }

  void write(const NodeAppeared& o, Duration age) {
    head(Tag::kNodeAppeared, age);
    out_.text(o.node);
    out_.integer(o.pid);
  }
  void write(const NodeVanished& o, Duration age) {
    head(Tag::kNodeVanished, age);
    out_.text(o.node);
  }
  void write(const EndpointAppeared& o, Duration age) {
    head(Tag::kEndpointAppeared, age);
    endpoint(o);
  }
  void write(const EndpointVanished& o, Duration age) {
    head(Tag::kEndpointVanished, age);
    endpoint(o);
  }
  void write(const SampleArrived& o, Duration age) {
    head(Tag::kSampleArrived, age);
    out_.natural(o.topic.index);
    out_.natural(o.published);
  }
  void write(const SignalRead& o, Duration age) {
    head(Tag::kSignalRead, age);
    out_.natural(o.signal.index);
    value(o.value);
  }
  void write(const DiagnosticRead& o, Duration age) {
    head(Tag::kDiagnosticRead, age);
    out_.natural(o.diagnostic.index);
    out_.byte(o.level);
  }
  void write(const ParameterRead& o, Duration age) {
    head(Tag::kParameterRead, age);
    out_.natural(o.parameter.index);
    value(o.value);
  }
  void write(const LifecycleRead& o, Duration age) {
    head(Tag::kLifecycleRead, age);
    out_.natural(o.component.index);
    out_.byte(static_cast<std::uint8_t>(o.state) | (o.is_shut_down ? kShutDown : 0));
  }
  void write(const ProcessSeen& o, Duration age) {
    const bool has_cause = o.cause != Cause::kUnknown;
    head(has_cause ? Tag::kProcessSeenWithCause : Tag::kProcessSeen, age);
    out_.natural(o.component.index);
    word(o.state);
    out_.integer(o.pid);
    out_.text(o.remark);
    if (has_cause) word(o.cause);
  }
  void write(const LauncherSeen& o, Duration age) {
    head(Tag::kLauncherSeen, age);
    out_.natural(o.component.index);
    out_.integer(o.pid);
    out_.byte(static_cast<std::uint8_t>((o.has_ended ? kEnded : 0) |
                                        (o.has_crashed ? kCrashed : 0) |
                                        (o.ran_others ? kRanOthers : 0)));
  }
  void write(const StartedHere& o, Duration age) {
    head(Tag::kStartedHere, age);
    out_.natural(o.component.index);
    out_.integer(o.pid);
    out_.integer(o.launcher);
    out_.integer(o.runs_for.count());
  }
  void write(const ProcessWorked& o, Duration age) {
    head(Tag::kProcessWorked, age);
    out_.natural(o.component.index);
    out_.integer(o.pid);
  }
  void write(const UsageSeen& o, Duration age) {
    head(Tag::kUsageSeen, age);
    out_.natural(o.component.index);
    out_.real(o.cores);
    out_.real(o.mib);
  }
  void write(const GoalsSeen& o, Duration age) {
    head(Tag::kGoalsSeen, age);
    out_.natural(o.topic.index);
    out_.natural(o.goals.size());
    for (const GoalsSeen::Goal& goal : o.goals) {
      out_.natural(goal.id);
      word(goal.status);
    }
  }
  void write(const LogSeen& o, Duration age) {
    head(Tag::kLogSeen, age);
    out_.natural(o.component.index);
    word(o.level);
  }
  void write(const HostReached& o, Duration age) {
    head(Tag::kHostReached, age);
    out_.natural(o.component.index);
    out_.byte(o.is_reached ? 1 : 0);
  }
  void write(const LivesOn& o, Duration age) {
    head(Tag::kLivesOn, age);
    out_.natural(o.component.index);
    out_.text(o.host);
  }
  void write(const HostHeard& o, Duration age) {
    head(Tag::kHostHeard, age);
    out_.text(o.host);
    out_.byte(o.is_heard ? 1 : 0);
  }
  void write(const EndsWith& o, Duration age) {
    head(Tag::kEndsWith, age);
    out_.natural(o.component.index);
    out_.natural(o.others.size());
    for (const ComponentId other : o.others) out_.natural(other.index);
  }
  void write(const Probed& o, Duration age) {
    head(Tag::kProbed, age);
    out_.natural(o.component.index);
    out_.byte(static_cast<std::uint8_t>((o.node & 0x7f) << 1 | (o.answered ? 1 : 0)));
  }
  void write(const Reply& o, Duration age) {
    head(Tag::kReply, age);
    out_.natural(o.command.number);
    word(o.outcome);
    if (const auto* v = std::get_if<Value>(&o.value)) {
      value(*v);
    } else if (const auto* state = std::get_if<Lifecycle>(&o.value)) {
      tag(ValueTag::kLifecycle);
      word(*state);
    } else {
      tag(ValueTag::kNone);
    }
    out_.text(o.text);
  }
  void write(const LinkTrouble& o, Duration age) {
    head(Tag::kLinkTrouble, age);
    out_.text(o.text);
  }

  void write(const NamesakesSeen& o, Duration age) {
    head(Tag::kNamesakesSeen, age);
    out_.text(o.node);
    out_.natural(static_cast<std::uint64_t>(o.others));
  }
  void write(const HearingLost& o, Duration age) {
    head(Tag::kHearingLost, age);
    out_.text(o.reason);
  }
  void write(const HearingRegained&, Duration age) { head(Tag::kHearingRegained, age); }
  void write(const Overslept& o, Duration age) {
    head(Tag::kOverslept, age);
    out_.integer(o.by.count());
  }
  void write(const StatusHeard& o, Duration age) {
    head(Tag::kStatusHeard, age);
    out_.text(o.name);
    out_.text(o.hardware_id);
    texts(o.keys);
  }
  void write(const ParametersListed& o, Duration age) {
    head(Tag::kParametersListed, age);
    out_.natural(o.component.index);
    texts(o.names);
  }
  void write(const StartBarred& o, Duration age) {
    head(Tag::kStartBarred, age);
    out_.natural(o.component.index);
    out_.text(o.missing);
  }
  void write(const ListenerKnown& o, Duration age) {
    head(Tag::kListenerKnown, age);
    out_.natural(o.topic.index);
  }
  void write(const PublisherKnown& o, Duration age) {
    head(Tag::kPublisherKnown, age);
    out_.text(o.status);
    out_.text(o.node);
  }
  void write(const PriorsTold& o, Duration age) {
    head(Tag::kPriorsTold, age);
    out_.natural(o.priors.size());
    for (const PriorsTold::Prior& each : o.priors) {
      out_.natural(each.strategy.index);
      out_.real(each.alpha);
      out_.real(each.beta);
    }
    out_.text(o.source);
  }
  void texts(const std::vector<std::string>& all) {
    out_.natural(all.size());
    for (const std::string& each : all) out_.text(each);
  }
  void write(const Order& o, Duration age) {
    head(Tag::kOrder, age);
    out_.natural(o.number);
    out_.text(o.author);
    out_.text(o.reason);
    std::visit([&](const auto& order) { write_order(order); }, o.what);
  }
  void write_order(const Pause&) { word(OrderTag::kPause); }
  void write_order(const Resume&) { word(OrderTag::kResume); }
  void write_order(const SetDryRun& o) {
    word(OrderTag::kSetDryRun);
    out_.byte(o.is_on ? 1 : 0);
  }
  void write_order(const Approve& o) {
    word(OrderTag::kApprove);
    out_.natural(o.strategy.index);
  }
  void write_order(const Refuse& o) {
    word(OrderTag::kRefuse);
    out_.natural(o.strategy.index);
  }
  void write_order(const Propose& o) {
    word(OrderTag::kPropose);
    out_.natural(o.strategy.index);
  }
  void write_order(const Silence& o) {
    word(OrderTag::kSilence);
    silenced(o.what);
    out_.byte(o.lasts ? 1 : 0);
    if (o.lasts) out_.integer(o.lasts->count());
  }
  void write_order(const LiftSilence& o) {
    word(OrderTag::kLiftSilence);
    silenced(o.what);
  }
  void write_order(const RunStrategy& o) {
    word(OrderTag::kRunStrategy);
    out_.natural(o.strategy.index);
  }
  void write_order(const Revive&) { word(OrderTag::kRevive); }
  void write_order(const EndStarted&) { word(OrderTag::kEndStarted); }
  void write_order(const Forget& o) {
    word(OrderTag::kForget);
    out_.byte(o.rule ? 1 : 0);
    if (o.rule) out_.natural(o.rule->index);
  }
  void silenced(const Silenceable& what) {
    const auto* component = std::get_if<ComponentId>(&what);
    out_.byte(component != nullptr ? 0 : 1);
    out_.natural(component != nullptr ? component->index : std::get<RuleId>(what).index);
  }

  template <class Endpoint>
  void endpoint(const Endpoint& o) {
    out_.text(o.node);
    word(o.kind);
    out_.text(o.name);
  }
  void value(const Value& v) {
    if (const auto* truth = std::get_if<bool>(&v)) {
      tag(*truth ? ValueTag::kTrue : ValueTag::kFalse);
    } else if (const auto* whole = std::get_if<std::int64_t>(&v)) {
      tag(ValueTag::kInteger);
      out_.integer(*whole);
    } else if (const auto* number = std::get_if<double>(&v)) {
      tag(ValueTag::kReal);
      out_.real(*number);
    } else {
      tag(ValueTag::kText);
      out_.text(std::get<std::string>(v));
    }
  }

  ByteWriter& out_;
};

class Decoder {
 public:
  Decoder(ByteReader& in, const RuleSet& rules) : in_(in), rules_(rules) {}

  Observation operator()(Time now) {
    const auto tag = static_cast<Tag>(in_.byte());
    const Time at = earlier(now, in_.integer());
    return {at, what(tag)};
  }

 private:
  // Damaged bytes may hold anything; time must not overflow over it.
  Time earlier(Time now, std::int64_t nanoseconds) {
    std::int64_t at = 0;
    const bool overflows = __builtin_sub_overflow(now.time_since_epoch().count(), nanoseconds, &at);
    if (overflows || !is_plausible(Time(Duration(at)))) in_.fail();
    return in_.is_good() ? Time(Duration(at)) : now;
  }

  ObservationWhat what(Tag tag) {
    // One field after the other: the order of evaluation of a call's arguments is unspecified.
    switch (tag) {
      case Tag::kNodeAppeared: {
        std::string node = in_.text();
        return NodeAppeared{std::move(node), pid()};
      }
      case Tag::kNodeVanished:
        return NodeVanished{in_.text()};
      case Tag::kEndpointAppeared:
        return endpoint<EndpointAppeared>();
      case Tag::kEndpointVanished:
        return endpoint<EndpointVanished>();
      case Tag::kSampleArrived: {
        const auto topic = id<TopicId>(rules_.topics.size());
        return SampleArrived{topic, static_cast<std::uint32_t>(below(1ull << 32))};
      }
      case Tag::kSignalRead: {
        const auto signal = id<SignalId>(rules_.signals.size());
        return SignalRead{signal, value()};
      }
      case Tag::kDiagnosticRead: {
        const auto diagnostic = id<DiagnosticId>(rules_.diagnostics.size());
        return DiagnosticRead{diagnostic, in_.byte()};
      }
      case Tag::kParameterRead: {
        const auto parameter = id<ParameterId>(rules_.parameters.size());
        return ParameterRead{parameter, value()};
      }
      case Tag::kLifecycleRead: {
        const auto component = id<ComponentId>(rules_.components.size());
        const std::uint8_t state = in_.byte();
        const std::uint8_t primary = state & ~kShutDown;
        if (primary > static_cast<std::uint8_t>(Lifecycle::kTransition)) in_.fail();
        return LifecycleRead{component, static_cast<Lifecycle>(primary), (state & kShutDown) != 0};
      }
      case Tag::kProcessSeen:
      case Tag::kProcessSeenWithCause: {
        ProcessSeen seen;
        seen.component = id<ComponentId>(rules_.components.size());
        seen.state = word(ProcessState::kGone);
        seen.pid = pid();
        seen.remark = in_.text();
        if (tag == Tag::kProcessSeenWithCause) seen.cause = word(Cause::kOrder);
        return seen;
      }
      case Tag::kLauncherSeen: {
        const auto component = id<ComponentId>(rules_.components.size());
        const int launcher = pid();
        const std::uint8_t how = in_.byte();
        return LauncherSeen{component, launcher, (how & kEnded) != 0, (how & kCrashed) != 0,
                            (how & kRanOthers) != 0};
      }
      case Tag::kStartedHere: {
        StartedHere seen;
        seen.component = id<ComponentId>(rules_.components.size());
        seen.pid = pid();
        seen.launcher = pid();
        seen.runs_for = Duration(in_.integer());
        return seen;
      }
      case Tag::kProcessWorked: {
        const auto component = id<ComponentId>(rules_.components.size());
        return ProcessWorked{component, pid()};
      }
      case Tag::kUsageSeen: {
        UsageSeen seen{id<ComponentId>(rules_.components.size())};
        seen.cores = in_.real();
        seen.mib = in_.real();
        return seen;
      }
      case Tag::kGoalsSeen: {
        GoalsSeen seen{id<TopicId>(rules_.topics.size()), {}};
        for (std::uint64_t left = in_.natural(); left > 0 && in_.is_good(); --left) {
          const std::uint64_t goal = in_.natural();
          seen.goals.push_back({goal, GoalStatus(in_.byte() % 7)});
        }
        return seen;
      }
      case Tag::kLogSeen: {
        const auto component = id<ComponentId>(rules_.components.size());
        return LogSeen{component, log_level(in_.byte())};
      }
      case Tag::kHostReached: {
        const auto component = id<ComponentId>(rules_.components.size());
        return HostReached{component, in_.byte() != 0};
      }
      case Tag::kLivesOn: {
        const auto component = id<ComponentId>(rules_.components.size());
        return LivesOn{component, in_.text()};
      }
      case Tag::kHostHeard: {
        std::string host = in_.text();
        return HostHeard{std::move(host), in_.byte() != 0};
      }
      case Tag::kEndsWith: {
        EndsWith seen;
        seen.component = id<ComponentId>(rules_.components.size());
        for (std::uint64_t left = in_.natural(); left > 0 && in_.is_good(); --left)
          seen.others.push_back(id<ComponentId>(rules_.components.size()));
        return seen;
      }
      case Tag::kProbed: {
        const auto component = id<ComponentId>(rules_.components.size());
        const std::uint8_t how = in_.byte();
        return Probed{component, (how & 1) != 0, static_cast<std::uint8_t>(how >> 1)};
      }
      case Tag::kReply:
        return reply();
      case Tag::kLinkTrouble:
        return LinkTrouble{in_.text()};
      case Tag::kOrder:
        return order();
      case Tag::kNamesakesSeen: {
        std::string node = in_.text();
        return NamesakesSeen{std::move(node), static_cast<int>(below(1ull << 31))};
      }
      case Tag::kHearingLost:
        return HearingLost{in_.text()};
      case Tag::kHearingRegained:
        return HearingRegained{};
      case Tag::kOverslept:
        return Overslept{Duration(in_.integer())};
      case Tag::kStartBarred: {
        const auto component = id<ComponentId>(rules_.components.size());
        return StartBarred{component, in_.text()};
      }
      case Tag::kListenerKnown:
        return ListenerKnown{id<TopicId>(rules_.topics.size())};
      case Tag::kPublisherKnown: {
        std::string status = in_.text();
        return PublisherKnown{std::move(status), in_.text()};
      }
      case Tag::kPriorsTold: {
        PriorsTold told;
        for (std::uint64_t left = in_.natural(); left > 0 && in_.is_good(); --left) {
          const auto strategy = id<StrategyId>(rules_.strategies.size());
          const double alpha = in_.real();
          told.priors.push_back({strategy, alpha, in_.real()});
        }
        told.source = in_.text();
        return told;
      }
      case Tag::kStatusHeard: {
        StatusHeard heard;
        heard.name = in_.text();
        heard.hardware_id = in_.text();
        heard.keys = texts();
        return heard;
      }
      case Tag::kParametersListed: {
        const auto component = id<ComponentId>(rules_.components.size());
        return ParametersListed{component, texts()};
      }
    }
    in_.fail();
    return LinkTrouble{};
  }

  std::vector<std::string> texts() {
    std::vector<std::string> all;
    for (std::uint64_t left = in_.natural(); left > 0 && in_.is_good(); --left)
      all.push_back(in_.text());
    return all;
  }

  Order order() {
    Order order;
    order.number = in_.natural();
    order.author = in_.text();
    order.reason = in_.text();
    order.what = what_order(static_cast<OrderTag>(in_.byte()));
    return order;
  }
  decltype(Order::what) what_order(OrderTag tag) {
    switch (tag) {
      case OrderTag::kPause:
        return Pause{};
      case OrderTag::kResume:
        return Resume{};
      case OrderTag::kSetDryRun:
        return SetDryRun{in_.byte() != 0};
      case OrderTag::kApprove:
        return Approve{id<StrategyId>(rules_.strategies.size())};
      case OrderTag::kRefuse:
        return Refuse{id<StrategyId>(rules_.strategies.size())};
      case OrderTag::kPropose:
        return Propose{id<StrategyId>(rules_.strategies.size())};
      case OrderTag::kSilence: {
        Silence silence{silenced(), {}};
        if (in_.byte() != 0) silence.lasts = Duration(in_.integer());
        return silence;
      }
      case OrderTag::kLiftSilence:
        return LiftSilence{silenced()};
      case OrderTag::kRunStrategy:
        return RunStrategy{id<StrategyId>(rules_.strategies.size())};
      case OrderTag::kForget:
        if (in_.byte() == 0) return Forget{};
        return Forget{id<RuleId>(rules_.rules.size())};
      case OrderTag::kRevive:
        return Revive{};
      case OrderTag::kEndStarted:
        return EndStarted{};
    }
    in_.fail();
    return Pause{};
  }
  Silenceable silenced() {
    if (in_.byte() == 0) return id<ComponentId>(rules_.components.size());
    return id<RuleId>(rules_.rules.size());
  }

  Reply reply() {
    Reply reply;
    reply.command.number = in_.natural();
    reply.outcome = word(Outcome::kTimedOut);
    const auto tag = static_cast<ValueTag>(in_.byte());
    if (tag == ValueTag::kLifecycle) {
      reply.value = word(Lifecycle::kTransition);
    } else if (tag != ValueTag::kNone) {
      reply.value = value(tag);
    }
    reply.text = in_.text();
    return reply;
  }

  template <class Endpoint>
  Endpoint endpoint() {
    Endpoint endpoint;
    endpoint.node = in_.text();
    endpoint.kind = word(EndpointKind::kClient);
    endpoint.name = in_.text();
    return endpoint;
  }

  Value value() { return value(static_cast<ValueTag>(in_.byte())); }
  Value value(ValueTag tag) {
    switch (tag) {
      case ValueTag::kFalse:
        return false;
      case ValueTag::kTrue:
        return true;
      case ValueTag::kInteger:
        return in_.integer();
      case ValueTag::kReal:
        return in_.real();
      case ValueTag::kText:
        return in_.text();
      default:
        in_.fail();
        return false;
    }
  }

  std::uint64_t below(std::uint64_t limit) {
    const std::uint64_t number = in_.natural();
    if (number >= limit) in_.fail();
    return number < limit ? number : 0;
  }
  template <class Id>
  Id id(std::size_t count) {
    return Id(static_cast<std::size_t>(below(count)));
  }
  template <class Enum>
  Enum word(Enum last) {
    const std::uint8_t number = in_.byte();
    if (number > static_cast<std::uint8_t>(last)) {
      in_.fail();
      return Enum{};
    }
    return static_cast<Enum>(number);
  }
  int pid() {
    const std::int64_t number = in_.integer();
    if (number < 0 || number > INT32_MAX) in_.fail();
    return static_cast<int>(number);
  }

  ByteReader& in_;
  const RuleSet& rules_;
};

}  // namespace

void encode(Time now, std::span<const Observation> observations, std::optional<Digest> digest,
            ByteWriter& out) {
  out.integer(now.time_since_epoch().count());
  out.natural(observations.size() << 1 | (digest ? 1 : 0));
  Encoder encoder(out);
  for (const Observation& observation : observations) encoder(observation, now);
  if (!digest) return;
  for (int shift = 0; shift < 64; shift += 8) out.byte(static_cast<std::uint8_t>(*digest >> shift));
}

Expected<bool> StepReader::next(Step& step) {
  step.observations.clear();
  step.digest.reset();
  if (in_.is_at_end()) return false;
  step.now = Time(Duration(in_.integer()));
  if (!is_plausible(step.now)) in_.fail();
  const std::uint64_t head = in_.natural();
  Decoder decode(in_, rules_);
  for (std::uint64_t i = 0; i < head >> 1 && in_.is_good(); ++i)
    step.observations.push_back(decode(step.now));
  if ((head & 1) != 0) {
    Digest digest = 0;
    for (int shift = 0; shift < 64; shift += 8) digest |= Digest{in_.byte()} << shift;
    step.digest = digest;
  }
  if (!in_.is_good()) return Error{"its steps are damaged, or of another rule file"};
  return true;
}

}  // namespace culprit::journal

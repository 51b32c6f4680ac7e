#include "journal/step_codec.h"

#include <type_traits>
#include <utility>

#include "journal/fields.h"

namespace culprit::journal {
namespace {

// A kind of observation or order, by its number in files.
template <std::uint8_t kNumber, class T>
struct Kind {
  static constexpr std::uint8_t number = kNumber;
  using Type = T;
};

template <class... Each>
struct Kinds {
  // The first one. A kind without a number does not compile.
  template <class T>
  static constexpr std::uint8_t number_of() {
    constexpr std::uint8_t number = [] {
      std::uint8_t first = 0;
      ((first = first == 0 && std::is_same_v<T, typename Each::Type> ? Each::number : first), ...);
      return first;
    }();
    static_assert(number > 0);
    return number;
  }
  // Calls `read` with an empty one of the kind. False: no kind has this number.
  template <class Read>
  static bool make(std::uint8_t number, Read read) {
    return ((number == Each::number && (read(typename Each::Type{}), true)) || ...);
  }
};

// Files hold these numbers: they must not change.
constexpr std::uint8_t kProcessSeenWithCause = 24;
constexpr std::uint8_t kSampleArrivedLostHere = 38;
using ObservationKinds =
    Kinds<Kind<1, NodeAppeared>, Kind<2, NodeVanished>, Kind<3, EndpointAppeared>,
          Kind<4, EndpointVanished>, Kind<5, SampleArrived>, Kind<6, SignalRead>,
          Kind<7, DiagnosticRead>, Kind<8, ParameterRead>, Kind<9, LifecycleRead>,
          Kind<10, ProcessSeen>, Kind<11, Probed>, Kind<12, Reply>, Kind<13, LinkTrouble>,
          Kind<14, Order>, Kind<15, NamesakesSeen>, Kind<16, HearingLost>,
          Kind<17, HearingRegained>, Kind<18, Overslept>, Kind<19, StatusHeard>,
          Kind<20, ParametersListed>, Kind<21, ProcessWorked>, Kind<22, HostReached>,
          Kind<23, EndsWith>, Kind<kProcessSeenWithCause, ProcessSeen>, Kind<25, LauncherSeen>,
          Kind<26, PriorsTold>, Kind<27, LivesOn>, Kind<28, HostHeard>, Kind<29, ListenerKnown>,
          Kind<30, StartedHere>, Kind<31, UsageSeen>, Kind<32, StartBarred>,
          Kind<33, PublisherKnown>, Kind<34, GoalsSeen>, Kind<35, LogSeen>, Kind<36, TimeHeld>,
          Kind<37, ClockStepped>, Kind<kSampleArrivedLostHere, SampleArrived>, Kind<39, Unloaded>>;
using OrderKinds =
    Kinds<Kind<1, Pause>, Kind<2, Resume>, Kind<3, SetDryRun>, Kind<4, Approve>, Kind<5, Refuse>,
          Kind<6, Silence>, Kind<7, LiftSilence>, Kind<8, RunStrategy>, Kind<9, Forget>,
          Kind<10, Revive>, Kind<11, EndStarted>, Kind<12, Propose>>;

// Robots' clocks count from the start of the machine, or from 1970. A time beyond that by a century
// is damage, and must not enter calculations.
bool is_plausible(Time time) {
  constexpr Duration kCentury = std::chrono::hours(24 * 365 * 100);
  return time.time_since_epoch() > -kCentury && time.time_since_epoch() < 2 * kCentury;
}

// The fields of each kind in the order in which files hold them. `Codec` is FieldWriter or FieldReader.
template <class Codec>
class Fields {
 public:
  explicit Fields(Codec codec) : codec_(codec) {}

  template <class T>
  using Of = typename Codec::template Field<T>;

  template <class T>
  void of_kind(std::uint8_t number, T& o) {
    of(o);
    if constexpr (std::is_same_v<std::remove_const_t<T>, ProcessSeen>) {
      if (number == kProcessSeenWithCause) codec_.word(o.cause, Cause::kDoubt);
    }
    if constexpr (std::is_same_v<T, SampleArrived>) o.lost_here = number == kSampleArrivedLostHere;
  }

 private:
  void of(Of<NodeAppeared> o) { codec_.text(o.node), codec_.pid(o.pid); }
  void of(Of<NodeVanished> o) { codec_.text(o.node); }
  void of(Of<EndpointAppeared> o) { endpoint(o); }
  void of(Of<EndpointVanished> o) { endpoint(o); }
  void of(Of<SampleArrived> o) {
    codec_.id(o.topic);
    codec_.natural_below(1ull << 32, o.published);
  }
  void of(Of<SignalRead> o) { codec_.id(o.signal), codec_.value(o.value); }
  void of(Of<DiagnosticRead> o) { codec_.id(o.diagnostic), codec_.byte(o.level); }
  void of(Of<ParameterRead> o) { codec_.id(o.parameter), codec_.value(o.value); }
  void of(Of<LifecycleRead> o) {
    codec_.id(o.component);
    codec_.lifecycle(o.state, o.is_shut_down);
  }
  void of(Of<ProcessSeen> o) {  // and the cause, if it has one (of_kind)
    codec_.id(o.component);
    codec_.word(o.state, ProcessState::kGone);
    codec_.pid(o.pid);
    codec_.text(o.remark);
  }
  void of(Of<LauncherSeen> o) {
    codec_.id(o.component);
    codec_.pid(o.pid);
    codec_.truths(o.has_ended, o.has_crashed, o.ran_others);
  }
  void of(Of<StartedHere> o) {
    codec_.id(o.component);
    codec_.pid(o.pid);
    codec_.pid(o.launcher);
    codec_.duration(o.runs_for);
  }
  void of(Of<ProcessWorked> o) { codec_.id(o.component), codec_.pid(o.pid); }
  void of(Of<UsageSeen> o) {
    codec_.id(o.component);
    codec_.real(o.cores);
    codec_.real(o.mib);
  }
  void of(Of<LogSeen> o) {
    codec_.id(o.component);
    codec_.log_level(o.level);
  }
  void of(Of<GoalsSeen> o) {
    codec_.id(o.topic);
    codec_.list(o.goals, [this](auto& goal) {
      codec_.natural(goal.id);
      codec_.goal_status(goal.status);
    });
  }
  void of(Of<HostReached> o) { codec_.id(o.component), codec_.truth(o.is_reached); }
  void of(Of<TimeHeld> o) { codec_.id(o.component), codec_.truth(o.is_held); }
  void of(Of<ClockStepped> o) { codec_.duration(o.by); }
  void of(Of<LivesOn> o) { codec_.id(o.component), codec_.text(o.host); }
  void of(Of<HostHeard> o) { codec_.text(o.host), codec_.truth(o.is_heard); }
  void of(Of<EndsWith> o) {
    codec_.id(o.component);
    codec_.list(o.others, [this](auto& other) { codec_.id(other); });
  }
  void of(Of<Probed> o) {
    codec_.id(o.component);
    codec_.truth_and_number(o.answered, o.node);
  }
  void of(Of<Reply> o) {
    codec_.natural(o.command.number);
    codec_.word(o.outcome, Outcome::kTimedOut);
    codec_.answer(o.value);
    codec_.text(o.text);
  }
  void of(Of<LinkTrouble> o) { codec_.text(o.text); }
  void of(Of<NamesakesSeen> o) {
    codec_.text(o.node);
    codec_.natural_below(1ull << 31, o.others);
  }
  void of(Of<HearingLost> o) { codec_.text(o.reason); }
  void of(Of<HearingRegained>) {}
  void of(Of<Overslept> o) { codec_.duration(o.by); }
  void of(Of<StatusHeard> o) {
    codec_.text(o.name);
    codec_.text(o.hardware_id);
    texts(o.keys);
  }
  void of(Of<ParametersListed> o) { codec_.id(o.component), texts(o.names); }
  void of(Of<StartBarred> o) { codec_.id(o.component), codec_.text(o.missing); }
  void of(Of<Unloaded> o) { codec_.id(o.component); }
  void of(Of<ListenerKnown> o) { codec_.id(o.topic); }
  void of(Of<PublisherKnown> o) { codec_.text(o.status), codec_.text(o.node); }
  void of(Of<PriorsTold> o) {
    codec_.list(o.priors, [this](auto& prior) {
      codec_.id(prior.strategy);
      codec_.real(prior.alpha);
      codec_.real(prior.beta);
    });
    codec_.text(o.source);
  }

  void of(Of<Order> o) {
    codec_.natural(o.number);
    codec_.text(o.author);
    codec_.text(o.reason);
    what_of(o);
  }
  void what_of(const Order& order) {
    std::visit(
        [this]<class What>(const What& what) {
          codec_.byte(OrderKinds::number_of<What>());
          of(what);
        },
        order.what);
  }
  void what_of(Order& order) {
    std::uint8_t number = 0;
    codec_.byte(number);
    const bool is_known = OrderKinds::make(number, [&](auto what) {
      of(what);
      order.what = std::move(what);
    });
    if (!is_known) codec_.fail();
  }
  void of(Of<Pause>) {}
  void of(Of<Resume>) {}
  void of(Of<SetDryRun> o) { codec_.truth(o.is_on); }
  void of(Of<Approve> o) { codec_.id(o.strategy); }
  void of(Of<Refuse> o) { codec_.id(o.strategy); }
  void of(Of<Propose> o) { codec_.id(o.strategy); }
  void of(Of<Silence> o) {
    codec_.silenced(o.what);
    codec_.optional(o.lasts, [this](auto& lasts) { codec_.duration(lasts); });
  }
  void of(Of<LiftSilence> o) { codec_.silenced(o.what); }
  void of(Of<RunStrategy> o) { codec_.id(o.strategy); }
  void of(Of<Forget> o) {
    codec_.optional(o.rule, [this](auto& rule) { codec_.id(rule); });
  }
  void of(Of<Revive>) {}
  void of(Of<EndStarted>) {}

  template <class Endpoint>
  void endpoint(Endpoint& o) {
    codec_.text(o.node);
    codec_.word(o.kind, EndpointKind::kClient);
    codec_.text(o.name);
  }
  template <class Texts>
  void texts(Texts& all) {
    codec_.list(all, [this](auto& text) { codec_.text(text); });
  }

  Codec codec_;
};

void write_observation(const Observation& observation, Time now, ByteWriter& out) {
  Fields fields{FieldWriter(out)};
  std::visit(
      [&]<class What>(const What& what) {
        std::uint8_t number = ObservationKinds::number_of<What>();
        if constexpr (std::is_same_v<What, ProcessSeen>) {
          if (what.cause != Cause::kUnknown) number = kProcessSeenWithCause;
        }
        if constexpr (std::is_same_v<What, SampleArrived>) {
          if (what.lost_here) number = kSampleArrivedLostHere;
        }
        out.byte(number);
        out.integer((now - observation.at).count());
        fields.of_kind(number, what);
      },
      static_cast<const ObservationWhat::Variant&>(observation.what));
}

// Damaged bytes may hold anything; time must not overflow over it.
Time read_time(ByteReader& in, Time now) {
  std::int64_t at = 0;
  const bool overflows = __builtin_sub_overflow(now.time_since_epoch().count(), in.integer(), &at);
  if (overflows || !is_plausible(Time(Duration(at)))) in.fail();
  return in.is_good() ? Time(Duration(at)) : now;
}

Observation read_observation(ByteReader& in, const RuleSet& rules, Time now) {
  Fields fields{FieldReader(in, rules)};
  const std::uint8_t number = in.byte();
  Observation observation{read_time(in, now), LinkTrouble{}};
  const bool is_known = ObservationKinds::make(number, [&](auto what) {
    fields.of_kind(number, what);
    observation.what = std::move(what);
  });
  if (!is_known) in.fail();
  return observation;
}

}  // namespace

void encode(Time now, std::span<const Observation> observations, std::optional<Digest> digest,
            ByteWriter& out) {
  out.integer(now.time_since_epoch().count());
  out.natural(observations.size() << 1 | (digest ? 1 : 0));
  for (const Observation& observation : observations) write_observation(observation, now, out);
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
  for (std::uint64_t i = 0; i < head >> 1 && in_.is_good(); ++i)
    step.observations.push_back(read_observation(in_, rules_, step.now));
  if ((head & 1) != 0) {
    Digest digest = 0;
    for (int shift = 0; shift < 64; shift += 8) digest |= Digest{in_.byte()} << shift;
    step.digest = digest;
  }
  if (!in_.is_good()) return Error{"its steps are damaged, or of another rule file"};
  return true;
}

}  // namespace culprit::journal

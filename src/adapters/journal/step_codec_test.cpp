// A step's bytes bring back exactly what was written, and damaged ones are refused.
#include "journal/step_codec.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "language/checker.h"

namespace culprit::journal {
namespace {

const RuleSet& codec_rules() {
  static const RuleSet set = *check(Source("t", R"(
COMPONENT a NODE /a LAUNCH "a"
COMPONENT b NODE /b LAUNCH "b"
SIGNAL s DIAGNOSTIC d KEY k
RULE R
  POLICIES ERROR
  TRIGGER s > 1 || age(/t) > 1s || level(d) > 1 || parameter(a, p) > 1
    STRATEGY restart 50 10
      ADAPTATION a restart 2
    STRATEGY other 50 10
      ADAPTATION b restart 2
)"))
                                  .rules;
  return set;
}

Value any_value() {
  switch (*rc::gen::inRange(0, 4)) {
    case 0:
      return *rc::gen::arbitrary<bool>();
    case 1:
      return *rc::gen::arbitrary<std::int64_t>();
    case 2:
      return *rc::gen::arbitrary<double>();
    default:
      return *rc::gen::arbitrary<std::string>();
  }
}

decltype(Order::what) any_order() {
  const StrategyId strategy(*rc::gen::inRange<std::size_t>(0, 2));
  const Silenceable what =
      *rc::gen::arbitrary<bool>() ? Silenceable(ComponentId(1)) : Silenceable(RuleId(0));
  switch (*rc::gen::inRange(0, 11)) {
    case 0:
      return Pause{};
    case 1:
      return Resume{};
    case 2:
      return SetDryRun{*rc::gen::arbitrary<bool>()};
    case 3:
      return Approve{strategy};
    case 4:
      return Refuse{strategy};
    case 5:
      return Silence{what, *rc::gen::arbitrary<bool>() ? std::optional(Duration(5)) : std::nullopt};
    case 6:
      return LiftSilence{what};
    case 7:
      return *rc::gen::arbitrary<bool>() ? Forget{RuleId(0)} : Forget{};
    case 8:
      return Revive{};
    case 9:
      return EndStarted{};
    default:
      return RunStrategy{strategy};
  }
}

ObservationWhat anything() {
  const std::string text = *rc::gen::arbitrary<std::string>();
  const ComponentId component(*rc::gen::inRange<std::size_t>(0, 2));
  switch (*rc::gen::inRange(0, 36)) {
    case 0:
      return NodeAppeared{text, *rc::gen::positive<int>()};
    case 1:
      return NodeVanished{text};
    case 2:
      return EndpointAppeared{text, EndpointKind::kServer, "/x"};
    case 3:
      return EndpointVanished{text, EndpointKind::kClient, "/x"};
    case 4:
      return SampleArrived{TopicId(0), *rc::gen::arbitrary<std::uint32_t>(),
                           *rc::gen::arbitrary<bool>()};
    case 5:
      return SignalRead{SignalId(0), any_value()};
    case 6:
      return DiagnosticRead{DiagnosticId(0), *rc::gen::arbitrary<std::uint8_t>()};
    case 7:
      return ParameterRead{ParameterId(0), any_value()};
    case 8:
      return LifecycleRead{component, Lifecycle::kTransition, *rc::gen::arbitrary<bool>()};
    case 9:
      return ProcessSeen{component, ProcessState::kStopped, 7, text,
                         static_cast<Cause>(*rc::gen::inRange(0, 5))};
    case 10:
      return Probed{component, *rc::gen::arbitrary<bool>(),
                    *rc::gen::inRange<std::uint8_t>(0, 128)};
    case 11: {
      Reply reply{{*rc::gen::arbitrary<std::uint64_t>()}, Outcome::kTimedOut, {}, text};
      if (*rc::gen::arbitrary<bool>()) reply.value = any_value();
      if (*rc::gen::arbitrary<bool>()) reply.value = Lifecycle::kActive;
      return reply;
    }
    case 12:
      return Order{3, "ann", text, any_order()};
    case 13:
      return HearingLost{text};
    case 14:
      return HearingRegained{};
    case 15:
      return Overslept{Duration(*rc::gen::arbitrary<std::int64_t>())};
    case 16:
      return StatusHeard{text, "id", *rc::gen::arbitrary<std::vector<std::string>>()};
    case 17:
      return ParametersListed{component, *rc::gen::arbitrary<std::vector<std::string>>()};
    case 18:
      return ProcessWorked{component, *rc::gen::inRange(0, 100000)};
    case 19:
      return HostReached{component, *rc::gen::arbitrary<bool>()};
    case 20:
      return EndsWith{component, std::vector<ComponentId>(*rc::gen::inRange<std::size_t>(0, 3),
                                                          ComponentId(1))};
    case 21:
      return LauncherSeen{component, *rc::gen::inRange(0, 100000), *rc::gen::arbitrary<bool>(),
                          *rc::gen::arbitrary<bool>(), *rc::gen::arbitrary<bool>()};
    case 22:
      return PriorsTold{{{StrategyId(0), *rc::gen::arbitrary<double>(), 2.5}}, text};
    case 23:
      return LivesOn{component, text};
    case 24:
      return HostHeard{text, *rc::gen::arbitrary<bool>()};
    case 25:
      return ListenerKnown{TopicId(0)};
    case 26:
      return StartedHere{component, *rc::gen::inRange(0, 100000), *rc::gen::inRange(0, 100000),
                         Duration(*rc::gen::arbitrary<std::int64_t>())};
    case 27:
      return UsageSeen{component, *rc::gen::arbitrary<double>(), 120.5};
    case 28:
      return StartBarred{component, text};
    case 29:
      return PublisherKnown{text, "/driver"};
    case 30:
      return GoalsSeen{TopicId(0), {{*rc::gen::arbitrary<std::uint64_t>(), GoalStatus::kAborted}}};
    case 31:
      return LogSeen{component, *rc::gen::element(LogLevel::kDebug, LogLevel::kFatal)};
    case 32:
      return TimeHeld{component, *rc::gen::arbitrary<bool>()};
    case 33:
      return ClockStepped{*rc::gen::element(Duration(-3600), Duration(2))};
    case 34:
      return Unloaded{component};
    default:
      return LinkTrouble{text};
  }
}

std::string bytes_of(const Step& step) {
  std::string bytes;
  ByteWriter out(bytes);
  encode(step.now, step.observations, step.digest, out);
  return bytes;
}

Step any_step() {
  Step step;
  step.now = Time(std::chrono::milliseconds(*rc::gen::inRange(0, 1'000'000'000)));
  for (int i = *rc::gen::inRange(0, 10); i > 0; --i)
    step.observations.push_back(
        {step.now + std::chrono::microseconds(*rc::gen::inRange(-1'000'000, 1'000)), anything()});
  if (*rc::gen::arbitrary<bool>()) step.digest = *rc::gen::arbitrary<std::uint64_t>();
  return step;
}

RC_GTEST_PROP(StepCodec, BringsBackWhatWasWritten, ()) {
  const Step first = any_step();
  const Step second = any_step();
  const std::string bytes = bytes_of(first) + bytes_of(second);
  StepReader reader(bytes, codec_rules());
  Step step;
  for (const Step* written : {&first, &second}) {
    const auto more = reader.next(step);
    RC_ASSERT(more.has_value());
    RC_ASSERT(*more);
    RC_ASSERT(step.now == written->now);
    RC_ASSERT(step.digest == written->digest);
    RC_ASSERT(step.observations.size() == written->observations.size());
    // Written again they are the same to the last bit, not-a-number included.
    RC_ASSERT(bytes_of(step) == bytes_of(*written));
  }
  RC_ASSERT(!*reader.next(step));
}

RC_GTEST_PROP(StepCodec, RefusesWhatIsCutShort, ()) {
  const std::string bytes = bytes_of(any_step());
  const auto size = *rc::gen::inRange<std::size_t>(1, bytes.size());
  const std::string cut = bytes.substr(0, size);
  StepReader reader(cut, codec_rules());
  Step step;
  RC_ASSERT(!reader.next(step).has_value());
}

TEST(StepCodec, RefusesWhatTheRulesDoNotHave) {
  Step step;
  step.observations = {{Time{}, SampleArrived{TopicId(7), 1}}};
  const std::string bytes = bytes_of(step);
  StepReader reader(bytes, codec_rules());
  EXPECT_FALSE(reader.next(step));
}

}  // namespace
}  // namespace culprit::journal

// From a sample to the request that answers it, between processes: a source, `culprit run`, and a
// plain reader.
#include <algorithm>
#include <cstdlib>
#include <sstream>

#include <benchmark/benchmark.h>

#include "base/mutex.h"
#include "claims.h"
#include "live.h"
#include "ros2/messages.h"
#include "ros2/names.h"
#include "ros2/node.h"

namespace culprit::bench {
namespace {

using namespace std::chrono_literals;
using rtps::SystemTime;

// The node that culprit adapts, and the topics whose values and silence say that it has to.
class Target {
 public:
  explicit Target(const World& world) : side_(world) {
    node_ = std::move(*ros2::Node::create(side_.context(), {"/", "target"}));
    if (!node_->parameters().declare("reset", Value(0.0))) std::abort();
    value_ =
        ros2::RawPublisher::create(node_->entry(), "/bench/value", ros2::msg::Float64::kType, {});
    // The request is timed by the time stamp that its writer put on the wire.
    requests_ = side_.context().participant().create_reader(
        {.topic = ros2::mangle_topic(ros2::Channel::kRequest, "/target/set_parameters"),
         .type = ros2::mangle_type(ros2::Channel::kRequest, "rcl_interfaces/srv/SetParameters"),
         .qos = {},
         .payload = ros2::PayloadUse::kHeader,
         .user_data = {},
         .on_match = {}},
        [this](const ros2::Sample& sample) {
          const MutexLock lock(mutex_);
          request_ = sample.sent;
          changed_.notify_all();
        });
  }

  // Gives when it was sent.
  SystemTime publish(double value) {
    const SystemTime now = std::chrono::system_clock::now();
    (*value_)->publish(rtps::encode(ros2::msg::Float64{value}));
    return now;
  }

  void forget_request() {
    const MutexLock lock(mutex_);
    request_.reset();
  }
  std::optional<SystemTime> await_request(Duration patience) {
    MutexLock lock(mutex_);
    changed_.wait_for(lock, patience,
                      [this]() CULPRIT_REQUIRES(mutex_) { return request_.has_value(); });
    return request_;
  }

 private:
  Side side_;
  std::unique_ptr<ros2::Node> node_;
  Expected<std::unique_ptr<ros2::RawPublisher>> value_ = Error{""};
  Mutex mutex_;
  ConditionVariable changed_;
  std::optional<SystemTime> request_ CULPRIT_GUARDED_BY(mutex_);
  Expected<std::unique_ptr<ros2::Reader>> requests_ = Error{""};
};

double micros(auto duration) { return std::chrono::duration<double, std::micro>(duration).count(); }

// Samples as the plain reader saw them, in order.
struct Seen {
  double sent;  // microseconds of the system clock
  double here;
};
std::vector<Seen> seen_in(const std::string& output) {
  std::vector<Seen> out;
  std::istringstream lines(output);
  for (long long sent = 0, here = 0; lines >> sent >> here;)
    out.push_back({static_cast<double>(sent) / 1e3, static_cast<double>(here) / 1e3});
  return out;
}

// The rule asks for another value each time, so that each time there is something to set.
constexpr const char* kValueRules = R"(
CYCLE 10ms
COMPONENT target NODE /target
SIGNAL value TOPIC /bench/value FIELD data
SIGNAL reset PARAMETER target reset
RULE High
  POLICIES ERROR
  TRIGGER value > 0.5
    STRATEGY raise 90 50
      ADAPTATION target set_parameter reset value 1
)";

// The timed repair happens more often than the governor allows, so the limits are off and each repair counts alone. The journal is this run's own, too: another
// one would remember earlier attempts.
std::vector<std::string> run_ungoverned(const std::filesystem::path& rules) {
  return {"run",
          rules.string(),
          "--journal",
          (rules.parent_path() / "bench.journal").string(),
          "--healthy",
          "0",
          "--settle",
          "0",
          "--quiet",
          "0",
          "--intensity",
          "none",
          "--intensity-kind",
          "none",
          "--intensity-component",
          "none",
          "--restarts",
          "none",
          "--backoff",
          "0",
          "--storm",
          "0"};
}

void trigger_to_request(benchmark::State& state) {
  const World world;
  Target target(world);
  Child reader(world, "culprit-bench-peer", {"latencies", "/bench/value"});
  const Child culprit(world, "culprit", run_ungoverned(world.write("value.rules", kValueRules)));
  std::this_thread::sleep_for(3s);

  std::vector<double> requests;  // when they were written, as above
  for (auto _ : state) {
    for (int i = 1; i <= 320; ++i) {
      target.publish(0);
      std::this_thread::sleep_for(60ms);
      target.forget_request();
      target.publish(i);
      if (const auto request = target.await_request(1s))
        requests.push_back(micros(request->time_since_epoch()));
    }
  }
  reader.terminate();
  const std::vector<Seen> samples = seen_in(reader.output());

  std::vector<double> answers;
  std::vector<double> wires;
  for (const double request : requests) {
    // It answers the last sample before it.
    const auto after = std::find_if(samples.begin(), samples.end(),
                                    [&](const Seen& s) { return s.sent > request; });
    if (after == samples.begin()) continue;
    const Seen& sample = *std::prev(after);
    answers.push_back(request - sample.sent);
    wires.push_back(sample.here - sample.sent);
  }
  state.counters["answered"] = static_cast<double>(answers.size());
  state.counters["request_p50_us"] = quantile(answers, 0.5);
  state.counters["request_p99_us"] = quantile(answers, 0.99);
  state.counters["one_way_p50_us"] = quantile(wires, 0.5);
  state.counters["one_way_p99_us"] = quantile(wires, 0.99);
  claim("sample to request on the wire, p50, beside one way of the same sample",
        quantile(answers, 0.5) / quantile(wires, 0.5), 3, "times");
  claim("sample to request on the wire, p99, beside one way of the same sample",
        quantile(answers, 0.99) / quantile(wires, 0.99), 5, "times");
}
BENCHMARK(trigger_to_request)->Iterations(1)->Unit(benchmark::kSecond);

constexpr const char* kSilenceRules = R"(
CYCLE 100ms
COMPONENT target NODE /target
RULE Silent
  POLICIES ERROR
  TRIGGER phi(/bench/value) > 8
    STRATEGY reset 90 50
      ADAPTATION target increase_parameter reset 1 3
)";

void silence_to_request(benchmark::State& state) {
  const World world;
  Target target(world);
  const Child culprit(world, "culprit",
                      run_ungoverned(world.write("silence.rules", kSilenceRules)));
  std::this_thread::sleep_for(3s);
  std::vector<double> seconds;
  for (auto _ : state) {
    for (int i = 0; i < 5; ++i) {
      SystemTime last;
      constexpr int kSamples = 28;
      for (int n = 1; n <= kSamples; ++n) {
        last = target.publish(0);
        if (n < kSamples) std::this_thread::sleep_for(100ms);
      }
      target.forget_request();
      if (const auto request = target.await_request(5s))
        seconds.push_back(micros(*request - last) / 1e6);
    }
  }
  state.counters["answered"] = static_cast<double>(seconds.size());
  state.counters["p50_s"] = quantile(seconds, 0.5);
  claim("silent 10 Hz topic to request on the wire, slowest of five", quantile(seconds, 1), 0.5,
        "s");
}
BENCHMARK(silence_to_request)->Iterations(1)->Unit(benchmark::kSecond);

}  // namespace
}  // namespace culprit::bench

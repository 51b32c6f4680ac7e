// The cost of keeping the journal, and the speed of reading it again.
#include <array>
#include <chrono>
#include <filesystem>
#include <string>
#include <thread>
#include <unistd.h>

#include <benchmark/benchmark.h>

#include "claims.h"
#include "journal/recorder.h"
#include "journal/recovery.h"
#include "language/checker.h"
#include "live.h"
#include "manager/manager.h"
#include "plan/paper_planner.h"
#include "replay/replay.h"

namespace culprit::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kRules = R"(
COMPONENT camera NODE /camera LAUNCH "camera"
SIGNAL entropy DIAGNOSTIC segmentation KEY entropy
RULE Slow
  POLICIES ERROR
  TRIGGER rate(/rgb) < 10 || rate(/depth) < 10
    STRATEGY restart 50 10
      ADAPTATION camera restart 5
RULE Bad
  POLICIES WARNING
  TRIGGER mean(entropy, 1s) > 0.5
    STRATEGY redeploy 50 10
      ADAPTATION camera redeploy 5
)";

// A file of its own, gone with it.
struct File {
  std::filesystem::path path;
  explicit File(const std::string& name)
      : path(std::filesystem::temp_directory_path() /
             ("culprit-bench-" + std::to_string(getpid()) + "-" + name + ".journal")) {
    remove();
  }
  ~File() { remove(); }
  void remove() const {
    for (const char* part : {"", "-wal", "-shm", "-lock", "-learned", "-intents"})
      std::filesystem::remove(path.string() + part);
  }
};

// 1,000 events a second reach a live manager 20 at a time (Inbox::kSoon).
std::vector<Observation> events(Time now) {
  std::vector<Observation> all;
  for (int i = 0; i < 20; ++i) {
    const Time at = now - std::chrono::milliseconds(20 - i);
    if (i % 4 == 3) {
      all.push_back({at, SignalRead{SignalId(0), Value(0.1 + 0.001 * i)}});
    } else {
      all.push_back({at, SampleArrived{TopicId(static_cast<std::size_t>(i % 2)), 1}});
    }
  }
  return all;
}

journal::Session session() {
  journal::Session session;
  session.rules_path = "bench.rules";
  session.rules_text = kRules;
  session.discovery = Manager::kDiscovery;
  return session;
}

journal::Recorder::Options options_for(const File& file) {
  journal::Recorder::Options options;
  options.path = file.path;
  options.wall_clock = [] {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(
               std::chrono::system_clock::now().time_since_epoch())
        .count();
  };
  return options;
}

// Times of steps that came first after a pause, with cold caches, and of those that came second. A
// median of both together would lie anywhere between the two.
struct Steps {
  std::array<std::vector<double>, 2> ns;
  double typical() const { return (quantile(ns[0], 0.5) + quantile(ns[1], 0.5)) / 2; }
};

// Claim: at most 5 % on top of what a step takes the thread that steps, in real time.
void journalling(benchmark::State& state) {
  const RuleSet rules = *check(Source("bench.rules", kRules)).rules;
  const File file("step");
  Manager bare(rules, std::make_unique<PaperPlanner>(), {});
  Manager recorded(rules, std::make_unique<PaperPlanner>(), {});
  journal::Recorder recorder(std::move(*journal::Writer::open(file.path, {})), options_for(file),
                             session(), recorded.knowledge());
  Steps without;
  Steps with;
  for (auto _ : state) {
    Time now{};
    const auto begin = Clock::now();
    for (int i = 0; i < 500; ++i) {
      now += std::chrono::milliseconds(20);
      std::this_thread::sleep_until(begin + now.time_since_epoch());
      for (const int turn : {0, 1}) {
        const bool records = i % 2 == turn;
        Manager& manager = records ? recorded : bare;
        std::vector<Observation> observations = events(now);
        const auto start = Clock::now();
        manager.step(now, observations);
        if (records) recorder.stepped(now, observations, {}, manager.events());
        const std::chrono::duration<double, std::nano> took = Clock::now() - start;
        (records ? with : without).ns[static_cast<std::size_t>(turn)].push_back(took.count());
      }
    }
  }
  const double before = without.typical();
  const double after = with.typical();
  claim("journalling at 1,000 events/s: added to a step, median", 100 * (after - before) / before,
        5, "%");
}
BENCHMARK(journalling)->Iterations(1)->Unit(benchmark::kMillisecond);

void fill(const File& file, const RuleSet& rules, int steps, journal::Writer::Options limits = {}) {
  Manager manager(rules, std::make_unique<PaperPlanner>(), {});
  journal::Recorder recorder(std::move(*journal::Writer::open(file.path, limits)),
                             options_for(file), session(), manager.knowledge());
  Time now{};
  for (int i = 0; i < steps; ++i) {
    now += std::chrono::milliseconds(20);
    std::vector<Observation> observations = events(now);
    manager.step(now, observations);
    recorder.stepped(now, observations, {}, manager.events());
    // As fast as the recorder can: it would drop what is too much.
    if (i % 2000 == 1999) std::this_thread::sleep_for(std::chrono::milliseconds(210));
  }
}

// Claim: a second of a robot with 100,000 events is replayed within a second.
void replaying(benchmark::State& state) {
  const RuleSet rules = *check(Source("bench.rules", kRules)).rules;
  const File file("replay");
  fill(file, rules, 20'000);
  const auto reader = journal::Reader::open(file.path);
  auto recording = replay::Recording::open(*reader);
  double seconds = 0;
  std::uint64_t observations = 0;
  bool is_same = true;
  for (auto _ : state) {
    const auto begin = Clock::now();
    const auto result = replay::repeat(*recording, *reader, std::make_unique<PaperPlanner>(), {});
    seconds += std::chrono::duration<double>(Clock::now() - begin).count();
    observations += result->observations;
    is_same = is_same && !result->difference;
  }
  claim("replay: time for 100,000 events", 100'000 * seconds / static_cast<double>(observations), 1,
        "s");
  claim("replay: decisions that differ", is_same ? 0 : 1, 0, "");
}
BENCHMARK(replaying)->Iterations(3)->Unit(benchmark::kMillisecond);

// Claim: at most a second from the start of the process to the knowledge of what was left behind,
// with 1 GB of journal. It is filled with rows of steps, as a journal of that size is.
void recovery(benchmark::State& state) {
  const RuleSet rules = *check(Source("bench.rules", kRules)).rules;
  const File file("recovery");
  {
    journal::Writer::Options limits;
    limits.max_bytes = std::int64_t{4} << 30;
    auto writer = journal::Writer::open(file.path, limits);
    (void)writer->append({{{0, 1, "session", to_line(journal::to_json(session()))}}, {}}, 1,
                         journal::Durability::kProcessEnd);
    journal::Batch batch;
    for (int i = 0; i < 1000; ++i)
      batch.entries.push_back({0, 1, "steps", std::string(std::size_t{1} << 14, 'x')});
    for (int i = 0; i < 64; ++i) {
      (void)writer->append(batch, 1, journal::Durability::kProcessEnd);
      (void)writer->append({{{0, 1, "event", R"({"type":"trouble","text":"x"})"}}, {}}, 1,
                           journal::Durability::kProcessEnd);
    }
  }
  std::vector<double> times;
  for (auto _ : state) {
    const auto begin = Clock::now();
    auto writer = journal::Writer::open(file.path, {});
    const auto reader = journal::Reader::open(file.path);
    benchmark::DoNotOptimize(journal::recover(*reader, {}, rules, {}));
    times.push_back(std::chrono::duration<double>(Clock::now() - begin).count());
  }
  claim("recovery with a journal of 1 GB, slowest", quantile(times, 1), 1, "s");
}
BENCHMARK(recovery)->Iterations(3)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace culprit::bench

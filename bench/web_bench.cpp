// What it costs the manager that people look on: nothing but the telling, however many they are.
#include <chrono>
#include <httplib.h>
#include <string>
#include <thread>
#include <vector>

#include <benchmark/benchmark.h>

#include "claims.h"
#include "language/checker.h"
#include "live.h"
#include "plan/paper_planner.h"
#include "web/server.h"
#include "web/watched_manager.h"

namespace culprit::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kComponents = 500;

RuleSet large_robot() {
  std::string text;
  for (int i = 0; i < kComponents; ++i) {
    const std::string n = std::to_string(i);
    text += "COMPONENT c" + n + " NODE /c" + n + " LAUNCH \"c\"\n";
    text += "RULE R" + n + "\nPOLICIES ERROR\nTRIGGER age(/t" + n +
            ") > 1h\nSTRATEGY s 50 10\nADAPTATION c" + n + " restart 5\n";
  }
  return *check(Source("bench.rules", text)).rules;
}

// Pages that read the stream as browsers do, each on a connection of its own.
class Pages {
 public:
  Pages(int port, int count, std::function<void()> on_event) {
    for (int i = 0; i < count; ++i) {
      clients_.push_back(std::make_unique<httplib::Client>("127.0.0.1", port));
      threads_.emplace_back([this, i, on_event] {
        clients_[static_cast<std::size_t>(i)]->Get(
            "/api/stream", [&](const char* data, std::size_t size) {
              if (std::string_view(data, size).find("event: event") != std::string_view::npos)
                on_event();
              return true;
            });
      });
    }
  }
  ~Pages() {
    for (const auto& client : clients_) client->stop();
    for (std::thread& thread : threads_) thread.join();
  }

 private:
  std::vector<std::unique_ptr<httplib::Client>> clients_;
  std::vector<std::thread> threads_;
};

void step_with_pages(benchmark::State& state) {
  const RuleSet rules = large_robot();
  Manager manager(rules, std::make_unique<PaperPlanner>(), {});
  web::Hub hub;
  web::Metrics metrics;
  web::WatchedManager watched(manager, hub, metrics, Time{});
  web::Server::Options options;
  options.access.token = web::make_token();
  const auto server = web::Server::start(options, {}, &hub);
  const int pages = static_cast<int>(state.range(0));
  const Pages reading((*server)->port(), pages, [] {});
  while (pages > 0 && !hub.has_readers()) std::this_thread::yield();

  Time now{};
  std::vector<Observation> observation(1);
  std::size_t next = 0;
  const auto once = [&] {
    now += std::chrono::milliseconds(1);
    observation[0] = {now, SampleArrived{TopicId(next++ % kComponents)}};
    benchmark::DoNotOptimize(watched.step(now, observation));
  };
  for (auto _ : state) once();
  // A state is told each 200 ms of the robot's time, which is one step in 200.
  std::vector<double> microseconds(4000);
  for (double& each : microseconds) {
    const auto begin = Clock::now();
    once();
    each = std::chrono::duration<double, std::micro>(Clock::now() - begin).count();
    if (pages > 0) std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
  const std::string who = std::to_string(pages) + " pages open, 500 components: ";
  claim(who + "a step, median", quantile(microseconds, 0.5), 5, "us");
  if (pages == 0) return;  // then nothing is told
  claim(who + "a step that tells the state, p99.9", quantile(microseconds, 0.999), 20'000, "us");
}
BENCHMARK(step_with_pages)->Arg(0)->Arg(50)->Iterations(1000);

void event_to_page(benchmark::State& state) {
  web::Hub hub;
  web::Server::Options options;
  options.access.token = web::make_token();
  const auto server = web::Server::start(options, {}, &hub);
  std::atomic<int> arrived = 0;
  const Pages reading((*server)->port(), 1, [&] { ++arrived; });
  while (!hub.has_readers()) std::this_thread::yield();
  std::vector<double> milliseconds;
  for (auto _ : state) {
    const int before = arrived;
    const auto begin = Clock::now();
    hub.publish(web::Kind::kEvent, "{}");
    while (arrived == before) std::this_thread::yield();
    milliseconds.push_back(std::chrono::duration<double, std::milli>(Clock::now() - begin).count());
  }
  claim("an event, from the decision to a page: p99", quantile(milliseconds, 0.99), 100, "ms");
}
BENCHMARK(event_to_page)->Iterations(500);

}  // namespace
}  // namespace culprit::bench

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
#include "web/hub_observer.h"
#include "web/server.h"

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

// A manager of a large robot, of which one topic after the other has a sample.
class Watched {
 public:
  explicit Watched(const RuleSet& rules)
      : manager_(rules, std::make_unique<PaperPlanner>(), {}), observer_(hub_, metrics_) {
    observer_.begins(manager_, {}, Time{});
  }

  web::Hub& hub() { return hub_; }

  // How long a step took, in us.
  double step() {
    now_ += std::chrono::milliseconds(1);
    observation_[0] = {now_, SampleArrived{TopicId(next_++ % kComponents)}};
    const auto begin = Clock::now();
    const std::vector<Command> commands = manager_.step(now_, observation_);
    observer_.stepped({now_, Clock::now() - begin, observation_, commands, manager_.events()});
    return std::chrono::duration<double, std::micro>(Clock::now() - begin).count();
  }

 private:
  Manager manager_;
  web::Hub hub_;
  web::Metrics metrics_;
  web::HubObserver observer_;
  Time now_{};
  std::vector<Observation> observation_{1};
  std::size_t next_ = 0;
};

// Two managers take turns, one that 50 pages look at and one that nobody does. Both begin after the
// same pause, so that neither has the caches to itself.
void step_with_pages(benchmark::State& state) {
  constexpr int kPages = 50;
  const RuleSet rules = large_robot();
  Watched alone(rules);
  Watched seen(rules);
  web::Server::Options options;
  options.access.token = web::make_token();
  const auto server = web::Server::start(options, {}, &seen.hub());
  const Pages reading((*server)->port(), kPages, [] {});
  while (!seen.hub().has_readers()) std::this_thread::yield();

  // A state is told each 200 ms of the robot's time, which is one step in 200.
  std::vector<double> alone_us;
  std::vector<double> seen_us;
  const auto pause = [] { std::this_thread::sleep_for(std::chrono::microseconds(100)); };
  for (auto _ : state) {
    pause();
    alone_us.push_back(alone.step());
    pause();
    seen_us.push_back(seen.step());
  }
  const double median = quantile(seen_us, 0.5);
  claim("a step while 50 pages look on, 500 components: median", median, 5, "us");
  claim("the same beside a step that nobody sees", median / quantile(alone_us, 0.5), 1.5, "times");
  claim("the same when it tells the state: p99.9", quantile(seen_us, 0.999), 20'000, "us");
}
BENCHMARK(step_with_pages)->Iterations(5000);

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

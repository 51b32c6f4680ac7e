// The manager's cost of being watched by web clients: only the publishing, however many they are.
#include <chrono>
#include <filesystem>
#include <httplib.h>
#include <string>
#include <thread>
#include <unistd.h>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>
#include <fmt/core.h>

#include "claims.h"
#include "http/http_server.h"
#include "journal/session.h"
#include "journal/writer.h"
#include "language/checker.h"
#include "live.h"
#include "plan/paper_planner.h"
#include "web/calls.h"
#include "web/hub_observer.h"

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

  http::Hub& hub() { return hub_; }

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
  http::Hub hub_;
  web::Metrics metrics_;
  web::HubObserver observer_;
  Time now_{};
  std::vector<Observation> observation_{1};
  std::size_t next_ = 0;
};

// Two managers take turns, one with 50 pages and one with none. Both begin after the same pause, so
// that neither has the caches to itself.
void step_with_pages(benchmark::State& state) {
  constexpr int kPages = 50;
  const RuleSet rules = large_robot();
  Watched alone(rules);
  Watched seen(rules);
  http::HttpServer::Options options;
  options.access.token = http::make_token();
  const auto server = http::HttpServer::start(options, {}, &seen.hub());
  const Pages reading((*server)->port(), kPages, [] {});
  while (!seen.hub().has_readers()) std::this_thread::yield();

  // A state is published each 200 ms of the robot's time, which is one step in 200.
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
  http::Hub hub;
  http::HttpServer::Options options;
  options.access.token = http::make_token();
  const auto server = http::HttpServer::start(options, {}, &hub);
  std::atomic<int> arrived = 0;
  const Pages reading((*server)->port(), 1, [&] { ++arrived; });
  while (!hub.has_readers()) std::this_thread::yield();
  std::vector<double> milliseconds;
  for (auto _ : state) {
    const int before = arrived;
    const auto begin = Clock::now();
    hub.publish(http::Kind::kEvent, "{}");
    while (arrived == before) std::this_thread::yield();
    milliseconds.push_back(std::chrono::duration<double, std::milli>(Clock::now() - begin).count());
  }
  claim("an event, from the decision to a page: p99", quantile(milliseconds, 0.99), 100, "ms");
}
BENCHMARK(event_to_page)->Iterations(500);

constexpr const char* kRulesOfADay = R"(
COMPONENT camera NODE /camera
RULE CameraSilent
  POLICIES ERROR
  TRIGGER age(/rgb) > 500ms
    STRATEGY restart 50 10
      ADAPTATION camera restart 3
)";

// A day with an incident a minute, each of ten rows with reasons, among the rows of what was observed.
void write_day(const std::filesystem::path& path, std::int64_t begin) {
  constexpr std::int64_t kSecond = 1'000'000'000;
  auto writer = std::move(*journal::Writer::open(path, {}));
  journal::Session session;
  session.rules_text = kRulesOfADay;
  session.planner = Json::object();
  const std::string reasons(1500, 'x');
  journal::Batch batch;
  const auto add = [&](std::string_view kind, std::int64_t at, const std::string& body) {
    batch.entries.push_back({0, at, std::string(kind), body});
  };
  add(journal::kind::kSession, begin, to_line(journal::to_json(session)));
  for (std::int64_t minute = 0; minute < 1440; ++minute) {
    const std::int64_t at = begin + minute * 60 * kSecond;
    for (int i = 0; i < 3; ++i) add(journal::kind::kSteps, at, std::string(20'000, 'x'));
    const auto event = [&](int after, const char* type) {
      add(journal::kind::kEvent, at + after * kSecond,
          fmt::format(R"({{"type":"{}","rule":"CameraSilent","strategy":"restart",)"
                      R"("criticality":"ERROR","text":"{}","time":{}}})",
                      type, reasons, at + after * kSecond));
    };
    event(0, "failure_detected");
    event(0, "strategy_chosen");
    for (int i = 0; i < 7; ++i) event(1, "adaptation_done");
    event(3, "failure_resolved");
  }
  if (const auto written = writer.append(batch, begin, journal::Durability::kProcessEnd); !written)
    throw std::runtime_error(written.error());
}

void day_of_journal(benchmark::State& state) {
  constexpr std::int64_t kBegin = 1'800'000'000'000'000'000;
  const auto folder =
      std::filesystem::temp_directory_path() / ("culprit-bench-day-" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  write_day(folder / "day.journal", kBegin);
  http::Hub hub;
  const auto routes = web::incident_routes(hub, folder / "day.journal");
  std::vector<double> milliseconds;
  for (auto _ : state) {
    const auto begin = Clock::now();
    const http::Answer answer = routes[0].answer({{"since", "1800000000"}});
    milliseconds.push_back(std::chrono::duration<double, std::milli>(Clock::now() - begin).count());
    if (answer.body["incidents"].size() != 1440) throw std::runtime_error(to_line(answer.body));
  }
  std::filesystem::remove_all(folder);
  claim("1,440 incidents of a day, from the journal", quantile(milliseconds, 0.5), 500, "ms");
}
BENCHMARK(day_of_journal)->Iterations(5);

}  // namespace
}  // namespace culprit::bench

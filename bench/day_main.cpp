// Writes the journal of a day, for a page that opens it (ui/tests/speed.mjs).
//
//     culprit-bench-day RULES FILE [SECONDS]
//
// RULES are those of SUNSET (rules/sunset.rules). Its model runs for 24 hours of virtual time that end now, and one of its ten
// faults, by chance, strikes every SECONDS (60). It is managed by the manager that runs live, whose steps are recorded by the
// recorder that runs live. Exits with 1 if that did not write all of it.
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <thread>

#include <fmt/core.h>

#include "base/text_file.h"
#include "exemplars/sunset/model/sunset_model.h"
#include "journal/reader.h"
#include "journal/recorder.h"
#include "language/checker.h"
#include "manager/manager.h"
#include "manager/runtime.h"
#include "plan/bayes/bayes_planner.h"
#include "simulation/fault.h"
#include "simulation/simulated_robot.h"

namespace culprit::bench {
namespace {

using namespace std::chrono_literals;

constexpr Duration kDay = 24h;
constexpr Duration kSettled = 60s;  // from the start to the first fault
// The recorder writes in real time, and drops what becomes too much: after so many observations it is given the time of
// a write.
constexpr std::size_t kAtOnce = 20'000;

std::int64_t wall_now() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

int break_now_and_then(sunset::model::SunsetModel& model, Duration period) {
  simulation::Random chance(1);
  int count = 0;
  for (Time at = Time{} + kSettled; at < Time{} + kDay - period; at += period, ++count) {
    const auto faults = sunset::faults();
    const auto place = std::min(
        faults.size() - 1,
        static_cast<std::size_t>(chance.uniform(0, 1) * static_cast<double>(faults.size())));
    const sunset::Fault& fault = faults[place];
    const simulation::BadParameter bad{std::string(fault.name), fault.value};
    if (const auto done =
            simulation::inject(model.world(), {at, sunset::node_of(fault.member).full(), bad});
        !done)
      throw std::runtime_error(done.error());
  }
  return count;
}

journal::Session session_of(const std::string& path, const std::string& text) {
  journal::Session session;
  session.robot = "sunset";
  session.rules_path = path;
  session.rules_text = text;
  session.planner = {{"name", "bayes"}};
  session.boot = "the start before this one";  // whose clock has ended
  session.discovery = Manager::kDiscovery;
  return session;
}

std::int64_t count(const journal::Reader& reader, const char* condition) {
  return *reader.database().number(std::string("SELECT count(*) FROM entry WHERE ") + condition);
}

int write_day(const std::string& rules_path, const std::string& path, Duration period) {
  const auto text = read_text(rules_path);
  if (!text) throw std::runtime_error(text.error());
  const auto checked = check(Source(rules_path, *text));
  if (!checked.rules) throw std::runtime_error(rules_path + " has errors");
  const RuleSet& rules = *checked.rules;

  sunset::model::SunsetModel model(**sunset::model::find_profile("live"), 1);
  const int broken = break_now_and_then(model, period);
  simulation::SimulatedRobot robot(rules, model.world());
  Manager manager(rules, std::make_unique<BayesPlanner>(), {});

  const std::int64_t begin = wall_now() - kDay.count();
  std::atomic<std::int64_t> wall = begin;
  journal::Recorder::Options options;
  options.path = path;
  options.wall_clock = [&wall] { return wall.load(); };
  auto writer = journal::Writer::open(path, {});
  if (!writer) throw std::runtime_error(writer.error());
  {
    journal::Recorder recorder(std::move(*writer), options, session_of(rules_path, *text),
                               manager.knowledge());
    std::size_t since_write = 0;
    Runtime runtime(manager, robot);
    runtime.on_step = [&](const Runtime::Step& step) {
      wall = begin + step.now.time_since_epoch().count();
      since_write += step.observations.size();
      recorder.stepped(step.now, step.observations, step.commands, step.events);
      if (since_write < kAtOnce) return;
      since_write = 0;
      std::this_thread::sleep_for(journal::Recorder::kSoon + 20ms);
    };
    const std::atomic<bool> never = false;
    runtime.run(never, Time{} + kDay);
    if (const auto ended = recorder.end(journal::Ending::kStopped); !ended)
      throw std::runtime_error(ended.error());
  }
  const auto reader = journal::Reader::open(path);
  if (!reader) throw std::runtime_error(reader.error());
  fmt::print("{} faults, {} rows, {} of them of observations, {:.0f} MiB\n", broken,
             count(*reader, "true"), count(*reader, "kind = 'steps'"),
             static_cast<double>(std::filesystem::file_size(path)) / (1 << 20));
  return count(*reader, "kind = 'gap'") == 0 ? 0 : 1;
}

}  // namespace
}  // namespace culprit::bench

int main(int argc, char** argv) {
  if (argc < 3) {
    fmt::print(stderr, "culprit-bench-day RULES FILE [SECONDS]\n");
    return 2;
  }
  const auto period = std::chrono::seconds(argc > 3 ? std::atoi(argv[3]) : 60);
  try {
    return culprit::bench::write_day(argv[1], argv[2], period);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}

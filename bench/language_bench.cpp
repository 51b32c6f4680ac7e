// The tools of the rule language: how long a check, an editor's keystroke and a suite of tests
// take.
#include <algorithm>
#include <ctime>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "claims.h"
#include "language/checker.h"
#include "live.h"
#include "lsp/language_server.h"

namespace culprit::bench {
namespace {

double processor_milliseconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

// The fastest of several runs, in milliseconds: other programs' caches disturbed it least.
template <class Work>
double fastest(int runs, Work work) {
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < runs; ++i) {
    const double begin = processor_milliseconds();
    work();
    best = std::min(best, processor_milliseconds() - begin);
  }
  return best;
}

// The same of a whole run of culprit, from its start to its end.
double fastest_command(int runs, const World& world, const std::vector<std::string>& arguments) {
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < runs; ++i) {
    const Child::Ended ended = Child(world, "culprit", arguments).wait();
    if (ended.exit_code != 0) throw std::runtime_error("culprit " + arguments[0] + " failed");
    best = std::min(best, 1e3 * ended.cpu_seconds);
  }
  return best;
}

std::string rule(int i, const std::string& trigger, const std::string& strategies) {
  return "RULE Rule" + std::to_string(i) + "\n  POLICIES ERROR FOR 500ms\n  TRIGGER " + trigger +
         "\n" + strategies;
}

std::string restart_or_redeploy(const std::string& component) {
  return "    STRATEGY restart 50 10\n      ADAPTATION " + component +
         " restart 3\n    STRATEGY redeploy 90 10\n      ADAPTATION " + component +
         " redeploy 10\n";
}

// A component, a signal and a dependency for each rule.
std::string large_robot(int rules) {
  std::string text;
  for (int i = 0; i < rules; ++i) {
    const std::string n = std::to_string(i);
    text += "COMPONENT c" + n + " NODE /ns/c" + n + " LAUNCH \"run c" + n + "\"\n";
    text += "SIGNAL s" + n + " DIAGNOSTIC c" + n + " KEY k" + n + " STALE 2s RANGE 0..1\n";
    if (i > 0) text += "DEPENDENCY c" + n + " ON c" + std::to_string(i / 2) + "\n";
  }
  for (int i = 0; i < rules; ++i) {
    const std::string n = std::to_string(i);
    text +=
        rule(i, "s" + n + " > 0.5 && age(/ns/c" + n + "/out) > 1s", restart_or_redeploy("c" + n));
  }
  return text;
}

// Twenty components, each with hundreds of rules about the same signals.
std::string crowded_robot(int rules) {
  std::string text;
  for (int c = 0; c < 20; ++c) {
    const std::string n = std::to_string(c);
    text += "COMPONENT c" + n + " NODE /ns/c" + n + " LAUNCH \"run c" + n + "\"\nSIGNAL s" + n +
            " DIAGNOSTIC c" + n + " KEY k RANGE 0..1\n";
  }
  for (int i = 0; i < rules; ++i) {
    const std::string n = std::to_string(i % 20);
    text +=
        rule(i, "s" + n + " > 0." + std::to_string(i) + " && lifecycle(c" + n + ") == \"active\"",
             restart_or_redeploy("c" + n));
  }
  return text;
}

// Undeclared signals, whose type only the last rule reveals.
std::string chain(int rules) {
  std::string text;
  for (int i = rules; i > 1; --i)
    text += rule(i, "x" + std::to_string(i) + " == x" + std::to_string(i - 1),
                 restart_or_redeploy("late"));
  return "COMPONENT late LAUNCH \"late\"\n" + text +
         rule(1, "x1 == \"text\"", restart_or_redeploy("late"));
}

// Names that are declared, and others that are used.
std::string other_names(int rules) {
  std::string text;
  for (int i = 0; i < rules; ++i) text += "CONST threshold_" + std::to_string(i) + " = 1\n";
  text += "COMPONENT late LAUNCH \"late\"\n";
  for (int i = 0; i < rules; ++i)
    text += rule(i, "measured_" + std::to_string(i) + " > 1", restart_or_redeploy("late"));
  return text;
}

// Triggers of forty comparisons.
std::string long_triggers(int rules) {
  std::string text = "COMPONENT late LAUNCH \"late\"\n";
  for (int i = 0; i < rules; ++i) {
    std::string trigger = "x > 0";
    for (int j = 1; j < 40; ++j)
      trigger += (j % 2 == 0 ? " && y" : " || y") + std::to_string(j) + " < " + std::to_string(i);
    text += rule(i, trigger, restart_or_redeploy("late"));
  }
  return text;
}

struct Shape {
  const char* name;
  std::string (*text)(int rules);
};
constexpr Shape kShapes[] = {{"many components", large_robot},
                             {"few components", crowded_robot},
                             {"chained signals", chain},
                             {"names not declared", other_names},
                             {"long triggers", long_triggers}};

double check_time(const std::string& text, int runs) {
  const Source source("bench.rules", text);
  if (!check(source).rules) throw std::runtime_error("the rules of the benchmark have errors");
  return fastest(runs, [&] { benchmark::DoNotOptimize(check(source)); });
}

// Ten times the rules take about ten times as long; somewhat more where they leave the caches, and
// a hundred times where some pass compares all with all.
void check_linear(benchmark::State& state) {
  for (auto _ : state) {
    for (const Shape& shape : kShapes) {
      const double small = check_time(shape.text(1000), 5);
      const double large = check_time(shape.text(10'000), 3);
      claim(std::string("a rule among 10,000 beside one among 1,000, ") + shape.name,
            large / 10 / small, 3, "times");
    }
  }
}
BENCHMARK(check_linear)->Iterations(1)->Unit(benchmark::kSecond);

// As a user waits for it: the program starts, reads, checks, says ok.
void check_command(benchmark::State& state) {
  const World world;
  const std::string rules = world.write("large.rules", large_robot(10'000)).string();
  for (auto _ : state) {
    claim("culprit check of 10,000 rules with a component each",
          fastest_command(9, world, {"check", rules}), 150, "ms");
  }
}
BENCHMARK(check_command)->Iterations(1)->Unit(benchmark::kSecond);

// A keystroke in a file of 1,000 rules: the text before it, and the typed text.
struct Keystroke {
  const char* where;
  const char* behind;
  const char* typed;
};
constexpr Keystroke kKeystrokes[] = {
    {"a comment at the end", "ADAPTATION c999 redeploy 10\n", "# typed"},
    {"the number in a trigger", "s500 > 0.5", "1"},
    {"the name in a trigger", "TRIGGER s500", "x"},  // of a signal that is not declared then
    {"the trigger breaks", "s500 > 0.5 &&", "&"},    // and with it all is silent that is no mistake
    {"the first component's command", "LAUNCH \"run c", "x"},
    {"a range, on which triggers depend", "KEY k500 STALE 2s RANGE 0", ".1"},
};

// From the editor's message to the diagnostics: for a character that comes, and goes again.
void keystroke(benchmark::State& state) {
  bool is_published = false;
  lsp::LanguageServer server("", [&](const Json&) { is_published = true; });
  const std::string text = large_robot(1000);
  const auto message = [](const char* method, Json params) {
    return Json{{"jsonrpc", "2.0"}, {"method", method}, {"params", std::move(params)}};
  };
  server.handle(message("textDocument/didOpen",
                        {{"textDocument", {{"uri", "file:///x.rules"}, {"text", text}}}}));
  const auto time_of = [&](const std::string& changed) {
    const Json change =
        message("textDocument/didChange", {{"textDocument", {{"uri", "file:///x.rules"}}},
                                           {"contentChanges", {{{"text", changed}}}}});
    is_published = false;
    const double time = fastest(1, [&] { server.handle(change); });
    if (!is_published) throw std::runtime_error("no diagnostics came");
    return time;
  };
  for (auto _ : state) {
    for (const Keystroke& key : kKeystrokes) {
      const std::size_t place = text.find(key.behind);
      if (place == std::string::npos) throw std::runtime_error("the rules are others");
      std::string changed = text;
      changed.insert(place + std::string(key.behind).size(), key.typed);
      std::vector<double> times;
      for (int i = 0; i < 25; ++i) {
        times.push_back(time_of(changed));
        times.push_back(time_of(text));
      }
      claim(std::string("diagnostics after a keystroke in 1,000 rules, ") + key.where + ": median",
            quantile(times, 0.5), 10, "ms");
    }
  }
}
BENCHMARK(keystroke)->Iterations(1)->Unit(benchmark::kMillisecond);

// The SUNSET pipeline for a minute, with a camera that dies, a thousand times.
void rule_tests(benchmark::State& state) {
  const World world;
  std::string text = "RULES " CULPRIT_SUNSET_RULES R"(
COMPONENT camera        PUBLISHES /managed_subsystem/rgb_camera
COMPONENT depth         PUBLISHES /managed_subsystem/depth_camera
COMPONENT fusion        NEEDS camera depth  PUBLISHES /managed_subsystem/sensors_fused
COMPONENT segmentation  NEEDS fusion  PUBLISHES /managed_subsystem/segmentation
TOPIC /managed_subsystem/rgb_camera     0s: 10Hz
TOPIC /managed_subsystem/depth_camera   0s: 10Hz
TOPIC /managed_subsystem/sensors_fused  0s: 10Hz
TOPIC /managed_subsystem/segmentation   0s: 10Hz
)";
  for (int i = 0; i < 1000; ++i)
    text += "TEST \"" + std::to_string(i) +
            "\"\n  AT 5s camera KILLED\n  RUN 60s\n  EXPECT RGBDead RESOLVED WITH rgb_redeploy\n";
  const std::string tests = world.write("thousand.test", text).string();
  for (auto _ : state) {
    claim("culprit test of 1,000 tests of a minute each",
          fastest_command(5, world, {"test", tests}) / 1000, 1, "s");
  }
}
BENCHMARK(rule_tests)->Iterations(1)->Unit(benchmark::kSecond);

}  // namespace
}  // namespace culprit::bench

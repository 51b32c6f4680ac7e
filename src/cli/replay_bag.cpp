#include "cli/replay_bag.h"

#include <unistd.h>

#include <fmt/core.h>

#include "bag/bag_file.h"
#include "bag/bag_reading.h"
#include "base/environment.h"
#include "cli/commands.h"
#include "cli/journal_file.h"
#include "cli/load_rules.h"
#include "manager/manager.h"
#include "terminal/console.h"

namespace culprit::cli {
namespace {

// Steps a manager that only advises through the messages of a bag.
class BagRun {
 public:
  BagRun(const RuleSet& rules, const PlannerOptions& planner, Time start)
      : rules_(rules), start_(start), manager_(rules, planner.planner(), options(start)) {}

  void step(Time now, std::span<const Observation> observations) {
    // A recording may have gaps of hours; at most this many deadlines in one are stepped.
    constexpr int kMostDeadlines = 100'000;
    for (int i = 0; i < kMostDeadlines && manager_.next_deadline() < now; ++i) {
      manager_.step(manager_.next_deadline(), {});
      print();
    }
    manager_.step(now, observations);
    print();
  }

  int decisions() const { return decisions_; }

 private:
  static Manager::Options options(Time start) {
    Manager::Options options;
    options.autonomy = Autonomy::kAdvise;
    options.start = start;
    // A bag does not show nodes: none is absent because it was not seen.
    options.discovery = std::chrono::hours(24 * 365);
    return options;
  }

  void print() {
    for (const Event& event : manager_.events()) {
      decisions_ += std::holds_alternative<StrategyChosen>(event.what) ? 1 : 0;
      const std::string text = line(event, rules_, start_, colour_of(STDOUT_FILENO));
      if (!text.empty()) fmt::print("{}\n", text);
    }
  }

  const RuleSet& rules_;
  Time start_;
  Manager manager_;
  int decisions_ = 0;
};

}  // namespace

int replay_bag(const BagReplay& options) {
  const auto rules = load_rules(options.rules);
  if (rules == nullptr) return kFailed;
  auto bag = bag::BagFile::open(options.bag);
  if (!bag) return fail(bag.error());
  ros2::MessageLibrary library(
      ros2::message_directories(options.message_path, environment("AMENT_PREFIX_PATH")));
  bag::BagReading reading(*rules, bag->contents(), library);

  std::optional<BagRun> run;
  std::vector<Observation> observations;
  std::uint64_t messages = 0;
  for (bag::BagMessage message; bag->next(message); ++messages) {
    const Time now{Duration(message.at)};
    if (!run) run.emplace(*rules, options.planner, now);
    observations.clear();
    reading.read(message, observations);
    run->step(now, observations);
  }
  for (const std::string& each : reading.missing())
    fmt::print(stderr, "culprit: the bag does not have what the rules read: {}\n", each);
  const std::vector<std::string> losses = bag->contents().losses();
  for (const std::string& each : losses)
    fmt::print(stderr, "culprit: the bag is not whole: {}\n", each);
  const std::string late =
      bag->out_of_order() > 0 ? fmt::format(" ({} out of order)", bag->out_of_order()) : "";
  fmt::print("{} messages{}, {} decisions\n", messages, late, run ? run->decisions() : 0);
  return losses.empty() ? kOk : kFailed;
}

}  // namespace culprit::cli

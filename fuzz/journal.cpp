// Journal files: whatever their rows say, they are read to their end or refused. Steps that are
// read can be written again unchanged, and the manager can be stepped with them.
//
// The first line of the input is the kind of a row, the rest its body, which is read as the row
// would be. If it is `file`, the rest is the whole database; if it is `inheritance`, the state that
// another culprit hands over.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>

#include "journal/inheritance.h"
#include "journal/recovery.h"
#include "journal/requests.h"
#include "journal/step_codec.h"
#include "journal/verify.h"
#include "plan/bayes/bayes_planner.h"
#include "replay/replay.h"

namespace {

using namespace culprit;

const RuleSet& rules() {
  static const RuleSet set = *check(Source("fuzz.rules", R"(
COMPONENT camera NODE /camera LAUNCH "camera"
COMPONENT fusion NODE /fusion LAUNCH "fusion"
SIGNAL entropy DIAGNOSTIC segmentation KEY entropy STALE 2s
RULE Silent
  POLICIES ERROR
  TRIGGER age(/rgb) > 300ms || entropy > 0.5 || level(segmentation) > 1
    STRATEGY redeploy 50 10
      ADAPTATION camera redeploy 5
    STRATEGY tune 50 10 WHEN parameter(camera, gain) < 2
      ADAPTATION camera increase_parameter gain 0.5 5
)"))
                                  .rules;
  return set;
}

void read_steps(const std::string& body) {
  Manager manager(rules(), std::make_unique<BayesPlanner>(), {});
  journal::StepReader reader(body, rules());
  journal::Step step;
  std::string again;
  int steps = 0;
  for (auto more = reader.next(step); more && *more; more = reader.next(step)) {
    ++steps;
    journal::ByteWriter out(again);
    journal::encode(step.now, step.observations, step.digest, out);
    manager.step(step.now, step.observations);
  }
  journal::StepReader second(again, rules());
  for (int i = 0; i < steps; ++i) {
    const auto more = second.next(step);
    if (!more || !*more) __builtin_trap();
  }
}

void read_row(const std::string& body) {
  const Json json = parse_json(body);
  (void)journal::session_from_json(json);
  (void)journal::learned_from_json(json);
  (void)journal::command_from_json(json, rules());
  if (auto interrupted = journal::interrupted_from_json(json, rules())) {
    Manager manager(rules(), std::make_unique<BayesPlanner>(), {});
    manager.resume(std::move(*interrupted));
    for (int i = 0; i < 20; ++i) manager.step(Time(std::chrono::seconds(i)), {});
  }
}

// The state that a manager hands over to its successor. It can be handed over again, and a manager
// can begin with it.
void read_inheritance(const std::string& body) {
  const Time now(std::chrono::hours(1));
  const auto told = journal::inheritance_from_text(body, rules(), std::chrono::minutes(1), now);
  if (!told) return;
  const std::string again = journal::to_text(*told, rules(), body.size() * 2 + 4096);
  if (!again.empty() && !journal::inheritance_from_text(again, rules(), {}, now)) __builtin_trap();
  journal::Learned learned;
  journal::inherit(learned, told->learned);
  Manager manager(rules(), std::make_unique<BayesPlanner>(), {.start = now});
  replay::restore(manager, learned, rules());
  manager.remember(
      journal::still_counting(journal::joined(told->past, told->past, rules()), now, rules()));
  for (int i = 0; i < 20; ++i) manager.step(now + std::chrono::seconds(i), {});
}

// In a file with a name: SQLite opens no other.
void read_file(const std::string& bytes) {
  const std::string path = (std::filesystem::temp_directory_path() / "culprit-fuzz-").string() +
                           std::to_string(getpid()) + ".sqlite";
  std::ofstream(path, std::ios::binary) << bytes;
  if (const auto journal = journal::Reader::open(path)) {
    (void)journal::verify(*journal);
    (void)journal::recover(*journal, {}, rules(), {Time(std::chrono::hours(1)), 1});
    if (auto recording = replay::Recording::open(*journal))
      (void)replay::repeat(*recording, *journal, std::make_unique<BayesPlanner>(), {});
  }
  std::filesystem::remove(path);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const std::size_t line = text.find('\n');
  if (line == std::string::npos) return 0;
  const std::string kind = text.substr(0, line);
  const std::string body = text.substr(line + 1);
  if (kind == "file") {
    read_file(body);
  } else if (kind == journal::kind::kSteps) {
    read_steps(body);
  } else if (kind == "inheritance") {
    read_inheritance(body);
  } else {
    read_row(body);
  }
  return 0;
}

#include "demo/suave_demo_command.h"

#include <algorithm>
#include <unistd.h>

#include <fmt/core.h>

#include "base/text_file.h"
#include "demo/demo_setup.h"
#include "json/json.h"
#include "terminal/command.h"
#include "terminal/console.h"

namespace culprit::lab {
namespace {

Json to_json(const MissionOutcome& outcome, double speed) {
  const suave::MissionSeen& mission = outcome.mission;
  Json json{{"robot", "suave"},
            {"speed", speed},
            {"search_time_s", nullptr},
            {"distance_m", mission.inspected_m},
            {"mission_s", *mission.done_s},
            {"failures", outcome.failures},
            {"strategies", outcome.strategies},
            {"reaction_time_s", outcome.reaction_times},
            {"unresolved", outcome.unresolved}};
  if (mission.found_s) json["search_time_s"] = *mission.found_s;
  return json;
}

void print(const MissionOutcome& outcome, double speed) {
  const suave::MissionSeen& mission = outcome.mission;
  say(stdout, "\n  pipeline    {}\n",
      mission.found_s ? fmt::format("found after {:.1f} s", *mission.found_s) : "not found");
  say(stdout, "  inspected   {:.1f} m\n", mission.inspected_m);
  say(stdout, "  mission     {:.0f} s of robot time, {:.1f} s on the clock\n", *mission.done_s,
      *mission.done_s / speed);
  say(stdout, "  failures    {}, of which {} resolved\n", outcome.failures.size(),
      outcome.reaction_times.size());
  if (outcome.reaction_times.empty()) return;
  const auto longest =
      std::max_element(outcome.reaction_times.begin(), outcome.reaction_times.end());
  say(stdout, "  reaction    {:.2f} s on the clock at most, from detection to resolution\n",
      *longest);
}

}  // namespace

int demo_suave(SuaveDemo::Options options, const std::string& json) {
  StopSignals signals;
  const Colour colour = colour_of(STDOUT_FILENO);
  const double speed = options.speed;
  say(stdout, "Starting SUAVE: vehicle, search, follow, motion, recharge, mode manager, mission\n");
  options.on_event = [colour](const Event& event, const RuleSet& rules, Time start) {
    const std::string text = line(event, rules, start, colour);
    if (!text.empty()) say(stdout, "{}\n", text);
  };
  auto demo = SuaveDemo::start(std::move(options), signals.stopped());
  if (!demo) {
    say(stderr, "culprit: {}\n", demo.error());
    return kFailed;
  }
  say_domain("SUAVE", (*demo)->domain());
  const auto outcome = (*demo)->fly();
  if (!outcome) {
    say(stderr, "culprit: {}\n", outcome.error());
    return kFailed;
  }
  print(*outcome, speed);
  if (!json.empty()) {
    if (auto written = write_text(json, to_indented(to_json(*outcome, speed)) + "\n"); !written) {
      say(stderr, "culprit: {}\n", written.error());
      return kFailed;
    }
  }
  return outcome->mission.found_s ? kOk : kFailed;
}

}  // namespace culprit::lab

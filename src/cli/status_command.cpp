#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <memory>
#include <thread>
#include <unistd.h>

#include "base/name_grammar.h"
#include "cli/commands.h"
#include "cli/running_culprit.h"
#include "cli/status_report.h"
#include "terminal/console.h"

namespace culprit::cli {
namespace {

struct StatusOptions {
  WhichCulprit which;
  bool json = false;
  bool watch = false;
};

// Errors: it says who it is, and nothing more.
Expected<WhatCulpritSays> asked(const RunningCulprit& culprit) {
  WhatCulpritSays said;
  said.about = culprit.about;
  for (const auto& [path, document] :
       {std::pair("/api/robot", &said.robot), std::pair("/api/state", &said.state),
        std::pair("/api/control", &said.control)}) {
    auto answer = culprit.client.get(path, http::LocalClient::kLargeAnswer);
    if (!answer) return Error{answer.error()};
    *document = std::move(*answer);
  }
  if (auto events = culprit.client.get("/api/events", http::LocalClient::kLargeAnswer);
      events && events->is_array())
    said.events = events->get<std::vector<Json>>();
  return said;
}

int status(const StatusOptions& options) {
  constexpr std::size_t kEvents = 6;
  auto found = culprits_here(options.which);
  if (!found) return fail(found.error(), kUsage);
  CulpritsHere& here = *found;
  const bool are_all_known = !here.answering.empty() && here.others.empty();
  Verdict worst = are_all_known ? Verdict::kWell : Verdict::kNotWell;
  Json list = Json::array();
  for (const RunningCulprit& culprit : here.answering) {
    const auto said = asked(culprit);
    if (!said) {
      here.others.push_back(culprit.name() + " does not say how the robot is: " + said.error());
      worst = Verdict::kNotWell;
      continue;
    }
    worst = std::max(worst, verdict_of(*said));
    list.push_back({{"about", said->about},
                    {"well", verdict_of(*said) == Verdict::kWell},
                    {"control", said->control},
                    {"state", said->state}});
    if (options.json) continue;
    const Colour colour = colour_of(STDOUT_FILENO);
    for (const auto& lines : {situation_lines(*said, colour),
                              event_lines(*said, kEvents, colour),
                              about_lines(*said),
                              {""}}) {
      for (const std::string& line : lines) say(stdout, "{}\n", line);
    }
  }
  if (options.json) {
    say(stdout, "{}\n",
        to_line({{"culprits", list}, {"others", here.others}, {"not_meant", here.not_meant}}));
  } else if (here.answering.empty()) {
    return fail(none_to_ask(here));
  } else {
    for (const auto* others : {&here.others, &here.not_meant}) {
      for (const std::string& other : *others) say(stdout, "{}\n", escape_controls(other));
    }
  }
  return worst == Verdict::kWell ? kOk : worst == Verdict::kSeesLess ? kWarnings : kFailed;
}

// Until Ctrl-C: over and over in one place on a terminal, one report below the other elsewhere.
int watch_status(const StatusOptions& options) {
  constexpr auto kPeriod = std::chrono::seconds(2);
  const bool is_screen = isatty(STDOUT_FILENO) == 1 && !options.json;
  constexpr auto kTick = std::chrono::milliseconds(100);
  StopSignals signals;
  std::atomic<bool> is_stopped = false;
  signals.on_stop([&] { is_stopped = true; });
  for (;;) {
    constexpr const char* kClear = "\033[H\033[2J";
    if (is_screen) say_text(stdout, kClear);
    const int verdict = status(options);
    for (Duration waited{}; waited < kPeriod; waited += kTick) {
      if (is_stopped) return verdict;
      std::this_thread::sleep_for(kTick);
    }
    if (std::ferror(stdout) != 0) return kFailed;  // nobody reads it
  }
}

}  // namespace

void add_status(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<StatusOptions>();
  CLI::App* command =
      app.add_subcommand("status",
                         "Show failures, their root cause and the next step, as reported by the "
                         "culprits of this machine.\n"
                         "Exits with 0 if all is well. Exits with 3 if no failure is seen, but a "
                         "rule that is not ERROR is blind, a component is not there, or simulated "
                         "time stands still. Exits with 1 in all other cases.");
  command->add_flag("--json", options->json, "As one JSON document (docs/web.md)");
  command->add_flag("--watch", options->watch, "Report again every 2 s until Ctrl-C");
  options->which.add_to(*command);
  options->which.add_all_to(*command);
  command->callback([options, &exit_code] {
    exit_code = options->watch ? watch_status(*options) : status(*options);
  });
}

}  // namespace culprit::cli

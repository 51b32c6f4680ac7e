#include <atomic>
#include <chrono>
#include <memory>
#include <thread>
#include <unistd.h>

#include <fmt/core.h>

#include "base/live_clock.h"
#include "base/mutex.h"
#include "cli/commands.h"
#include "cli/give_order.h"
#include "cli/status_report.h"
#include "cli/terminal_screen.h"
#include "terminal/console.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;

// A stream says something each second at least (web/event_stream.h).
constexpr Duration kSilenceAtMost = 3s;
constexpr std::size_t kEventsKept = 200;

// Follows what a running culprit says, on a thread of its own, and goes on trying when it falls silent.
class Follower {
 public:
  Follower(http::LocalClient client, Json about) : client_(std::move(client)) {
    said_.about = std::move(about);
    thread_ = std::thread([this] { follow(); });
  }
  ~Follower() {
    is_over_ = true;
    thread_.join();
  }

  struct Now {
    WhatCulpritSays said;
    std::string trouble;  // why nothing new comes; empty: it does
    Duration old{};       // since it said something
  };
  Now now() const {
    const MutexLock lock(mutex_);
    return {said_, trouble_, live_now() - heard_};
  }

 private:
  void follow() {
    while (!is_over_) {
      const auto ended = client_.follow([this](std::string_view kind, Json document) {
        take(kind, std::move(document));
        return !is_over_;
      });
      {
        const MutexLock lock(mutex_);
        trouble_ = ended ? "it has ended" : ended.error();
      }
      if (!is_over_) std::this_thread::sleep_for(200ms);
    }
  }

  void take(std::string_view kind, Json document) {
    const MutexLock lock(mutex_);
    heard_ = live_now();
    trouble_.clear();
    if (kind == "hello") said_.events.clear();
    if (kind == "robot") said_.state = nullptr;  // its lists are in the order of the rules before
    if (kind == "robot")
      said_.robot = std::move(document);
    else if (kind == "state")
      said_.state = std::move(document);
    else if (kind == "control")
      said_.control = std::move(document);
    else if (kind == "event")
      said_.events.push_back(std::move(document));
    if (said_.events.size() > 2 * kEventsKept)
      said_.events.erase(said_.events.begin(), said_.events.end() - kEventsKept);
  }

  const http::LocalClient client_;
  std::atomic<bool> is_over_ = false;
  mutable Mutex mutex_;
  WhatCulpritSays said_ CULPRIT_GUARDED_BY(mutex_);
  std::string trouble_ CULPRIT_GUARDED_BY(mutex_);
  Time heard_ CULPRIT_GUARDED_BY(mutex_) = live_now();
  std::thread thread_;
};

std::vector<std::string> screen(const Follower::Now& now, const std::string& note,
                                std::size_t rows) {
  const Colour colour = colour_of(STDOUT_FILENO);
  std::vector<std::string> lines;
  if (!now.trouble.empty() || now.old > kSilenceAtMost)
    lines.push_back(fmt::format("OLD: no data for {:.0f} s: {}", seconds(now.old),
                                now.trouble.empty() ? "it does not answer" : now.trouble));
  const auto add = [&](const std::vector<std::string>& more) {
    lines.insert(lines.end(), more.begin(), more.end());
  };
  add(situation_lines(now.said, colour));
  const std::vector<std::string> about = about_lines(now.said);
  lines.emplace_back();
  // Components have half of what is left, events the rest.
  const std::size_t taken = lines.size() + about.size() + 3;
  const std::size_t left = rows > taken ? rows - taken : 0;
  std::vector<std::string> components = component_lines(now.said, colour);
  const std::vector<std::string> events = event_lines(now.said, left, colour);
  const std::size_t most = std::max(left / 2, left - std::min(left, events.size()));
  if (components.size() > most && most > 0) {
    const std::size_t more = components.size() - most + 1;
    components.resize(most - 1);
    components.push_back(fmt::format("  and {} more", more));
  }
  add(components);
  lines.emplace_back();
  const std::size_t rest = left - std::min(left, components.size());
  add(event_lines(now.said, rest, colour));
  add(about);
  lines.push_back("q ends, p pauses culprit" + (note.empty() ? "" : "; " + note));
  return lines;
}

int top(const WhichCulprit& which) {
  if (isatty(STDIN_FILENO) == 0 || isatty(STDOUT_FILENO) == 0)
    return fail("top needs a terminal; culprit status --json is for programs", kUsage);
  const auto culprit = the_culprit(which);
  if (!culprit) return fail(culprit.error());
  StopSignals signals;
  Follower follower(culprit->client.with_patience(kSilenceAtMost), culprit->about);
  TerminalScreen terminal;
  std::string note;
  while (!signals.stopped()) {
    terminal.draw(screen(follower.now(), note, TerminalScreen::size().rows));
    constexpr int kRedraw = 250;  // ms
    const char key = terminal.key(kRedraw);
    if (key == 'q') break;
    if (key == 'p') note = give(*culprit, {{"order", "pause"}}, "").text;
  }
  return kOk;
}

}  // namespace

void add_top(CLI::App& app, int& exit_code) {
  auto which = std::make_shared<WhichCulprit>();
  CLI::App* command =
      app.add_subcommand("top", "Watch the robot and its culprit at a terminal, live");
  which->add_to(*command);
  command->callback([which, &exit_code] { exit_code = top(*which); });
}

}  // namespace culprit::cli

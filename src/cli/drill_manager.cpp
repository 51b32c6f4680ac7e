#include "cli/drill_manager.h"

#include <csignal>
#include <sys/wait.h>

#include "base/environment.h"
#include "base/live_clock.h"
#include "journal/json.h"
#include "live/announcements.h"
#include "owners/piped_program.h"
#include "owners/proc.h"
#include "owners/process_tree.h"
#include "owners/spawn.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;

bool runs(const drill::ProcessId& process) {
  return owners::start_ticks_of(process.pid) == process.ticks &&
         owners::state_letter(process.pid).value_or('Z') != 'Z';
}

std::string last_words(const std::filesystem::path& log) {
  const auto text = read_text(log.string());
  return text ? owners::last_line(*text) : "";
}

}  // namespace

double drill_clock() { return static_cast<double>(wall_now()) / 1e9; }

void end_manager(const drill::ProcessId& process) {
  if (process.pid == 0) return;
  const auto held = owners::hold(process.pid, process.ticks);
  for (const auto& [signal, patience] : {std::pair(SIGINT, 5s), std::pair(SIGKILL, 2s)}) {
    if (!held || !runs(process)) break;
    owners::send_signal(held, signal);
    for (const Time end = live_now() + patience; runs(process) && live_now() < end;)
      std::this_thread::sleep_for(20ms);
  }
  waitpid(process.pid, nullptr, WNOHANG);
}

Expected<std::unique_ptr<DrillManager>> DrillManager::start(
    const std::vector<std::string>& arguments, const std::filesystem::path& log,
    const std::atomic<bool>& stop, const Note& note) {
  owners::Program program;
  program.arguments = {(own_folder() / "culprit").string()};
  program.arguments.insert(program.arguments.end(), arguments.begin(), arguments.end());
  program.log = log;
  const auto pid = owners::spawn(program);
  if (!pid) return Error{pid.error()};
  const drill::ProcessId process{*pid, owners::start_ticks_of(*pid).value_or(0)};
  if (auto noted = note(process); !noted) {
    end_manager(process);
    return Error{noted.error()};
  }
  std::string why = "it does not answer";
  for (const Time end = live_now() + 60s; live_now() < end && !stop && runs(process);) {
    WhichCulprit which;
    auto here = culprits_here(which);
    if (!here) return Error{here.error()};
    for (RunningCulprit& each : here->answering) {
      if (each.process == *pid)
        return std::unique_ptr<DrillManager>(new DrillManager(process, std::move(each)));
    }
    std::this_thread::sleep_for(100ms);
  }
  if (!runs(process)) why = last_words(log);
  end_manager(process);
  return Error{"the culprit of this drill cannot be started: " + why + " (" + log.string() + ")"};
}

DrillManager::DrillManager(drill::ProcessId process, RunningCulprit culprit)
    : process_(process), culprit_(std::move(culprit)), thread_([this] { follow(); }) {}

DrillManager::~DrillManager() {
  is_over_ = true;
  if (!is_left_) end_manager(process_);
  thread_.join();
}

void DrillManager::follow() {
  while (!is_over_ && runs(process_)) {
    (void)culprit_.client.with_patience(3s).follow([this](std::string_view kind, Json document) {
      const MutexLock lock(mutex_);
      told_ = live_now();
      if (kind == "robot") robot_ = std::move(document);
      if (kind == "graph") graph_ = std::move(document);
      if (kind == "state") state_ = std::move(document);
      if (kind == "control") control_ = std::move(document);
      if (kind == "event") add_event(std::move(document));
      return !is_over_;
    });
    if (!is_over_) std::this_thread::sleep_for(50ms);
  }
}

void DrillManager::add_event(Json event) {
  const std::string type = journal::text_of(event, "type");
  if (type == "failure_detected") detected_.insert(journal::text_of(event, "rule"));
  has_reloaded_ |= type == live::announcements::kReloaded.name;
  // After a break the events that are known come again.
  if (events_.empty() ||
      journal::number_of(event, "clock") >= journal::number_of(events_.back(), "clock"))
    events_.push_back(std::move(event));
}

bool DrillManager::has_detected(const std::string& rule) const {
  const MutexLock lock(mutex_);
  return detected_.contains(rule);
}

bool DrillManager::has_reloaded() const {
  const MutexLock lock(mutex_);
  return has_reloaded_;
}

bool DrillManager::is_running() const { return runs(process_); }

std::string DrillManager::why_it_does_not_act() const {
  const MutexLock lock(mutex_);
  if (journal::flag_of(control_, "paused")) return "culprit is paused; culprit resume ends that";
  if (journal::flag_of(control_, "dry_run")) return "culprit is on a dry run";
  return "";
}

bool DrillManager::is_answering() const {
  const MutexLock lock(mutex_);
  return runs(process_) && (told_ == kLongAgo || live_now() < told_ + 3s);
}

drill::RobotView DrillManager::view() const {
  const MutexLock lock(mutex_);
  return {robot_, graph_, state_};
}

std::vector<Json> DrillManager::events_since(double clock) const {
  const MutexLock lock(mutex_);
  std::vector<Json> out;
  for (const Json& each : events_)
    if (journal::number_of(each, "clock") >= clock) out.push_back(each);
  return out;
}

}  // namespace culprit::cli

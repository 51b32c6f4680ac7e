#include "cli/drill_session.h"

#include <algorithm>
#include <thread>

#include "base/joined.h"
#include "base/live_clock.h"
#include "base/text_file.h"
#include "journal/json.h"
#include "owners/proc.h"

namespace culprit::cli {
namespace {

using namespace std::chrono_literals;
using drill::Fault;
using drill::FaultKind;
using drill::Injected;
using drill::RobotView;
using drill::Trial;

constexpr Duration kLook = 50ms;
constexpr Duration kNotices = 5s;  // a rule that has not fired by then does not notice the fault
constexpr Duration kStarved = 1s;  // a look that comes so late proves nothing
constexpr Duration kHears = 3s;    // after that, until culprit must have been heard again
constexpr const char* kNoAnswer = "the culprit of this drill does not answer";

std::string boot_id() {
  const auto text = read_text("/proc/sys/kernel/random/boot_id");
  return text ? text->substr(0, text->find('\n')) : "";
}

bool ends_at_once(const Fault& fault) { return fault.kind == FaultKind::kRestart; }

// It takes no time. Other faults wait for a node, or for the firewall.
bool is_signal(const Fault& fault) {
  return fault.kind == FaultKind::kKill || fault.kind == FaultKind::kHang ||
         fault.kind == FaultKind::kSlow;
}

// A deactivated node that no rule is about is not well either.
std::vector<std::string> complaints_of(const RobotView& view, const RobotView& before,
                                       const std::vector<Fault>& faults) {
  std::vector<std::string> all = view.complaints(&before);
  const auto components = view.components();
  for (const Fault& fault : faults) {
    const auto found = components.find(fault.component);
    if (fault.kind == FaultKind::kDeactivate && found != components.end() &&
        found->second.lifecycle != "active")
      all.push_back(fault.component + " is " + found->second.lifecycle);
  }
  return all;
}

bool is_noticed(const std::vector<Json>& events) {
  return std::ranges::any_of(events, [](const Json& event) {
    return journal::text_of(event, "type") == "failure_detected" && !drill::is_of_own_rule(event);
  });
}

}  // namespace

Expected<std::unique_ptr<DrillSession>> DrillSession::begin(Options options, Say say,
                                                            const std::atomic<bool>& stop) {
  std::unique_ptr<DrillSession> session(new DrillSession(std::move(options), std::move(say), stop));
  if (auto locked = session->lock(); !locked) return Error{locked.error()};
  auto node = DrillNode::join();
  if (!node) return Error{node.error()};
  session->node_ = std::move(*node);
  session->injector_ = std::make_unique<DrillInjector>(*session->node_);
  if (auto undone = session->undo_what_is_left(); !undone) return Error{undone.error()};
  const auto here = culprits_here({});
  if (!here) return Error{here.error()};
  if (!here->answering.empty())
    return Error{here->answering.front().name() +
                 " manages a robot on this domain; end it first: a drill starts its own"};
  auto manager =
      DrillManager::start(session->options_.manager, session->options_.log, session->stop_,
                          [&](const drill::ProcessId& process) -> Expected<void> {
                            session->healer_ = process;
                            if (auto noted = session->note({}); !noted)
                              return Error{"nothing is injected: " + noted.error()};
                            return {};
                          });
  if (!manager) {
    if (session->left_.empty()) (void)drill::forget_injected(session->options_.injected);
    return Error{manager.error()};
  }
  session->manager_ = std::move(*manager);
  if (auto well = session->wait_until_well(Until::kWellOrTold); !well) return Error{well.error()};
  if (auto undone = session->undo_what_is_left_now(); !undone) return Error{undone.error()};
  session->healthy_ = session->manager_->view();
  session->usual_ =
      session->healthy_->healthy(session->node_->publishers_of(session->healthy_->topics()));
  return session;
}

Expected<void> DrillSession::lock() {
  const std::string path = options_.injected.string() + "-lock";
  std::error_code error;
  std::filesystem::create_directories(options_.injected.parent_path(), error);
  auto taken = journal::FileLock::take(path);
  if (!taken) return Error{"cannot make '" + path + "': " + taken.error()};
  if (!*taken) return Error{"another drill of this robot runs; nothing is injected"};
  lock_ = std::move(*taken);
  return {};
}

Expected<void> DrillSession::undo_what_is_left() {
  const auto left = drill::read_injected(options_.injected);
  if (!left) return Error{left.error() + "; restore the healthy robot, then remove this file"};
  if (!*left) return {};
  const bool is_same_boot = (*left)->boot == boot_id();
  if (is_same_boot) end_manager((*left)->manager);
  for (const Injected& each : (*left)->faults) {
    if (drill::acts_on_process(each.fault.kind) && !is_same_boot) continue;
    const auto undone = injector_->undo(each);
    if (!undone)
      left_.push_back(each);
    else if (*undone)
      say_("undone, left by an earlier drill: " + to_string(each.fault));
  }
  return {};
}

Expected<void> DrillSession::undo_what_is_left_now() {
  if (left_.empty()) return {};
  undo_all(left_);
  if (left_.empty()) return note({});
  return Error{"left by an earlier drill, and cannot be undone: " + to_string(left_.front().fault) +
               "; restore the healthy robot, then remove '" + options_.injected.string() + "'"};
}

Expected<void> DrillSession::note(std::vector<Injected> injected) const {
  injected.insert(injected.end(), left_.begin(), left_.end());
  return drill::write_injected(options_.injected, {boot_id(), healer_, std::move(injected)});
}

DrillSession::~DrillSession() {
  if (!manager_ || (options_.heals && !heal())) return;
  undo(left_);
  manager_.reset();
  if (!left_.empty()) {
    say_(to_string(left_.front().fault) + " is not undone; the next drill tries again");
    return;
  }
  if (auto forgotten = drill::forget_injected(options_.injected); !forgotten)
    say_(forgotten.error());
}

bool DrillSession::heal() {
  if (is_culprit_lost()) {
    static const std::atomic<bool> kNeverStopped = false;
    say_("the culprit of this drill exited or hangs; another one heals the robot");
    manager_.reset();
    // On a full disk the next drill finds it by its socket, and says so.
    auto next = DrillManager::start(options_.manager, options_.log, kNeverStopped,
                                    [&](const drill::ProcessId& process) {
                                      healer_ = process;
                                      (void)note({});
                                      return Expected<void>();
                                    });
    if (!next) {
      say_(next.error() + "; restore the healthy robot");
      return false;
    }
    manager_ = std::move(*next);
    calm_.reset();
  }
  if (auto well = wait_until_well(Until::kWell); !well) {
    say_(well.error() + "; culprit goes on and heals it: process " +
         std::to_string(manager_->process().pid));
    manager_->leave();
    return false;
  }
  return true;
}

std::string DrillSession::why_to_end() {
  if (stop_) return "interrupted";
  if (!aborted_.empty()) return aborted_;
  if (is_culprit_lost()) return kNoAnswer;
  const RobotView view = manager_->view();
  for (const Condition& each : options_.aborts)
    if (view.trigger(each.rule).value_or(false) || manager_->has_detected(each.rule))
      aborted_ = "ABORT " + each.text + " is true";
  if (manager_->has_reloaded()) aborted_ = "the rules were reloaded";
  return aborted_;
}

bool DrillSession::is_culprit_lost() const {
  // A drill that stood still itself received nothing.
  const bool may_hear = live_now() >= later(stood_still_, kHears);
  return !manager_->is_running() || (may_hear && !manager_->is_answering());
}

std::string DrillSession::blind_abort() const {
  const RobotView view = manager_->view();
  for (const Condition& each : options_.aborts)
    if (!view.trigger(each.rule))
      return "ABORT " + each.text + " is unknown: a topic or node that it reads is not seen";
  return "";
}

void DrillSession::next_look() {
  const Time before = live_now();
  std::this_thread::sleep_for(kLook);
  if (live_now() - before >= kStarved) stood_still_ = live_now();
}

Expected<void> DrillSession::wait_until_well(Until until) {
  std::vector<std::string> complaints;
  for (const Time end = live_now() + options_.patience; live_now() < end;) {
    if (const std::string why = why_to_end(); !why.empty() && until == Until::kWellOrTold)
      return Error{why};
    complaints = manager_->view().complaints(healthy_ ? &*healthy_ : nullptr);
    // Its last word may be that all is well.
    if (!manager_->is_answering()) complaints = {kNoAnswer};
    if (!complaints.empty()) calm_.reset();
    if (complaints.empty() && !calm_) calm_ = live_now();
    if (calm_ && live_now() - *calm_ >= drill::kCalm) return {};
    next_look();
  }
  return Error{"the robot is not healthy: " + joined(complaints)};
}

Expected<void> DrillSession::may_inject() const {
  if (const std::string why = manager_->why_it_does_not_act(); !why.empty()) return Error{why};
  const RobotView view = manager_->view();
  for (const Condition& each : options_.interlocks)
    if (view.trigger(each.rule).value_or(true))
      return Error{"INTERLOCK " + each.text + " does not hold, or is unknown"};
  if (const std::string blind = blind_abort(); !blind.empty()) return Error{blind};
  return {};
}

Expected<std::vector<Injected>> DrillSession::prepare(const std::vector<Fault>& faults) {
  const auto components = manager_->view().components();
  std::vector<Injected> out;
  for (const Fault& fault : faults) {
    const auto found = components.find(fault.component);
    if (found == components.end()) return Error{fault.component + " is not known"};
    if (!found->second.is_alive) return Error{fault.component + " is not there"};
    if (!drill::acts_on_process(fault.kind) && fault.kind != FaultKind::kSetParameter &&
        found->second.lifecycle != "active")
      return Error{fault.component + " is no active lifecycle node"};
    for (const auto& [name, other] : components)
      if (drill::acts_on_process(fault.kind) && name != fault.component && other.pid != 0 &&
          other.pid == found->second.pid)
        return Error{fault.component + " shares its process with " + name};
    auto prepared = injector_->prepare(fault, found->second.node, found->second.pid);
    if (!prepared) return Error{prepared.error()};
    out.push_back(std::move(*prepared));
  }
  return out;
}

bool DrillSession::undo(std::vector<Injected>& injected) {
  bool is_undone = false;
  std::erase_if(injected, [&](const Injected& each) {
    const auto undone = injector_->undo(each);
    is_undone |= undone && *undone;
    return undone.has_value();
  });
  return is_undone;
}

bool DrillSession::undo_all(std::vector<Injected>& injected) {
  bool is_undone = undo(injected);
  for (const Time end = live_now() + options_.patience; !injected.empty() && live_now() < end;) {
    next_look();
    is_undone |= undo(injected);
  }
  return is_undone;
}

// `announced`: just before the first fault.
void DrillSession::watch_reaction(Trial& trial, std::vector<Injected>& injected, Time announced) {
  const RobotView before = *healthy_;
  const bool has_lasting =
      std::ranges::any_of(trial.faults, [](const Fault& each) { return drill::lasts(each.kind); });
  // The clock on the wall may be set meanwhile: it dates what is written, and measures nothing.
  const Time begin = live_now();
  if (std::ranges::all_of(trial.faults, is_signal) && begin - announced >= kStarved)
    stood_still_ = begin;
  std::optional<std::pair<Time, double>> calm;
  bool is_over = std::ranges::all_of(trial.faults, ends_at_once);
  const auto undo_now = [&] {
    if (undo(injected)) trial.undone = drill_clock();
    is_over = true;
  };
  for (double after = 0; after < seconds(options_.patience); after = seconds(live_now() - begin)) {
    next_look();
    const RobotView view = manager_->view();
    for (const std::string& each : view.silent(usual_))
      trial.silent.try_emplace(each, drill_clock());
    trial.trouble = why_to_end();
    if (trial.trouble.empty()) trial.trouble = aborted_ = manager_->why_it_does_not_act();
    // The fault hides what the condition reads, so nobody would see the danger.
    if (trial.trouble.empty()) trial.trouble = aborted_ = blind_abort();
    if (!trial.trouble.empty()) return undo_now();
    const bool noticed = is_noticed(manager_->events_since(trial.injected));
    // The guard lets a stopped process go on by itself. Others stay broken for half of the time that culprit has.
    const Duration until = has_lasting ? options_.hang
                           : noticed   ? options_.patience / 2
                                       : options_.hang + kNotices;
    if (!is_over && after > seconds(until)) undo_now();
    const bool is_well = complaints_of(view, before, trial.faults).empty();
    if (!is_well) calm.reset();
    if (is_well && !calm) calm.emplace(live_now(), drill_clock());
    const bool was_awaited = noticed || is_over || after > seconds(kNotices);
    if (calm && was_awaited && live_now() - calm->first >= drill::kCalm) {
      trial.well = calm->second;
      calm_ = calm->first;
      break;
    }
  }
  if (stood_still_ >= begin) trial.trouble = "the drill itself stood still meanwhile";
}

void DrillSession::inject(const std::vector<Injected>& injected, Trial& trial) {
  trial.injected = drill_clock();
  calm_.reset();
  for (const Injected& each : injected) {
    say_("injects " + to_string(each.fault));
    if (ends_at_once(each.fault)) trial.undone = drill_clock();
    const auto done = injector_->inject(each, options_.hang);
    if (done) continue;
    trial.trouble = done.error();
    return;
  }
}

Expected<Trial> DrillSession::run(const drill::Step& step) {
  if (auto well = wait_until_well(Until::kWellOrTold); !well) return Error{well.error()};
  Trial trial{step.faults, step.round};
  auto injected = prepare(step.faults);
  if (!injected) {
    trial.trouble = injected.error();
    return trial;
  }
  if (auto noted = note(*injected); !noted) return Error{"nothing is injected: " + noted.error()};
  // A late node or a slow disk may have taken seconds, in which the robot changed.
  auto may = wait_until_well(Until::kWellOrTold);
  if (may) may = may_inject();
  if (!may) {
    (void)note({});
    return Error{may.error()};
  }
  const Time announced = live_now();
  inject(*injected, trial);
  if (trial.trouble.empty()) watch_reaction(trial, *injected, announced);
  if (undo_all(*injected)) {
    calm_.reset();
    // The remedy may be a fault by itself now (an enhancement of a good picture), and has to be undone, too.
    if (trial.well) {
      trial.restored = drill_clock();
      (void)wait_until_well(Until::kWellOrTold);
    }
  }
  trial.end = drill_clock();
  for (Json event : manager_->events_since(trial.injected)) {
    event.erase("candidates");
    trial.events.push_back(std::move(event));
  }
  left_.insert(left_.end(), injected->begin(), injected->end());
  if (!left_.empty()) return Error{to_string(left_.front().fault) + " cannot be undone now"};
  // If the disk is full meanwhile, the record stays as it was: undoing twice harms nothing.
  (void)note({});
  return trial;
}

bool DrillSession::watch(Duration time) {
  for (const Time end = live_now() + time; live_now() < end;) {
    if (!why_to_end().empty()) return false;
    next_look();
  }
  return true;
}

}  // namespace culprit::cli

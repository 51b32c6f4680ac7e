#include "managers/scripted_manager.h"

#include <algorithm>
#include <utility>

namespace culprit::study {

ScriptedManager::ScriptedManager(const RuleSet& names, std::uint64_t seed)
    : names_(names), random_(seed) {}

std::vector<Command> ScriptedManager::step(Time now, std::span<const Observation> observations) {
  for (; begun_ < threads_.size(); ++begun_) threads_[begun_].begin();
  for (const Observation& observation : observations) {
    now_ = std::max(now_, std::min(observation.at, now));
    observe(observation);
    resume_all();
  }
  now_ = std::max(now_, now);
  resume_all();
  return std::exchange(commands_, {});
}

void ScriptedManager::observe(const Observation& observation) {
  if (const auto* reply = std::get_if<Reply>(&observation.what)) {
    const auto asker = asking_.find(reply->command);
    if (asker == asking_.end()) return;
    asker->second.answer->reply = *reply;
    ready_.push_back(asker->second.thread);
    asking_.erase(asker);
  } else if (const auto* read = std::get_if<SignalRead>(&observation.what)) {
    const std::string& name = names_[read->signal].name;
    latest_[name] = read->value;
    on_signal(name, read->value);
    ring(news_);
  }
}

// Resumes every waiting routine that can go on, in the order in which it became ready.
void ScriptedManager::resume_all() {
  for (;;) {
    if (!ready_.empty()) {
      const auto thread = ready_.front();
      ready_.pop_front();
      thread.resume();
      continue;
    }
    const auto due = std::find_if(sleepers_.begin(), sleepers_.end(),
                                  [this](const Sleeper& s) { return s.until <= now_; });
    if (due == sleepers_.end()) return;
    ready_.push_back(due->thread);
    sleepers_.erase(due);
  }
}

Time ScriptedManager::next_deadline() const {
  if (begun_ < threads_.size()) return kLongAgo;
  Time next = kNever;
  for (const Sleeper& sleeper : sleepers_) next = std::min(next, sleeper.until);
  return next;
}

const Value* ScriptedManager::latest(const std::string& signal) const {
  const auto found = latest_.find(signal);
  return found == latest_.end() ? nullptr : &found->second;
}

double ScriptedManager::number(const std::string& signal, double otherwise) const {
  const Value* value = latest(signal);
  const auto* known = value == nullptr ? nullptr : std::get_if<double>(value);
  return known == nullptr ? otherwise : *known;
}

bool ScriptedManager::is_true(const std::string& signal) const {
  const Value* value = latest(signal);
  return value != nullptr && *value == Value(true);
}

void ScriptedManager::Sleep::await_suspend(std::coroutine_handle<> thread) const {
  manager.sleepers_.push_back({later(manager.now_, time), thread});
}

void ScriptedManager::ring(Bell& bell) {
  for (const auto thread : std::exchange(bell.waiting, {})) ready_.push_back(thread);
}

ScriptedManager::Answer ScriptedManager::ask(const std::string& component, Request what,
                                             Duration timeout) {
  const auto known = std::find_if(names_.components.begin(), names_.components.end(),
                                  [&](const Component& c) { return c.name == component; });
  const CommandId id{++last_command_};
  commands_.push_back({id, ComponentId(static_cast<std::size_t>(known - names_.components.begin())),
                       std::move(what), timeout});
  return {*this, id, {}};
}

void ScriptedManager::Answer::await_suspend(std::coroutine_handle<> thread) {
  manager.asking_.emplace(command, Asker{this, thread});
}

void ScriptedManager::leave(Gate& gate) {
  gate.is_taken = false;
  if (gate.waiting.empty()) return;
  gate.is_taken = true;
  ready_.push_back(gate.waiting.front());
  gate.waiting.pop_front();
}

}  // namespace culprit::study

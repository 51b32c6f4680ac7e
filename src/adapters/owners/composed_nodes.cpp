#include "owners/composed_nodes.h"

#include <algorithm>
#include <system_error>

#include "base/invariant.h"
#include "base/live_clock.h"
#include "owners/proc.h"

namespace culprit::owners {
namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t kFirstRequest = std::uint64_t{1} << 62;  // the manager's begin at 1
// Until a container's owner answers: longer than any of them takes.
constexpr Duration kOwner = 15s;

bool has_process(int pid) { return pid != 0 && state_letter(pid).value_or('Z') != 'Z'; }

std::vector<std::uint64_t> ids_of(const std::string& node, const ContainerAnswer& list) {
  std::vector<std::uint64_t> ids;
  for (const LoadedNode& each : list.nodes) {
    if (each.name == node) ids.push_back(each.id);
  }
  return ids;
}

}  // namespace

ComposedNodes::ComposedNodes(const RuleSet& rules, const std::vector<ComponentId>& order,
                             ContainerServices& services, ContainerOwner owner, Inbox& inbox)
    : rules_(rules), services_(services), owner_(std::move(owner)), inbox_(inbox) {
  for (const ComponentId part : order) {
    if (!rules_[part].composed) continue;
    const std::string& node = rules_[part].composed->container;
    auto at = std::find_if(containers_.begin(), containers_.end(),
                           [&](const auto& each) { return each->node == node; });
    if (at == containers_.end()) {
      containers_.push_back(std::make_unique<Container>(Container{node, {}, {}}));
      at = containers_.end() - 1;
      for (const ComponentId c : order) {
        if (rules_[c].node != node) continue;
        (*at)->component = c;
        container_of_[c] = at->get();
      }
    }
    (*at)->parts.push_back(part);
    container_of_[part] = at->get();
  }
  try {
    for (const auto& each : containers_)
      each->thread = std::thread([this, &container = *each] { run(container); });
  } catch (const std::system_error&) {
    end();
    throw;
  }
}

ComposedNodes::~ComposedNodes() { end(); }

void ComposedNodes::end() {
  {
    const MutexLock lock(mutex_);
    is_ending_ = true;
  }
  if (!containers_.empty()) services_.interrupt();
  something_came_.notify_all();
  for (const auto& each : containers_) {
    if (each->thread.joinable()) each->thread.join();
  }
}

bool ComposedNodes::is_responsible_for(ComponentId component) const {
  return container_of_.contains(component);
}

void ComposedNodes::start(CommandId command, ComponentId component, Duration patience) {
  put({command, component, Errand::Kind::kStart, patience});
}

void ComposedNodes::stop(CommandId command, ComponentId component, int pid, Ending ending,
                         Hangs hangs) {
  put({command, component, Errand::Kind::kStop, {}, pid, ending, hangs});
}

void ComposedNodes::put(Errand errand) {
  {
    const MutexLock lock(mutex_);
    container_of_.at(errand.component)->errands.push_back(errand);
  }
  something_came_.notify_all();
}

void ComposedNodes::reply(CommandId command, const Answer& answer) {
  Reply reply{command, answer.outcome, {}, answer.text};
  if (answer.pid != 0) reply.value = Value(std::int64_t{answer.pid});
  inbox_.put(std::move(reply));
}

// ---- what is observed

void ComposedNodes::observe(const Observation& observation) {
  if (containers_.empty()) return;
  const MutexLock lock(mutex_);
  if (const auto* node = std::get_if<NodeAppeared>(&observation.what)) {
    nodes_[node->node] = node->pid;
    for (const auto& each : containers_) {
      const auto found = nodes_.find(each->node);
      if (found != nodes_.end() && found->second == node->pid) each->has_news = true;
      for (const ComponentId part : each->parts) {
        if (rules_[part].node == node->node && node->pid != 0) lives_[part] = {node->pid};
      }
    }
  } else if (const auto* gone = std::get_if<NodeVanished>(&observation.what)) {
    nodes_.erase(gone->node);
    for (const auto& each : containers_) {
      if (each->node == gone->node) left_[gone->node] = observation.at;
      for (const ComponentId part : each->parts) {
        if (rules_[part].node != gone->node) continue;
        lives_[part].left = observation.at;
        each->has_news |= observation.at >= lives_[part].taken_until;
      }
    }
  } else {
    return;
  }
  something_came_.notify_all();
}

void ComposedNodes::remember(ComponentId component, int pid) {
  const MutexLock lock(mutex_);
  if (rules_[component].composed && pid != 0) lives_.try_emplace(component, Life{pid});
}

bool ComposedNodes::answered(const Reply& reply) {
  const MutexLock lock(mutex_);
  const auto asked = asked_.find(reply.command);
  // Also a reply after its time limit.
  if (asked == asked_.end())
    return reply.command.number >= kFirstRequest &&
           reply.command.number <= kFirstRequest + requests_;
  asked->second = reply;
  something_came_.notify_all();
  return true;
}

ComposedNodes::Process ComposedNodes::process_of(const std::string& node) const {
  const MutexLock lock(mutex_);
  const auto found = nodes_.find(node);
  if (found == nodes_.end()) return {};
  // If its process has exited, the graph reports that in a moment.
  return {found->second == 0 || has_process(found->second), found->second};
}

// It lived in a process of the container before this one, and was not unloaded there.
bool ComposedNodes::is_lost(const Container& container, ComponentId part, int pid) const {
  constexpr Duration kTogether = 5s;  // nodes of a process that ends leave one after the other
  const MutexLock lock(mutex_);
  const auto life = lives_.find(part);
  if (life == lives_.end() || life->second.pid == pid || has_process(life->second.pid))
    return false;
  const auto left = left_.find(container.node);
  return !life->second.left || left == left_.end() || *life->second.left > left->second - kTogether;
}

template <class Done>
bool ComposedNodes::wait(Time until, Done done) const {
  MutexLock lock(mutex_);
  while (!is_ending_ && !done()) {
    const Duration left = until - live_now();
    if (left <= Duration::zero()) return false;
    something_came_.wait_for(lock, std::min<Duration>(left, 50ms));  // processes end unsaid
  }
  return !is_ending_;
}

// ---- the thread of a container

void ComposedNodes::run(Container& container) {
  constexpr Duration kQuiet = 500ms;  // after somebody came to the container
  MutexLock lock(mutex_);
  while (!is_ending_) {
    const auto has_errand = [&]() CULPRIT_REQUIRES(mutex_) {
      return is_ending_ || !container.errands.empty();
    };
    const auto has_something = [&]() CULPRIT_REQUIRES(mutex_) {
      return has_errand() || container.has_news;
    };
    if (container.barred.empty()) {
      something_came_.wait(lock, has_something);
    } else if (!something_came_.wait_for(lock, Supervisor::kMissingPeriod, has_something)) {
      lock.unlock();
      look_for_missing(container);
      lock.lock();
      continue;
    }
    if (container.errands.empty() && something_came_.wait_for(lock, kQuiet, has_errand) == false) {
      container.has_news = false;
      lock.unlock();
      look(container);
      lock.lock();
    }
    if (is_ending_ || container.errands.empty()) continue;
    const Errand errand = container.errands.front();
    container.errands.pop_front();
    lock.unlock();
    const bool is_container = errand.component == container.component;
    if (errand.kind == Errand::Kind::kStart) {
      start_part(container, errand);
    } else {
      reply(errand.command,
            is_container ? stop_container(container, errand) : stop_part(container, errand));
    }
    lock.lock();
  }
}

void ComposedNodes::note_missing(Container& container, ComponentId part, const std::string& what) {
  container.barred.insert(part);
  inbox_.put(StartBarred{part, what});
}

// Without its container nothing is known to be missing.
void ComposedNodes::look_for_missing(Container& container) {
  const Process process = process_of(container.node);
  std::erase_if(container.barred, [&](ComponentId part) {
    if (process.pid != 0 && !services_.could_load(rules_[part], process.pid)) return false;
    inbox_.put(StartBarred{part, ""});
    return true;
  });
}

// Lists the container's nodes before it can hang.
void ComposedNodes::look(Container& container) {
  const Process process = process_of(container.node);
  if (!process.is_there || process.pid == 0) return;
  if (list(container, process.pid, kAnswer).outcome != Outcome::kDone) return;
  for (const ComponentId part : take_unloaded(container, process.pid)) inbox_.put(Unloaded{part});
}

// Those that the process had when it lost their nodes, and that it does not list any more.
std::vector<ComponentId> ComposedNodes::take_unloaded(const Container& container, int pid) {
  std::vector<ComponentId> unloaded;
  const MutexLock lock(mutex_);
  for (const ComponentId part : container.parts) {
    const std::string& node = rules_[part].node;
    const auto life = lives_.find(part);
    const bool has_left = life != lives_.end() && life->second.pid == pid && life->second.left &&
                          *life->second.left >= life->second.taken_until && !nodes_.contains(node);
    if (!has_left || container.listed->contains(node)) continue;
    lives_.erase(life);
    unloaded.push_back(part);
  }
  return unloaded;
}

ContainerAnswer ComposedNodes::list(Container& container, int pid, Duration patience) {
  ContainerAnswer answer = services_.list(container.node, pid, patience);
  if (answer.outcome != Outcome::kDone) return answer;
  container.listed.emplace();
  container.listed_by = pid;
  for (const LoadedNode& each : answer.nodes) container.listed->insert(each.name);
  return answer;
}

ComposedNodes::Answer ComposedNodes::ask_owner(const std::function<void(CommandId)>& ask,
                                               Duration patience) {
  CommandId id;
  {
    const MutexLock lock(mutex_);
    id = CommandId{kFirstRequest + ++requests_};
    asked_[id] = std::nullopt;
  }
  ask(id);
  wait(later(live_now(), patience),
       [&]() CULPRIT_REQUIRES(mutex_) { return asked_[id].has_value(); });
  const MutexLock lock(mutex_);
  const std::optional<Reply> reply = asked_[id];
  asked_.erase(id);
  if (!reply) return {Outcome::kTimedOut, "its owner did not answer"};
  const auto* pid = std::get_if<Value>(&reply->value);
  const auto* number = pid == nullptr ? nullptr : std::get_if<std::int64_t>(pid);
  return {reply->outcome, reply->text, number == nullptr ? 0 : static_cast<int>(*number)};
}

// ---- ending

ComposedNodes::Answer ComposedNodes::stop_container(Container& container, const Errand& errand) {
  const Process process = process_of(container.node);
  const bool is_to_replace = errand.ending == Ending::kToStartAgain;
  // It was started for one of its components.
  if (is_to_replace && !process.is_there && is_coming(container)) return {};
  if (is_to_replace && errand.pid != 0 && process.pid != 0 && process.pid != errand.pid) return {};
  return ask_owner(
      [&](CommandId id) {
        owner_.stop(id, errand.component, errand.pid, errand.ending, errand.hangs);
      },
      kOwner);
}

ComposedNodes::Answer ComposedNodes::stop_part(Container& container, const Errand& errand) {
  const Component& part = rules_[errand.component];
  const Process process = process_of(container.node);
  const Process own = process_of(part.node);
  // The process that the order names has exited: now its successor runs, or none.
  if (errand.pid != 0 && own.pid != errand.pid && process.pid != errand.pid) return {};
  if (!process.is_there) {
    if (!own.is_there) return {};
    return {Outcome::kRefused, part.name + " is there without its container " + container.node +
                                   ", and is not ended; correct IN"};
  }
  if (process.pid == 0)
    return {Outcome::kRefused, "it is not proven which process on this machine " + container.node +
                                   " is, so it is not asked to unload " + part.name};
  if (own.is_there && own.pid != process.pid)
    return {Outcome::kRefused, part.name + " does not live in the container " + container.node +
                                   ", and is not ended; correct IN"};
  if (const auto contest = services_.contest(container.node)) return {Outcome::kRefused, *contest};
  const bool is_to_replace = errand.ending == Ending::kToStartAgain;
  if (is_to_replace) {
    if (const auto could = services_.could_load(part, process.pid); !could) {
      note_missing(container, errand.component, could.error());
      return {
          Outcome::kRefused,
          part.name + " is not unloaded, because it could not be loaded again: " + could.error()};
    }
  }
  bool is_stuck = false;
  Answer answer = unload(container, errand, process.pid, is_stuck);
  if (!is_stuck || !is_to_replace) return answer;
  const std::string cause = answer.text;
  if (const std::string why = why_not_replace(container, process.pid); !why.empty())
    return {answer.outcome, cause + ". The container is not replaced: " + why};
  inbox_.put(LinkTrouble{cause + ": its container is replaced, with all that it has"});
  answer = replace(container, process.pid, Hangs::kYes);
  if (answer.outcome != Outcome::kDone) answer.text = cause + "; and " + answer.text;
  return answer;
}

// `is_stuck`: the container was asked in vain.
ComposedNodes::Answer ComposedNodes::unload(Container& container, const Errand& errand, int pid,
                                            bool& is_stuck) {
  CULPRIT_ASSERT(pid != 0);  // a container that is not proven to be of this machine
  const Component& part = rules_[errand.component];
  const Duration patience = errand.hangs == Hangs::kYes ? kHungAnswer : kAnswer;
  bool has_unloaded_one = false;  // its node may leave the graph later
  const auto stuck = [&](const ContainerAnswer& answer) {
    is_stuck = true;
    note_failed_unload(errand.component, has_unloaded_one ? Outcome::kTimedOut : answer.outcome);
    return Answer{answer.outcome, container.node + " did not unload " + part.name +
                                      (answer.text.empty() ? "" : ": " + answer.text)};
  };
  // A process that is stopped by a signal never answers.
  if (state_letter(pid) == 'T') return stuck({Outcome::kTimedOut, "its process is stopped"});
  ContainerAnswer has = list(container, pid, patience);
  if (!has_process(pid)) return {};
  if (has.outcome == Outcome::kRefused) return {Outcome::kRefused, has.text};
  if (has.outcome != Outcome::kDone) return stuck(has);
  const auto ids = ids_of(part.node, has);
  const auto unanswered = container.unanswered.find(errand.component);
  if (ids.empty() && unanswered != container.unanswered.end() && unanswered->second == pid)
    return stuck({Outcome::kTimedOut, "it is still loading it"});
  if (ids.empty() && process_of(part.node).is_there)
    return {Outcome::kRefused, container.node + " does not list " + part.name +
                                   ", so it did not load it and cannot unload it"};
  if (!ids.empty()) {
    const MutexLock lock(mutex_);
    lives_[errand.component] = {.pid = pid, .taken_until = kNever};
  }
  for (const std::uint64_t id : ids) {
    const ContainerAnswer answer = services_.unload(container.node, pid, id, kUnload);
    if (!has_process(pid)) return {};
    if (answer.outcome != Outcome::kDone) return stuck(answer);
    has_unloaded_one = true;
  }
  const bool has_left = wait(later(live_now(), kUnload), [&]() CULPRIT_REQUIRES(mutex_) {
    const auto found = nodes_.find(part.node);
    return found == nodes_.end() || found->second != pid || !has_process(pid);
  });
  has = list(container, pid, patience);
  if (!has_process(pid)) return {};
  if (has.outcome != Outcome::kDone) return stuck(has);
  if (!ids_of(part.node, has).empty() || !has_left)
    return stuck({Outcome::kTimedOut, "it reported success, but its node is still there"});
  if (errand.ending == Ending::kForGood) {
    const MutexLock lock(mutex_);
    lives_.erase(errand.component);
  }
  return {};
}

// From now on, or soon, it is somebody else who unloads it.
void ComposedNodes::note_failed_unload(ComponentId part, Outcome outcome) {
  const MutexLock lock(mutex_);
  const auto life = lives_.find(part);
  if (life == lives_.end() || life->second.left || life->second.taken_until != kNever) return;
  const bool may_happen = outcome == Outcome::kTimedOut;
  life->second.taken_until = may_happen ? later(live_now(), kLateUnload) : kLongAgo;
}

// Empty: all that it has can come back.
std::string ComposedNodes::why_not_replace(const Container& container, int pid) const {
  if (!container.component)
    return "no COMPONENT has NODE " + container.node +
           ", so its owner is unknown; declare it with a LAUNCH or a UNIT";
  if (!rules_[*container.component].can_start_again())
    return rules_[*container.component].name + " has neither LAUNCH nor UNIT";
  std::set<std::string> others;
  if (container.listed && container.listed_by == pid) {
    others = *container.listed;
  } else {
    const MutexLock lock(mutex_);
    for (const auto& [node, process] : nodes_) {
      if (process == pid && node != container.node) others.insert(node);
    }
  }
  for (const ComponentId part : container.parts) {
    if (others.erase(rules_[part].node) == 0) continue;
    if (const auto could = services_.could_load(rules_[part], pid); !could) return could.error();
  }
  if (others.empty()) return "";
  return *others.begin() +
         " lives there, too, and could not be loaded again; declare a COMPONENT with NODE " +
         *others.begin() + " IN " + container.node + " and its PLUGIN";
}

ComposedNodes::Answer ComposedNodes::replace(Container& container, int pid, Hangs hangs) {
  CULPRIT_ASSERT(container.component && pid != 0);  // any process of its owner would be ended
  const Answer answer = ask_owner(
      [&](CommandId id) {
        owner_.stop(id, *container.component, pid, Ending::kToStartAgain, hangs);
      },
      kOwner);
  if (answer.outcome != Outcome::kDone)
    return {answer.outcome, rules_[*container.component].name + ": " + answer.text};
  container.unanswered.clear();
  return {};
}

// ---- starting

bool ComposedNodes::is_coming(const Container& container) {
  return live_now() < container.coming_up &&
         (container.coming_pid == 0 || has_process(container.coming_pid));
}

ComposedNodes::Answer ComposedNodes::begin(Container& container) {
  CULPRIT_ASSERT(container.component);
  Answer started = ask_owner([&](CommandId id) { owner_.start(id, *container.component); }, kOwner);
  container.unanswered.clear();
  if (started.outcome != Outcome::kDone) return started;
  container.coming_up = later(live_now(), kComingUp);
  container.coming_pid = started.pid;
  return started;
}

// Waits until the container is there, and starts it if it is not.
ComposedNodes::Answer ComposedNodes::ensure(Container& container, Duration patience) {
  if (!process_of(container.node).is_there) {
    const std::string& name =
        container.component ? rules_[*container.component].name : container.node;
    if (!container.component || !rules_[*container.component].can_start_again())
      return {Outcome::kRefused, "its container " + container.node +
                                     " is not there, and the rules name no owner for it; "
                                     "declare a COMPONENT with that NODE and a LAUNCH or a UNIT"};
    if (!is_coming(container)) {
      const Answer started = begin(container);
      if (started.outcome != Outcome::kDone)
        return {started.outcome, "its container " + name + " was not started: " + started.text};
    }
    wait(later(live_now(), patience), [&]() CULPRIT_REQUIRES(mutex_) {
      const auto found = nodes_.find(container.node);
      return (found != nodes_.end() && has_process(found->second)) || !is_coming(container);
    });
    if (!process_of(container.node).is_there)
      return {Outcome::kTimedOut, is_coming(container)
                                      ? "its container " + name + " is not there yet"
                                      : "its container " + name + " exited at once"};
  }
  container.coming_up = kLongAgo;
  const Process process = process_of(container.node);
  if (process.pid == 0)
    return {Outcome::kRefused, "it is not proven which process on this machine " + container.node +
                                   " is, so nothing is loaded there"};
  if (const auto contest = services_.contest(container.node)) return {Outcome::kRefused, *contest};
  return {Outcome::kDone, "", process.pid};
}

void ComposedNodes::start_part(Container& container, const Errand& errand) {
  if (errand.component == container.component) {
    // The answer is its process's; the order does not wait for its components to come back, too.
    if (process_of(container.node).is_there) {
      reply(errand.command, {Outcome::kDone, "", process_of(container.node).pid});
    } else if (is_coming(container)) {
      reply(errand.command, {Outcome::kDone, "it was started for one of its components"});
    } else {
      const Answer started = begin(container);
      reply(errand.command, started);
      if (started.outcome != Outcome::kDone) return;
    }
    if (const Answer there = ensure(container, kComingUp); there.outcome == Outcome::kDone)
      load_all(container, there.pid, errand);
    return;
  }
  const Answer there = ensure(container, errand.patience);
  if (there.outcome != Outcome::kDone) return reply(errand.command, there);
  load_all(container, there.pid, errand);
}

// Loads the component that the errand is for, and the ones that the container's previous process
// had.
void ComposedNodes::load_all(Container& container, int pid, const Errand& errand) {
  for (const ComponentId part : container.parts) {
    const bool is_wanted = part == errand.component;
    if (!is_wanted && !is_lost(container, part, pid)) continue;
    const Answer answer = load(container, part, pid, is_wanted ? errand.patience : kLoad);
    if (is_wanted) {
      reply(errand.command, answer);
    } else if (answer.outcome != Outcome::kDone) {
      inbox_.put(LinkTrouble{rules_[part].name + " was lost with its container " + container.node +
                             " and is not loaded again: " + answer.text});
    }
  }
}

ComposedNodes::Answer ComposedNodes::load(Container& container, ComponentId part, int pid,
                                          Duration patience) {
  CULPRIT_ASSERT(pid != 0);
  const Component& component = rules_[part];
  const Process own = process_of(component.node);
  if (own.is_there && own.pid != pid)
    return {Outcome::kRefused, component.name + " is there already, and not in " + container.node};
  ContainerAnswer has = list(container, pid, std::max(patience, Duration(kAnswer)));
  if (has.outcome != Outcome::kDone) return {has.outcome, has.text};
  const auto unanswered = container.unanswered.find(part);
  const bool is_pending = unanswered != container.unanswered.end() && unanswered->second == pid;
  if (!ids_of(component.node, has).empty()) {
    container.unanswered.erase(part);
    return {Outcome::kDone, "it is loaded already", pid};
  }
  if (own.is_there)
    return {Outcome::kRefused,
            component.name + " is there already, though " + container.node + " does not list it"};
  if (is_pending)
    return {Outcome::kRefused, container.node + " is still loading " + component.name};
  if (const auto could = services_.could_load(component, pid); !could) {
    note_missing(container, part, could.error());
    return {Outcome::kRefused, could.error()};
  }
  const ContainerAnswer made = services_.load(component, pid, patience);
  if (made.outcome == Outcome::kTimedOut) container.unanswered[part] = pid;
  if (made.outcome != Outcome::kDone || made.nodes.empty()) return {made.outcome, made.text};
  const LoadedNode& node = made.nodes.front();
  // If somebody else loaded the same node meanwhile, theirs stays.
  has = list(container, pid, kAnswer);
  auto ids = ids_of(component.node, has);
  const bool is_double = ids.size() > 1;
  if (node.name != component.node || is_double) {
    const ContainerAnswer taken = services_.unload(container.node, pid, node.id, kUnload);
    if (taken.outcome != Outcome::kDone)
      inbox_.put(LinkTrouble{container.node + " does not unload " + node.name +
                             ", which it loaded one too many: " + taken.text});
    if (is_double) return {Outcome::kDone, "another program has loaded it", pid};
    return {Outcome::kRefused, container.node + " loaded it as " + node.name + " in place of " +
                                   component.node + ": the class takes no other name"};
  }
  if (has.outcome != Outcome::kDone) return {has.outcome, has.text};
  if (ids.empty())
    return {Outcome::kRefused, container.node + " reports that it loaded it, but does not list it"};
  return {Outcome::kDone, "", pid};
}

}  // namespace culprit::owners

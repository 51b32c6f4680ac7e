#include "link/component_link.h"

#include <algorithm>
#include <utility>

#include "base/live_clock.h"
#include "base/ros_names.h"
#include "base/tracer.h"
#include "link/list_parameter.h"
#include "link/service_call.h"
#include "ros2/lifecycle.h"
#include "ros2/parameter_store.h"
#include "ros2/services.h"
#include "rtps/receive_thread.h"

namespace culprit::link {
namespace {

using namespace std::chrono_literals;

// How long a node that was just seen may take until its services answer.
constexpr Duration kJoining = 5s;
constexpr Duration kProbe = 500ms;
// A node that announces a transition may answer nothing until it has finished.
constexpr Duration kTransitionAsked = 100ms;
// Between two requests after events: a flood of them asks the node 20 times a second.
constexpr auto kAskedAgain = 50ms;

Lifecycle to_lifecycle(std::uint8_t id) {
  switch (static_cast<LifecycleState>(id)) {
    case LifecycleState::kUnconfigured:
      return Lifecycle::kUnconfigured;
    case LifecycleState::kInactive:
      return Lifecycle::kInactive;
    case LifecycleState::kActive:
      return Lifecycle::kActive;
    case LifecycleState::kFinalized:
      return Lifecycle::kFinalized;
    case LifecycleState::kConfiguring:
    case LifecycleState::kCleaningUp:
    case LifecycleState::kShuttingDown:
    case LifecycleState::kActivating:
    case LifecycleState::kDeactivating:
    case LifecycleState::kErrorProcessing:
      return Lifecycle::kTransition;
    default:
      return Lifecycle::kUnknown;
  }
}

ros2::msg::Transition to_message(Transition transition) {
  switch (transition) {
    case Transition::kConfigure:
      return {static_cast<std::uint8_t>(ros2::TransitionId::kConfigure), ""};
    case Transition::kCleanup:
      return {static_cast<std::uint8_t>(ros2::TransitionId::kCleanup), ""};
    case Transition::kActivate:
      return {static_cast<std::uint8_t>(ros2::TransitionId::kActivate), ""};
    case Transition::kDeactivate:
      return {static_cast<std::uint8_t>(ros2::TransitionId::kDeactivate), ""};
  }
  return {};
}

}  // namespace

ComponentLink::ComponentLink(ros2::NodeEntry& self, ComponentId component, std::string node,
                             const RuleSet& rules, Inbox& inbox, TypeFinder& types,
                             Starvation& starvation)
    : self_(self),
      component_(component),
      node_(std::move(node)),
      rules_(rules),
      needs_(needs_of(component, rules)),
      inbox_(inbox),
      types_(types),
      starvation_(starvation),
      clients_(self, node_, needs_, inbox),
      tasks_(self.context().executor()) {}

void ComponentLink::lives_in(int pid, const rtps::GuidPrefix& participant) {
  pid_ = pid;
  {
    const MutexLock lock(claimed_mutex_);
    claimed_.holder = participant;
  }
  clients_.ask_only(participant);
}

void ComponentLink::service_seen(const ros2::GraphEndpoint& seen) {
  const std::string& service = seen.name;
  const TypeFinder::Offer offer{node_, seen.type, seen.service_hash, pid_, seen.type_hash};
  {
    const MutexLock lock(mutex_);
    services_[service] = offer;
  }
  const bool is_called =
      std::any_of(needs_.routines.begin(), needs_.routines.end(),
                  [&](const std::string& name) { return service_of(name, node_) == service; });
  if (is_called && !offer.hash.empty())
    types_.find(offer, [](const Expected<ros2::MessageLibrary*>&) {});
  if (service == node_ + "/change_state") {
    watch_transitions();
    asking_state_.begin();
    read_first_state(rtps::Haste::kNow);
  }
  if (service == node_ + "/get_parameters") {
    asking_values_.begin();
    asking_time_.begin();
    asking_anything_.begin();
    read_parameters();
    note_that_it_answers();
  }
  if (service == node_ + "/change_mode" && needs_.changes_modes) clients_.modes();
}

// ---- what is read without being commanded

void ComponentLink::check_lifecycle() {
  ros2::ServiceClient* client = clients_.has_lifecycle() ? clients_.lifecycle_reader() : nullptr;
  if (client == nullptr) return;
  client->call(
      rtps::encode(ros2::srv::GetState::Request{}), ros2::Repeat::kUntilAnswered, kProbe,
      [this](const ros2::CallResult& result) { on_lifecycle(result, Told::kIfNew); },
      rtps::Haste::kSoon);
}

void ComponentLink::ask_again() {
  if (asking_state_.is_due()) read_first_state(rtps::Haste::kSoon);
  if (asking_values_.is_due()) read_parameters();
  if (asking_time_.is_due()) ask_time_source(then_of_time_);
  if (asking_anything_.is_due()) note_that_it_answers();
}

void ComponentLink::read_first_state(rtps::Haste haste) {
  ros2::ServiceClient* client = clients_.lifecycle_reader();
  if (client == nullptr) return;
  asking_state_.asks();
  client->call(
      rtps::encode(ros2::srv::GetState::Request{}), ros2::Repeat::kUntilAnswered, kJoining,
      [this](const ros2::CallResult& result) {
        asking_state_.ends(result);
        on_lifecycle(result, Told::kAlways);
      },
      haste);
}

void ComponentLink::on_lifecycle(const ros2::CallResult& result, Told told) {
  if (result.outcome != ros2::CallOutcome::kAnswered) return;
  inbox_.put(Probed{component_, true});
  const auto response = rtps::decode<ros2::srv::GetState::Response>(result.reply);
  if (response) tell(to_lifecycle(response->current_state.id), told);
}

void ComponentLink::tell(Lifecycle state, Told told) {
  const Lifecycle before = told_.exchange(state);
  if (told == Told::kAlways || state != before) inbox_.put(LifecycleRead{component_, state});
}

void ComponentLink::watch_transitions() {
  const MutexLock lock(mutex_);
  if (transitions_) return;
  constexpr rtps::Qos kQos{.reliability = rtps::Reliability::kBestEffort, .depth = 10};
  auto subscription = ros2::RawSubscription::create(
      self_, node_ + "/transition_event", ros2::msg::TransitionEvent::kType, kQos,
      ros2::PayloadUse::kWhole, [this](const ros2::Sample& sample) { on_transition(sample); });
  if (subscription) transitions_ = std::move(*subscription);
}

// Anybody may send such an event. It is a reason to ask the node for its state, and proves nothing
// by itself.
void ComponentLink::on_transition(const ros2::Sample& sample) {
  const auto event = rtps::decode<ros2::msg::TransitionEvent>(sample.payload);
  if (!event) return;
  const Lifecycle state = to_lifecycle(event->goal_state.id);
  const bool is_shut_down =
      state == Lifecycle::kFinalized &&
      static_cast<LifecycleState>(event->start_state.id) == LifecycleState::kShuttingDown;
  {
    const MutexLock lock(claimed_mutex_);
    if (claimed_.holder && sample.identity.writer.prefix() != *claimed_.holder) return;
    claimed_.last = Claim{state, is_shut_down};
    if (std::exchange(claimed_.is_asked, true)) return;
  }
  tasks_.post([this] { ask_for_transition(); });
}

void ComponentLink::ask_for_transition() {
  ros2::ServiceClient* client = clients_.lifecycle_reader();
  std::optional<Claim> claim;
  {
    const MutexLock lock(claimed_mutex_);
    claim = std::exchange(claimed_.last, std::nullopt);
    claimed_.is_asked = claim && client != nullptr;
    if (!claimed_.is_asked) return;
  }
  client->call(rtps::encode(ros2::srv::GetState::Request{}), ros2::Repeat::kUntilAnswered,
               kTransitionAsked, [this, claim = *claim](const ros2::CallResult& result) {
                 on_state(result, claim);
                 tasks_.post_at(ros2::Executor::Clock::now() + kAskedAgain,
                                [this] { ask_for_transition(); });
               });
}

// A node with one thread answers nothing during a transition: then its silence confirms that one is
// under way. Any other state counts only from the node itself, except that it was shut down.
void ComponentLink::on_state(const ros2::CallResult& result, const Claim& claim) {
  const auto response = result.outcome == ros2::CallOutcome::kAnswered
                            ? rtps::decode<ros2::srv::GetState::Response>(result.reply)
                            : std::nullopt;
  if (response) {
    inbox_.put(Probed{component_, true});
    const Lifecycle state = to_lifecycle(response->current_state.id);
    told_ = state;
    const bool is_shut_down = state == Lifecycle::kFinalized && was_shut_down(claim);
    inbox_.put(LifecycleRead{component_, state, is_shut_down});
  } else if (claim.state == Lifecycle::kTransition) {
    tell(Lifecycle::kTransition, Told::kAlways);
  } else if (claim.is_shut_down && pid_ != 0) {
    // It may end at once. Only its process can speak in its name (rtps/origins.h), and nothing is ended by that.
    told_ = claim.state;
    inbox_.put(LifecycleRead{component_, claim.state, true});
  }
}

// The event about it may have come after the request, and before its answer.
bool ComponentLink::was_shut_down(const Claim& claim) {
  const MutexLock lock(claimed_mutex_);
  return claim.is_shut_down || (claimed_.last && claimed_.last->is_shut_down);
}

void ComponentLink::read_parameters() {
  ros2::ServiceClient* client = clients_.parameter_reader();
  if (client == nullptr) return;
  for (std::size_t p = 0; p < rules_.parameters.size(); ++p) {
    if (rules_.parameters[p].component != component_) continue;
    // One by one: a name that is not declared would leave all of them unanswered.
    asking_values_.asks();
    client->call(rtps::encode(ros2::srv::GetParameters::Request{{rules_.parameters[p].name}}),
                 ros2::Repeat::kUntilAnswered, kJoining, [this, p](const ros2::CallResult& result) {
                   asking_values_.ends(result);
                   if (result.outcome != ros2::CallOutcome::kAnswered) return;
                   const auto response =
                       rtps::decode<ros2::srv::GetParameters::Response>(result.reply);
                   if (!response) return;
                   auto value = response->values.size() == 1
                                    ? read_value(rules_.parameters[p].name, response->values[0])
                                    : std::nullopt;
                   if (value) {
                     inbox_.put(ParameterRead{ParameterId(p), std::move(*value)});
                   } else {
                     misses_parameter_ = true;
                   }
                 });
  }
}

void ComponentLink::ask_time_source(std::function<void(bool)> then) {
  ros2::ServiceClient* client = clients_.parameter_reader();
  if (client == nullptr) return;
  then_of_time_ = std::move(then);
  asking_time_.asks();
  client->call(rtps::encode(ros2::srv::GetParameters::Request{{"use_sim_time"}}),
               ros2::Repeat::kUntilAnswered, kJoining,
               [this, then = then_of_time_](const ros2::CallResult& result) {
                 asking_time_.ends(result);
                 if (result.outcome != ros2::CallOutcome::kAnswered) return;
                 const auto response =
                     rtps::decode<ros2::srv::GetParameters::Response>(result.reply);
                 if (response && response->values.size() == 1) then(response->values[0].bool_value);
               });
}

void ComponentLink::ask_time_source_again() {
  if (then_of_time_) ask_time_source(then_of_time_);
}

// One that answered once, and ceases to, hangs.
void ComponentLink::note_that_it_answers() {
  const auto note = [this](const ros2::CallResult& result) {
    asking_anything_.ends(result);
    if (result.outcome == ros2::CallOutcome::kAnswered) inbox_.put(Probed{component_, true});
  };
  asking_anything_.asks();
  if (!read_anything(kJoining, rtps::Haste::kSoon, note)) asking_anything_.ends({});
}

void ComponentLink::check_parameters() {
  if (!misses_parameter_.exchange(false)) return;
  ros2::ServiceClient* client = clients_.parameter_names();
  if (client == nullptr) return;
  client->call(rtps::encode(ros2::srv::ListParameters::Request{}), ros2::Repeat::kUntilAnswered,
               kJoining, [this](const ros2::CallResult& result) {
                 constexpr std::size_t kMost = 1000;
                 if (result.outcome != ros2::CallOutcome::kAnswered) return;
                 auto response = rtps::decode<ros2::srv::ListParameters::Response>(result.reply);
                 if (!response) return;
                 response->names.resize(std::min(response->names.size(), kMost));
                 inbox_.put(ParametersListed{component_, std::move(response->names)});
               });
}

// Unanswered probes beyond a few in a row add no information.
void ComponentLink::unanswered(Time due, const std::function<Time()>& heard) {
  constexpr std::size_t kMost = 10;
  const Time last = heard ? heard() : kNever;
  const MutexLock lock(unanswered_mutex_);
  unanswered_.push_back(due);
  if (unanswered_.size() > kMost) unanswered_.pop_front();
  for (; !unanswered_.empty() && unanswered_.front() <= last; unanswered_.pop_front())
    inbox_.put(Probed{component_, false});
}

// Since it did not answer before.
bool ComponentLink::is_at_work(int pid) {
  constexpr Duration kLongest = 3s;
  const auto now = look_at_processor_time(pid);
  const auto before = std::exchange(looked_, now);
  return now && before && now->at <= later(before->at, kLongest) && was_at_work(*before, *now);
}

void ComponentLink::forget_unanswered() {
  const MutexLock lock(unanswered_mutex_);
  unanswered_.clear();
}

void ComponentLink::probe(int pid, std::function<Time()> heard) {
  // Messages that prove that another computer is reachable may have arrived up to
  // ReceiveThread::kSoon earlier.
  const Time due = later(live_now(), kProbe + rtps::ReceiveThread::kSoon);
  const auto tell_of = [this, pid, heard = std::move(heard), due](const ros2::CallResult& result) {
    if (result.outcome == ros2::CallOutcome::kAnswered) {
      forget_unanswered();
      inbox_.put(Probed{component_, true});
      return;
    }
    const Time now = live_now();
    starvation_.note(due, now);
    const bool is_busy = pid != 0 && (is_traced(pid) || is_at_work(pid));
    if (!is_busy && !starvation_.is_recent(now)) unanswered(due, heard);
  };
  read_anything(kProbe, rtps::Haste::kSoon, tell_of);
}

void ComponentLink::ask(std::function<void(std::optional<rtps::GuidPrefix> answered)> then) {
  const bool is_asked =
      read_anything(kProbe, rtps::Haste::kNow, [then](const ros2::CallResult& result) {
        then(result.outcome == ros2::CallOutcome::kAnswered ? std::optional(result.server)
                                                            : std::nullopt);
      });
  if (!is_asked) then(std::nullopt);
}

// If the node has a lifecycle, this reads its state, and reports it as check_lifecycle() does.
bool ComponentLink::read_anything(Duration patience, rtps::Haste haste,
                                  std::function<void(const ros2::CallResult&)> then) {
  const bool is_managed = clients_.has_lifecycle();
  ros2::ServiceClient* client =
      is_managed ? clients_.lifecycle_reader() : clients_.parameter_reader();
  if (client == nullptr) return false;
  if (!is_managed) {
    client->call(rtps::encode(ros2::srv::GetParameters::Request{}), ros2::Repeat::kUntilAnswered,
                 patience, std::move(then), haste);
    return true;
  }
  client->call(
      rtps::encode(ros2::srv::GetState::Request{}), ros2::Repeat::kUntilAnswered, patience,
      [this, then = std::move(then)](const ros2::CallResult& result) {
        then(result);
        if (result.outcome != ros2::CallOutcome::kAnswered) return;
        const auto response = rtps::decode<ros2::srv::GetState::Response>(result.reply);
        if (response) tell(to_lifecycle(response->current_state.id), Told::kIfNew);
      },
      haste);
  return true;
}

// ---- commands

void ComponentLink::execute(const Command& command) {
  std::visit([&](const auto& what) { run(command, what); }, command.what);
}

// A node's own words go into the journal, the page and alerts.
void ComponentLink::reply(const Command& command, Answer answer) {
  constexpr std::size_t kLongestText = 500;  // bytes
  if (answer.text.size() > kLongestText) answer.text.resize(kLongestText);
  inbox_.put(Reply{command.id, answer.outcome, std::move(answer.value), std::move(answer.text)});
}

std::optional<ComponentLink::Answer> ComponentLink::why_unanswered(const ros2::CallResult& result,
                                                                   const Command& command,
                                                                   const std::string& type) const {
  switch (result.outcome) {
    case ros2::CallOutcome::kUnreachable:
      return Answer{Outcome::kUnreachable, {}, node_ + " offers no " + type + " that answers"};
    case ros2::CallOutcome::kTimedOut:
      return Answer{Outcome::kTimedOut, {}, "no answer within " + to_string(command.timeout)};
    case ros2::CallOutcome::kAnswered:
      break;
  }
  return std::nullopt;
}

template <class Service, class Understand>
void ComponentLink::ask(ros2::ServiceClient* client, const typename Service::Request& request,
                        ros2::Repeat repeat, const Command& command, Understand understand) {
  if (client == nullptr)
    return reply(command, {Outcome::kUnreachable, {}, "no client could be made"});
  client->call(rtps::encode(request), repeat, command.timeout,
               [this, command, understand](const ros2::CallResult& result) {
                 if (const auto none = why_unanswered(result, command, std::string(Service::kType)))
                   return reply(command, *none);
                 const auto response = rtps::decode<typename Service::Response>(result.reply);
                 if (!response) {
                   return reply(command,
                                {Outcome::kRefused,
                                 {},
                                 "the answer is no " + std::string(Service::kType) + " response"});
                 }
                 reply(command, understand(*response));
               });
}

void ComponentLink::run(const Command& command, const ChangeLifecycle& what) {
  ask<ros2::srv::ChangeState>(
      clients_.lifecycle(), {to_message(what.transition)}, ros2::Repeat::kNever, command,
      [](const ros2::srv::ChangeState::Response& response) {
        return Answer{response.success ? Outcome::kDone : Outcome::kRefused, {}, ""};
      });
}

void ComponentLink::run(const Command& command, const ReadLifecycle&) {
  ask<ros2::srv::GetState>(clients_.lifecycle_reader(), {}, ros2::Repeat::kUntilAnswered, command,
                           [this](const ros2::srv::GetState::Response& response) {
                             const Lifecycle state = to_lifecycle(response.current_state.id);
                             tell(state, Told::kAlways);
                             return Answer{Outcome::kDone, state, ""};
                           });
}

// A list parameter is set as a list: the rules have its text.
Expected<ros2::msg::ParameterValue> ComponentLink::to_set(const std::string& name,
                                                          const Value& value) {
  std::uint8_t type = 0;
  {
    const MutexLock lock(lists_mutex_);
    const auto list = lists_.find(name);
    if (list != lists_.end()) type = list->second;
  }
  if (type == 0) return ros2::to_parameter_value(value);
  const auto* text = std::get_if<std::string>(&value);
  auto list = text != nullptr ? list_parameter(*text, type) : std::nullopt;
  if (!list)
    return Error{"parameter " + name + " is a list, and " + to_string(value) +
                 " is none with elements of its type; write it as \"[1, 2]\""};
  return std::move(*list);
}

std::optional<Value> ComponentLink::read_value(const std::string& name,
                                               const ros2::msg::ParameterValue& value) {
  {
    const MutexLock lock(lists_mutex_);
    lists_.erase(name);
    if (is_list(value)) lists_[name] = value.type;
  }
  return value_or_list(value);
}

void ComponentLink::run(const Command& command, const SetParameter& what) {
  auto value = to_set(what.name, what.value);
  if (!value) return reply(command, {Outcome::kRefused, {}, value.error()});
  ask<ros2::srv::SetParameters>(
      clients_.parameters(), {{{what.name, std::move(*value)}}}, ros2::Repeat::kNever, command,
      [name = what.name](const ros2::srv::SetParameters::Response& response) {
        if (response.results.size() != 1) {
          return Answer{Outcome::kRefused, {}, "there is no parameter " + name};
        }
        const auto& result = response.results[0];
        return Answer{result.successful ? Outcome::kDone : Outcome::kRefused, {}, result.reason};
      });
}

void ComponentLink::run(const Command& command, const ReadParameter& what) {
  ask<ros2::srv::GetParameters>(
      clients_.parameter_reader(), {{what.name}}, ros2::Repeat::kUntilAnswered, command,
      [this, name = what.name](const ros2::srv::GetParameters::Response& response) {
        auto value =
            response.values.size() == 1 ? read_value(name, response.values[0]) : std::nullopt;
        if (!value) return Answer{Outcome::kRefused, {}, "there is no parameter " + name};
        return Answer{Outcome::kDone, std::move(*value), ""};
      });
}

void ComponentLink::run(const Command& command, const CallService& what) {
  TypeFinder::Offer offer;
  {
    const MutexLock lock(mutex_);
    const auto known = services_.find(what.service);
    if (known != services_.end()) offer = known->second;
  }
  if (offer.type.empty())
    return reply(command,
                 {Outcome::kUnreachable, {}, node_ + " offers no service " + what.service});
  offer.pid = pid_;
  tasks_.post([this, command, what, offer] {
    types_.find(offer,
                [this, command, what, offer](const Expected<ros2::MessageLibrary*>& library) {
                  if (!library) return reply(command, {Outcome::kRefused, {}, library.error()});
                  const auto prepared = ServiceCall::prepare(offer.type, what.request, **library);
                  if (!prepared) return reply(command, {Outcome::kRefused, {}, prepared.error()});
                  call(command, offer.type, what.service, *prepared);
                });
  });
}

void ComponentLink::call(const Command& command, const std::string& type,
                         const std::string& service, const ServiceCall& call) {
  ros2::ServiceClient* client = clients_.routine(service, type);
  if (client == nullptr)
    return reply(command, {Outcome::kUnreachable, {}, "no client could be made"});
  client->call(
      call.request(), ros2::Repeat::kNever, command.timeout,
      [this, command, type, asked = call](const ros2::CallResult& result) {
        if (const auto none = why_unanswered(result, command, type)) return reply(command, *none);
        const auto verdict = asked.judge(result.reply);
        if (!verdict)
          return reply(command, {Outcome::kRefused, {}, "the answer is no " + type + " response"});
        reply(command, {verdict->is_done ? Outcome::kDone : Outcome::kRefused, {}, verdict->text});
      });
}

void ComponentLink::run(const Command& command, const ChangeMode& what) {
  ask<ros2::srv::ChangeMode>(
      clients_.modes(), {what.mode}, ros2::Repeat::kNever, command,
      [](const ros2::srv::ChangeMode::Response& response) {
        return Answer{response.success ? Outcome::kDone : Outcome::kRefused, {}, ""};
      });
}

void ComponentLink::run(const Command& command, const ReadMode&) {
  ros2::ServiceClient* client = clients_.modes();
  ask<ros2::srv::GetMode>(client == nullptr ? nullptr : client->probe(), {},
                          ros2::Repeat::kUntilAnswered, command,
                          [](const ros2::srv::GetMode::Response& response) {
                            return Answer{Outcome::kDone, Value(response.current_mode), ""};
                          });
}

// As in probe(): one that a debugger holds proves nothing, nor one that is at work, nor one that a starved culprit asked.
void ComponentLink::run(const Command& command, const Probe&) {
  const Time due = later(live_now(), command.timeout);
  const int asked = pid_;
  const auto before = asked == 0 ? std::nullopt : look_at_processor_time(asked);
  const auto answer = [this, command, due, before](const ros2::CallResult& result) {
    const int pid = pid_;
    if (result.outcome == ros2::CallOutcome::kTimedOut) {
      starvation_.note(due, live_now());
      const auto now = before ? look_at_processor_time(pid) : std::nullopt;
      if (pid != 0 && is_traced(pid))
        return reply(command, {Outcome::kUnreachable, {}, "a debugger holds its process"});
      if (now && was_at_work(*before, *now))
        return reply(command, {Outcome::kUnreachable, {}, "its process is at work"});
      if (starvation_.is_recent(live_now()))
        return reply(command, {Outcome::kUnreachable, {}, "culprit itself had no processor"});
    }
    const auto none = why_unanswered(result, command, "service");
    reply(command, none ? *none : Answer{});
  };
  if (!read_anything(command.timeout, rtps::Haste::kNow, answer))
    reply(command, {Outcome::kUnreachable, {}, "no client could be made"});
}

void ComponentLink::run(const Command& command, const StopProcess&) {
  reply(command, {Outcome::kUnreachable, {}, "processes are not steered over DDS"});
}

void ComponentLink::run(const Command& command, const StartProcess&) {
  reply(command, {Outcome::kUnreachable, {}, "processes are not steered over DDS"});
}

}  // namespace culprit::link

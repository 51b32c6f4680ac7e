#include "live/launch.h"

#include <algorithm>
#include <iterator>
#include <optional>
#include <set>
#include <sstream>
#include <utility>

#include "base/text_file.h"
#include "robot/component_binding.h"

namespace culprit::live {
namespace {

// Producers before their consumers, else as the file has them. Components that depend on one
// another come in the file's order, too.
void add_in_order(ComponentId component, const RuleSet& rules, std::vector<bool>& is_visited,
                  std::vector<ComponentId>& order) {
  if (is_visited[component.index]) return;
  is_visited[component.index] = true;
  for (const Dependency& each : rules.dependencies) {
    if (each.consumer == component) add_in_order(each.producer, rules, is_visited, order);
  }
  order.push_back(component);
}

class Starting {
 public:
  using OnAsked = std::function<void(ComponentId)>;

  Starting(Robot& robot, const RuleSet& rules, const std::atomic<bool>& stop, LaunchTimes times,
           OnAsked on_asked)
      : on_asked_(std::move(on_asked)),
        robot_(robot),
        rules_(rules),
        stop_(stop),
        times_(times),
        binding_(rules),
        parts_(rules.components.size()) {}

  void look() {
    observe_until(later(robot_.now(), times_.look), [] { return false; });
  }

  bool is_there(ComponentId component) const { return parts_[component.index].joined.has_value(); }
  // Only of what is there.
  Time joined(ComponentId component) const { return *parts_[component.index].joined; }

  void begin(ComponentId component, const StartComponent& start) {
    part(component).start = next_request();
    part(component).began = robot_.now();
    start(part(component).start, component);
    end_ = std::min(end_, later(robot_.now(), times_.patience));
  }

  void remember(const History& past) {
    for (const Event& event : past) {
      const auto* came_up = std::get_if<CameUp>(&event.what);
      if (came_up != nullptr) part(came_up->component).before = came_up->how;
    }
  }

  // Resumes a component that was started before. `was_asked`: its lifecycle transitions had begun
  // as well.
  void resume(ComponentId component, bool was_asked) {
    part(component).is_left_halfway = was_asked;
    end_ = std::min(end_, later(robot_.now(), times_.patience));
  }

  // Returns the problem; empty: it is up, or needs no lifecycle changes.
  std::optional<std::string> bring_up(ComponentId component) {
    const LifecycleDriver driver = rules_[component].lifecycle;
    const bool joined = joins(component);
    if (!part(component).trouble.empty()) return part(component).trouble;
    if (driver == LifecycleDriver::kSelf || driver == LifecycleDriver::kLauncher)
      return std::nullopt;
    if (!joined) return std::nullopt;  // the manager will see
    if (!is_managed(component))
      return driver == LifecycleDriver::kManaged && !part(component).has_ended
                 ? std::optional<std::string>(
                       "LIFECYCLE says that culprit brings it up, but it offers no "
                       "lifecycle services")
                 : std::nullopt;
    const bool may_drive_itself =
        driver == LifecycleDriver::kUndeclared && !part(component).is_left_halfway;
    if (may_drive_itself && moves(component)) return std::nullopt;
    if (robot_.now() >= end_) return "there was no time left to configure and activate it";
    const auto trouble =
        step(component, Transition::kConfigure, Lifecycle::kUnconfigured, Lifecycle::kInactive);
    if (trouble) return trouble;
    return step(component, Transition::kActivate, Lifecycle::kInactive, Lifecycle::kActive);
  }

  // Nothing: it is not active, or was before.
  std::optional<ComingUp> came_up(ComponentId component) const {
    const Part& it = parts_[component.index];
    if (it.state != Lifecycle::kActive || !it.joined || !it.began) return std::nullopt;
    const auto driver = it.was_asked ? ComingUp::Driver::kCulprit : ComingUp::Driver::kOther;
    const Time rises = it.was_asked ? it.asked : *it.joined;
    return ComingUp{driver, *it.joined - *it.began, it.state_since - rises};
  }

  std::vector<Observation> seen() && {
    std::set<ComponentId> told;
    std::vector<Observation> kept;
    for (auto each = seen_.rbegin(); each != seen_.rend(); ++each) {
      const auto* read = std::get_if<LifecycleRead>(&each->what);
      if (read == nullptr || told.insert(read->component).second) kept.push_back(std::move(*each));
    }
    return {std::make_move_iterator(kept.rbegin()), std::make_move_iterator(kept.rend())};
  }

 private:
  struct Part {
    CommandId start{};
    std::optional<Time> began;
    std::optional<Time> joined;
    Time news{};  // when it joined, or showed another end of its
    bool has_lifecycle = false;
    bool has_ended = false;
    ComingUp before{};             // how it came up last
    std::string trouble{};         // why it could not be started
    bool is_left_halfway = false;  // by a culprit before this one
    bool was_asked = false;        // to change its lifecycle
    Time asked{};                  // first
    Lifecycle state = Lifecycle::kUnknown;
    Time state_since{};
  };
  Part& part(ComponentId component) { return parts_[component.index]; }

  template <class Done>
  bool observe_until(Time until, Done done) {
    while (!done()) {
      if (stop_ || robot_.now() >= until) return false;
      const std::size_t before = seen_.size();
      robot_.observe(until, seen_);
      for (std::size_t i = before; i < seen_.size(); ++i) take(seen_[i]);
      // Answers to requests that are not the manager's.
      std::erase_if(seen_,
                    [](const Observation& o) { return std::holds_alternative<Reply>(o.what); });
    }
    return true;
  }

  void take(const Observation& observation) {
    if (const auto* node = std::get_if<NodeAppeared>(&observation.what)) {
      const auto component = binding_.bind(node->node);
      if (component && !part(*component).joined)
        part(*component).joined = part(*component).news = observation.at;
    } else if (const auto* end = std::get_if<EndpointAppeared>(&observation.what)) {
      const auto component = binding_.bind(end->node);
      if (!component) return;
      part(*component).news = observation.at;
      if (end->kind == EndpointKind::kServer && end->name == end->node + "/change_state")
        part(*component).has_lifecycle = true;
    } else if (const auto* read = std::get_if<LifecycleRead>(&observation.what)) {
      Part& it = part(read->component);
      it.has_lifecycle = true;
      if (it.state != read->state) it.state_since = observation.at;
      it.state = read->state;
    } else if (const auto* process = std::get_if<ProcessSeen>(&observation.what)) {
      part(process->component).has_ended = process->state == ProcessState::kGone;
    } else if (const auto* reply = std::get_if<Reply>(&observation.what)) {
      take(*reply);
    }
  }

  void take(const Reply& reply) {
    if (reply.command == asked_) reply_ = reply;
    if (reply.outcome == Outcome::kDone) return;
    for (Part& each : parts_) {
      if (each.start != reply.command || !each.began) continue;
      each.has_ended = true;
      each.trouble = reply.text;
    }
  }

  bool joins(ComponentId component) {
    observe_until(end_, [&] { return part(component).joined || part(component).has_ended; });
    return part(component).joined && !part(component).has_ended;
  }

  // A node announces its services together with itself; on a busy machine they come one after the other. The
  // file can say that there will be some.
  bool is_managed(ComponentId component) {
    const Part& it = part(component);
    const bool is_told = rules_[component].lifecycle == LifecycleDriver::kManaged;
    const auto is_known = [&] { return it.has_lifecycle || it.has_ended; };
    const auto until = [&] {
      return std::min(end_, is_told ? later(*it.joined, times_.transition)
                                    : later(it.news, times_.least_grace));
    };
    for (Time last{}; !is_known() && !stop_ && last != until();) {
      last = until();
      observe_until(last, is_known);
    }
    return it.has_lifecycle && !it.has_ended;
  }

  // From the order to start it until its node was there; 0: it was not started here.
  static Duration start_of(const Part& it) {
    return it.began ? *it.joined - *it.began : Duration::zero();
  }

  // Whether it leaves the state in which every lifecycle node begins, without a request from here.
  bool moves(ComponentId component) {
    const Part& it = part(component);
    using Driver = ComingUp::Driver;
    const bool is_ours = it.before.driver == Driver::kCulprit;
    const Duration others =
        it.before.driver == Driver::kOther ? 2 * it.before.rising : Duration::zero();
    const Duration grace =
        is_ours ? Duration::zero() : std::max({times_.least_grace, start_of(it), others});
    return observe_until(std::min(end_, later(*it.joined, grace)), [&] {
      return it.state != Lifecycle::kUnknown && it.state != Lifecycle::kUnconfigured;
    });
  }

  // Takes it from one state to the next, if it is in the first. Only the state that is read back
  // counts.
  std::optional<std::string> step(ComponentId component, Transition transition, Lifecycle from,
                                  Lifecycle to) {
    if (read(component) != from) return std::nullopt;
    if (!std::exchange(part(component).was_asked, true)) {
      part(component).asked = robot_.now();
      on_asked_(component);
    }
    const Reply reply = ask(component, ChangeLifecycle{transition});
    Lifecycle state = read(component);
    for (const Time end = later(robot_.now(), times_.transition);
         state == Lifecycle::kTransition && robot_.now() < end && !stop_;) {
      observe_until(later(robot_.now(), kPeriod), [] { return false; });
      state = read(component);
    }
    if (state == to) return std::nullopt;
    const char* what = transition == Transition::kConfigure ? "to configure it" : "to activate it";
    return std::string(what) + " did not succeed" + (reply.text.empty() ? "" : ": " + reply.text);
  }

  Lifecycle read(ComponentId component) {
    const Reply reply = ask(component, ReadLifecycle{});
    const auto* state = std::get_if<Lifecycle>(&reply.value);
    return state == nullptr ? Lifecycle::kUnknown : *state;
  }

  template <class What>
  Reply ask(ComponentId component, What what) {
    asked_ = next_request();
    reply_.reset();
    robot_.execute({asked_, component, what, times_.transition});
    observe_until(later(robot_.now(), times_.transition + times_.least_grace),
                  [&] { return reply_ || part(component).has_ended; });
    if (reply_) return *reply_;
    const char* why = part(component).has_ended ? "its process has ended" : "no answer";
    return {asked_, Outcome::kTimedOut, {}, why};
  }

  CommandId next_request() { return CommandId{kFirstRequest + ++requests_}; }

  static constexpr std::uint64_t kFirstRequest = std::uint64_t{1}
                                                 << 63;  // the manager's begin at 1
  static constexpr Duration kPeriod = std::chrono::milliseconds(100);

  const OnAsked on_asked_;
  Robot& robot_;
  const RuleSet& rules_;
  const std::atomic<bool>& stop_;
  const LaunchTimes times_;
  ComponentBinding binding_;
  std::vector<Part> parts_;  // by component
  Time end_ = kNever;
  std::vector<Observation> seen_;
  std::uint64_t requests_ = 0;
  CommandId asked_{};
  std::optional<Reply> reply_;
};

}  // namespace

std::vector<ComponentId> in_order(const RuleSet& rules) {
  std::vector<bool> is_visited(rules.components.size());
  std::vector<ComponentId> order;
  for (std::size_t c = 0; c < rules.components.size(); ++c)
    add_in_order(ComponentId(c), rules, is_visited, order);
  return order;
}

std::filesystem::path launching_beside(const std::filesystem::path& journal) {
  return journal.string() + "-launching";
}

// "lidar", or "lidar asked", a line.
Unfinished read_unfinished(const std::filesystem::path& path) {
  Unfinished unfinished;
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return unfinished;
  const auto text = read_text(path.string());
  if (!text) return unfinished;
  std::istringstream lines(*text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t blank = line.find(' ');
    unfinished[line.substr(0, blank)] = blank != std::string::npos;
  }
  return unfinished;
}

Expected<void> write_unfinished(const std::filesystem::path& path, const Unfinished& unfinished) {
  std::error_code error;
  if (unfinished.empty()) {
    std::filesystem::remove(path, error);
    return {};
  }
  std::string text;
  for (const auto& [name, was_asked] : unfinished) text += name + (was_asked ? " asked\n" : "\n");
  return write_text(path.string(), text);
}

Launched launch(Robot& robot, const RuleSet& rules, const StartComponent& start, Listener& listener,
                const std::atomic<bool>& stop, LaunchTimes times, const LaunchKeeper& keeper) {
  Unfinished unfinished;
  Starting starting(robot, rules, stop, times, [&](ComponentId c) {
    unfinished[rules[c].name] = true;
    keeper.keep(unfinished);
  });
  starting.remember(keeper.past);
  starting.look();
  std::vector<ComponentId> missing;
  std::vector<ComponentId> started;
  for (const ComponentId c : in_order(rules)) {
    if (keeper.stay_down.contains(c)) {
      if (keeper.starts_missing && !starting.is_there(c) && rules[c].can_start())
        listener.on_remark("culprit: " + rules[c].name +
                           " is not started: it stays down until `culprit revive`\n");
      continue;
    }
    const auto left = keeper.left.find(rules[c].name);
    if (left != keeper.left.end() && keeper.runs(c)) {
      listener.on_remark("bringing up " + rules[c].name +
                         ", which an earlier culprit had started\n");
      starting.resume(c, left->second);
      unfinished.insert(*left);
    } else if (keeper.starts_missing && !starting.is_there(c) && rules[c].can_start() &&
               !rules[c].is_respawned) {
      missing.push_back(c);
      unfinished[rules[c].name] = false;
    } else {
      continue;
    }
    started.push_back(c);
  }
  if (stop) return {std::move(starting).seen(), {}, {}};
  keeper.keep(unfinished);
  for (const ComponentId c : missing) {
    listener.on_remark("starting " + rules[c].name + "\n");
    starting.begin(c, start);
  }
  Launched launched;
  for (const ComponentId c : started) {
    launched.parts.push_back({rules[c].name, rules[c].node, {}});
    if (stop) continue;
    if (const auto trouble = starting.bring_up(c))
      listener.on_remark("culprit: " + rules[c].name + " was started and is not up: " + *trouble +
                         "\n");
    if (const auto how = starting.came_up(c))
      launched.past.push_back({starting.joined(c), CameUp{c, *how}});
    if (stop) continue;
    unfinished.erase(rules[c].name);
    keeper.keep(unfinished);
  }
  std::ranges::stable_sort(launched.past, {}, &Event::at);
  launched.seen = std::move(starting).seen();
  return launched;
}

}  // namespace culprit::live

#include "live/live_robot.h"

#include <algorithm>
#include <set>
#include <system_error>

#include "base/environment.h"
#include "journal/requests.h"
#include "live/launch.h"
#include "owners/proc.h"

namespace culprit::live {
namespace {

// ", with /tracker, /filter"
std::string with(const owners::ComponentContainers::Home& home) {
  constexpr std::size_t kShown = 3;
  std::string text;
  for (std::size_t i = 0; i < std::min(home.others.size(), kShown); ++i)
    text += (i == 0 ? ", with " : ", ") + home.others[i];
  const std::size_t more = home.others.size() - std::min(home.others.size(), kShown);
  return more == 0 ? text : text + " and " + std::to_string(more) + " more";
}

// "process 12 (/opt/ros/bin/camera of user 1000), started by process 9 (/usr/bin/python3 ...)"
std::string program_of(int pid) {
  constexpr int kInit = 1;  // it gets those whose parent has ended
  const auto in_words = [](int process) {
    const auto identity = owners::identity_of(process);
    return "process " + std::to_string(process) +
           (identity ? " (" + owners::to_string(*identity) + ")" : "");
  };
  const int parent = owners::parent_of(pid).value_or(0);
  return in_words(pid) + (parent > kInit ? ", started by " + in_words(parent) : "");
}

// One that goes on, and is proven, where those of `ours` end.
std::optional<int> other_of(const std::vector<int>& processes, const std::set<int>& ours) {
  const auto other = std::ranges::find_if(processes, [&](int pid) {
    const char state = pid == 0 ? 'Z' : owners::state_letter(pid).value_or('Z');
    return !ours.contains(pid) && state != 'Z' && state != 'T' && state != 't';
  });
  return other == processes.end() ? std::nullopt : std::optional(*other);
}

}  // namespace

LiveRobot::LiveRobot(const RuleSet& rules)
    : rules_(rules),
      binding_(rules),
      containers_(rules),
      elsewhere_(host_name()),
      units_(rules, inbox_) {}

LiveRobot::~LiveRobot() = default;

void LiveRobot::report(std::string trouble) { inbox_.put(LinkTrouble{std::move(trouble)}); }

void LiveRobot::tell(PriorsTold priors) { inbox_.put(std::move(priors)); }

// Each part has threads of its own. Where the system gives none (pids.max), the robot is not joined: the manager that
// runs goes on.
Expected<std::unique_ptr<LiveRobot>> LiveRobot::open(const RuleSet& rules, Options options) {
  try {
    return join(rules, std::move(options));
  } catch (const std::system_error& no_thread) {
    return Error{std::string("the system gives culprit no further thread (") + no_thread.what() +
                 "); raise TasksMax, pids.max or ulimit -u"};
  }
}

Expected<std::unique_ptr<LiveRobot>> LiveRobot::join(const RuleSet& rules, Options options) {
  if (auto seen = owners::proc_is_of_our_processes(); !seen) return Error{seen.error()};
  std::unique_ptr<LiveRobot> robot(new LiveRobot(rules));
  robot->supervisor_ =
      std::make_unique<owners::Supervisor>(rules, std::move(options.supervisor), robot->inbox_);
  auto link = link::Link::open(rules, std::move(options.link), robot->inbox_);
  if (!link) return Error{link.error()};
  robot->link_ = std::move(*link);
  robot->container_clients_ = std::make_unique<owners::ContainerClients>(
      robot->link_->entry(), [&link = *robot->link_](const std::string& node) {
        const auto all = link.contested();
        const auto found = all.find(node);
        return found == all.end() ? std::nullopt : std::optional(found->second);
      });
  owners::ComposedNodes::ContainerOwner owner{
      [&robot = *robot](CommandId command, ComponentId component) {
        robot.start_process(command, component);
      },
      [&robot = *robot](CommandId command, ComponentId component, int pid, owners::Ending ending,
                        owners::Hangs hangs) {
        robot.end_process(command, component, pid, ending, hangs);
      }};
  robot->composed_ = std::make_unique<owners::ComposedNodes>(
      rules, in_order(rules), *robot->container_clients_, std::move(owner), robot->inbox_);
  return robot;
}

void LiveRobot::observe(Time until, std::vector<Observation>& observations) {
  const std::size_t before = observations.size();
  listen(until, observations);
  // Before that nothing is judged for not being heard.
  shown_until_ = until - Duration(1);
  if (live_now() >= until) prove_hearing(observations);
  witness(before, observations);
  // Replies to requests to a container's owner do not concern the manager.
  const auto is_composed = [this](const Observation& o) {
    const auto* reply = std::get_if<Reply>(&o.what);
    return reply != nullptr && composed_->answered(*reply);
  };
  observations.erase(std::remove_if(observations.begin() + static_cast<std::ptrdiff_t>(before),
                                    observations.end(), is_composed),
                     observations.end());
  // A component whose process was found is watched from now on, also if culprit did not start it.
  for (std::size_t i = before; i < observations.size(); ++i) {
    containers_.observe(observations[i]);
    elsewhere_.observe(observations[i]);
    composed_->observe(observations[i]);
    const auto* appeared = std::get_if<NodeAppeared>(&observations[i].what);
    if (appeared == nullptr) continue;
    const auto component = binding_.bind(appeared->node);
    if (!component || appeared->pid == 0) continue;
    elsewhere_.runs_here(*component, appeared->pid);
    supervisor_->adopt(*component, appeared->pid, observations[i].at);
    units_.found(*component, appeared->pid);
  }
  tell_what_ends_together(before, observations);
}

// No other component ends with one that a container loads or that has an owner: it is reloaded, or
// the request is refused. A process that culprit did not start is ended alone, without its group.
void LiveRobot::tell_what_ends_together(std::size_t before,
                                        std::vector<Observation>& observations) {
  const bool is_news = std::any_of(observations.begin() + static_cast<std::ptrdiff_t>(before),
                                   observations.end(), [](const Observation& each) {
                                     return std::holds_alternative<NodeAppeared>(each.what) ||
                                            std::holds_alternative<NodeVanished>(each.what);
                                   });
  if (!is_news) return;
  for (std::size_t c = 0; c < rules_.components.size(); ++c) {
    const ComponentId component(c);
    if (rules_[component].has_owner() || composed_->is_responsible_for(component)) continue;
    std::vector<ComponentId> others =
        containers_.end_with(component, supervisor_->has_started(component));
    std::vector<ComponentId>& told = ends_with_[component];
    if (told == others) continue;
    told = others;
    observations.push_back({live_now(), EndsWith{component, std::move(others)}});
  }
}

// Until then, or until hearing becomes doubtful or certain again. Between two heartbeats nothing
// changes.
void LiveRobot::listen(Time until, std::vector<Observation>& observations) {
  const std::size_t before = observations.size();
  while (true) {
    const Time now = live_now();
    const bool judges = link_->doubtful() > now;
    if (judges != judges_) return inbox_.take(now, observations);
    const Time look = judges ? link_->doubtful() : later(now, ros2::Hearing::kPeriod);
    inbox_.take(std::min(until, look), observations);
    const bool was_woken = observations.size() > before || live_now() < std::min(until, look);
    if (was_woken || live_now() >= until) return;
  }
}

// A silence is judged when its time is up, and that the robot was heard last may be shown of a
// moment before it only. So culprit sends a message to itself. Messages that arrive until it
// returns, a fraction of a millisecond later, are judged as well. If it does not return in time,
// hearing is doubtful.
void LiveRobot::prove_hearing(std::vector<Observation>& observations) {
  constexpr Duration kLook = std::chrono::microseconds(100);
  const Time asked = live_now();
  link_->prove_hearing();
  while (link_->heard() < asked && link_->doubtful() > live_now())
    inbox_.take(later(live_now(), kLook), observations);
  inbox_.take(live_now(), observations);
  shown_until_ = link_->heard();
}

// Must run before observations are judged: it decides whether missing messages mean anything.
void LiveRobot::witness(std::size_t before, std::vector<Observation>& observations) {
  const Time now = live_now();
  const bool judges = link_->doubtful() > now;
  if (!judges) shown_until_ = kNever;  // nothing is judged, whatever the time
  if (judges || link_->is_paused()) {
    deaf_since_.reset();
  } else if (!deaf_since_) {
    deaf_since_ = now;
  }
  if (judges == judges_) return;
  judges_ = judges;
  Observation observation{now, HearingRegained{}};
  if (!judges) observation.what = HearingLost{link_->doubt()};
  observations.insert(observations.begin() + static_cast<std::ptrdiff_t>(before),
                      std::move(observation));
}

void LiveRobot::execute(const Command& command) {
  if (const std::string doubt = binding_.ambiguity(command.component); !doubt.empty())
    return inbox_.put(Reply{command.id, Outcome::kRefused, {}, doubt});
  if (std::holds_alternative<StopProcess>(command.what)) {
    stop_process(command);
  } else if (std::holds_alternative<StartProcess>(command.what)) {
    start(command.id, command.component, command.timeout);
  } else {
    link_->execute(command);
  }
}

void LiveRobot::adopt_again(ComponentId component, int pid, Time known) {
  supervisor_->adopt_again(component, pid, known);
  if (pid != 0 && !rules_[component].node.empty()) link_->note_proven_here(rules_[component].node);
  composed_->remember(component, pid);
}

void LiveRobot::remember_hosts(const KnownRobot& known) {
  std::set<ComponentId> done;
  for (auto part = known.parts.rbegin(); part != known.parts.rend(); ++part) {
    const auto component = journal::find_component(rules_, part->component);
    if (component && done.insert(*component).second) elsewhere_.remember(*component, part->host);
  }
}

void LiveRobot::withdraw_doubles(const std::function<bool(ComponentId)>& may) {
  const std::map<std::string, std::vector<int>> doubled = link_->doubled();
  for (const auto& [node, processes] : doubled) {
    const auto component = binding_.bind(node);
    if (!component || rules_[*component].launch.empty() || !may(*component)) continue;
    const std::set<int> ours = supervisor_->started(*component);
    const auto other = other_of(processes, ours);
    if (!other || std::ranges::none_of(processes, [&](int pid) { return ours.contains(pid); }))
      continue;
    const std::vector<std::string> would_end = containers_.nodes_in(ours);
    const bool is_all_doubled = std::ranges::all_of(would_end, [&](const std::string& each) {
      const auto found = doubled.find(each);
      return found != doubled.end() && other_of(found->second, ours);
    });
    if (!is_all_doubled) continue;
    report(rules_[*component].name + " runs twice: culprit started one, and there is " +
           program_of(*other) + ", too; culprit ends its own");
    supervisor_->withdraw(*component);
  }
}

void LiveRobot::start(CommandId command, ComponentId component, Duration patience) {
  const auto cut_off = rules_[component].has_owner() ? std::nullopt : link_->cut_off(component);
  if (cut_off)
    return inbox_.put(Reply{command,
                            Outcome::kUnreachable,
                            {},
                            rules_[component].name + " ran on " + *cut_off +
                                ", which is unreachable now: it may still run there. culprit "
                                "starts nothing in its place"});
  if (composed_->is_responsible_for(component))
    return composed_->start(command, component, patience);
  start_process(command, component);
}

void LiveRobot::start_process(CommandId command, ComponentId component) {
  if (auto* units = units_.of(component)) return units->start(command, component);
  if (const std::string host = elsewhere_.host_of(component); !host.empty())
    return inbox_.put(Reply{command,
                            Outcome::kUnreachable,
                            {},
                            rules_[component].name + " ran on " + host +
                                " last, and may still run there: culprit starts no second one "
                                "here. Start it there, or declare its owner there (UNIT or "
                                "CONTAINER, with HOST)"});
  supervisor_->start(command, component);
}

// A process that culprit started belongs to the component by its LAUNCH, whatever other nodes are
// in it.
void LiveRobot::stop_process(const Command& command) {
  const ComponentId component = command.component;
  const Adaptation& what = rules_[command.purpose.strategy].adaptations[command.purpose.adaptation];
  const bool is_replaced = what.type == AdaptationType::kRedeploy;
  const auto ending = is_replaced ? owners::Ending::kToStartAgain : owners::Ending::kForGood;
  const StopProcess& stop = std::get<StopProcess>(command.what);
  const auto hangs = stop.hangs ? owners::Hangs::kYes : owners::Hangs::kNo;
  link_->expect_departure(component, later(live_now(), command.timeout));
  if (composed_->is_responsible_for(component))
    return composed_->stop(command.id, component, stop.pid, ending, hangs);
  const auto home = containers_.home_of(component);
  if (home && !supervisor_->has_started(component)) {
    const std::string& name = rules_[component].name;
    return inbox_.put(Reply{command.id,
                            Outcome::kRefused,
                            {},
                            name + " lives in the container " + home->container + with(*home) +
                                ": ending its process would end them all. Declare how it is "
                                "loaded, IN " +
                                home->container +
                                " PLUGIN package::Class, and the container itself as a "
                                "COMPONENT with NODE " +
                                home->container + " and a LAUNCH"});
  }
  // systemd and engines know themselves what they run.
  const auto lost = containers_.would_lose(component);
  if (lost && !rules_[component].has_owner() && !supervisor_->has_started(component)) {
    const std::string& name = rules_[component].name;
    const std::string& other = rules_[*lost].name;
    return inbox_.put(Reply{command.id,
                            Outcome::kRefused,
                            {},
                            name + " lives in one process with " + other +
                                ", which would end with it and is started otherwise. If a "
                                "container loads them, declare that: IN /container PLUGIN "
                                "package::Class; if one program makes both, leave LAUNCH to one"});
  }
  end_process(command.id, component, stop.pid, ending, hangs);
}

void LiveRobot::end_process(CommandId command, ComponentId component, int pid,
                            owners::Ending ending, owners::Hangs hangs) {
  if (auto* units = units_.of(component))
    return units->stop(command, component, pid, ending, hangs);
  supervisor_->stop(command, component, pid, ending, hangs);
}

}  // namespace culprit::live

// Messages that do not come, come late, or carry a wrong time.
#include <algorithm>
#include <set>

#include <fmt/core.h>

#include "base/tool_names.h"
#include "doctor/examine.h"
#include "doctor/stamped_types.h"
#include "doctor/wiring.h"
#include "doctor/wording.h"

namespace culprit::doctor {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kFewestStamps = 3;
constexpr Duration kOld = 1s;          // later than that no transform is kept for, by default 10 s
constexpr Duration kFuture = 2s;       // localization dates transforms ahead, by a second
constexpr Duration kOtherClock = 10s;  // off by more it is another clock

std::vector<std::string> names_of(const std::vector<End>& ends) {
  std::set<std::string> names;
  for (const End& end : ends) names.insert(end.node);
  return {names.begin(), names.end()};
}

// ---- whether they come

// The shortest that a subscriber demands; nothing if none does.
const End* most_demanding(const Channel& topic) {
  const End* found = nullptr;
  for (const End& to : topic.receivers) {
    const Duration deadline = to.endpoint.qos.deadline;
    if (deadline == rtps::kInfinite || is_tool_node(to.node)) continue;
    if (found == nullptr || deadline < found->endpoint.qos.deadline) found = &to;
  }
  return found;
}

// A best effort reader may lose one; two in twenty it does not.
bool is_late(const Flow& flow, Duration deadline) {
  const auto late = std::ranges::count_if(flow.pauses, [&](Duration p) { return p > deadline; });
  return late >= 2 && late * 20 >= std::ssize(flow.pauses);
}

void look_at_deadline(const std::string& name, const Channel& topic, const Flow& flow,
                      Findings& all) {
  const End* reader = most_demanding(topic);
  if (reader == nullptr || topic.senders.empty()) return;
  const Duration deadline = reader->endpoint.qos.deadline;
  const bool is_silent = flow.messages < 2 && flow.listened > 3 * deadline && flow.listened > 2s;
  if (!is_silent && !is_late(flow, deadline)) return;
  const std::vector<std::string> writers = names_of(topic.senders);
  const Duration longest = flow.pauses.empty() ? flow.listened : std::ranges::max(flow.pauses);
  all.push_back({"D040",
                 Gravity::kError,
                 name + ": " + listed(writers) + " → " + reader->node,
                 is_silent ? fmt::format("{} came in {}, and the deadline is {}",
                                         count_of(flow.messages, "message"),
                                         duration(flow.listened), duration(deadline))
                           : fmt::format("{} of {} pauses were longer than the deadline of {}, the "
                                         "longest {}",
                                         std::ranges::count_if(
                                             flow.pauses, [&](Duration p) { return p > deadline; }),
                                         flow.pauses.size(), duration(deadline), duration(longest)),
                 reader->node + " is notified again and again of a missed deadline",
                 "see what delays " + writers.front() + ", or set a deadline that it can meet",
                 {writers.front(), reader->node},
                 name});
}

bool is_active(const Picture& picture, const std::string& node) {
  const auto state = picture.lifecycles.find(node);
  return state == picture.lifecycles.end() || state->second.last == "active";
}

// Sensors publish all the time; for other topics this is unknown.
void look_at_silence(const Picture& picture, const std::string& name, const Channel& topic,
                     const Flow& flow, Findings& all) {
  constexpr Duration kLongEnough = 4s;
  if (flow.messages > 0 || flow.listened < kLongEnough) return;
  if (topic.senders.empty() || !is_sensor_type(topic.senders.front().endpoint.type)) return;
  if (!has_robots_end(topic.receivers)) return;  // some publish only while somebody listens
  const bool may_speak = std::ranges::any_of(topic.senders, [&](const End& from) {
    return !is_tool_node(from.node) && is_active(picture, from.node) &&
           !picture.unanswered.contains(from.node) && from.endpoint.partitions.empty();
  });
  if (!may_speak) return;
  const std::vector<std::string> writers = names_of(topic.senders);
  all.push_back({"D041", Gravity::kWarning,
                 name + ": " + listed(writers) + " → " + listed(names_of(topic.receivers)),
                 fmt::format("it is published, and nothing came in {}", duration(flow.listened)),
                 "its node answers, so it is the driver, the device or its input that stands still",
                 "see the log of " + writers.front() + ", and whether the device is there", writers,
                 name});
}

// ---- what does not arrive

// A few may be lost while readers and writers find each other.
void look_at_loss(const std::string& name, const Channel& topic, const Flow& flow, Findings& all) {
  constexpr std::size_t kFewestSent = 50;
  constexpr std::size_t kFewestLost = 3;
  constexpr double kMuch = 0.02;
  const std::size_t sent = flow.messages + flow.lost;
  const double share = sent == 0 ? 0 : static_cast<double>(flow.lost) / static_cast<double>(sent);
  if (sent < kFewestSent || flow.lost < kFewestLost || share < kMuch) return;
  const std::vector<std::string> writers = names_of(topic.senders);
  all.push_back({"D048", Gravity::kWarning, name + ": " + listed(writers),
                 fmt::format("{} of {} messages were sent and did not come here ({:.0f} %)",
                             flow.lost, sent, 100 * share),
                 "best-effort readers miss them, too, and reliable ones wait for their repetition; "
                 "the network or a host is at fault, not the node",
                 "see the link between the computers (ping, Wi-Fi), and the receive buffers here "
                 "(net.core.rmem_max)",
                 writers, name});
}

// ---- what time they carry

bool is_simulated(const Picture& picture, const std::string& node) {
  const auto found = picture.uses_simulated_time.find(node);
  return found != picture.uses_simulated_time.end() && found->second;
}

// How far the stamps of a robot are behind the clocks of its computers as a whole: nothing, unless
// most of them agree on a clock of their own, as those of a bag do that is played without /clock.
Duration own_clock(const Picture& picture) {
  std::vector<Duration> lags;
  for (const auto& [name, flow] : picture.flows) {
    if (flow.stamps && flow.stamps->count >= kFewestStamps) lags.push_back(flow.stamps->lag);
  }
  if (lags.size() < 2) return {};
  std::ranges::sort(lags);
  const Duration middle = lags[lags.size() / 2];
  if (middle > -kOtherClock && middle < kOtherClock) return {};
  const auto agree = std::ranges::count_if(
      lags, [&](Duration lag) { return lag > middle - kOtherClock && lag < middle + kOtherClock; });
  return 3 * agree >= 2 * std::ssize(lags) ? middle : Duration();
}

bool is_running(const std::optional<SimulatedClock>& clock) {
  return clock && clock->ticks > 1 && clock->last != clock->first;
}

void look_at_stamps(const Picture& picture, const std::string& name, const Channel& topic,
                    const Flow& flow, Duration clock, Findings& all) {
  const auto latches = [](const End& from) {
    return from.endpoint.qos.durability == rtps::Durability::kTransientLocal;
  };
  // A latched message was true when it was published, and still is.
  if (!flow.stamps || topic.senders.empty() || std::ranges::any_of(topic.senders, latches)) return;
  const Flow::Stamps& stamps = *flow.stamps;
  const std::vector<std::string> writers = names_of(topic.senders);
  const auto add = [&](const char* code, Gravity gravity, std::string seen, std::string matters,
                       std::string remedy) {
    all.push_back({code, gravity, name + ": " + listed(writers), std::move(seen),
                   std::move(matters), std::move(remedy), writers, name});
  };
  if (stamps.jumps_back > 0 && !(picture.clock && picture.clock->jumps_back > 0))
    add("D044", Gravity::kError,
        fmt::format("its time stamps jumped back {}, by {} at most",
                    stamps.jumps_back == 1 ? "once" : count_of(stamps.jumps_back, "time"),
                    duration(stamps.furthest_back)),
        "tf drops its history or what comes after, and filters start again",
        "is the clock set while it runs (chrony, PTP), or do two devices publish here?");
  if (stamps.count < kFewestStamps) return;
  const auto simulated = std::ranges::count_if(
      writers, [&](const std::string& node) { return is_simulated(picture, node); });
  const bool are_simulated = simulated == std::ssize(writers);
  if (simulated > 0 && !are_simulated) return;  // whose are they?
  if (are_simulated) {
    const bool is_wall_time = stamps.lag > -kOtherClock && stamps.lag < kOtherClock;
    if (is_running(picture.clock) && stamps.simulated_lag && is_wall_time &&
        (*stamps.simulated_lag < -kOtherClock || *stamps.simulated_lag > kOtherClock))
      add("D045", Gravity::kError,
          fmt::format(
              "its node has use_sim_time, and its stamps are of the real clock, {} from /clock",
              duration(std::max(*stamps.simulated_lag, -*stamps.simulated_lag))),
          "nodes with simulated time see them as far off, and tf refuses them",
          "let it stamp with its node's clock (node->now(), get_clock().now())");
    return;
  }
  const Duration lag = stamps.lag - clock;
  if (lag > kOld)
    add("D042", Gravity::kWarning,
        fmt::format("its stamps are {} old when they are sent", duration(lag)),
        "nodes that look up a transform or wait for messages of one time are too late",
        lag > 1h ? "set the clock of the device or computer that stamps them (chrony, PTP)"
                 : "see what delays them: a queue, a slow device, or a clock that is behind");
  if (lag < -kFuture)
    add("D043", Gravity::kError,
        fmt::format("its stamps are {} ahead when they are sent", duration(-lag)),
        "tf has no transform for that time yet: nodes wait for it, or drop them",
        "set the clock of the device or computer that stamps them (chrony, PTP)");
}

// ---- simulated time

void look_at_clock(const Picture& picture, const Wiring& wiring, Findings& all) {
  std::vector<std::string> simulated, real;
  for (const auto& [node, uses] : picture.uses_simulated_time) {
    if (!is_tool_node(node)) (uses ? simulated : real).push_back(node);
  }
  if (picture.clock && picture.clock->jumps_back > 0)
    all.push_back(
        {"D044",
         Gravity::kError,
         "/clock",
         fmt::format(
             "the simulated time jumped back {}",
             picture.clock->jumps_back == 1 ? "once" : count_of(picture.clock->jumps_back, "time")),
         "tf drops its history, and filters start again",
         "do two simulators or bags publish /clock?",
         {},
         "/clock"});
  if (simulated.empty()) return;
  const auto clock = wiring.topics.find("/clock");
  const bool is_published = clock != wiring.topics.end() && !clock->second.senders.empty();
  if (!is_published || !is_running(picture.clock)) {
    all.push_back({"D046", is_published ? Gravity::kWarning : Gravity::kError, listed(simulated),
                   is_published
                       ? "they use simulated time (use_sim_time), and /clock stands still"
                       : "they use simulated time (use_sim_time), and /clock has no publisher",
                   "for them no time passes: timers do not fire, and nothing has a time stamp",
                   is_published ? "let the simulation or the bag run"
                                : "start the simulator, or set use_sim_time to false",
                   simulated, "/clock"});
    return;
  }
  // A node that publishes no time stamp, and reads none, may use another clock.
  std::erase_if(real, [&](const std::string& node) {
    const auto found = std::ranges::find(
        picture.nodes, node, [](const Node& each) -> const std::string& { return each.node.name; });
    return found == picture.nodes.end() ||
           std::ranges::none_of(found->endpoints, [](const ros2::GraphEndpoint& each) {
             return each.kind == EndpointKind::kPublisher && is_stamped_type(each.type);
           });
  });
  std::erase_if(real, [&](const std::string& node) {  // who makes the clock is beyond it
    return std::ranges::any_of(clock->second.senders,
                               [&](const End& end) { return end.node == node; });
  });
  if (real.empty()) return;
  all.push_back(
      {"D047", Gravity::kWarning, listed(real),
       "they publish time stamps of the real clock, and others of the robot use simulated "
       "time (use_sim_time): " +
           listed(simulated),
       "each takes the other's messages for far off in time",
       "set use_sim_time for all nodes, or for none", real, "/clock"});
}

}  // namespace

void examine_flows(const Picture& picture, Findings& all) {
  const Wiring wiring = wiring_of(picture);
  const Duration clock = own_clock(picture);
  for (const auto& [name, flow] : picture.flows) {
    const auto topic = wiring.topics.find(name);
    if (topic == wiring.topics.end()) continue;
    look_at_deadline(name, topic->second, flow, all);
    look_at_silence(picture, name, topic->second, flow, all);
    look_at_loss(name, topic->second, flow, all);
    look_at_stamps(picture, name, topic->second, flow, clock, all);
  }
  look_at_clock(picture, wiring, all);
}

}  // namespace culprit::doctor

#include "rca_study/generator.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "simulation/random.h"

namespace culprit::study::rca {
namespace {

using simulation::Random;

constexpr double kFeedbackPasses = 0.5;  // controllers live with a bad estimate for a while
constexpr double kFirstFault_s = 3;      // until then the robot is well
constexpr double kAtOnce_s = 1;          // within which all faults come
constexpr double kCycle_s = 0.2;         // of the rules
constexpr double kShortestCause_s = 5;   // how long a common cause lasts
constexpr double kLongestCause_s = 15;

// How well each Repair helps against each FaultKind. No source publishes such rates; these say that
// a process that is gone or hangs needs a new one, and that most of the rest yields to a restart.
constexpr std::array<std::array<double, kFaultKinds>, kRepairs> kHelps = {{
    // silent, slow, degraded, flapping, crash, hang, wrong parameter
    {0.05, 0.10, 0.50, 0.05, 0.00, 0.00, 0.97},
    {0.80, 0.60, 0.50, 0.60, 0.00, 0.00, 0.10},
    {0.95, 0.90, 0.70, 0.90, 0.97, 0.97, 0.90},
}};
constexpr std::array kLevels = {Criticality::kNonCritical, Criticality::kWarning,
                                Criticality::kError};
constexpr std::array<int, kRepairs> kImpact = {2, 5, 15};
constexpr std::array<double, kRepairs> kTakes_s = {0.2, 1, 3};

std::vector<InjectedFault> faults(const RcaSetting& setting, Random& random) {
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random.next() % n); };
  std::set<std::size_t> faulty;
  std::vector<InjectedFault> all;
  while (faulty.size() < std::min(setting.faults, setting.components)) {
    const std::size_t component = below(setting.components);
    if (!faulty.insert(component).second) continue;
    const auto kind = static_cast<FaultKind>(below(kFaultKinds));
    all.push_back({component, setting.is_flapping ? FaultKind::kFlapping : kind,
                   kFirstFault_s + random.uniform(0, kAtOnce_s)});
  }
  if (setting.has_unfixable && !all.empty()) all.front().is_unfixable = true;
  return all;
}

class Generator {
 public:
  Generator(const RcaSetting& setting, std::uint64_t seed)
      : setting_(setting), factors_(setting.factors), random_(seed), more_(simulation::mix(~seed)) {
    scenario_.seed = random_.next();
  }

  RcaScenario run() {
    add_components();
    add_data();
    if (!setting_.is_as_told) add_redundancy();
    if (setting_.is_cyclic && size() > 1) add_feedback();
    if (setting_.components >= 20) add_infrastructure();
    scenario_.faults = faults(setting_, random_);
    leave_unwatched();
    hide_dependencies();
    add_common_causes();
    return std::move(scenario_);
  }

 private:
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(random_.next() % n); }
  std::size_t size() const { return setting_.components; }
  // As many layers as a robot of this size has: 5 of SUNSET's five nodes' kind, 10 of Autoware's.
  std::size_t layers() const {
    return std::clamp<std::size_t>(
        static_cast<std::size_t>(std::lround(2 * std::pow(static_cast<double>(size()), 0.3))), 2,
        std::max<std::size_t>(2, size() / 2));
  }
  std::size_t layer_of(std::size_t component) const { return component * layers() / size(); }
  std::size_t first_of(std::size_t layer) const {
    return (layer * size() + layers() - 1) / layers();
  }

  void add_components() {
    for (std::size_t i = 0; i < size(); ++i) {
      RcaComponent component{"c" + std::to_string(i), Criticality::kError, {}, {}};
      if (setting_.has_mixed_levels) component.criticality = kLevels[below(kLevels.size())];
      component.detector = {
          random_.uniform(factors_.detector_latency_s.low, factors_.detector_latency_s.high),
          setting_.noise, setting_.noise, factors_.false_alarms};
      for (std::size_t r = 0; r < kRepairs; ++r) component.treatments.push_back(treatment(r));
      if (factors_.states_latency) state_latency(component);
      scenario_.components.push_back(std::move(component));
      scenario_.topics.push_back({"/c" + std::to_string(i) + "/out", {i}, {}});
    }
  }

  // The rules' author knows the rates of the robots before this one, which differ a little, where
  // each is carried out: what needs a process is not, once that is gone.
  Treatment treatment(std::size_t repair) {
    Treatment treatment{static_cast<Repair>(repair), 0, 10, kImpact[repair], kTakes_s[repair], {}};
    double sum = 0;
    for (std::size_t k = 0; k < kFaultKinds; ++k) {
      sum += kHelps[repair][k];
      const double own = random_.uniform(0.85, 1.15);
      treatment.helps[k] =
          std::clamp(kHelps[repair][k] * (setting_.is_as_told ? 1 : own), 0.0, 0.98);
    }
    const std::size_t kinds = treatment.repair == Repair::kRedeploy ? kFaultKinds : kFaultKinds - 1;
    treatment.success = std::round(100 * sum / static_cast<double>(kinds));
    return treatment;
  }

  // The verdict on a strategy comes after its impact, and so after the detector could show it.
  static void state_latency(RcaComponent& component) {
    for (Treatment& treatment : component.treatments)
      treatment.impact += static_cast<int>(std::ceil(component.detector.latency_s / kCycle_s));
  }

  void subscribe(std::size_t topic, std::size_t component, double passes) {
    auto& subscribers = scenario_.topics[topic].subscribers;
    const bool is_there =
        std::any_of(subscribers.begin(), subscribers.end(),
                    [&](const Subscription& s) { return s.component == component; });
    if (is_there) return;
    subscribers.push_back(
        {component, passes, random_.uniform(factors_.delay_s.low, factors_.delay_s.high), false});
  }

  // One to three inputs; every tenth component of a layer has many readers.
  void add_data() {
    for (std::size_t i = first_of(1); i < size(); ++i) {
      const std::size_t layer = layer_of(i);
      const std::size_t inputs = 1 + below(3);
      for (std::size_t k = 0; k < inputs; ++k) {
        const std::size_t from = layer >= 2 && random_.chance(0.25) ? layer - 2 : layer - 1;
        const std::size_t width = first_of(from + 1) - first_of(from);
        std::size_t place = below(width);
        if (random_.chance(0.3)) place -= place % 10;
        subscribe(first_of(from) + place, i, factors_.pass);
      }
    }
  }

  void add_redundancy() {
    std::vector<std::vector<Subscription*>> inputs(size());
    for (RcaTopic& topic : scenario_.topics) {
      for (Subscription& s : topic.subscribers) inputs[s.component].push_back(&s);
    }
    for (auto& of_one : inputs) {
      if (of_one.size() < 2 || !random_.chance(0.1)) continue;
      of_one[0]->is_redundant = of_one[1]->is_redundant = true;
    }
  }

  void add_feedback() {
    const std::size_t count = std::max<std::size_t>(1, size() / 20);
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t from = first_of(1) + below(size() - first_of(1));
      const std::size_t back = std::min(layer_of(from), 1 + below(3));
      const std::size_t to = first_of(layer_of(from) - back);
      const std::size_t width = first_of(layer_of(from) - back + 1) - to;
      subscribe(from, to + below(width), setting_.is_as_told ? factors_.pass : kFeedbackPasses);
    }
  }

  void add_infrastructure() {
    const auto add_topic = [&](const std::string& name, double publish, double read) {
      RcaTopic topic{name, {}, {}, setting_.ignores_plumbing};
      scenario_.topics.push_back(topic);
      const std::size_t place = scenario_.topics.size() - 1;
      for (std::size_t i = 0; i < size(); ++i) {
        if (random_.chance(publish)) scenario_.topics[place].publishers.push_back(i);
        if (random_.chance(read)) subscribe(place, i, 0);
      }
    };
    add_topic("/tf", 0.05, 0.4);
    add_topic("/diagnostics", 0.6, 0);
    add_topic("/robot_state", 0, 0.2);
    const std::size_t monitor = first_of(layers() - 1) + below(size() - first_of(layers() - 1));
    scenario_.topics.back().publishers.push_back(monitor);
    subscribe(scenario_.topics.size() - 2, monitor, 0);
  }

  // So many of those at hand, each as likely as any other.
  template <class Each>
  void take_share(double share, std::vector<Each> all, const std::function<void(Each)>& take) {
    auto count = static_cast<std::size_t>(std::lround(share * static_cast<double>(all.size())));
    for (; count > 0; --count) {
      const std::size_t place = more_.next() % all.size();
      take(all[place]);
      all[place] = all.back();
      all.pop_back();
    }
  }

  void leave_unwatched() {
    std::vector<RcaComponent*> all;
    for (RcaComponent& component : scenario_.components) all.push_back(&component);
    take_share<RcaComponent*>(factors_.unwatched, all,
                              [](RcaComponent* c) { c->is_unwatched = true; });
  }

  void hide_dependencies() {
    std::vector<Subscription*> all;
    for (RcaTopic& topic : scenario_.topics) {
      for (Subscription& s : topic.subscribers) {
        if (s.passes > 0) all.push_back(&s);
      }
    }
    take_share<Subscription*>(factors_.hidden, all, [](Subscription* s) { s->is_hidden = true; });
  }

  // The components that illness may reach from one, that one included.
  std::vector<bool> reached_from(std::size_t component) const {
    std::vector<bool> is_reached(size(), false);
    std::vector<std::size_t> open{component};
    is_reached[component] = true;
    while (!open.empty()) {
      const std::size_t from = open.back();
      open.pop_back();
      for (const Subscription& s : scenario_.topics[from].subscribers) {
        if (s.passes <= 0 || is_reached[s.component]) continue;
        is_reached[s.component] = true;
        open.push_back(s.component);
      }
    }
    return is_reached;
  }

  // On a small robot there may be no two components of which neither depends on the other: then
  // there are fewer causes.
  void add_common_causes() {
    constexpr int kTries = 200;
    for (std::size_t n = 0; n < factors_.common_causes; ++n) {
      for (int k = 0; k < kTries; ++k) {
        const std::size_t first = more_.next() % size();
        const std::size_t second = more_.next() % size();
        if (reached_from(first)[second] || reached_from(second)[first]) continue;
        scenario_.common_causes.push_back({first, second,
                                           kFirstFault_s + more_.uniform(0, kAtOnce_s),
                                           more_.uniform(kShortestCause_s, kLongestCause_s)});
        break;
      }
    }
  }

  const RcaSetting& setting_;
  const RcaFactors& factors_;
  Random random_;
  Random more_;  // of the factors, so that a robot differs by them alone
  RcaScenario scenario_;
};

}  // namespace

std::vector<InjectedFault> random_faults(const RcaSetting& setting, std::uint64_t seed) {
  Random random(seed);
  return faults(setting, random);
}

RcaScenario generate(const RcaSetting& setting, std::uint64_t seed) {
  return Generator(setting, seed).run();
}

}  // namespace culprit::study::rca

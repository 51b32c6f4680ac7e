#include "web/robot_json.h"

#include <cmath>
#include <map>

#include "knowledge/describe.h"
#include "web/component_health.h"
#include "web/event_json.h"
#include "web/overview.h"

namespace culprit::web {
namespace {

Json strategy_to_json(const Strategy& strategy, const RuleSet& rules) {
  const Belief prior = initial_belief(strategy.success, strategy.confidence);
  Json json{{"name", strategy.name},
            {"impact", strategy.impact.count},
            {"components", names_of(strategy.components, rules)},
            {"prior", {prior.alpha, prior.beta}},
            {"actions", action_list(strategy, rules)}};
  return json;
}

// The owner in words; empty: the rules name none.
std::string owner_of(const Component& component) {
  using Engine = EngineContainer::Engine;
  if (component.unit)
    return component.unit->name +
           (component.unit->is_of_user ? ", of the user's systemd" : ", of systemd");
  if (component.engine)
    return std::string(component.engine->engine == Engine::kDocker ? "docker " : "podman ") +
           component.engine->name;
  if (component.composed)
    return component.composed->container + ", which loads " + component.composed->plugin;
  if (component.is_respawned) return "its launcher, which starts it again";
  return component.launch.empty() ? "" : "culprit, by its LAUNCH command";
}

Json component_to_json(const Component& component) {
  Json json{{"name", component.name}, {"can_start", component.can_start_again()}};
  const auto add = [&](const char* member, const std::string& text) {
    if (!text.empty()) json[member] = text;
  };
  add("node", component.node);
  add("owner", owner_of(component));
  add("host", component.host());
  if (component.composed) add("container", component.composed->container);
  if (component.engine) add("container", component.engine->name);
  if (component.is_required) json["required"] = true;
  return json;
}

Json value_of(const Slot& slot, const Input& input) {
  if (!slot.known) return nullptr;
  switch (input.type) {
    case Type::kBool:
      return slot.b;
    case Type::kDuration:
      return seconds(Duration(slot.i));
    case Type::kInt:
      return slot.i;
    case Type::kString:
      return std::string(slot.s);
    case Type::kDouble:
      return std::isfinite(slot.d) ? Json(slot.d) : Json(nullptr);
  }
  return nullptr;
}

std::string_view word_of(RulePhase phase) {
  constexpr std::string_view kWords[] = {"quiet", "failing", "attempting", "exhausted"};
  return kWords[static_cast<std::size_t>(phase)];
}

std::string_view word_of(Attempt::Stage stage) {
  constexpr std::string_view kWords[] = {"adapting", "waiting", "suspended", "undoing", "over"};
  return kWords[static_cast<std::size_t>(stage)];
}

Json rule_to_json(RuleId id, const Knowledge& knowledge, Time start) {
  const RuleState& state = knowledge.states[id];
  Json json{{"phase", word_of(state.phase)}};
  if (const auto& blind = knowledge.blindness[id]) {
    json["blind"] = {{"since", time_to_json(blind->since, start)},
                     {"why", culprit::to_string(blind->why)},
                     {"text", describe(*blind)}};
    if (!blind->input.empty()) json["blind"]["input"] = blind->input;
    if (!blind->near.empty()) json["blind"]["near"] = blind->near;
  }
  // A trigger that is true, but not yet for the time of FOR or HOLD, is no failure yet.
  if (state.phase == RulePhase::kQuiet) {
    json["trigger"] =
        state.detection.trigger.known ? Json(state.detection.trigger.b) : Json(nullptr);
    return json;
  }
  json["since"] = time_to_json(state.failing_since, start);
  json["attempts"] = state.search.attempts;
  if (state.search.retry_at > knowledge.now)
    json["retry_at"] = time_to_json(state.search.retry_at, start);
  if (state.settling) {
    json["settling"] = {{"with", knowledge.rules[state.settling->with].name},
                        {"until", time_to_json(state.settling->until, start)}};
  }
  if (state.attempt) {
    json["attempt"] = {{"strategy", knowledge.rules[state.attempt->strategy].name},
                       {"stage", word_of(state.attempt->stage)},
                       {"chosen", time_to_json(state.attempt->chosen, start)},
                       {"deadline", time_to_json(state.attempt->deadline, start)}};
  }
  return json;
}

// The state of the process. A stopped process has not exited: it goes on after SIGCONT.
std::string_view word_of_process(const ComponentState& state) {
  if (state.process == ProcessState::kStopped) return "stopped";
  if (state.hangs()) return "hung";
  return *state.alive ? "running" : "gone";
}

Json components_to_json(const Knowledge& knowledge) {
  const std::vector<std::size_t> health = health_of_components(knowledge);
  Json list = Json::array();
  for (std::size_t c = 0; c < health.size(); ++c) {
    const ComponentId id(c);
    const ComponentState& state = knowledge.components[id];
    Json json{{"health", kHealthWords[health[c]]}, {"present", knowledge.graph.is_present(id)}};
    json["alive"] = state.alive ? Json(*state.alive) : Json(nullptr);
    // A PID of another computer means nothing here.
    if (state.known_pid() != 0 && knowledge.rules.components[c].host().empty())
      json["pid"] = state.known_pid();
    if (state.alive) json["process"] = word_of_process(state);
    if (state.lifecycle != Lifecycle::kUnknown) json["lifecycle"] = to_string(state.lifecycle);
    if (!state.process_remark.empty()) json["remark"] = state.process_remark;
    if (const std::string host = knowledge.host_of(id); !host.empty()) json["host"] = host;
    if (knowledge.is_unheard(id) && !state.time_held) json["unheard"] = true;
    if (const Attempt* attempt = knowledge.states.reservation(id))
      json["adapting"] = knowledge.rules[attempt->strategy].name;
    list.push_back(std::move(json));
  }
  return list;
}

// The usual rate and the present silence of each topic that is watched.
Json topics_to_json(const Knowledge& knowledge) {
  Json list = Json::array();
  for (std::size_t t = 0; t < knowledge.rules.topics.size(); ++t) {
    const SignalStore::Rhythm& rhythm = knowledge.signals.rhythm(TopicId(t));
    Json json{{"rate", nullptr}, {"age", nullptr}};
    if (rhythm.interval > Duration::zero())
      json["rate"] = std::round(10 / seconds(rhythm.interval)) / 10;
    if (rhythm.last) json["age"] = time_to_json(knowledge.now, *rhythm.last);
    list.push_back(std::move(json));
  }
  return list;
}

// The learned couplings between failures.
Json couplings_to_json(const Knowledge& knowledge) {
  Json list = Json::array();
  for (std::size_t r = 0; r < knowledge.rules.rules.size(); ++r) {
    for (const Couplings::Learned& each : knowledge.couplings.of(RuleId(r))) {
      if (each.coupling == Coupling()) continue;
      list.push_back(Json::array({each.cause.index, r, each.coupling.cleared, each.coupling.stayed,
                                  each.coupling.spared}));
    }
  }
  return list;
}

// How late rules show a change, as far as that was learned.
Json latencies_to_json(const Knowledge& knowledge) {
  Json list = Json::array();
  for (std::size_t r = 0; r < knowledge.rules.rules.size(); ++r) {
    const Latencies::Learned& latency = knowledge.latencies.learned(RuleId(r));
    if (latency.count == 0) continue;
    list.push_back(
        Json::array({r, latency.count, seconds(latency.range.least), seconds(latency.range.most)}));
  }
  return list;
}

// How often failures of two rules began together; of one rule twice: how often it began.
Json coincidences_to_json(const Knowledge& knowledge) {
  Json list = Json::array();
  for (std::size_t r = 0; r < knowledge.rules.rules.size(); ++r) {
    const int count = knowledge.coincidences.times(RuleId(r));
    if (count > 0) list.push_back(Json::array({r, r, count}));
  }
  for (const auto& [pair, count] : knowledge.coincidences.pairs()) {
    if (count > 0) list.push_back(Json::array({pair.first.index, pair.second.index, count}));
  }
  return list;
}

}  // namespace

Json learned_to_json(const Knowledge& knowledge) {
  return {{"couplings", couplings_to_json(knowledge)},
          {"latencies", latencies_to_json(knowledge)},
          {"coincidences", coincidences_to_json(knowledge)}};
}

Json rules_to_json(const RuleSet& rules) {
  Json json{{"robot", rules.robot},        {"cycle_s", seconds(rules.cycle)},
            {"components", Json::array()}, {"topics", Json::array()},
            {"inputs", Json::array()},     {"thresholds", Json::array()},
            {"rules", Json::array()}};
  for (const Component& c : rules.components) json["components"].push_back(component_to_json(c));
  for (const Topic& t : rules.topics) json["topics"].push_back(t.name);
  for (const Input& i : rules.inputs) {
    json["inputs"].push_back(describe(i, rules));
    json["thresholds"].push_back(i.thresholds);
  }
  for (const Rule& rule : rules.rules) {
    Json entry{{"name", rule.name},
               {"criticality", culprit::to_string(rule.policies.criticality)},
               {"attempts", rule.policies.attempts},
               {"components", names_of(rule.components, rules)},
               {"inputs", Json::array()},
               {"strategies", Json::array()}};
    for (const InputId i : rule.inputs) entry["inputs"].push_back(i.index);
    for (const StrategyId s : rule.strategies)
      entry["strategies"].push_back(strategy_to_json(rules[s], rules));
    json["rules"].push_back(std::move(entry));
  }
  return json;
}

namespace {

// The node of a culprit that only looks at the robot, such as `culprit doctor`, is no part of it.
bool is_survey(const std::string& node) {
  return node.substr(node.rfind('/') + 1).starts_with("_culprit_survey");
}

}  // namespace

Json graph_to_json(const Knowledge& knowledge) {
  const DependencyGraph& graph = knowledge.graph;
  std::vector<DependencyGraph::Edge> edges = graph.edges();
  std::erase_if(
      edges, [](const auto& edge) { return is_survey(edge.consumer) || is_survey(edge.producer); });
  std::map<std::string, bool> nodes;  // and whether they are present
  // A node that is gone but has an edge counts: its consumers wait for it.
  for (const auto& edge : edges) nodes[edge.consumer] = nodes[edge.producer] = false;
  for (const std::string& node : graph.nodes()) {
    if (!is_survey(node)) nodes[node] = true;
  }

  // So does a component, whether it is there or not.
  std::map<std::string, ComponentId> components;
  for (std::size_t c = 0; c < knowledge.rules.components.size(); ++c) {
    const std::string& name = graph.node_name(ComponentId(c));
    if (name.empty()) continue;
    nodes.try_emplace(name, false);
    components.emplace(name, ComponentId(c));
  }

  Json json{{"nodes", Json::array()}, {"edges", Json::array()}};
  for (const auto& [name, is_present] : nodes) {
    Json node{{"node", name}, {"present", is_present}};
    if (const auto component = components.find(name); component != components.end()) {
      node["component"] = knowledge.rules[component->second].name;
      const std::string host = knowledge.host_of(component->second);
      if (!host.empty()) node["host"] = host;
    }
    json["nodes"].push_back(std::move(node));
  }
  for (const auto& edge : edges)
    json["edges"].push_back(Json::array({edge.consumer, edge.producer, edge.channel}));
  return json;
}

namespace {

// The running components that culprit started, and the launcher that each one stands in for.
void add_started(const Knowledge& knowledge, Time start, Json& list) {
  for (const Departures::Started& each : knowledge.departures.started()) {
    Json entry{{"component", knowledge.rules[each.component].name},
               {"pid", each.pid},
               {"since", time_to_json(each.since, start)}};
    entry["launcher"] = each.launcher == 0 ? Json(nullptr) : Json(each.launcher);
    list.push_back(std::move(entry));
  }
}

// The components that are not started again, since a person ended them, or may have.
void add_down(const Knowledge& knowledge, Json& list) {
  for (std::size_t c = 0; c < knowledge.rules.components.size(); ++c) {
    const auto departure = knowledge.departures.of(ComponentId(c), knowledge.now);
    if (!departure || departure->what != Departures::What::kStaysDown) continue;
    const std::string& name = knowledge.rules.components[c].name;
    list.push_back({{"component", name},
                    {"why", culprit::to_string(departure->why)},
                    {"text", describe(*departure, name)}});
  }
}

}  // namespace

Json control_to_json(const Manager& manager, Time start) {
  const RuleSet& rules = manager.knowledge().rules;
  const auto held_back = manager.held_back();
  Json json{{"paused", manager.governor().is_paused()},
            {"held_back", held_back ? Json(*held_back) : Json()},
            {"dry_run", manager.autonomy() == Autonomy::kAdvise},
            {"hears", manager.hears()},
            {"silences", Json::array()},
            {"asked", Json::array()},
            {"started", Json::array()},
            {"down", Json::array()}};
  add_started(manager.knowledge(), start, json["started"]);
  add_down(manager.knowledge(), json["down"]);
  for (const Governor::ActiveSilence& silence : manager.governor().silences()) {
    Json entry;
    if (const auto* component = std::get_if<ComponentId>(&silence.what)) {
      entry["component"] = rules[*component].name;
    } else {
      entry["rule"] = rules[std::get<RuleId>(silence.what)].name;
    }
    entry["until"] = time_to_json(silence.until, start);
    entry["author"] = silence.author;
    entry["reason"] = silence.reason;
    json["silences"].push_back(std::move(entry));
  }
  for (const StrategyId id : manager.governor().asked())
    json["asked"].push_back({{"rule", rules[rules[id].rule].name}, {"strategy", rules[id].name}});
  return json;
}

// The evidence for the cause of each failure, if another component would be held responsible without it.
Json hinges_to_json(const Incident& incident, const Manager& manager) {
  Json list = Json::array();
  const auto add = [&](RuleId failure) {
    for (const Suspect& suspect : manager.incidents().suspects_of(failure)) {
      for (const Evidence& each : suspect.evidence) {
        if (each.without.empty()) continue;
        list.push_back({{"rule", manager.knowledge().rules[failure].name},
                        {"text", each.text},
                        {"without", each.without}});
      }
    }
  };
  add(incident.root);
  for (const RuleId failure : incident.consequences) add(failure);
  return list;
}

Json incidents_to_json(const Manager& manager, Time start) {
  const RuleSet& rules = manager.knowledge().rules;
  Json list = Json::array();
  for (const Incident& each : manager.incidents().open()) {
    const Incidents::Course course = manager.course_of(each);
    list.push_back(
        {{"id", each.id},
         {"headline", each.headline},
         {"health", each.is_exhausted ? "EXHAUSTED" : culprit::to_string(each.criticality)},
         {"since", time_to_json(each.since, start)},
         {"rule", rules[each.root].name},
         {"components", names_of(each.components, rules)},
         {"certain", each.is_certain},
         {"host", each.host.empty() ? Json(nullptr) : Json(each.host)},
         {"consequences", names_of(each.consequences, rules)},
         {"hinges_on", hinges_to_json(each, manager)},
         {"needs_person", each.needs_person()},
         {"doing", course.doing},
         {"next", course.next}});
  }
  return list;
}

void add_looks(const Manager& manager, Json& state) {
  state["overview"] = to_json(overview_of(manager));
  const std::vector<std::size_t> health = health_of_components(manager.knowledge());
  for (std::size_t c = 0; c < health.size(); ++c) {
    const ComponentLook look = look_of(ComponentId(c), health[c], manager);
    state["components"][c]["look"] = look.look;
    state["components"][c]["condition"] = look.condition;
  }
}

Json state_to_json(const Knowledge& knowledge, Time start) {
  const RuleSet& rules = knowledge.rules;
  Json json{{"t", time_to_json(knowledge.now, start)},
            {"rules", Json::array()},
            {"components", components_to_json(knowledge)},
            {"topics", topics_to_json(knowledge)},
            {"inputs", Json::array()},
            {"beliefs", Json::array()},
            {"priors", Json::array()}};
  for (std::size_t r = 0; r < rules.rules.size(); ++r)
    json["rules"].push_back(rule_to_json(RuleId(r), knowledge, start));
  for (std::size_t i = 0; i < rules.inputs.size(); ++i)
    json["inputs"].push_back(value_of(knowledge.signals[InputId(i)], rules.inputs[i]));
  for (std::size_t s = 0; s < rules.strategies.size(); ++s) {
    const Belief& belief = knowledge.beliefs[StrategyId(s)];
    const Belief& prior = knowledge.beliefs.prior(StrategyId(s));
    json["beliefs"].push_back(Json::array({belief.alpha, belief.beta}));
    json["priors"].push_back(Json::array({prior.alpha, prior.beta}));
  }
  return json;
}

}  // namespace culprit::web

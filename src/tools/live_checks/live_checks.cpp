#include "live_checks/live_checks.h"

#include <algorithm>
#include <array>
#include <set>
#include <unordered_map>

#include "base/ros_names.h"
#include "language/occurrences.h"
#include "language/parser.h"

namespace culprit::live_checks {
namespace {

using OccurrenceKind = Occurrence::Kind;
using Names = std::vector<std::string_view>;

template <class Table>
Names names_of(const Table& table) {
  Names names;
  for (const auto& [name, thing] : table) names.push_back(name);
  return names;
}

bool is_identifier(std::string_view name) {
  const auto is_letter = [](unsigned char c) { return std::isalpha(c) != 0 || c == '_'; };
  return !name.empty() && is_letter(name[0]) &&
         std::all_of(name.begin(), name.end(),
                     [&](unsigned char c) { return is_letter(c) || std::isdigit(c) != 0; });
}

class LiveChecks {
 public:
  LiveChecks(const syntax::File& file, const RuleSet& rules, const LiveInventory& robot)
      : file_(file), rules_(rules), robot_(robot) {
    for (const syntax::Name& topic : file.ignored_topics) ignored_.insert(topic.span.begin);
    for (const syntax::Component& c : file.components) declarations_.emplace(c.name.text, &c);
    for (const Component& c : rules.components) {
      components_.emplace(c.name, &c);
      if (!c.node.empty()) components_.emplace(c.node, &c);
      for (const std::string& other : c.other_nodes) components_.emplace(other, &c);
    }
    for (const Signal& s : rules.signals) {
      if (std::holds_alternative<LookedUp>(s.source)) looked_up_.emplace(s.name, &s);
    }
    for (const LiveInventory::LaunchTrouble& each : robot.launch_troubles)
      launch_troubles_[each.component].push_back(&each);
  }

  std::vector<Diagnostic> find_owner_troubles() {
    for (const syntax::Component& component : file_.components) owner(component);
    return std::move(found_);
  }

  std::vector<Diagnostic> find() {
    const Occurrence* before = nullptr;
    const auto all = occurrences(file_);
    for (const Occurrence& o : all) {
      look_up(o);
      const bool asks_state = before != nullptr && before->kind == OccurrenceKind::kFunction &&
                              before->name == "lifecycle" && o.kind == OccurrenceKind::kComponent;
      if (asks_state) managed_node(o.name, o.span);
      before = &o;
    }
    for (const syntax::Signal& signal : file_.signals) {
      key(signal);
      field(signal);
    }
    for (const syntax::Component& component : file_.components) {
      owner(component);
      several_nodes(component);
      other_nodes(component);
    }
    for (std::size_t r = 0; r < file_.rules.size(); ++r) {
      for (std::size_t i = 0; i < file_.rules[r].strategies.size(); ++i) {
        const syntax::Strategy& written = file_.rules[r].strategies[i];
        const Strategy& strategy = rules_[rules_.rules[r].strategies[i]];
        for (const syntax::Adaptation& each : written.adaptations) services(each);
        for (const Adaptation& each : strategy.adaptations)
          type_of_parameter(written.adaptations[each.written], each);
      }
    }
    return std::move(found_);
  }

 private:
  void look_up(const Occurrence& o) {
    switch (o.kind) {
      case OccurrenceKind::kComponent:
        return component(o);
      case OccurrenceKind::kTopic:
        return topic(o);
      case OccurrenceKind::kParameter:
        return parameter(o);
      case OccurrenceKind::kSignal:
        return looked_up_signal(o);
      case OccurrenceKind::kDiagnostic:
        return status(o);
      case OccurrenceKind::kService:
        return routine(o);
      case OccurrenceKind::kAction:
        return action(o);
      case OccurrenceKind::kConstant:
      case OccurrenceKind::kRule:
      case OccurrenceKind::kStrategy:
      case OccurrenceKind::kFunction:
      case OccurrenceKind::kTemplate:
      case OccurrenceKind::kHole:
      case OccurrenceKind::kFile:
        return;
    }
  }

  // ---- who starts it

  void owner(const syntax::Component& written) {
    const Component* c = component_of(written.name.text);
    if (c == nullptr) return;
    for (const LiveInventory::UnitTrouble& each : robot_.unit_troubles) {
      if (each.unit == c->unit) warn(Code::kNoSuchUnit, written.unit->span, each.why, "");
    }
    for (const LiveInventory::ContainerTrouble& each : robot_.container_troubles) {
      if (each.container == c->engine)
        warn(Code::kNoSuchUnit, written.engine_container->span, each.why, "");
    }
    for (const LiveInventory::HostTrouble& each : robot_.host_troubles) {
      if (each.host == c->host() && written.host)
        warn(Code::kNoSuchHost, written.host->span, each.why, "");
    }
    const auto launch_troubles = launch_troubles_.find(c->name);
    if (launch_troubles == launch_troubles_.end()) return;
    for (const LiveInventory::LaunchTrouble* each : launch_troubles->second) {
      using Clause = LiveInventory::LaunchTrouble::Clause;
      const std::string program = c->launch.empty() ? "" : c->launch.front();
      const Composition composed = c->composed.value_or(Composition{});
      const auto& [place, text] =
          each->clause == Clause::kSetup    ? std::pair(written.setup, c->setup)
          : each->clause == Clause::kFolder ? std::pair(written.folder, c->folder)
          : each->clause == Clause::kPlugin ? std::pair(written.plugin, composed.plugin)
          : each->clause == Clause::kParameters
              ? std::pair(written.parameters, composed.parameters)
              : std::pair(Seldom<syntax::Name>(written.launch), program);
      const bool runs_otherwise = each->clause == Clause::kRunning;
      if (place && text == each->text)
        warn(runs_otherwise ? Code::kRunsOtherwise : Code::kCannotLaunch, place->span, each->why,
             each->clause == Clause::kLaunch
                 ? "correct its path, or add SETUP with the file to source first"
                 : "");
    }
  }

  // ---- the graph

  void component(const Occurrence& o) {
    const Component* c = component_of(o.name);
    if (c == nullptr || !node_of(o.name).empty() || !is_first(OccurrenceKind::kComponent, c->name))
      return;
    const auto declared = declarations_.find(c->name);
    const std::string remedy = c->can_start()
                                   ? "start it (culprit run --launch does), or correct the name"
                                   : "start it, or correct the name";
    if (!c->node.empty()) {
      const bool has_node = declared != declarations_.end() && declared->second->node;
      warn(Code::kNoSuchNode, has_node ? declared->second->node->span : o.span,
           "the robot has no node '" + c->node + "'", remedy,
           closest_full_name(c->node, names_of(robot_.nodes)));
      return;
    }
    const std::string cause = "no node of the robot is called '" + c->name + "'";
    const std::string near = closest(c->name, own_names());
    if (declared == declarations_.end())
      return warn(Code::kNoSuchNode, o.span, cause, remedy, near);
    // The component keeps its name, by which the rest of the file knows it.
    const Span name = declared->second->name.span;
    const std::string node = near.empty() ? "" : " NODE " + robot_.node_of({near, "", {}, false});
    warn(Code::kNoSuchNode, name, cause, remedy, node, {name.end, name.end});
  }

  // Without NODE: one of several nodes that are no other component's, and it is unknown which.
  void several_nodes(const syntax::Component& written) {
    const Component* c = component_of(written.name.text);
    if (c == nullptr || !c->node.empty()) return;
    std::vector<std::string> fitting;
    for (const auto& [name, node] : robot_.nodes) {
      if (own_name(name) == c->name && !components_.contains(name)) fitting.push_back(name);
    }
    if (fitting.size() < 2) return;
    std::sort(fitting.begin(), fitting.end());
    found_.push_back({Code::kSeveralNodes,
                      Severity::kError,
                      written.name.span,
                      "'" + c->name + "' could be '" + fitting[0] + "' or '" + fitting[1] + "'",
                      "say which with NODE " + fitting[0] + " or NODE " + fitting[1],
                      {}});
  }

  void action(const Occurrence& o) {
    const auto status = robot_.topics.find(o.name + std::string(kStatusOfAction));
    if (status != robot_.topics.end() && status->second.is_published()) return;
    if (!is_first(OccurrenceKind::kAction, o.name)) return;
    Names offered;
    for (const auto& [topic, known] : robot_.topics) {
      if (topic.ends_with(kStatusOfAction))
        offered.push_back(std::string_view(topic).substr(0, topic.size() - kStatusOfAction.size()));
    }
    warn(Code::kNoSuchTopic, o.span, "no node offers the action '" + o.name + "'",
         "start its server, or correct the name", closest_full_name(o.name, offered));
  }

  // Nodes of one component are one process.
  void other_nodes(const syntax::Component& written) {
    const Component* c = component_of(written.name.text);
    const auto main = c == nullptr ? robot_.nodes.end() : robot_.nodes.find(c->node);
    for (const syntax::Name& other : written.other_nodes) {
      const auto found = robot_.nodes.find(other.text);
      if (found == robot_.nodes.end()) {
        warn(Code::kNoSuchNode, other.span, "the robot has no node '" + other.text + "'",
             "start it, or correct the name; the component counts as down while it is missing",
             closest_full_name(other.text, names_of(robot_.nodes)));
      } else if (main != robot_.nodes.end() && main->second.pid != found->second.pid) {
        warn(Code::kNoSuchNode, other.span,
             "node '" + other.text + "' is of another process than '" + c->node + "'",
             "declare it as a component of its own");
      }
    }
  }

  void topic(const Occurrence& o) {
    if (ignored_.contains(o.span.begin)) return;
    std::string name = o.name;
    if (!o.scope.empty()) {
      const std::string node = node_of(o.scope);
      if (node.empty()) return;
      name = topic_of(o.name, node);
    }
    const auto found = robot_.topics.find(name);
    if (found != robot_.topics.end() && found->second.is_published()) return;
    if (!is_first(OccurrenceKind::kTopic, name)) return;
    if (found != robot_.topics.end()) {
      warn(Code::kNoSuchTopic, o.span, "no node publishes '" + name + "' now",
           "start its publisher, or name a topic that is published");
      return;
    }
    Names published;
    for (const auto& [other, topic] : robot_.topics) {
      if (topic.is_published()) published.push_back(other);
    }
    std::string near = closest_full_name(name, published);
    const bool same_namespace = namespace_of(near) == namespace_of(name);
    if (!o.scope.empty() && same_namespace && !o.name.starts_with('~')) near = own_name(near);
    warn(Code::kNoSuchTopic, o.span, "the robot has no topic '" + name + "'",
         "start its publisher, or correct the name", near);
  }

  void routine(const Occurrence& o) {
    const std::string node = node_of(o.scope);
    if (!o.scope.empty() && node.empty()) return;
    const std::string name = service_of(o.name, node);
    if (robot_.services.contains(name) || !is_first(OccurrenceKind::kService, name)) return;
    Names routines;
    for (const auto& [service, type] : robot_.services) routines.push_back(service);
    warn(Code::kNoSuchService, o.span, "the robot has no service '" + name + "'",
         "start its server, or correct the name", closest_full_name(name, routines));
  }

  // Services that every node of its kind offers.
  void services(const syntax::Adaptation& a) {
    using enum AdaptationType;
    switch (a.type) {
      case kActivate:
      case kDeactivate:
      case kRestart:
        return managed_node(a.component.text, a.span);
      case kChangeMode:
        return offers(a.component.text, "change_mode", a.span, "has no modes",
                      "only nodes with a change_mode service can change their mode");
      case kSetParameter:
      case kIncreaseParameter:
      case kDecreaseParameter:
      case kChangeCommunication:
        return offers(a.component.text, "set_parameters", a.span, "has no parameters to set",
                      "only nodes with a set_parameters service accept new values");
      case kCall:
        return request(a);
      case kRedeploy:
      case kStart:
      case kStop:
      case kStartGroup:
        return;
    }
  }

  // Parameters have a type of their own, which a node does not change.
  void type_of_parameter(const syntax::Adaptation& written, const Adaptation& adaptation) {
    if (!written.value) return;
    const auto value =
        robot_.value_of_parameter(node_of(written.component.text), written.subject.text);
    if (!value) return;
    const Type type = adaptation.value.type;
    constexpr std::array kTypes = {Type::kBool, Type::kInt, Type::kDouble, Type::kString};
    const Type wanted = kTypes[value->index()];
    const bool fits = type == wanted || type == Type::kDuration ||
                      (type == Type::kInt && wanted == Type::kDouble);
    if (fits) return;
    warn(Code::kTypeMismatch, written.value->span,
         "parameter '" + written.subject.text + "' of the node is of the type " +
             std::string(to_string(wanted)) + " (" + to_string(*value) + "), and this is " +
             std::string(to_string(type)),
         "the node would refuse it: write a value of the type " + std::string(to_string(wanted)));
  }

  void request(const syntax::Adaptation& a) {
    const std::string service = service_of(a.subject.text, node_of(a.component.text));
    for (const LiveInventory::RequestTrouble& each : robot_.request_troubles) {
      if (each.service == service && each.request == (a.request ? a.request->text : ""))
        warn(Code::kBadRequest, a.request ? a.request->span : a.subject.span, each.why, "");
    }
  }

  void managed_node(const std::string& component, Span place) {
    offers(component, "change_state", place, "is no managed node",
           "only nodes with a lifecycle can be activated, deactivated or restarted; redeploy works "
           "for every node");
  }

  void offers(const std::string& component, const std::string& service, Span place,
              const std::string& lack, std::string remedy) {
    const std::string node = node_of(component);
    if (node.empty() || robot_.services.contains(node + "/" + service)) return;
    if (!is_first(OccurrenceKind::kService, node + "/" + service)) return;
    warn(Code::kNoSuchService, place,
         "node '" + node + "' " + lack + ": it offers no service '" + service + "'",
         std::move(remedy));
  }

  void parameter(const Occurrence& o) {
    const auto node = robot_.nodes.find(node_of(o.scope));
    if (node == robot_.nodes.end() || !node->second.parameters) return;
    const auto& parameters = *node->second.parameters;
    if (parameters.contains(o.name) ||
        !is_first(OccurrenceKind::kParameter, node->first + "\n" + o.name))
      return;
    warn(Code::kNoSuchParameter, o.span,
         "node '" + node->first + "' has no parameter '" + o.name + "'",
         "correct the name, or declare the parameter in the node",
         as_written(closest(o.name, names_of(parameters))));
  }

  // ---- diagnostics

  void status(const Occurrence& o) {
    Names known;
    for (const auto& s : robot_.diagnostics) {
      if (s.is_called(o.name)) return;
      known.push_back(s.name);
      known.push_back(s.hardware_id);
    }
    if (!is_first(OccurrenceKind::kDiagnostic, o.name)) return;
    warn(Code::kNoSuchDiagnostic, o.span, "no diagnostic status '" + o.name + "' was received",
         kListenLonger, as_written(closest(o.name, known)));
  }

  void key(const syntax::Signal& signal) {
    const auto* source = std::get_if<syntax::DiagnosticSource>(&signal.source);
    if (source == nullptr) return;
    Names known;
    bool is_heard = false;
    for (const auto& s : robot_.diagnostics) {
      if (!s.is_called(source->status.text)) continue;
      if (s.values.contains(source->key.text)) return;
      is_heard = true;
      for (const auto& [key, value] : s.values) known.push_back(key);
    }
    const std::string both = source->status.text + "\n" + source->key.text;
    if (!is_heard || !is_first(OccurrenceKind::kDiagnostic, both)) return;
    warn(Code::kNoSuchDiagnostic, source->key.span,
         "status '" + source->status.text + "' has no key '" + source->key.text + "'",
         "correct the key", as_written(closest(source->key.text, known)));
  }

  // ---- messages

  void field(const syntax::Signal& signal) {
    const auto* source = std::get_if<syntax::TopicSource>(&signal.source);
    if (source == nullptr) return;
    const auto topic = robot_.topics.find(source->topic.text);
    if (topic == robot_.topics.end()) return;
    const auto trouble = topic->second.unreadable.find(source->field.text);
    if (trouble != topic->second.unreadable.end())
      warn(Code::kNoSuchField, source->field.span, trouble->second, "");
  }

  // The key of a diagnostic, or "<status>_<key>" (ros2/diagnostics_watch.h).
  void looked_up_signal(const Occurrence& o) {
    const auto signal = looked_up_.find(o.name);
    if (signal == looked_up_.end() || !is_first(OccurrenceKind::kSignal, o.name)) return;
    if (robot_.value_of(*signal->second, rules_)) return;
    Names known;
    for (const auto& s : robot_.diagnostics) {
      for (const auto& [key, value] : s.values) {
        if (is_identifier(key)) known.push_back(key);
      }
    }
    warn(Code::kNoSuchDiagnostic, o.span,
         "no diagnostic with the key '" + o.name + "' was received", kListenLonger,
         closest(o.name, known));
  }

  // ---- tools

  const Component* component_of(const std::string& name) const {
    const auto found = components_.find(name);
    return found == components_.end() ? nullptr : found->second;
  }

  // Empty while it is not there.
  std::string node_of(const std::string& component) const {
    const Component* found = component_of(component);
    return found == nullptr ? "" : robot_.node_of(*found);
  }

  const Names& own_names() {
    if (own_names_.empty()) {
      for (const auto& [name, node] : robot_.nodes)
        own_names_.push_back(std::string_view(name).substr(name.rfind('/') + 1));
    }
    return own_names_;
  }

  bool is_first(OccurrenceKind kind, const std::string& name) {
    return said_.emplace(kind, name).second;
  }

  // `near` is what was probably meant at `where`; empty if that is not known.
  void warn(Code code, Span place, std::string cause, std::string remedy, const std::string& near,
            Span where) {
    if (!near.empty()) remedy = "did you mean '" + near.substr(near.find_first_not_of(' ')) + "'?";
    found_.push_back({code, Severity::kWarning, place, std::move(cause), std::move(remedy),
                      replacement(where, near)});
  }
  void warn(Code code, Span place, std::string cause, std::string remedy,
            const std::string& near = "") {
    warn(code, place, std::move(cause), std::move(remedy), near, place);
  }

  static constexpr const char* kListenLonger =
      "correct the name, or listen for longer: some are published rarely";

  const syntax::File& file_;
  const RuleSet& rules_;
  const LiveInventory& robot_;
  std::set<std::uint32_t> ignored_;  // topics, by where they stand
  std::unordered_map<std::string, const syntax::Component*> declarations_;
  std::unordered_map<std::string, const Component*> components_;  // by name and by node
  std::unordered_map<std::string, const Signal*> looked_up_;
  // By component.
  std::unordered_map<std::string, std::vector<const LiveInventory::LaunchTrouble*>>
      launch_troubles_;
  std::set<std::pair<OccurrenceKind, std::string>> said_;
  Names own_names_;
  std::vector<Diagnostic> found_;
};

bool comes_before(const Diagnostic& a, const Diagnostic& b) { return a.span.begin < b.span.begin; }

// Finds names that are missing on the robot, at places that have no diagnostic yet.
std::vector<Diagnostic> find_missing(const syntax::File& file, const RuleSet& rules,
                                     const LiveInventory& robot,
                                     const std::vector<Diagnostic>& said) {
  std::set<std::uint32_t> places;
  for (const Diagnostic& d : said) {
    if (d.code != Code::kUnused) places.insert(d.span.begin);
  }
  std::vector<Diagnostic> found = LiveChecks(file, rules, robot).find();
  std::erase_if(found, [&](const Diagnostic& d) { return places.contains(d.span.begin); });
  std::stable_sort(found.begin(), found.end(), comes_before);
  return found;
}

}  // namespace

void check_live(const syntax::File& file, const RuleSet& rules, const LiveInventory& robot,
                std::vector<Diagnostic>& diagnostics) {
  for (Diagnostic& missing : find_missing(file, rules, robot, diagnostics)) {
    std::erase_if(diagnostics, [&](const Diagnostic& d) {
      return d.code == Code::kUnused && d.span.begin == missing.span.begin;
    });
    diagnostics.push_back(std::move(missing));
  }
  std::stable_sort(diagnostics.begin(), diagnostics.end(), comes_before);
}

std::vector<Diagnostic> missing_on(const LiveInventory& robot, const Source& source) {
  const Parsed parsed = parse_whole(source);
  if (parsed.file.has_reuse()) {
    const Expansion rules = expand(source);
    if (!rules.mistakes.empty()) return {};
    return as_written(missing_on(robot, rules.source), rules.source);
  }
  const Checked checked = check(parsed);
  if (!checked.rules) return {};
  return find_missing(parsed.file, *checked.rules, robot, checked.diagnostics);
}

std::vector<Diagnostic> cannot_launch(const syntax::File& file, const RuleSet& rules,
                                      const std::vector<LiveInventory::LaunchTrouble>& troubles) {
  LiveInventory nobody;
  nobody.launch_troubles = troubles;
  return LiveChecks(file, rules, nobody).find_owner_troubles();
}

Checked check_against(const LiveInventory& robot, const Source& source, Strictness strictness) {
  const Parsed parsed = parse_whole(source);
  if (parsed.file.has_reuse()) {
    const Expansion rules = expand(source);
    Checked checked = check_against(robot, rules, strictness);
    checked.diagnostics = as_written(std::move(checked.diagnostics), rules.source);
    return checked;
  }
  Checked checked = check(parsed, strictness);
  if (checked.rules) check_live(parsed.file, *checked.rules, robot, checked.diagnostics);
  return checked;
}

Checked check_against(const LiveInventory& robot, const Expansion& rules, Strictness strictness) {
  if (!rules.mistakes.empty()) return {{}, rules.mistakes};
  return check_against(robot, rules.source, strictness);
}

}  // namespace culprit::live_checks

#include "language/symbols.h"

#include <algorithm>
#include <utility>

namespace culprit {
namespace {

std::size_t parameter_hash(ComponentId component, std::string_view name) {
  return mixed_hash(name_hash(name), component.index);
}

std::size_t input_hash(const Input& input) {
  std::size_t hash = static_cast<std::size_t>(input.kind);
  for (const std::uint32_t id : {input.topic.index, input.signal.index, input.component.index,
                                 input.parameter.index, input.diagnostic.index})
    hash = mixed_hash(hash, id);
  hash = mixed_hash(hash, static_cast<std::size_t>(input.window.count()));
  return mixed_hash(mixed_hash(hash, static_cast<std::size_t>(input.outcome)),
                    static_cast<std::size_t>(input.log_level));
}

bool is_same_input(const Input& a, const Input& b) {
  return a.kind == b.kind && a.topic == b.topic && a.signal == b.signal &&
         a.component == b.component && a.parameter == b.parameter && a.diagnostic == b.diagnostic &&
         a.window == b.window && a.outcome == b.outcome && a.log_level == b.log_level;
}

}  // namespace

bool Symbols::first_declaration(const syntax::Name& name, const char* what) {
  const auto component = place_of(name.text, rules_.components, components_);
  const bool is_component = component && rules_.components[*component].declared;
  const bool is_constant = constants_.contains(name.text);
  if (!is_component && !is_constant && !known_signal(name.text)) return true;
  const std::string kind = is_component ? "component" : is_constant ? "constant" : "signal";
  diagnostics_.push_back({Code::kDuplicateName, Severity::kError, name.span,
                          "'" + name.text + "' is a " + kind + " already",
                          std::string("give this ") + what + " another name"});
  return false;
}

void Symbols::declare(const syntax::File& file) {
  components_.reserve(file.components.size());
  components_by_node_.reserve(file.components.size());
  owners_.reserve(file.components.size());
  signals_.reserve(file.signals.size());
  for (const syntax::Constant& c : file.constants) {
    // Its value follows, in file order: a constant may use the ones before it.
    if (first_declaration(c.name, "constant")) constants_[c.name.text] = {{}, true};
  }
  for (const syntax::Component& c : file.components) {
    if (first_declaration(c.name, "component")) declare_component(c);
  }
  for (const syntax::Signal& s : file.signals) {
    if (first_declaration(s.name, "signal")) declare_signal(s);
  }
  for (const syntax::BrokenDeclaration& broken : file.broken_declarations) {
    if (!broken.name.text.empty()) declare_broken(broken);
  }
  for (const syntax::Group& g : file.groups) {
    if (first_declaration(g.name, "group")) declare_group(g);
  }
  for (const auto& [constant, value] : constants_) declared_values_.push_back(constant);
}

const std::vector<std::string_view>& Symbols::sorted_values() {
  if (!std::exchange(are_values_sorted_, true))
    std::sort(declared_values_.begin(), declared_values_.end());
  return declared_values_;
}

void Symbols::declare_component(const syntax::Component& written) {
  Component component{written.name.text,
                      written.node ? written.node->text : "",
                      {},
                      true,
                      written.is_required,
                      written.lifecycle,
                      written.is_respawned,
                      written.ready.value_or(Duration::zero())};
  if (written.node) declare_node(*written.node, component);
  for (const syntax::Name& other : written.other_nodes) {
    if (declare_node(other, component)) component.other_nodes.push_back(other.text);
  }
  owners_.read(written, component);
  declared_components_.push_back(written.name.text);
  add_component(std::move(component));
}

// Whether no component has it yet.
bool Symbols::declare_node(const syntax::Name& node, const Component& component) {
  const auto first = components_by_node_.find(name_hash(node.text), [&](std::uint32_t place) {
    return place == rules_.components.size() ? component.has_node(node.text)
                                             : rules_.components[place].has_node(node.text);
  });
  if (!first) {
    components_by_node_.add(name_hash(node.text), rules_.components.size());
    return true;
  }
  const bool is_own = *first == rules_.components.size();
  const std::string& owner = is_own ? component.name : rules_.components[*first].name;
  diagnostics_.push_back({Code::kDuplicateName, Severity::kError, node.span,
                          "this node is component '" + owner + "' already",
                          "declare each node once"});
  return false;
}

ComponentId Symbols::add_component(Component component) {
  const ComponentId id(rules_.components.size());
  components_.add(name_hash(component.name), id.index);
  rules_.components.push_back(std::move(component));
  return id;
}

SignalId Symbols::add_signal(Signal signal, std::optional<Type> type) {
  const SignalId id(rules_.signals.size());
  signals_.add(name_hash(signal.name), id.index);
  signal_types_.push_back(types_.add(type));
  rules_.signals.push_back(std::move(signal));
  return id;
}

// "pose/position/x"
void Symbols::check_field(const syntax::Name& field) {
  if (field.text.starts_with('.') && field.text.size() > 1) {
    const std::string meant = field.text.substr(1);
    diagnostics_.push_back({Code::kSyntax, Severity::kError, field.span,
                            "a path of fields begins with no '.'", "write " + meant,
                            Edit{field.span, meant}});
    return;
  }
  if (field.text.find("[-") != std::string::npos) {
    diagnostics_.push_back({Code::kSyntax, Severity::kError, field.span,
                            "elements count from 0, from the front",
                            "write its number, as in ranges[0]"});
    return;
  }
  if (field.text.find('/') == std::string::npos ||
      field.text.find_first_of("[(") != std::string::npos)
    return;
  std::string meant = field.text.substr(field.text.starts_with('/') ? 1 : 0);
  std::replace(meant.begin(), meant.end(), '/', '.');
  diagnostics_.push_back({Code::kSyntax, Severity::kError, field.span,
                          "a path of fields has dots, and no '/'", "write " + meant,
                          Edit{field.span, meant}});
}

void Symbols::declare_signal(const syntax::Signal& s) {
  Signal signal{s.name.text, LookedUp{}, Type::kDouble, s.stale, {}};
  std::optional<ComponentId> publisher;
  if (s.from) publisher = component(*s.from);
  if (const auto* d = std::get_if<syntax::DiagnosticSource>(&s.source)) {
    signal.source = DiagnosticKey{d->status.text, d->key.text, publisher};
  } else if (const auto* t = std::get_if<syntax::TopicSource>(&s.source)) {
    check_field(t->field);
    signal.source = TopicField{topic(t->topic.text, publisher), t->field.text};
  } else {
    const auto& p = std::get<syntax::ParameterSource>(s.source);
    signal.source = parameter(component(p.component), p.parameter.text);
  }
  if (s.range) {
    if (s.range->low >= s.range->high) {
      diagnostics_.push_back({Code::kEmptyRange, Severity::kError, s.range->span,
                              "this range holds no values", "write the smaller number first"});
    }
    signal.range = {s.range->low, s.range->high};
  }
  declared_values_.push_back(s.name.text);
  add_signal(std::move(signal), s.range ? std::optional(Type::kDouble) : std::nullopt);
}

// Nothing: the file does not declare it, which is an error here. A group is started in an order, so what
// belongs to it has to be certain.
std::optional<ComponentId> Symbols::declared_part(const syntax::Name& name,
                                                  const std::string& what) {
  const auto known = known_component(name.text);
  if (known && rules_[*known].declared) return known;
  const std::string near = near_name(name.text, declared_components_);
  diagnostics_.push_back(
      {Code::kBadGroup, Severity::kError, name.span, what + " '" + name.text + "' is not declared",
       near.empty() ? "declare it: COMPONENT " + name.text + " NODE /" + name.text
                    : "did you mean '" + near + "'?",
       replacement(name.span, near)});
  return std::nullopt;
}

void Symbols::declare_group(const syntax::Group& written) {
  const auto report = [&](const syntax::Name& where, std::string cause, std::string remedy) {
    diagnostics_.push_back(
        {Code::kBadGroup, Severity::kError, where.span, std::move(cause), std::move(remedy)});
  };
  Group group{written.name.text, {}, {}, {}};
  for (const syntax::Name& name : written.members) {
    const auto member = declared_part(name, "component");
    if (!member) continue;
    if (std::ranges::find(group.members, *member) != group.members.end()) {
      report(name, "'" + name.text + "' is twice in group '" + group.name + "'",
             "name each component once, in the order in which the manager starts them");
      continue;
    }
    group.members.push_back(*member);
  }
  if (const auto manager = declared_part(written.manager, "the manager")) {
    group.manager = *manager;
    if (std::ranges::find(group.members, *manager) != group.members.end())
      report(written.manager,
             "'" + written.manager.text + "' manages group '" + group.name + "' and is in it",
             "take it out of the braces");
  }
  declared_values_.push_back(written.name.text);
  group.health =
      add_signal({group.name, GroupId(rules_.groups.size()), Type::kString, {}, {}}, Type::kString);
  rules_.groups.push_back(std::move(group));
}

std::optional<GroupId> Symbols::group(const syntax::Name& name) {
  if (is_group(name.text)) return std::get<GroupId>(rules_[*known_signal(name.text)].source);
  std::vector<std::string_view> groups;
  for (const Group& each : rules_.groups) groups.push_back(each.name);
  if (broken_signals_.contains(name.text)) return std::nullopt;  // it may have been declared as one
  const std::string near = near_name(name.text, groups);
  diagnostics_.push_back(
      {Code::kBadGroup, Severity::kError, name.span, "'" + name.text + "' is no group",
       !near.empty() ? "did you mean '" + near + "'?"
       : known_component(name.text)
           ? "it is a component: name the group that it belongs to, or activate it"
           : "declare it: GROUP " + name.text + " { planner, controller } MANAGER manager",
       replacement(name.span, near)});
  return std::nullopt;
}

// There is an error, so the rule set will not be used; only the names have to be there.
void Symbols::declare_broken(const syntax::BrokenDeclaration& broken) {
  using Broken = syntax::BrokenDeclaration::Kind;
  const std::string& name = broken.name.text;
  switch (broken.kind) {
    case Broken::kConstant:
      constants_.try_emplace(name, Constant{{}, true});
      return;
    case Broken::kComponent:
      if (place_of(name, rules_.components, components_)) return;
      declared_components_.push_back(name);
      // Whether it has a LAUNCH command is not known, so no check may report it as missing.
      add_component({name, "", {""}, true});
      return;
    case Broken::kSignal:
      broken_signals_.insert(name);
      if (!known_signal(name)) add_signal({name, LookedUp{}, Type::kDouble, {}, {}});
      return;
  }
}

const Symbols::Constant* Symbols::constant(const std::string& name) const {
  const auto found = constants_.find(name);
  return found == constants_.end() ? nullptr : &found->second;
}

void Symbols::define_constant(const syntax::Name& name, Constant value) {
  constants_[name.text] = std::move(value);
}

std::string Symbols::near_name(const std::string& name,
                               const std::vector<std::string_view>& declared) {
  if (declared.size() > comparisons_left_) return "";
  comparisons_left_ -= declared.size();
  return closest(name, declared);
}

void Symbols::report_undeclared(const syntax::Name& name, const char* what,
                                const std::vector<std::string_view>& declared) {
  const std::string near = near_name(name.text, declared);
  const auto fix = replacement(name.span, near);
  if (strictness_ == Strictness::kStrict) {
    diagnostics_.push_back(
        {Code::kUndeclared, Severity::kError, name.span,
         std::string(what) + " '" + name.text + "' is not declared",
         near.empty() ? "declare it, or check without --strict" : "did you mean '" + near + "'?",
         fix});
  } else if (!near.empty()) {
    near_misses_[name.text] = {near, diagnostics_.size()};
    diagnostics_.push_back({Code::kUnknownName, Severity::kWarning, name.span,
                            std::string(what) + " '" + name.text +
                                "' is not declared and will be looked up on the robot",
                            "did you mean '" + near + "'?", fix});
  }
}

std::optional<ComponentId> Symbols::known_component(std::string_view name) const {
  auto found = place_of(name, rules_.components, components_);
  // A full node name may stand for the component that is declared with it.
  if (!found && name.starts_with('/'))
    found = components_by_node_.find(name_hash(name), [&](std::uint32_t place) {
      return rules_.components[place].has_node(name);
    });
  return found ? std::optional(ComponentId(*found)) : std::nullopt;
}

std::optional<SignalId> Symbols::known_signal(std::string_view name) const {
  const auto found = place_of(name, rules_.signals, signals_);
  return found ? std::optional(SignalId(*found)) : std::nullopt;
}

std::optional<ParameterId> Symbols::known_parameter(ComponentId component,
                                                    std::string_view name) const {
  const auto found = parameters_.find(parameter_hash(component, name), [&](std::uint32_t place) {
    const Parameter& known = rules_.parameters[place];
    return known.component == component && known.name == name;
  });
  return found ? std::optional(ParameterId(*found)) : std::nullopt;
}

bool Symbols::is_group(std::string_view name) const {
  const auto signal = known_signal(name);
  return signal && std::holds_alternative<GroupId>(rules_[*signal].source);
}

// Reports the name once; later uses of it as a component get no message.
ComponentId Symbols::group_as_component(const syntax::Name& name) {
  diagnostics_.push_back({Code::kBadGroup, Severity::kError, name.span,
                          "'" + name.text + "' is a group, and no component",
                          "read it as a signal, as in " + name.text +
                              " != \"active\", and adapt it with start_group, or name one of its "
                              "components"});
  return add_component({name.text, "", {""}, true});
}

ComponentId Symbols::component(const syntax::Name& name) {
  if (const auto known = known_component(name.text)) return *known;
  if (is_group(name.text)) return group_as_component(name);
  report_undeclared(name, "component", declared_components_);
  const bool is_node = name.text.starts_with('/');
  return add_component({name.text, is_node ? name.text : "", {}, false});
}

SignalId Symbols::signal(const syntax::Name& name) {
  if (const auto known = known_signal(name.text)) return *known;
  report_undeclared(name, "signal", sorted_values());
  return add_signal({name.text, LookedUp{}, Type::kDouble, {}, {}});
}

bool Symbols::is_looked_up(const std::string& signal) const {
  const auto found = known_signal(signal);
  return strictness_ == Strictness::kLenient && found &&
         std::holds_alternative<LookedUp>(rules_[*found].source);
}

bool Symbols::is_topic(std::string_view name) const {
  return place_of(name, rules_.topics, topics_).has_value();
}

std::string Symbols::topic_of_signal(std::string_view name) const {
  const auto found = known_signal(name);
  const auto* field = found ? std::get_if<TopicField>(&rules_[*found].source) : nullptr;
  return field != nullptr ? rules_[field->topic].name : "";
}

bool Symbols::is_declared_component(std::string_view name) const {
  const auto known = place_of(name, rules_.components, components_);
  return known && rules_.components[*known].declared && !is_group(name);
}

std::string Symbols::forget_near_miss(const std::string& signal) {
  const auto found = near_misses_.find(signal);
  if (found == near_misses_.end()) return "";
  const NearMiss miss = found->second;
  near_misses_.erase(found);
  forgotten_reports_.insert(miss.report);
  return miss.near;
}

void Symbols::drop_forgotten_reports() {
  if (forgotten_reports_.empty()) return;
  std::vector<Diagnostic> kept;
  for (std::size_t i = 0; i < diagnostics_.size(); ++i) {
    if (!forgotten_reports_.contains(i)) kept.push_back(std::move(diagnostics_[i]));
  }
  diagnostics_ = std::move(kept);
  forgotten_reports_.clear();
}

namespace {

// The entry of `table` that is called so; a new one, if none is.
template <class Entry>
std::uint32_t known_or_new(const std::string& name, std::vector<Entry>& table,
                           PlaceIndex& by_name) {
  if (const auto known = place_of(name, table, by_name)) return *known;
  by_name.add(name_hash(name), table.size());
  table.push_back({name});
  return static_cast<std::uint32_t>(table.size() - 1);
}

}  // namespace

TopicId Symbols::topic(const std::string& name, std::optional<ComponentId> publisher) {
  const auto known = topics_.find(name_hash(name), [&](std::uint32_t place) {
    const Topic& topic = rules_.topics[place];
    return topic.name == name && topic.publisher == publisher;
  });
  const TopicId id(known.value_or(static_cast<std::uint32_t>(rules_.topics.size())));
  if (!known) {
    topics_.add(name_hash(name), id.index);
    rules_.topics.push_back({name, publisher});
  }
  return id;
}

DiagnosticId Symbols::diagnostic(const std::string& name) {
  return DiagnosticId(known_or_new(name, rules_.diagnostics, level_names_));
}

ParameterId Symbols::parameter(ComponentId component, const std::string& name) {
  const auto known = known_parameter(component, name);
  const ParameterId id = known.value_or(ParameterId(rules_.parameters.size()));
  if (!known) {
    parameters_.add(parameter_hash(component, name), id.index);
    rules_.parameters.push_back({component, name});
    parameter_types_.push_back(types_.add(std::nullopt));
  }
  return id;
}

InputId Symbols::input(const Input& wanted) {
  const std::size_t hash = input_hash(wanted);
  const auto known = inputs_.find(
      hash, [&](std::uint32_t place) { return is_same_input(rules_.inputs[place], wanted); });
  const InputId id(known.value_or(static_cast<std::uint32_t>(rules_.inputs.size())));
  if (!known) {
    inputs_.add(hash, id.index);
    rules_.inputs.push_back(wanted);
  }
  return id;
}

}  // namespace culprit

#include "import/rule_writer.h"

#include <algorithm>
#include <cmath>

#include "base/value.h"
#include "import/vocabulary.h"

namespace culprit::foreign {
namespace {

using enum AdaptationType;
using Kind = Expression::Kind;

constexpr double kConfidence = 10;    // attempts; the paper's experiments
constexpr double kLeastChance = 0.1;  // percent

// The reference's estimate of how many ticks an adaptation takes.
int usual_impact(AdaptationType type) {
  switch (type) {
    case kActivate:
    case kDeactivate:
      return 10;
    case kRestart:
      return 25;
    case kRedeploy:
      return 50;
    case kChangeCommunication:
      return 2;
    case kSetParameter:
    case kIncreaseParameter:
    case kDecreaseParameter:
    case kStart:
    case kStop:
    case kChangeMode:
    case kCall:
    case kStartGroup:
      break;
  }
  return 1;
}

std::string number_text(double number) {
  const bool is_whole = number == std::floor(number) && std::abs(number) < 1e15;
  return is_whole ? std::to_string(static_cast<std::int64_t>(number)) : to_string(Value(number));
}

// As a parameter, mode or topic name stands in a line.
std::string name_text(const std::string& name) {
  const bool is_bare = !name.empty() && name.find("//") == std::string::npos &&
                       std::all_of(name.begin(), name.end(), [](char c) {
                         return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
                                (c >= '0' && c <= '9') || c == '_' || c == '/' || c == '.' ||
                                c == '~' || c == '-';
                       });
  return is_bare ? name : to_string(Value(name));
}

class Writer {
 public:
  Writer(const File& file, const std::string& name) : file_(file), name_(name), vocabulary_(file) {}

  Written write() {
    written_.blocks.emplace_back();  // the header, filled in last
    constants();
    components();
    signals();
    for (const Rule& rule : file_.rules) add_rule(rule);
    if (!file_.comments_at_end.empty()) block(0).comments = file_.comments_at_end;
    header();
    return std::move(written_);
  }

 private:
  Block& block(std::uint32_t line) {
    Block block;
    block.line = line;
    written_.blocks.push_back(std::move(block));
    return written_.blocks.back();
  }

  void note(Block& block, const std::string& text) {
    if (std::find(block.notes.begin(), block.notes.end(), text) != block.notes.end()) return;
    block.notes.push_back(text);
    written_.notes.push_back({block.line, text});
  }

  // Writes the lines for the whole file.
  void header() {
    Block& header = written_.blocks.front();
    header.comments = {"Imported from " + name_ + ", in the dialect " + file_.dialect + "."};
    header.lines = {"CYCLE 200ms"};
    std::vector<Note> general;
    general.swap(written_.notes);
    note(header,
         "the reference tries each strategy once; here a rule gives up after three rounds, "
         "or after ATTEMPTS n");
    if (has_usual_impact_)
      note(header,
           "the file gives no impacts; these are the ticks that the reference plans for each "
           "kind of adaptation");
    if (has_usual_confidence_)
      note(header,
           "the file says nothing about how sure its probabilities are; they count as 10 "
           "attempts each");
    if (has_no_level_)
      note(header,
           "this dialect knows no levels and no strategies: each rule is a WARNING with one "
           "strategy of 100 percent; say what is more, or less, critical");
    if (has_no_level_)
      note(header,
           "in this dialect a failed adaptation is repeated, and after five failures the "
           "component is redeployed; add a STRATEGY with redeploy where that is wanted");
    written_.notes.insert(written_.notes.end(), general.begin(), general.end());
  }

  void constants() {
    for (const Constant& constant : file_.constants) {
      Block& block = this->block(constant.remarks.line);
      block.comments = constant.remarks.comments;
      for (const std::string& text : constant.remarks.notes) note(block, text);
      const std::string original = constant.type + " " + constant.name + " " + constant.value_text;
      if (!vocabulary_.counts(constant)) {
        note(block, "'" + original + "' is one of several declarations of " + constant.name +
                        "; the " + (file_.last_constant_counts ? "last" : "first") + " one counts");
        continue;
      }
      const std::string ours = vocabulary_.constant(constant);
      if (ours.empty()) {
        note(block, "'" + original +
                        "' is no constant here: it is a monitored value, and unknown "
                        "until it is first observed");
        continue;
      }
      if (ours != constant.name) note(block, constant.name + " is called " + ours + " here");
      block.lines = {"CONST " + ours + " = " + literal_text(constant.value) +
                     behind(constant.remarks)};
    }
    for (const Constant& constant : file_.without_value) {
      Block& block = this->block(constant.remarks.line);
      block.comments = constant.remarks.comments;
      note(block, "'" + constant.type + " " + constant.name +
                      "' has no value, so it is taken for a monitored one, unknown until it is "
                      "first observed; if it is a constant, add CONST " +
                      constant.name + " = and its value");
    }
  }

  void components() {
    for (const Vocabulary::Component& component : vocabulary_.components()) {
      Block& block = this->block(0);
      const bool is_full = component.node.starts_with('/');
      if (!is_full && component.name != component.node)
        note(block, "'" + component.node + "' is no name of a ROS node");
      std::string line = "COMPONENT " + component.name;
      if (is_full) line += " NODE " + component.node;
      if (component.is_redeployed) {
        const std::string own = component.node.substr(component.node.rfind('/') + 1);
        line +=
            " LAUNCH " + to_string(Value("ros2 launch managed_subsystem " + own + ".launch.py"));
        note(block,
             "the reference redeploys with launch files of one package, managed_subsystem; "
             "change LAUNCH if " +
                 own + " is started in another way");
      }
      block.lines = {line};
    }
  }

  void signals() {
    for (const Vocabulary::Signal& signal : vocabulary_.signals()) {
      block(0).lines = {"SIGNAL " + signal.name + " DIAGNOSTIC " + name_text(signal.status) +
                        " KEY " + name_text(signal.key)};
    }
  }

  // ---- rules

  void add_rule(const Rule& rule) {
    // A component that is active already must not keep the others from being activated.
    const auto& first = rule.strategies.front().adaptations;
    const bool is_lifecycle =
        rule.repeats && !first.empty() &&
        (first.front().type == kActivate || first.front().type == kDeactivate);
    if (!is_lifecycle) return write_rule(rule, rule.name, "");
    for (const Adaptation& adaptation : first) {
      const std::string component = vocabulary_.component(adaptation.component);
      const bool activates = adaptation.type == kActivate;
      Rule single = rule;
      single.strategies.front().adaptations = {adaptation};
      const std::string condition =
          " && lifecycle(" + component + ") " + (activates ? "!=" : "==") + " \"active\"";
      single.remarks.notes.push_back(
          std::string("ON_EVERY_TRIGGER repeats the adaptation while the condition holds and the "
                      "component is ") +
          (activates ? "not active" : "active") + "; the trigger says that");
      write_rule(single, first.size() > 1 ? rule.name + "_" + component : rule.name, condition);
    }
  }

  void write_rule(const Rule& rule, const std::string& name, const std::string& condition) {
    Block& block = this->block(rule.remarks.line);
    block.is_rule = true;
    block.comments = rule.remarks.comments;
    for (const std::string& text : rule.remarks.notes) note(block, text);
    const std::string ours = rule_names_.claim(name);
    if (ours != name) note(block, "rule " + name + " is called " + ours + " here");
    if (rule.repeats && condition.empty())
      note(block,
           "ON_EVERY_TRIGGER repeats the adaptation as long as the condition holds; here it "
           "is tried, and judged by whether the condition ends");
    block.lines.push_back("RULE " + ours + behind(rule.remarks));
    block.lines.push_back("  POLICIES " + policies(rule));
    std::string trigger = text_of(rule.trigger, block);
    const bool is_or = rule.trigger.kind == Kind::kBinary &&
                       rule.trigger.op == syntax::Operator::kOr && !condition.empty();
    block.lines.push_back("  TRIGGER " + (is_or ? "(" + trigger + ")" : trigger) + condition);
    NameClaims strategy_names;
    for (const Strategy& strategy : rule.strategies) add_strategy(strategy, strategy_names, block);
  }

  std::string policies(const Rule& rule) {
    using enum Criticality;
    has_no_level_ |= !rule.criticality.has_value();
    std::string text = "WARNING";
    if (rule.criticality == kNonCritical) text = "NON_CRITICAL";
    if (rule.criticality == kError) text = "ERROR";
    if (rule.hold_window != 1)
      text += " HOLD " + std::to_string(rule.hold_needed) + "/" + std::to_string(rule.hold_window);
    return rule.on_change ? text + " ON_CHANGE" : text;
  }

  std::string text_of(const Expression& e, Block& block) {
    std::vector<std::string> names;
    collect_names(e, names);
    for (const std::string& name : names) {
      if (const std::string text = vocabulary_.note(name); !text.empty()) note(block, text);
    }
    if (compares_fractions(e))
      note(block,
           "the reference compares numbers by == and != as texts with six decimals; here "
           "they must be equal");
    return expression_text(e,
                           [this](const std::string& name) { return vocabulary_.meaning(name); });
  }

  bool compares_fractions(const Expression& e) const {
    const bool is_equality = e.kind == Kind::kBinary && (e.op == syntax::Operator::kEqual ||
                                                         e.op == syntax::Operator::kNotEqual);
    return std::any_of(e.children.begin(), e.children.end(), [&](const Expression& child) {
      const bool is_fraction =
          child.kind == Kind::kLiteral && std::holds_alternative<double>(*child.literal);
      return (is_equality && is_fraction) || compares_fractions(child);
    });
  }

  void add_strategy(const Strategy& strategy, NameClaims& names, Block& block) {
    for (const std::string& comment : strategy.remarks.comments)
      block.lines.push_back("    # " + comment);
    const std::string ours = names.claim(strategy.name);
    if (ours != strategy.name)
      note(block, "strategy " + strategy.name + " is called " + ours + " here");
    const std::string line = "STRATEGY " + ours + " " + number_text(chance(strategy, block)) + " " +
                             number_text(confidence(strategy, block)) + behind(strategy.remarks);
    if (strategy.adaptations.empty()) {
      note(block, "strategy " + ours + " adapts nothing; it is kept as a comment");
      block.lines.push_back("    # " + line);
      return;
    }
    block.lines.push_back("    " + line);
    for (const Adaptation& adaptation : strategy.adaptations) add_adaptation(adaptation, block);
  }

  double chance(const Strategy& strategy, Block& block) {
    const double percent = strategy.probability.value_or(100);
    if (percent > 0 && percent <= 100) return percent;
    note(block, "strategy " + strategy.name + " has a success probability of " +
                    number_text(percent) + "; culprit's are above 0 and at most 100");
    return percent > 100 ? 100 : kLeastChance;
  }

  double confidence(const Strategy& strategy, Block& block) {
    has_usual_confidence_ |= !strategy.confidence.has_value();
    const double attempts = strategy.confidence.value_or(kConfidence);
    if (attempts > 0 && attempts <= 100) return attempts;
    note(block, "strategy " + strategy.name + " has a confidence of " + number_text(attempts) +
                    "; culprit's are above 0 and at most 100");
    return attempts > 100 ? 100 : 1;
  }

  void add_adaptation(const Adaptation& adaptation, Block& block) {
    for (const std::string& comment : adaptation.remarks.comments)
      block.lines.push_back("      # " + comment);
    for (const std::string& text : adaptation.remarks.notes) note(block, text);
    std::string line = "      ADAPTATION " + vocabulary_.component(adaptation.component) + " " +
                       std::string(keyword(adaptation.type));
    if (!adaptation.subject.empty()) line += " " + name_text(adaptation.subject);
    if (adaptation.type == kChangeCommunication) {
      line += " " + topic(*adaptation.value, block);
    } else if (adaptation.value) {
      line += " " + text_of(*adaptation.value, block);
    }
    if (adaptation.type == kIncreaseParameter || adaptation.type == kDecreaseParameter)
      note(block, "the reference sets " + adaptation.subject +
                      " to the value itself; here it is changed by that much, as written");
    block.lines.push_back(line + " " + impact(adaptation, block) + behind(adaptation.remarks));
  }

  // culprit wants the topic itself, the reference computes it.
  std::string topic(const Expression& value, Block& block) {
    if (value.kind == Kind::kLiteral && std::holds_alternative<std::string>(*value.literal))
      return name_text(std::get<std::string>(*value.literal));
    if (value.kind == Kind::kName) {
      for (const Constant& constant : file_.constants) {
        if (constant.name == value.name.text && constant.type == "string" &&
            vocabulary_.counts(constant))
          return name_text(std::get<std::string>(constant.value));
      }
      note(block,
           value.name.text + " is no constant text, so it is taken for the topic's name itself");
      return name_text(value.name.text);
    }
    note(block, "a topic cannot be computed here; put its name in the place of TOPIC");
    return "<TOPIC>";  // a placeholder, which a check refuses
  }

  std::string impact(const Adaptation& adaptation, Block& block) {
    has_usual_impact_ |= !adaptation.impact.has_value();
    const double cycles = adaptation.impact.value_or(usual_impact(adaptation.type));
    const double ours = std::clamp(std::ceil(cycles), 1.0, 1e6);
    if (ours != cycles)
      note(block, "an impact of " + number_text(cycles) + " is taken as " + number_text(ours) +
                      ": impacts are whole cycles, 1 to 10^6");
    return number_text(ours);
  }

  static std::string behind(const Remarks& remarks) {
    return remarks.comment_behind.empty() ? "" : "  # " + remarks.comment_behind;
  }

  const File& file_;
  const std::string& name_;
  const Vocabulary vocabulary_;
  NameClaims rule_names_;
  Written written_;
  bool has_usual_impact_ = false;
  bool has_usual_confidence_ = false;
  bool has_no_level_ = false;
};

}  // namespace

Written write(const File& file, const std::string& name) { return Writer(file, name).write(); }

}  // namespace culprit::foreign

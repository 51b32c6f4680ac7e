// Maps the names of a reference file to names in culprit's language.
//
// The reference keeps one store for everything: its constants are the first values of entries that
// monitoring may overwrite. culprit separates them, so each name that a trigger reads is told apart
// by how the reference's monitoring names its values:
//   <namespace>_<topic>_freq   the rate of a topic in the namespace of one of the file's components
//   <node>_<key>               a key of the diagnostics of one of the file's components
// Any other constant stays one, unless a trigger reads nothing else and it is used nowhere as a
// limit or a value; any other name is a signal, which culprit looks up on the robot.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "import/expression_text.h"
#include "import/foreign_rules.h"

namespace culprit::foreign {

// Adds the names that `e` uses, in order, as often as it uses them.
void collect_names(const syntax::Expression& e, std::vector<std::string>& names);

// Names that are given once each.
class NameClaims {
 public:
  // A name that is valid, no word of the language, and not given before; as near to `wanted` as can
  // be.
  std::string claim(const std::string& wanted);
  // `name` itself, though it may have been given before: something outside goes by it.
  const std::string& keep(const std::string& name);

 private:
  std::set<std::string> used_;
  std::map<std::string, int> next_;  // the number to try behind a name that is used
};

class Vocabulary {
 public:
  // `file` must outlive it.
  explicit Vocabulary(const File& file);

  struct Component {
    std::string name;  // in culprit's file
    std::string node;  // as the reference names it: a full name, or the node's own
    bool is_redeployed = false;
  };
  struct Signal {
    std::string name;
    std::string status;
    std::string key;
  };
  // In the order in which the file first speaks of them.
  const std::vector<Component>& components() const { return components_; }
  const std::vector<Signal>& signals() const { return signals_; }

  const std::string& component(const std::string& written) const {
    return component_names_.at(written);
  }
  // False if another declaration of the same name counts.
  bool counts(const Constant& constant) const;
  // Empty for a constant that is a monitored value.
  std::string constant(const Constant& constant) const;
  Meaning meaning(const std::string& written) const;
  // A note for the person about the name where it is used; empty for most.
  std::string note(const std::string& written) const;

 private:
  void find_components(const File& file);
  void add_component(const std::string& written);
  void add_reading(const std::string& name);
  void look_up(const std::string& name);
  bool is_monitored(const std::string& name) const;
  bool add_rate(const std::string& name);
  bool add_diagnostic(const std::string& name);

  NameClaims claims_;
  std::vector<Component> components_;
  std::map<std::string, std::string> component_names_;
  std::map<std::string, const Constant*> constants_;
  std::map<std::string, std::string> constant_names_;
  std::map<std::string, std::string> rates_;         // name -> topic
  std::map<std::string, std::string> signal_names_;  // name -> ours
  std::vector<Signal> signals_;
};

}  // namespace culprit::foreign

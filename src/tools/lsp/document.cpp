#include "lsp/document.h"

#include "live_checks/live_checks.h"

namespace culprit::lsp {
namespace {

std::string place_text(const Source& source, const Place& place) {
  const Source& file = source.file(place.file);
  return file.name() + ":" + std::to_string(file.position(place.span.begin).line);
}

// The steps to it as lines of its remedy.
std::string with_notes(const Diagnostic& diagnostic, const LocatedDiagnostic& here,
                       const Source& source) {
  std::string text = diagnostic.remedy;
  for (const auto& note : here.notes)
    text += (text.empty() ? "" : "\n") + note.text + ": " + place_text(source, note.place);
  return text;
}

}  // namespace

Document::Document(std::string text, const std::string& name, const RuleLoader& load)
    : written_(parse_whole(Source(name, std::move(text)))) {
  read_rules(load);
}

void Document::change(std::string text, const RuleLoader& load) {
  written_ = parse_whole(Source(source().name(), std::move(text)));
  names_.reset();
  names_elsewhere_.reset();
  read_rules(load);
}

void Document::read_rules(const RuleLoader& load) {
  if (!file().has_reuse()) {
    rules = {source(), {}, {}};
    whole_.reset();
    checked = check(written_);
  } else {
    rules = expand(source(), load);
    whole_ = parse_whole(rules.source);
    checked = check(rules, *whole_);
  }
  tell(checked.diagnostics);
}

void Document::tell(const std::vector<Diagnostic>& found) {
  diagnostics.clear();
  elsewhere.clear();
  for (const Diagnostic& d : found) {
    const LocatedDiagnostic here = located(d, rules.source);
    Diagnostic written = d;
    written.span = here.place.span;
    written.fix = here.fix;
    written.remedy = with_notes(d, here, rules.source);
    if (here.place.file == 0) {
      diagnostics.push_back(std::move(written));
      continue;
    }
    for (const auto& note : here.notes) {
      if (note.place.file != 0) continue;
      diagnostics.push_back({d.code, d.severity, note.place.span,
                             place_text(rules.source, here.place) + ": " + d.cause, d.remedy});
    }
    elsewhere[here.place.file].push_back(std::move(written));
  }
}

Component Document::component_called(const std::string& name) const {
  if (checked.rules) {
    for (const Component& c : checked.rules->components) {
      if (c.declared && c.name == name) return c;
    }
  }
  for (const syntax::Component& c : file().components) {
    if (c.name.text == name) return {name, c.node ? c.node->text : "", {}, true};
  }
  return {name, name.starts_with('/') ? name : "", {}, false};
}

const std::vector<Occurrence>& Document::names() const {
  if (!names_) names_ = occurrences(file(), source());
  return *names_;
}

const std::vector<Occurrence>& Document::names_elsewhere() const {
  if (names_elsewhere_) return *names_elsewhere_;
  names_elsewhere_.emplace();
  if (!whole_) return *names_elsewhere_;
  for (Occurrence& o : occurrences(whole_->file)) {
    const Origin origin = rules.source.origin(o.span);
    if (o.declares && (origin.place.file != 0 || !origin.steps.empty() || origin.goes_in))
      names_elsewhere_->push_back(std::move(o));
  }
  return *names_elsewhere_;
}

bool Document::compare_with(const LiveInventory& robot) {
  std::vector<Diagnostic> all = checked.diagnostics;
  // A robot without any node is one that is not there, and says nothing about the rules.
  if (checked.rules && !robot.nodes.empty())
    live_checks::check_live(whole_ ? whole_->file : file(), *checked.rules, robot, all);
  const auto before = std::pair(std::move(diagnostics), std::move(elsewhere));
  tell(all);
  return before != std::pair(diagnostics, elsewhere);
}

}  // namespace culprit::lsp

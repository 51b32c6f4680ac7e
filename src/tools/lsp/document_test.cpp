#include "lsp/document.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "language/test_edits.h"
#include "language/test_example_robot.h"

namespace culprit::lsp {
namespace {

std::string said_of(const std::vector<Diagnostic>& diagnostics) {
  std::string out;
  for (const Diagnostic& d : diagnostics) {
    out += to_string(d.code) + (d.severity == Severity::kError ? " error " : " warning ") +
           std::to_string(d.span.begin) + "-" + std::to_string(d.span.end) + " " + d.cause + "\n" +
           d.remedy + "\n";
    if (d.fix)
      out += std::to_string(d.fix->span.begin) + "-" + std::to_string(d.fix->span.end) + " " +
             d.fix->text + "\n";
  }
  return out;
}

// All that is said of a document, as far as people see it.
std::string said_of(const Document& document) {
  std::string out = said_of(document.diagnostics);
  for (const auto& [file, diagnostics] : document.elsewhere)
    out += "in " + document.rules.source.file(file).name() + "\n" + said_of(diagnostics);
  for (const Occurrence& o : document.names())
    out += o.name + " " + std::to_string(o.span.begin) + (o.declares ? " declared\n" : "\n");
  for (const Occurrence& o : document.names_elsewhere())
    out += o.name + " " + std::to_string(o.span.begin) + "\n";
  if (!document.checked.rules) return out;
  const LiveInterest interest = interest_of(*document.checked.rules);
  for (const std::string& node : interest.nodes) out += node + "\n";
  for (const auto& [topic, fields] : interest.fields_of_topics) out += topic + "\n";
  for (const Rule& rule : document.checked.rules->rules)
    out += rule.name + " " + std::to_string(rule.declaration.span.begin) + "\n";
  return out;
}

RC_GTEST_PROP(LspDocument, SaysAfterEachEditWhatItSaysOfTheWholeText, ()) {
  std::string other = "SIGNAL battery TOPIC /battery FIELD level\n";  // of other.rules
  const auto load = [&](const std::string& file, const std::string&) -> Expected<Source> {
    if (file != "other.rules") return Error{"there is no file '" + file + "'"};
    return Source(file, other);
  };
  std::string text = random_start();
  Document document(text, "test.rules", load);
  for (int edits = *rc::gen::inRange(1, 12); edits > 0; --edits) {
    (*rc::gen::inRange(0, 6) == 0 ? other : text) = edited(text);
    document.change(text, load);
    Document whole(text, "test.rules", load);
    RC_ASSERT(said_of(document) == said_of(whole));
    document.compare_with(example_robot());
    whole.compare_with(example_robot());
    RC_ASSERT(said_of(document) == said_of(whole));
  }
}

}  // namespace
}  // namespace culprit::lsp

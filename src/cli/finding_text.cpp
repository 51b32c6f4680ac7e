#include "cli/finding_text.h"

#include <fmt/format.h>

#include "base/name_grammar.h"

namespace culprit::cli {
namespace {

std::string coloured(doctor::Gravity gravity, Colour colour) {
  const std::string text = label(gravity);
  if (colour == Colour::kOff) return text;
  return (gravity == doctor::Gravity::kError ? "\033[31m" : "\033[33m") + text + "\033[0m";
}

}  // namespace

std::string finding_text(const doctor::Finding& finding, Colour colour) {
  const auto when =
      finding.when ? "  when:    " + escape_controls(to_string(*finding.when)) + "\n" : "";
  return fmt::format("{}[{}]: {}\n{}  seen:    {}\n  matters: {}\n  do:      {}\n",
                     coloured(finding.gravity, colour), finding.code,
                     escape_controls(finding.subject), when, escape_controls(finding.seen),
                     escape_controls(finding.matters), escape_controls(finding.remedy));
}

void print_finding(const doctor::Finding& finding, Colour colour) {
  say_text(stdout, finding_text(finding, colour));
}

}  // namespace culprit::cli

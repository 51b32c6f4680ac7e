#include "cli/finding_text.h"

namespace culprit::cli {
namespace {

std::string coloured(doctor::Gravity gravity, Colour colour) {
  const std::string text = label(gravity);
  if (colour == Colour::kOff) return text;
  return (gravity == doctor::Gravity::kError ? "\033[31m" : "\033[33m") + text + "\033[0m";
}

}  // namespace

void print_finding(const doctor::Finding& finding, Colour colour) {
  say(stdout, "{}[{}]: {}\n", coloured(finding.gravity, colour), finding.code, finding.subject);
  if (finding.when) say(stdout, "  when:    {}\n", to_string(*finding.when));
  say(stdout, "  seen:    {}\n  matters: {}\n  do:      {}\n", finding.seen, finding.matters,
      finding.remedy);
}

}  // namespace culprit::cli

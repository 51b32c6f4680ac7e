#include <filesystem>
#include <memory>

#include <fmt/core.h>

#include "base/text_file.h"
#include "base/units.h"
#include "cli/commands.h"
#include "init/draft.h"
#include "init/look.h"
#include "language/checker.h"
#include "language/formatter.h"
#include "live/preflight.h"
#include "live/robot_survey.h"
#include "ros2/options.h"
#include "terminal/console.h"
#include "terminal/seconds_option.h"

namespace culprit::cli {
namespace {

struct InitOptions {
  double seconds = 30;
  std::string output;
};

Expected<init::Sighting> look(const InitOptions& options) {
  const auto participant = ros2::options_from_environment();
  if (!participant) return Error{participant.error()};
  if (participant->security)
    return Error{
        "the domain is secured, and keys for what rules need do not open all that a look "
        "takes; write the rules by hand"};
  auto survey = live::open_survey();
  if (!survey) return Error{survey.error()};
  say(stderr, "culprit: watching domain {} for {}; the robot should be well meanwhile\n",
      participant->domain, to_string(from_seconds(options.seconds)));
  init::Sighting seen = init::look(**survey, participant->domain, from_seconds(options.seconds));
  if (!seen.robot.has_robot()) return Error{live::nobody_on(participant->domain)};
  return seen;
}

// What was written, in a sentence, and what to do next.
void advise(const std::string& file, const RuleSet& rules) {
  say(stderr,
      "culprit: {} has {} components and {} rules. Read it, then try it:\n"
      "  culprit check --robot {}\n  culprit run --dry-run {}\n",
      file, rules.components.size(), rules.rules.size(), file, file);
}

int draft_rules(const InitOptions& options) {
  const bool has_file = !options.output.empty();
  if (has_file && std::filesystem::exists(options.output))
    return fail(options.output + " is there already; name another file, or move it away", kUsage);
  const auto seen = look(options);
  if (!seen) return fail(seen.error());
  const auto text = format({"the draft", init::draft(*seen)});
  if (!text) return fail(text.error());
  const Checked checked = check({"the draft", *text});
  if (!checked.rules || checked.rules->components.empty()) {
    say(stderr, "{}", *text);
    return fail("no node of this robot can be started again by what could be found out");
  }
  if (const auto written = write_text(options.output, *text); !written)
    return fail(written.error());
  if (has_file) advise(options.output, *checked.rules);
  return kOk;
}

}  // namespace

void add_init(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<InitOptions>();
  CLI::App* command = app.add_subcommand(
      "init",
      "Draft a rule file from a live robot that is well: its components, how they are started, and "
      "how long their topics pause. Changes nothing on the robot");
  add_seconds(*command, "--for", options->seconds, "How long to watch it", 5, 3600);
  command->add_option("-o,--output", options->output,
                      "Where to write the draft (default: stdout). No file is overwritten");
  command->callback([options, &exit_code] { exit_code = draft_rules(*options); });
}

}  // namespace culprit::cli

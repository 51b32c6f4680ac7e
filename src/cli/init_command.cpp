#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <fmt/core.h>

#include "base/amount.h"
#include "base/environment.h"
#include "base/text_file.h"
#include "base/units.h"
#include "cli/commands.h"
#include "cli/load_rules.h"
#include "cli/unified_diff.h"
#include "init/bag_draft.h"
#include "init/draft.h"
#include "init/lasting.h"
#include "init/look.h"
#include "init/marks.h"
#include "init/running_launch.h"
#include "init/update.h"
#include "language/checker.h"
#include "language/formatter.h"
#include "live/preflight.h"
#include "live/robot_survey.h"
#include "ros2/options.h"
#include "rule_files/rule_files.h"
#include "terminal/console.h"
#include "terminal/seconds_option.h"

namespace culprit::cli {
namespace {

struct InitOptions {
  double seconds = 30;
  std::string output;
  std::string launch_dump;
  std::string update;  // the rule file that is brought up to the robot; empty: a new draft
  bool packs = false;
  std::vector<std::string> bags;
  std::vector<std::filesystem::path> message_path;  // of bags

  init::Packs wanted_packs() const { return packs ? init::Packs::kChosen : init::Packs::kNone; }
};

Expected<init::LaunchDump> dump_of(const InitOptions& options) {
  if (options.launch_dump.empty()) return init::LaunchDump{};
  const auto text = read_text(options.launch_dump);
  if (!text) return Error{text.error()};
  return init::read_launch_dump(*text, options.launch_dump);
}

// Beside the draft: "my.rules" has "my.params.yaml".
std::string parameter_file(const InitOptions& options) {
  std::filesystem::path beside =
      std::filesystem::absolute(options.output.empty() ? options.update : options.output);
  return beside.replace_extension("params.yaml").string();
}

void take(init::LaunchDump dump, const InitOptions& options, init::RobotProfile& seen) {
  seen.dump = std::move(dump);
  seen.has_dump = !options.launch_dump.empty();
  if (!options.output.empty() || !options.update.empty())
    seen.parameter_file = parameter_file(options);
  if (seen.has_dump || seen.parameter_file.empty()) return;
  init::RunningLaunch running = init::running_launch(seen.robot);
  for (const std::string& note : running.notes) say(stderr, "culprit: {}\n", note);
  seen.dump = std::move(running.dump);
}

Expected<init::RobotProfile> look(const InitOptions& options) {
  const auto participant = ros2::options_from_environment();
  if (!participant) return Error{participant.error()};
  if (participant->security)
    return Error{
        "the domain is secured, and keys for the inputs of rules do not permit all that init "
        "reads; write the rules by hand"};
  auto survey = live::open_survey();
  if (!survey) return Error{survey.error()};
  say(stderr, "culprit: watching domain {} for {}; keep the robot healthy meanwhile\n",
      participant->domain, to_string(from_seconds(options.seconds)));
  init::RobotProfile seen =
      init::look(**survey, participant->domain, from_seconds(options.seconds));
  if (!seen.robot.has_robot()) return Error{live::no_nodes_on(participant->domain)};
  return seen;
}

// Reports the written file in a sentence, with the next step.
void advise(const std::string& file, const RuleSet& rules) {
  say(stderr,
      "culprit: {} has {} and {}. Read it, then try it:\n"
      "  culprit check --robot {}\n  culprit run --dry-run {}\n",
      file, amount_of(rules.components.size(), "component"), amount_of(rules.rules.size(), "rule"),
      file, file);
}

// Why nothing can be written there, which is said before anything is watched or read; empty: it can.
std::string objection_to_output(const std::string& output) {
  if (output.empty()) return "";
  if (std::filesystem::exists(output))
    return output + " is there already; name another file, or write --update in place of -o";
  const std::filesystem::path folder = std::filesystem::absolute(output).parent_path();
  std::error_code error;
  if (!std::filesystem::is_directory(folder, error))
    return "there is no folder '" + folder.string() + "' to write " + output + " to";
  return "";
}

int draft_rules(const InitOptions& options) {
  const bool has_file = !options.output.empty();
  if (const std::string objection = objection_to_output(options.output); !objection.empty())
    return fail(objection, kUsage);
  if (const auto robot = ros2::options_from_environment(); !robot)
    return fail(robot.error(), kUsage);
  auto dump = dump_of(options);
  if (!dump) return fail(dump.error(), kUsage);
  if (!options.launch_dump.empty() && !has_file)
    return fail("--launch writes a file of parameters beside the draft: name the draft with -o",
                kUsage);
  auto seen = look(options);
  if (!seen) return fail(seen.error());
  take(std::move(*dump), options, *seen);
  const init::Kept kept = init::keep_parameters(
      *seen, has_file ? std::filesystem::absolute(options.output).native() : "");
  for (const std::string& note : kept.notes) say(stderr, "culprit: {}\n", note);
  const auto text = format({"the draft", init::draft(*seen, options.wanted_packs())});
  if (!text) return fail(text.error());
  const Expansion rules =
      expand({has_file ? options.output : "the draft", *text}, rule_files::load);
  if (!rules.mistakes.empty()) return fail(render(rules.mistakes, rules.source));
  const Checked checked = check(rules);
  if (!checked.rules || checked.rules->components.empty()) {
    say(stderr, "{}", *text);
    return fail(
        "culprit found no node of this robot that it can start again; the draft above gives the "
        "reasons");
  }
  const std::string parameters = init::parameters_text(*seen);
  if (!parameters.empty() && std::filesystem::exists(seen->parameter_file))
    return fail(seen->parameter_file + " is there already; name another draft, or move it away",
                kUsage);
  for (const init::KeptFile& each : kept.files) {
    if (std::filesystem::exists(each.path))
      return fail(each.path + " is there already; name another draft, or move it away", kUsage);
  }
  for (const init::KeptFile& each : kept.files) {
    if (const auto written = write_text(each.path, each.text); !written)
      return fail(written.error());
  }
  if (!parameters.empty()) {
    if (const auto written = write_text(seen->parameter_file, parameters); !written)
      return fail(written.error());
  }
  if (const auto written = write_text(options.output, *text); !written)
    return fail(written.error());
  if (has_file) advise(options.output, *checked.rules);
  return kOk;
}

// From recordings instead of the live robot.
int draft_from_bags(const InitOptions& options) {
  const bool has_file = !options.output.empty();
  if (const std::string objection = objection_to_output(options.output); !objection.empty())
    return fail(objection, kUsage);
  std::vector<bag_doctor::BagCourse> courses;
  for (const std::string& bag : options.bags) {
    ros2::MessageLibrary library(
        ros2::message_directories(options.message_path, environment("AMENT_PREFIX_PATH")));
    auto course = bag_doctor::read_course(bag, library);
    if (!course) return fail(course.error());
    courses.push_back(std::move(*course));
  }
  const auto text = format({"the draft", init::draft_of_bags(courses)});
  if (!text) return fail(text.error());
  const Source source(has_file ? options.output : "the draft", *text);
  const Checked checked = check(source);
  if (!checked.rules) return fail(render(checked.diagnostics, source));
  if (checked.rules->rules.empty())
    return fail("the recordings have no topic with a steady rhythm, so there is no rule to draft");
  if (const auto written = write_text(options.output, *text); !written)
    return fail(written.error());
  if (has_file)
    say(stderr,
        "culprit: {0} has {1} rules. Read it, then try it on a recording that is not among these:\n"
        "  culprit check --bag BAG {0}\n  culprit replay BAG --rules {0}\n",
        options.output, checked.rules->rules.size());
  return kOk;
}

// A file and what it becomes, line by line.
struct ChangedText {
  std::string after;
  std::string diff;
};

ChangedText changed(const std::string& name, const std::string& before,
                    const init::Update& update) {
  if (update.changes.empty()) return {before, ""};
  const auto lines = lines_of(before);
  const std::string last = lines.empty() ? "" : std::string(lines.back()) + "\n";
  std::vector<LineEdit> edits;
  std::size_t at = 0;
  const auto keep_until = [&](std::size_t end) {
    for (; at < end; ++at) {
      if (lines[at].ends_with('\n')) {
        edits.push_back({' ', lines[at]});
      } else {  // something comes behind the last line
        edits.push_back({'-', lines[at]});
        edits.push_back({'+', last});
      }
    }
  };
  for (const init::Update::Change& change : update.changes) {
    keep_until(change.at);
    for (; at < change.at + change.removed; ++at) edits.push_back({'-', lines[at]});
    for (const std::string& line : change.added) edits.push_back({'+', line});
  }
  keep_until(lines.size());
  ChangedText result{"", unified_diff(name, edits)};
  for (const LineEdit& edit : edits) {
    if (edit.sign != '-') result.after += edit.line;
  }
  return result;
}

// The file of parameters that rules which were brought up to the robot name.
struct ParameterUpdate {
  std::string file;
  std::optional<std::string> before{};  // nothing: there is none
  std::string after{};                  // empty: it stays as it is
  std::string diff{};
  std::string note{};
};

Expected<ParameterUpdate> parameter_update(
    const InitOptions& options, const std::string& file,
    const std::function<std::string(std::string)>& wanted_of) {
  ParameterUpdate update{file};
  std::error_code error;
  if (std::filesystem::exists(update.file, error)) {
    auto text = read_text(update.file);
    if (!text) return Error{text.error()};
    update.before = std::move(*text);
  }
  const bool is_ours = update.before && init::is_as_written(*update.before);
  std::string wanted = wanted_of(is_ours ? *update.before : "");
  if (wanted.empty() || update.before == wanted) return update;
  if (update.before && !options.output.empty() && options.output != options.update)
    return Error{update.file + " is there already; name another draft, or move it away"};
  if (update.before && !is_ours) {
    update.note =
        update.file +
        " is not as culprit wrote it, and stays as it is: compare it with the robot's yourself";
    return update;
  }
  std::vector<LineEdit> edits;
  if (update.before) {
    for (const std::string_view line : lines_of(*update.before)) edits.push_back({'-', line});
  }
  for (const std::string_view line : lines_of(wanted)) edits.push_back({'+', line});
  update.diff = unified_diff(update.file, edits);
  update.after = std::move(wanted);
  return update;
}

// A file that was changed meanwhile is not overwritten.
Expected<void> write_parameters(const ParameterUpdate& update) {
  if (update.after.empty()) return {};
  std::error_code error;
  const bool is_there = std::filesystem::exists(update.file, error);
  const auto present = is_there ? read_text(update.file) : Expected<std::string>("");
  if (is_there != update.before.has_value() || !present ||
      (update.before && *present != *update.before))
    return Error{update.file +
                 " was changed while the robot was watched, and stays as it is; run it again"};
  return write_text(update.file, update.after);
}

int update_rules(const InitOptions& options) {
  const bool is_in_place = options.output == options.update;
  if (!options.output.empty() && !is_in_place && std::filesystem::exists(options.output))
    return fail(options.output + " is there already; name another file, or " + options.update,
                kUsage);
  const auto text = read_text(options.update);
  if (!text) return fail(text.error(), kUsage);
  const auto rules = load_rules(options.update);
  if (!rules) return fail(options.update + " has errors, and stays as it is", kUsage);
  auto dump = dump_of(options);
  if (!dump) return fail(dump.error(), kUsage);
  auto seen = look(options);
  if (!seen) return fail(seen.error());
  take(std::move(*dump), options, *seen);

  const init::Kept kept =
      init::keep_parameters(*seen, std::filesystem::absolute(options.update).native());
  std::vector<ParameterUpdate> parameters;
  auto of_dump = parameter_update(options, seen->parameter_file, [&](const std::string& before) {
    return init::parameters_text(*seen, before);
  });
  if (!of_dump) return fail(of_dump.error(), kUsage);
  parameters.push_back(std::move(*of_dump));
  for (const init::KeptFile& each : kept.files) {
    auto of_launch =
        parameter_update(options, each.path, [&](const std::string&) { return each.text; });
    if (!of_launch) return fail(of_launch.error(), kUsage);
    parameters.push_back(std::move(*of_launch));
  }
  const init::Update update = init::update(*text, *rules, *seen, options.wanted_packs());
  const ChangedText now = changed(options.update, *text, update);
  const Expansion after = expand({options.update, now.after}, rule_files::load);
  if (!after.mistakes.empty()) return fail(render(after.mistakes, after.source));
  if (const Checked checked = check(after); !checked.rules)
    return fail(render(checked.diagnostics, after.source));
  for (const ParameterUpdate& each : parameters) say(stdout, "{}", each.diff);
  say(stdout, "{}", now.diff);
  for (const auto* notes : {&update.notes, &kept.notes}) {
    for (const std::string& note : *notes) say(stderr, "culprit: {}\n", note);
  }
  for (const ParameterUpdate& each : parameters) {
    if (!each.note.empty()) say(stderr, "culprit: {}\n", each.note);
  }
  const bool is_as_it_was = std::ranges::all_of(
      parameters, [](const ParameterUpdate& each) { return each.after.empty(); });
  if (update.changes.empty() && is_as_it_was)
    say(stderr, "culprit: {} needs no change for this robot\n", options.update);
  if (options.output.empty()) return kOk;
  const auto present = read_text(options.update);
  if (is_in_place && (!present || *present != *text)) {
    return fail(options.update +
                " was changed while the robot was watched, and stays as it is; run it again");
  }
  for (const ParameterUpdate& each : parameters) {
    if (const auto written = write_parameters(each); !written) return fail(written.error());
  }
  if (is_in_place && update.changes.empty()) return kOk;
  if (const auto written = write_text(options.output, now.after); !written)
    return fail(written.error());
  return kOk;
}

}  // namespace

void add_init(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<InitOptions>();
  CLI::App* command =
      app.add_subcommand("init",
                         "Draft a rule file from a healthy live robot: its components, their start "
                         "commands, and the periods of their topics. Changes nothing on the robot");
  add_seconds(*command, "--for", options->seconds, "How long to watch it", 5, 3600);
  command
      ->add_option("-o,--output", options->output,
                   "Where to write the draft (default: stdout). No file is overwritten but the one "
                   "of --update")
      ->type_name("FILE");
  command
      ->add_option("--launch", options->launch_dump,
                   "play_launch's dump of the robot's launch file (system_model.yaml or "
                   "record.json), for composed and respawned nodes")
      ->type_name("FILE");
  command->add_flag(
      "--pack", options->packs,
      "Include the rule packs that fit the robot (docs/packs.md), with the measured rates");
  command
      ->add_option(
          "--update", options->update,
          "Update this rule file to the robot, and show the changes as a unified diff. New parts "
          "are added, unchanged drafted parts are replaced if they no longer fit, and lines "
          "written by people stay. Writes only with -o, which may name the same file")
      ->type_name("FILE");
  CLI::Option* bags =
      command
          ->add_option("--bag", options->bags,
                       "Draft rules that report from these recordings of a healthy robot instead; "
                       "several give better limits")
          ->type_name("FILE");
  for (const char* other : {"--for", "--launch", "--pack", "--update"})
    bags->excludes(command->get_option(other));
  command
      ->add_option("--message-path", options->message_path,
                   "Where message definitions are, beside AMENT_PREFIX_PATH")
      ->type_name("FOLDER")
      ->needs(bags);
  command->callback([options, &exit_code] {
    exit_code = !options->bags.empty()    ? draft_from_bags(*options)
                : options->update.empty() ? draft_rules(*options)
                                          : update_rules(*options);
  });
}

}  // namespace culprit::cli

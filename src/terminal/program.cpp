#include "terminal/program.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "base/closest.h"
#include "base/name_grammar.h"
#include "terminal/command.h"
#include "terminal/console.h"
#include "terminal/help.h"
#include "terminal/listed.h"
#include "terminal/manual.h"

namespace culprit {
namespace {

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

std::vector<std::string_view> names_of(const std::vector<const CLI::App*>& commands) {
  std::vector<std::string_view> names;
  for (const CLI::App* command : commands) names.push_back(command->get_name());
  return names;
}

std::vector<std::string> options_of(const CLI::App& command) {
  std::vector<const CLI::Option*> options = options_in(command);
  const auto all = command.get_options();  // with those that are not listed
  options.insert(options.end(), all.begin(), all.end());
  std::vector<std::string> names;
  for (const CLI::Option* option : options) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    for (const std::string& name : option->get_snames()) names.push_back("-" + name);
  }
  return names;
}

using Words = std::vector<std::pair<std::string_view, std::string_view>>;

// The first word behind `word` that is known; empty: there is none.
std::string_view translated(std::string_view word, const Words& words,
                            const std::vector<std::string_view>& known) {
  for (const auto& [theirs, ours] : words) {
    if (theirs == word && std::ranges::find(known, ours) != known.end()) return ours;
  }
  return "";
}

// As other tools call it.
std::string_view command_of_other_tools(std::string_view word,
                                        const std::vector<std::string_view>& known) {
  static const Words kWords = {
      {"start", "run"},       {"launch", "run"},     {"up", "run"},         {"stop", "pause"},
      {"continue", "resume"}, {"unpause", "resume"}, {"ps", "status"},      {"list", "status"},
      {"show", "status"},     {"watch", "top"},      {"history", "log"},    {"events", "log"},
      {"why", "explain"},     {"lint", "check"},     {"validate", "check"}, {"verify", "check"},
      {"diagnose", "doctor"}, {"mute", "silence"},   {"unmute", "silence"}, {"format", "fmt"},
      {"draft", "init"},      {"generate", "init"},  {"new", "init"},       {"simulate", "test"}};
  return translated(word, kWords, known);
}

std::string_view option_of_other_tools(std::string_view option,
                                       const std::vector<std::string_view>& known) {
  static const Words kWords = {
      {"--seconds", "--for"},   {"--seconds", "--wait"},     {"--duration", "--for"},
      {"--duration", "--wait"}, {"--time", "--for"},         {"--time", "--wait"},
      {"--timeout", "--wait"},  {"--follow", "--watch"},     {"--lines", "--last"},
      {"--out", "--output"},    {"--simulate", "--dry-run"}, {"--fault", "--kinds"},
      {"--faults", "--kinds"},  {"--component", "--only"}};
  return translated(option, kWords, known);
}

// "; did you mean 'check'?", or nothing.
std::string meant(std::string_view word, const std::vector<std::string_view>& known) {
  std::string lower(word);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  const bool is_case_only = lower != word && std::ranges::find(known, lower) != known.end();
  const std::string near = is_case_only ? lower : closest(word, known);
  return near.empty() ? "" : "; did you mean '" + near + "'?";
}

std::string comma_separated(const std::vector<std::string_view>& words) {
  std::string out;
  for (const std::string_view word : words) out += (out.empty() ? "" : ", ") + std::string(word);
  return out;
}

// The command that the line names, and how it is called: "culprit beliefs show".
struct Chosen {
  const CLI::App* command;
  std::string path;
  int depth = 0;  // words of `path` behind the program's name
};

Chosen chosen(const CLI::App& app) {
  Chosen out{&app, app.get_name()};
  while (!out.command->get_subcommands().empty()) {
    out.command = out.command->get_subcommands().front();
    out.path += " " + out.command->get_name();
    ++out.depth;
  }
  return out;
}

// A word with a digit behind its '-' is a number.
bool is_option(std::string_view word) {
  return word.size() > 1 && word[0] == '-' && (word[1] < '0' || word[1] > '9') && word[1] != '.';
}

// The first option on the command line that the command has not; empty: there is none.
std::string unknown_option(const std::vector<std::string>& known, int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string_view word(argv[i]);
    std::string option(word.substr(0, word.find('=')));
    if (option == "--") return "";
    if (!is_option(option)) continue;
    if (!option.starts_with("--")) option.resize(2);  // "-n5"
    if (std::find(known.begin(), known.end(), option) == known.end()) return option;
  }
  return "";
}

// Which of the other commands have it.
std::vector<std::string_view> commands_with(const CLI::App& app, const std::string& option) {
  std::vector<std::string_view> names;
  for (const CLI::App* command : commands_in(app)) {
    if (command->get_option_no_throw(option) != nullptr) names.push_back(command->get_name());
  }
  return names;
}

// The argument that has the option's name, or stands for it: BAG for "--bag", NAME for
// "--component"; empty: there is none.
std::string positional_called(const CLI::App& command, const std::string& option) {
  std::string upper(option);
  std::transform(upper.begin(), upper.end(), upper.begin(),
                 [](unsigned char c) { return std::toupper(c); });
  const bool is_name = is_one_of(option, {"--component", "--rule"});
  const bool is_file = is_one_of(option, {"--file", "--input", "--rules"});
  for (const CLI::Option* each : command.get_options()) {
    if (!each->get_positional()) continue;
    const std::string name = each->get_name(true);
    if ("--" + name == upper || (is_name && name == "NAME") || (is_file && name == "RULES"))
      return name;
  }
  return "";
}

// The remedy for an option that `command`, with the options `known`, has not: "; test has it".
std::string remedy_of(const CLI::App& app, const CLI::App& command, const std::string& option,
                      const std::vector<std::string>& known) {
  const bool is_program = &command == &app;
  if (is_program && (option == "-v" || option == "-V")) return "; did you mean '--version'?";
  if (const std::string word = positional_called(command, option); !word.empty())
    return "; write " + word + " without it";
  if (std::string near = meant(option, {known.begin(), known.end()}); !near.empty()) return near;
  if (option == "--domain") return "; set ROS_DOMAIN_ID, which every command heeds";
  if (const auto ours = option_of_other_tools(option, {known.begin(), known.end()}); !ours.empty())
    return "; did you mean '" + std::string(ours) + "'?";
  if (const auto parts = commands_with(command, option); !is_program && !parts.empty())
    return "; it stands behind " + comma_separated(parts);
  constexpr std::size_t kFew = 4;
  std::vector<std::string_view> own;
  for (const std::string& each : known) {
    if (each.starts_with("--") && each != "--help") own.push_back(each);
  }
  if (!is_program && !own.empty() && own.size() <= kFew) return "; it has " + comma_separated(own);
  const auto others = commands_with(app, option);
  constexpr std::size_t kMostNamed = 4;
  if (others.empty() || others.size() > kMostNamed) return "";
  return "; " + comma_separated(others) + (others.size() == 1 ? " has it" : " have it");
}

// The mistake, where the name of a command or of an option is not known; nothing where something
// else is wrong.
std::optional<std::string> unknown_word(const CLI::App& app, const Chosen& line, int argc,
                                        char** argv) {
  const auto parts = commands_in(*line.command);
  if (!parts.empty() && line.depth + 1 < argc && !is_option(argv[line.depth + 1])) {
    const char* word = argv[line.depth + 1];
    const std::vector<std::string_view> known = names_of(parts);
    const auto ours = command_of_other_tools(word, known);
    const std::string near =
        ours.empty() ? meant(word, known) : "; did you mean '" + std::string(ours) + "'?";
    if (line.command == &app) return "there is no command '" + printable(word) + "'" + near;
    return line.command->get_name() + " has no command '" + printable(word) + "'" +
           (near.empty() ? "; it has " + comma_separated(known) : near);
  }
  const std::vector<std::string> options = options_of(*line.command);
  const std::string option = unknown_option(options, argc, argv);
  if (option.empty()) return std::nullopt;
  const std::string cause =
      (line.command == &app ? "there is" : line.command->get_name() + " has") + " no option '" +
      printable(option) + "'";
  return cause + remedy_of(app, *line.command, option, options);
}

std::string without(std::string text, std::string_view prefix) {
  return text.starts_with(prefix) ? text.substr(prefix.size()) : text;
}

// "0.100000" as people write it.
std::string plain_range(std::string text) {
  for (auto at = text.find('.'); at != std::string::npos; at = text.find('.', at + 1)) {
    auto end = text.find_first_not_of("0123456789", at + 1);
    if (end == std::string::npos) end = text.size();
    auto last = end;
    while (last > at + 1 && text[last - 1] == '0') --last;
    if (last == at + 1) --last;
    text.erase(last, end - last);
  }
  return text;
}

// "Value 99999 not in range 0 to 65535", "xml not in {text,json}"
std::string invalid_value(const std::string& text) {
  const std::size_t colon = text.find(": ");
  if (colon == std::string::npos) return text;
  const std::string option = text.substr(0, colon + 2);
  const std::string rest = without(text.substr(colon + 2), "Value ");
  if (rest.starts_with("takes no value")) return text.substr(0, colon) + " " + printable(rest);
  constexpr std::string_view kRange = " not in range ";
  if (const auto at = rest.find(kRange); at != std::string::npos)
    return option + "'" + rest.substr(0, at) + "' is no number from " +
           plain_range(rest.substr(at + kRange.size()));
  constexpr std::string_view kSet = " not in {";
  const auto at = rest.find(kSet);
  if (at == std::string::npos || !rest.ends_with('}')) return text;
  const std::string value = rest.substr(0, at);
  const std::string list = rest.substr(at + kSet.size(), rest.size() - at - kSet.size() - 1);
  std::vector<std::string_view> known;
  for (std::string_view left = list; !left.empty();) {
    const auto comma = left.find(',');
    known.push_back(left.substr(0, comma));
    left = comma == std::string_view::npos ? "" : left.substr(comma + 1);
  }
  return option + "'" + value + "' is none of " + comma_separated(known) + meant(value, known);
}

std::string missing(const CLI::RequiredError& error, const CLI::App& command) {
  const std::string text = error.what();
  constexpr std::string_view kRequired = " is required";
  if (text == "A subcommand is required")
    return command.get_name() +
           " needs a command: " + comma_separated(names_of(commands_in(command)));
  constexpr std::string_view kOneOf = "Exactly 1 option from [";
  if (text.starts_with(kOneOf)) {
    std::string options = text.substr(kOneOf.size(), text.find(']') - kOneOf.size());
    for (auto at = options.find(','); at != std::string::npos; at = options.find(',', at + 4))
      options.replace(at, 1, " or ");
    return "give " + options + ", and not both";
  }
  return text.ends_with(kRequired) ? text.substr(0, text.size() - kRequired.size()) + " is missing"
                                   : text;
}

// The probable remedy for the argument that is too many, behind the word `before`.
std::string remedy_of_extra(std::string_view extra, std::string_view before,
                            const CLI::App& command) {
  const CLI::Option* option =
      is_option(before) ? command.get_option_no_throw(std::string(before)) : nullptr;
  if (option != nullptr && option->get_items_expected_max() == 0)
    return "; " + std::string(before) + " takes no value";
  const bool is_number = !before.empty() && before.find_first_not_of("0123456789.") == before.npos;
  if (is_number && extra.find_first_not_of("abcdefghijklmnopqrstuvwxyz") == extra.npos)
    return "; a duration is one word, as in 10min";
  bool takes_arguments = false;
  for (const CLI::Option* each : command.get_options()) {
    if (!each->get_positional()) continue;
    takes_arguments = true;
    if (each->get_items_expected_max() == 1 && !each->results().empty())
      return "; " + each->get_name(true) + " is '" + printable(each->results().front()) +
             "' already";
  }
  for (const char* known : {"--output", "--reason"}) {
    if (!takes_arguments && command.get_option_no_throw(known) != nullptr)
      return fmt::format("; did you mean {} '{}'?", known, printable(extra));
  }
  return "";
}

std::string too_many(const CLI::App& app, const CLI::App& command, int argc, char** argv) {
  std::vector<std::string> extras = command.remaining();
  if (extras.empty()) extras = app.remaining();
  if (extras.empty()) return "there is one argument too many";
  const std::string& extra = extras.front();
  if (is_option(extra))
    return "'" + printable(extra) + "' stands in front of the command; write it behind " +
           command.get_name();
  std::string_view before;
  for (int i = 2; i < argc; ++i) {
    if (extra == argv[i]) before = argv[i - 1];
  }
  return "'" + printable(extra) + "' is one argument too many" +
         remedy_of_extra(extra, before, command);
}

// ": FILE", or nothing.
std::string kind_of_value(const CLI::App& command, const std::string& name) {
  const CLI::Option* option = command.get_option_no_throw(name);
  const std::string value = option != nullptr ? value_of(*option) : "";
  return value.empty() || value == "TEXT" ? "" : ": " + value;
}

// A flag would take any number for the count of its uses: --web=80.
void refuse_values_of_flags(CLI::App& app) {
  for (CLI::Option* option : app.get_options()) {
    const bool is_flag = option->get_items_expected_max() == 0 && option->nonpositional();
    if (!is_flag || option == app.get_help_ptr() || option == app.get_version_ptr()) continue;
    option->check([](const std::string& value) {
      return value == "true" || value == "false" ? "" : "takes no value, as '" + value + "'";
    });
  }
  for (CLI::App* part : app.get_subcommands([](CLI::App*) { return true; }))
    refuse_values_of_flags(*part);
}

// The mistake in the words of people. CLI11 has its own for each.
std::string cause_of(const CLI::ParseError& error, const CLI::App& app, const CLI::App& command,
                     int argc, char** argv) {
  const std::string text = error.what();
  if (const auto* required = dynamic_cast<const CLI::RequiredError*>(&error))
    return missing(*required, command);
  if (dynamic_cast<const CLI::ValidationError*>(&error) != nullptr) return invalid_value(text);
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr)
    return too_many(app, command, argc, argv);
  constexpr std::string_view kNoConversion = "Could not convert: ";
  if (text.starts_with(kNoConversion)) {
    const std::string rest = text.substr(kNoConversion.size());
    const auto equals = rest.find(" = ");
    const CLI::Option* option =
        equals != std::string::npos ? command.get_option_no_throw(rest.substr(0, equals)) : nullptr;
    if (option != nullptr && option->get_items_expected_max() == 0)
      return rest.substr(0, equals) + " takes no value, as '" + printable(rest.substr(equals + 3)) +
             "'";
    if (equals != std::string::npos)
      return rest.substr(0, equals) + ": '" + printable(rest.substr(equals + 3)) + "' is no number";
  }
  constexpr std::string_view kOneMissing = ": 1 required ";
  if (const auto at = text.find(kOneMissing); at != std::string::npos)
    return text.substr(0, at) + " needs a value" + kind_of_value(command, text.substr(0, at));
  constexpr std::string_view kTwice = ": At Most 1 required but received";
  if (const auto at = text.find(kTwice); at != std::string::npos)
    return text.substr(0, at) + " is given more than once; give it once";
  constexpr std::string_view kMoreMissing = ": At least ";
  if (const auto at = text.find(kMoreMissing); at != std::string::npos)
    return text.substr(0, at) + " needs at least " +
           text.substr(at + kMoreMissing.size(),
                       text.find(' ', at + kMoreMissing.size()) - at - kMoreMissing.size()) +
           " values";
  return text;
}

// How the command is called, and where its options are listed.
void say_usage(const CLI::App& app, const Chosen& line) {
  const std::string of_command = without(line.path, app.get_name());
  const bool has_help = command_named(app, "help") != nullptr;
  const std::string more = has_help ? app.get_name() + " help" + of_command : line.path + " --help";
  say(stderr, "Usage: {}\nRun '{}' for more information.\n", usage_of(*line.command, line.path),
      more);
}

int usage_error(const std::string& cause, const CLI::App& app, const Chosen& line) {
  const int code = fail(cause, kUsage);
  say_usage(app, line);
  return code;
}

int parse_and_run(CLI::App& app, const std::function<void(int& exit_code)>& add_commands, int argc,
                  char** argv) {
  app.require_subcommand(1);
  app.formatter(help_formatter());
  int exit_code = kOk;
  add_commands(exit_code);
  refuse_values_of_flags(app);
  if (argc < 2) {
    say(stderr, "{}", app.help());
    return kUsage;
  }
  // "culprit --help run" is about `run`.
  const bool is_help_first = argc > 2 && is_one_of(argv[1], {"--help", "-h"}) && *argv[2] != '-';
  if (is_help_first) std::rotate(argv + 1, argv + 2, argv + argc);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error) == 0 ? kOk : kUsage;
    const Chosen line = chosen(app);
    const auto word = unknown_word(app, line, argc, argv);
    return usage_error(word ? *word : cause_of(error, app, *line.command, argc, argv), app, line);
  }
  // The command itself found the mistake.
  if (exit_code == kUsage) say_usage(app, chosen(app));
  return exit_code;
}

// A report that a full disk cut short must not look whole. A reader that has seen enough may leave.
bool is_output_written(int reason) {
  errno = reason;
  if (reason == 0 && std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return true;
  if (errno == EPIPE) return true;
  std::fprintf(stderr, "culprit: not all of the output could be written%s%s\n",
               errno != 0 ? ": " : "", errno != 0 ? std::strerror(errno) : "");
  return false;
}

}  // namespace

int run_program(CLI::App& app, const std::function<void(int& exit_code)>& add_commands, int argc,
                char** argv) {
  int exit_code = kFailed;
  int reason = 0;
  try {
    exit_code = parse_and_run(app, add_commands, argc, argv);
  } catch (const std::system_error& error) {
    // That is how {fmt} says that it cannot print.
    if (!std::string_view(error.what()).starts_with("cannot write to file"))
      return fail(fmt::format(
          "cannot go on: {}; is a limit of threads, processes or memory reached?", error.what()));
    reason = error.code().value();
  }
  return is_output_written(reason) ? exit_code : kFailed;
}

void end_program(int exit_code) {
  constexpr int kNoReason = 0;
  std::_Exit(is_output_written(kNoReason) ? exit_code : kFailed);
}

}  // namespace culprit

#include "terminal/wrong_call.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <initializer_list>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/core.h>

#include "base/closest.h"
#include "base/joined.h"
#include "base/name_grammar.h"
#include "terminal/help.h"
#include "terminal/listed.h"
#include "terminal/other_tools.h"
#include "terminal/seconds_option.h"

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

// "min" for "minutes"; empty: `word` is no unit.
std::string unit_of_words(std::string_view word) {
  constexpr auto kUnits = std::to_array<std::string_view>({"ms", "s", "min", "h", "d"});
  constexpr auto kLongForms =
      std::to_array<std::string_view>({"milliseconds", "seconds", "minutes", "hours", "days"});
  for (std::size_t i = 0; i < kUnits.size(); ++i) {
    const bool is_unit = word == kUnits[i] || (word.size() > 2 && kLongForms[i].starts_with(word));
    if (is_unit) return std::string(kUnits[i]);
  }
  return "";
}

// The known option that `option` ends with: --port of "--web-port"; empty: none.
std::string_view end_of(std::string_view option, const std::vector<std::string>& known) {
  for (const std::string_view each : known) {
    const bool is_word = each.starts_with("--") && each.size() < option.size();
    if (is_word && option.ends_with(each.substr(1))) return each;
  }
  return "";
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
    const bool is_single = !option.starts_with("--");
    if (is_single && std::ranges::find(known, "-" + option) != known.end())
      return option;                  // "-launch"
    if (is_single) option.resize(2);  // "-n5"
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
  const bool is_file = is_one_of(option, {"--file", "--input", "--rules", "-f"});
  const bool is_subject = is_one_of(option, {"--code", "--term"});
  for (const CLI::Option* each : command.get_options()) {
    if (!each->get_positional()) continue;
    const std::string name = each->get_name(true);
    if ("--" + name == upper || (is_name && name == "NAME") || (is_file && name == "RULES") ||
        (option == "--bag" && name == "JOURNAL") || (is_subject && name == "WHAT"))
      return name;
  }
  return "";
}

// "--robot" for "-r"; empty: none begins with this letter, or several do.
std::string_view only_with_letter(std::string_view option, const std::vector<std::string>& known) {
  std::string_view found;
  for (const std::string_view each : known) {
    const bool begins = option.size() == 2 && each.size() > 3 && each.starts_with("--") &&
                        each[2] == option[1] && each != found;
    if (begins && !found.empty()) return "";
    if (begins) found = each;
  }
  return found;
}

// All options of a command that has few; nothing for others.
std::string few_options(const std::vector<std::string>& known) {
  constexpr std::size_t kFew = 6;
  std::vector<std::string_view> own;
  for (const std::string_view each : known) {
    if (each.starts_with("--") && each != "--help" && std::ranges::find(own, each) == own.end())
      own.push_back(each);
  }
  return own.empty() || own.size() > kFew ? "" : "; it has " + joined(own);
}

// The remedy for an option that `command`, with the options `known`, has not: "; test has it".
std::string remedy_of(const CLI::App& app, const CLI::App& command, const std::string& option,
                      const std::vector<std::string>& known) {
  const bool is_program = &command == &app;
  const auto is_known = [&](const std::string& each) {
    return std::ranges::find(known, each) != known.end();
  };
  const auto ask = [](std::string_view word) {
    return "; did you mean '" + std::string(word) + "'?";
  };
  if (is_program && (option == "-v" || option == "-V")) return ask("--version");
  if (is_known("-" + option)) return ask("-" + option);
  const std::string word = option.substr(std::min(option.find_first_not_of('-'), option.size()));
  if (is_program && command_named(app, word) != nullptr) return ask(word);
  if (const std::string name = positional_called(command, option); !name.empty())
    return "; write " + name + " without it";
  if (option.starts_with("--no-") && is_known("--" + option.substr(5)))
    return "; leave --" + option.substr(5) + " out";
  if (const auto advice = advice_about(option, command.get_name()); !advice.empty())
    return "; " + std::string(advice);
  if (const auto end = end_of(option, known); !end.empty()) return ask(end);
  if (const auto ours = option_of_other_tools(option, {known.begin(), known.end()}); !ours.empty())
    return ask(ours);
  if (std::string near = meant(option, {known.begin(), known.end()}); !near.empty()) return near;
  if (const auto parts = commands_with(command, option); !is_program && !parts.empty())
    return "; it stands behind " + joined(parts);
  if (const auto whole = only_with_letter(option, known); !whole.empty()) return ask(whole);
  const auto others = commands_with(app, option);
  if (option.starts_with("--") && others.size() == 1)
    return ask(app.get_name() + " " + std::string(others.front()) + " " + option);
  return is_program ? "" : few_options(known);
}

// "end-started" for "end"; empty: none begins with that word, or several do.
std::string_view only_with_first_part(std::string_view word,
                                      const std::vector<std::string_view>& known) {
  const auto begins = [&](std::string_view each) {
    return each.starts_with(word) && each.substr(word.size()).starts_with('-');
  };
  const auto found = std::ranges::find_if(known, begins);
  return std::ranges::count_if(known, begins) == 1 ? *found : "";
}

std::string remedy_of_command(const CLI::App& app, std::string_view word) {
  const std::vector<std::string_view> known = names_of(commands_in(app));
  if (word == "version") return "; did you mean '--version'?";
  if (word == app.get_name()) return "; write '" + app.get_name() + "' once";
  if (const auto ours = command_of_other_tools(word, known); !ours.empty())
    return "; did you mean '" + std::string(ours) + "'?";
  if (const auto whole = only_with_first_part(word, known); !whole.empty())
    return "; did you mean '" + std::string(whole) + "'?";
  if (std::string near = meant(word, known); !near.empty()) return near;
  if (word.ends_with(".rules") && command_named(app, "check") != nullptr)
    return "; did you mean '" + app.get_name() + " run " + printable(word) + "'?";
  return "";
}

// The mistake, where the name of a command or of an option is not known; nothing where something
// else is wrong.
std::optional<std::string> unknown_word(const CLI::App& app, const Chosen& line, int argc,
                                        char** argv) {
  if (argc > 1 && !is_option(argv[1]) && command_named(app, argv[1]) == nullptr)
    return "there is no command '" + printable(argv[1]) + "'" + remedy_of_command(app, argv[1]);
  const auto parts = commands_in(*line.command);
  if (!parts.empty() && line.depth + 1 < argc && !is_option(argv[line.depth + 1])) {
    const char* word = argv[line.depth + 1];
    const std::vector<std::string_view> known = names_of(parts);
    const std::string near = meant(word, known);
    return line.command->get_name() + " has no command '" + printable(word) + "'" +
           (near.empty() ? "; it has " + joined(known) : near);
  }
  const std::vector<std::string> options = options_of(*line.command);
  const std::string option = unknown_option(options, argc, argv);
  if (option.empty()) return std::nullopt;
  const std::string cause =
      (line.command == &app ? "there is" : line.command->get_name() + " has") + " no option '" +
      printable(option) + "'";
  const bool is_of_ros =  // "-r scan:=/scan"
      !option.starts_with("--") && std::any_of(argv + 1, argv + argc, [](const char* word) {
        return std::string_view(word).find(":=") != std::string_view::npos;
      });
  return cause + remedy_of(app, *line.command, is_of_ros ? "--ros-args" : option, options);
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

// "The rule file" within a sentence.
std::string lower_first(std::string text) {
  const bool is_word =
      text.size() > 1 && (text[1] == ' ' || std::islower(static_cast<unsigned char>(text[1])) != 0);
  if (is_word) text[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(text[0])));
  return text;
}

std::string missing(const CLI::RequiredError& error, const CLI::App& command) {
  const std::string text = error.what();
  constexpr std::string_view kRequired = " is required";
  if (text == "A subcommand is required")
    return command.get_name() + " needs a command: " + joined(names_of(commands_in(command)));
  constexpr std::string_view kRequires = " requires ";
  if (const auto at = text.find(kRequires); at != std::string::npos && !text.ends_with(kRequired))
    return text.substr(0, at) + " needs " + text.substr(at + kRequires.size()) + ", too";
  if (!text.ends_with(kRequired)) return text;
  const std::string name = text.substr(0, text.size() - kRequired.size());
  const CLI::Option* option = command.get_option_no_throw(name);
  std::string what = option != nullptr ? option->get_description() : "";
  what = what.substr(0, what.find_first_of("\n;("));
  while (what.ends_with(' ')) what.pop_back();
  return name + " is missing" + (what.empty() ? "" : " (" + lower_first(what) + ")");
}

bool is_end_of_silence(std::string_view word) {
  return is_one_of(word, {"off", "lift", "remove", "end", "clear"});
}

// The probable remedy for the argument that is too many, behind the word `before`.
std::string remedy_of_extra(std::string_view extra, std::string_view before,
                            const CLI::App& command) {
  const CLI::Option* option =
      is_option(before) ? command.get_option_no_throw(std::string(before)) : nullptr;
  if (option != nullptr && option->get_items_expected_max() == 0)
    return "; " + std::string(before) + " takes no value";
  const auto has = [&](const char* name) { return command.get_option_no_throw(name) != nullptr; };
  const bool is_count = extra.find_first_not_of("0123456789") == std::string_view::npos;
  if (has("--for") && !is_count && typed_duration(std::string(extra)))
    return "; did you mean --for " + std::string(extra) + "?";
  if (has("--lines") && is_count && !extra.empty())
    return "; did you mean --lines " + std::string(extra) + "?";
  if (has("--lift") && (is_end_of_silence(extra) || is_end_of_silence(before))) {
    const std::string_view name = is_end_of_silence(before) ? extra : before;
    return "; write " + command.get_name() + " " +
           (name == command.get_name() ? "NAME" : printable(name)) + " --lift";
  }
  if (has("--journal") && extra.ends_with(".journal"))
    return "; did you mean --journal '" + printable(extra) + "'?";
  const bool is_rule_file = extra.ends_with(".rules");
  if (has("--output") && !is_rule_file && extra.find('.') != std::string_view::npos)
    return "; did you mean --output '" + printable(extra) + "'?";
  bool takes_arguments = false;
  for (const CLI::Option* each : command.get_options()) {
    if (!each->get_positional()) continue;
    takes_arguments = true;
    if (each->get_name(true) == "STRATEGY" && !each->results().empty())
      return "; write " + printable(each->results().front() + "." + std::string(extra));
    if (each->get_items_expected_max() == 1 && !each->results().empty())
      return "; " + each->get_name(true) + " is '" + printable(each->results().front()) +
             "' already";
  }
  if (takes_arguments) return "";
  // A reason is a sentence.
  const bool is_sentence = extra.find(' ') != std::string_view::npos;
  for (const char* known : {"--output", "--component", is_sentence ? "--reason" : "--output"}) {
    if (command.get_option_no_throw(known) != nullptr)
      return fmt::format("; did you mean {} '{}'?", known, printable(extra));
  }
  if (command.get_name() == "pause")
    return "; culprit mute " + printable(extra) + " leaves one part alone";
  return "; " + command.get_name() + " takes no arguments";
}

std::string too_many(const CLI::App& app, const CLI::App& command, int argc, char** argv) {
  std::vector<std::string> extras = command.remaining();
  if (extras.empty()) extras = app.remaining();
  if (extras.empty()) return "there is one argument too many";
  const std::string& extra = extras.front();
  const std::vector<std::string_view> words(argv, argv + argc);
  if (is_option(extra) && std::ranges::find(words, "--") != words.end())
    return "'" + printable(extra) + "' stands behind '--', so it is an argument; remove the '--'";
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

// `word` without the dashes that an editor put in place of "--".
std::string without_dashes(const std::string& word) {
  for (const std::string_view dash : {"\u2014", "\u2013", "\u2212"}) {
    if (word.starts_with(dash)) return without_dashes(word.substr(dash.size()));
  }
  return word;
}

// "--use-sim-time true"; "use_sim_time:=true", as ROS's tools have it; a dash that an editor made of two.
std::optional<std::string> slip_in_word(const CLI::App& command, int argc, char** argv) {
  for (int i = 2; i < argc; ++i) {
    const std::string word(argv[i]);
    if (const std::string name = without_dashes(word); name != word)
      return "an argument begins with a typographic dash; write --" + printable(name);
    const CLI::Option* before = command.get_option_no_throw(argv[i - 1]);
    const bool is_switch = is_one_of(word, {"true", "false", "yes", "no", "on", "off"});
    if (is_switch && before != nullptr && before->get_items_expected_max() == 0)
      return std::string(argv[i - 1]) + " takes no value; remove '" + word + "'";
    std::string option = "--" + word.substr(0, std::min(word.find(":="), word.size()));
    std::replace(option.begin(), option.end(), '_', '-');
    if (word.find(":=") != std::string::npos && command.get_option_no_throw(option) != nullptr)
      return "'" + printable(word) + "' is an argument of ROS; write " + option;
  }
  return std::nullopt;
}

// Too few or too many values of an option; nothing: `text` says something else.
std::optional<std::string> wrong_count(const std::string& text, const CLI::App& command) {
  constexpr std::string_view kOneMissing = ": 1 required ";
  if (const auto at = text.find(kOneMissing); at != std::string::npos)
    return text.substr(0, at) + " needs a value" + kind_of_value(command, text.substr(0, at));
  constexpr std::string_view kTwice = ": At Most 1 required but received";
  if (const auto at = text.find(kTwice); at != std::string::npos)
    return text.substr(0, at) + " is given more than once; give it once";
  constexpr std::string_view kTooMany = ": At Most ";
  if (const auto at = text.find(kTooMany); at != std::string::npos) {
    const std::string most = text.substr(at + kTooMany.size());
    return text.substr(0, at) + " takes at most " + most.substr(0, most.find(' ')) + " values";
  }
  constexpr std::string_view kMoreMissing = ": At least ";
  if (const auto at = text.find(kMoreMissing); at != std::string::npos)
    return text.substr(0, at) + " needs at least " +
           text.substr(at + kMoreMissing.size(),
                       text.find(' ', at + kMoreMissing.size()) - at - kMoreMissing.size()) +
           " values";
  return std::nullopt;
}

// "--record-topics --print-config": CLI11 would take an option for the value of the one in front.
std::optional<std::string> option_for_value(const CLI::App& command, const std::string& word,
                                            const std::string& next) {
  const CLI::Option* option = is_option(word) ? command.get_option_no_throw(word) : nullptr;
  const bool takes_value = option != nullptr && option->get_items_expected_min() > 0;
  const bool is_known = command.get_option_no_throw(next.substr(0, next.find('='))) != nullptr;
  const bool looks_like_option =
      next.starts_with("--") && next.size() > 2 && next.find(' ') == std::string::npos;
  if (!takes_value || !is_option(next) || (!is_known && !looks_like_option)) return std::nullopt;
  return word + " needs a value" + kind_of_value(command, word) + "; '" + printable(next) +
         "' stands in its place";
}

// "--for 10 minutes", "--record-disk 5 GB", "--restarts 20 per hour": `option` with the `number` and what follows.
std::optional<std::string> value_of_several_words(const std::string& option,
                                                  const CLI::Option& known,
                                                  const std::string& number,
                                                  const std::vector<std::string>& behind) {
  const std::string type = value_of(known);
  const std::string unit = unit_of_words(behind[0]);
  if (type == "DURATION" && !unit.empty())
    return option + ": a duration is one word; write " + option + " " + number + unit;
  if (type == "SIZE" && is_one_of(behind[0], {"B", "kB", "KB", "MB", "GB", "TB", "MiB", "GiB"}))
    return option + ": a size is one word; write " + option + " " + number + behind[0];
  const std::string period = behind.size() > 1 ? unit_of_words(behind[1]) : "";
  if (type == "TEXT" && is_one_of(behind[0], {"per", "in", "a", "/"}) && !period.empty())
    return option + ": this value is one word; write " + option + " " + number + "/1" + period;
  return std::nullopt;
}

// The mistake in the words of people. CLI11 has its own for each.
std::string cause_of(const CLI::ParseError& error, const CLI::App& app, const CLI::App& command,
                     int argc, char** argv) {
  const std::string text = error.what();
  if (auto slip = slip_in_word(command, argc, argv)) return *slip;
  constexpr std::string_view kExcludes = " excludes ";
  if (const auto at = text.find(kExcludes); at != std::string::npos)
    return text.substr(0, at) + " and " + text.substr(at + kExcludes.size()) +
           " exclude each other; leave one of them out";
  if (const auto* required = dynamic_cast<const CLI::RequiredError*>(&error))
    return missing(*required, command);
  if (dynamic_cast<const CLI::ValidationError*>(&error) != nullptr)
    return words_of_invalid_value(text);
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr)
    return too_many(app, command, argc, argv);
  constexpr std::string_view kNoConversion = "Could not convert: ";
  if (text.starts_with(kNoConversion)) {
    const std::string rest = text.substr(kNoConversion.size());
    const auto equals = rest.find(" = ");
    const CLI::Option* option =
        equals != std::string::npos ? command.get_option_no_throw(rest.substr(0, equals)) : nullptr;
    if (option != nullptr && option->get_items_expected_max() == 0)
      return rest.substr(0, equals) +
             " takes no value; remove '=" + printable(rest.substr(equals + 3)) + "'";
    if (equals != std::string::npos)
      return rest.substr(0, equals) + ": '" + printable(rest.substr(equals + 3)) + "' is no number";
  }
  if (auto count = wrong_count(text, command)) return *count;
  return text;
}

}  // namespace

std::string cause_of_wrong_call(const CLI::ParseError& error, const CLI::App& app,
                                const Chosen& line, int argc, char** argv) {
  if (auto word = unknown_word(app, line, argc, argv)) return *word;
  return cause_of(error, app, *line.command, argc, argv);
}

std::optional<std::string> slip_of_values(const CLI::App& command, int argc, char** argv) {
  for (int i = 2; i + 1 < argc && argv[i] != std::string_view("--"); ++i) {
    if (auto slip = option_for_value(command, argv[i], argv[i + 1])) return slip;
    const std::string word(argv[i]);
    const auto equals = word.find('=');
    const bool is_joined = word.starts_with("--") && equals != std::string::npos;
    const std::string option = is_joined ? word.substr(0, equals) : argv[i - 1];
    const std::string number = is_joined ? word.substr(equals + 1) : word;
    const CLI::Option* known = command.get_option_no_throw(option);
    const bool is_number =
        !number.empty() && number.find_first_not_of("0123456789.") == std::string::npos;
    if (known == nullptr || !is_number) continue;
    if (auto slip = value_of_several_words(option, *known, number, {argv + i + 1, argv + argc}))
      return slip;
  }
  return std::nullopt;
}

std::string words_of_invalid_value(const std::string& text) {
  const std::size_t colon = text.find(": ");
  if (colon == std::string::npos) return text;
  const std::string option = text.substr(0, colon + 2);
  const std::string rest = without(text.substr(colon + 2), "Value ");
  if (rest.starts_with("takes no value")) return text.substr(0, colon) + " " + printable(rest);
  constexpr std::string_view kRange = " not in range ";
  if (const auto at = rest.find(kRange); at != std::string::npos)
    return option + "'" + rest.substr(0, at) + "' is no number from " +
           plain_range(rest.substr(at + kRange.size()));
  constexpr std::string_view kNoFile = "File does not exist: ";
  if (rest.starts_with(kNoFile))
    return option + "there is no file '" + printable(rest.substr(kNoFile.size())) + "'";
  if (rest.find("unit not recognized") != std::string::npos)
    return option + "unknown unit; write a number and kB, MB or GB, as in 200MB";
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
  return option + "'" + value + "' is none of " + joined(known) + meant(value, known);
}

Chosen named_in(const CLI::App& app, int argc, char** argv) {
  Chosen out{&app, app.get_name()};
  while (out.depth + 1 < argc) {
    const CLI::App* next = command_named(*out.command, argv[out.depth + 1]);
    if (next == nullptr) break;
    out.command = next;
    out.path += " " + next->get_name();
    ++out.depth;
  }
  return out;
}

Chosen chosen(const CLI::App& app) {
  Chosen out{&app, app.get_name()};
  while (!out.command->get_subcommands().empty()) {
    out.command = out.command->get_subcommands().front();
    out.path += " " + out.command->get_name();
    ++out.depth;
  }
  return out;
}

}  // namespace culprit

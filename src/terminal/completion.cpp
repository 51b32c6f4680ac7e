#include "terminal/completion.h"

#include <algorithm>
#include <map>
#include <vector>

#include "base/joined.h"
#include "terminal/help.h"
#include "terminal/listed.h"

namespace culprit {
namespace {

// ---- what there is to complete

// A command, or the program itself: "", "run", "study sunset".
struct Completed {
  std::string path;
  const CLI::App* command = nullptr;
  bool is_of_others = false;  // what follows is for another program to complete
};

void collect_places(std::vector<Completed>& all, const CLI::App& command, const std::string& path,
                    const Manual& manual) {
  const std::string& heading = manual.others.heading;
  all.push_back({path, &command, !heading.empty() && command.get_group() == heading});
  for (const CLI::App* part : commands_in(command))
    collect_places(all, *part, path + (path.empty() ? "" : " ") + part->get_name(), manual);
}

std::vector<Completed> places_of(const CLI::App& app, const Manual& manual) {
  std::vector<Completed> all;
  collect_places(all, app, "", manual);
  return all;
}

enum class ValueKind { kNothing, kWords, kFile, kFolder, kText, kLive };

// The type of an option's or argument's value.
struct ValueType {
  ValueKind kind = ValueKind::kNothing;
  // "bayes paper"; of live names: the arguments of the program that print them, "names components".
  std::string words{};
};

ValueType type_of_value(const CLI::Option& option) {
  std::string type = value_of(option);
  if (type.ends_with(" ...")) type.resize(type.size() - 4);
  if (type.empty()) return {};
  if (type.starts_with("FILE")) return {ValueKind::kFile};
  if (type.starts_with("FOLDER")) return {ValueKind::kFolder};
  static const std::map<std::string, std::string> live = {
      {"COMPONENT", "components"}, {"NAME", "names"}, {"STRATEGY", "strategies"},
      {"TOPIC", "topics"},         {"NODE", "nodes"}, {"INCIDENT", "incidents"}};
  if (const auto kind = live.find(type); kind != live.end())
    return {ValueKind::kLive, "names " + kind->second};
  const std::size_t end = type.find('}');
  if (type.front() != '{' || end == std::string::npos) return {ValueKind::kText};
  std::string words = type.substr(1, end - 1);
  std::replace(words.begin(), words.end(), ',', ' ');
  return {ValueKind::kWords, words};
}

bool takes_several(const CLI::Option& option) { return option.get_items_expected_max() > 1; }

// "-n", "--lines"
std::vector<std::string> names_of(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

std::vector<const CLI::Option*> arguments_of(const CLI::App& command) {
  auto options = options_in(command);
  std::erase_if(options, [](const CLI::Option* option) { return !option->get_positional(); });
  return options;
}

std::vector<const CLI::Option*> named_options_of(const CLI::App& command) {
  auto options = options_in(command);
  std::erase_if(options, [](const CLI::Option* option) { return option->get_positional(); });
  return options;
}

// ---- texts

// Shells show one line beside each word: the first thing that is said.
std::string short_of(const std::string& text) {
  std::string first = text.substr(
      0, std::min({text.find('\n'), text.find("; "), text.find(". "), text.find(" (")}));
  if (first.ends_with('.')) first.pop_back();
  return first;
}

std::string in_quotes(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string with_backslashes(const std::string& text, const char* before) {
  std::string out;
  for (const char c : text) {
    if (std::string_view(before).find(c) != std::string_view::npos) out += '\\';
    out += c;
  }
  return out;
}

// For the names of functions: "culprit_lab".
std::string identifier(std::string text) {
  std::replace(text.begin(), text.end(), '-', '_');
  std::replace(text.begin(), text.end(), ' ', '_');
  return text;
}

// Puts `value` in place of each `name`.
std::string filled(std::string text, const std::map<std::string, std::string>& values) {
  for (const auto& [name, value] : values) {
    for (std::size_t at = 0; (at = text.find(name, at)) != std::string::npos; at += value.size())
      text.replace(at, name.size(), value);
  }
  return text;
}

std::string opening(const Manual& manual, const char* shell) {
  return "# Completion of " + manual.name + " for " + shell + ". Made by " + manual.name +
         " manual --format " + shell + "; do not edit.\n";
}

// ---- bash

std::string bash_value(const ValueType& value) {
  switch (value.kind) {
    case ValueKind::kNothing:
      return "";
    case ValueKind::kWords:
      return in_quotes(value.words);
    case ValueKind::kFile:
      return "@file";
    case ValueKind::kFolder:
      return "@folder";
    case ValueKind::kText:
      return "@text";
    case ValueKind::kLive:
      return in_quotes("@live " + value.words);
  }
  return "";
}

// Looks at the words before the cursor: which command they name, and whether the last one is an option that waits for
// its value. A "=" is a word of its own to bash.
constexpr const char* kBash = R"BASH(
FUNCTION() {
  local command= commands options arguments value others word waiting= i
  local -a words=()
  for ((i = 1; i <= COMP_CWORD; i++)); do
    [[ ${COMP_WORDS[i]} == = ]] || words+=("${COMP_WORDS[i]}")
  done
  [[ ${COMP_WORDS[COMP_CWORD]} == = ]] && words+=('')
  COMPREPLY=()
  FUNCTION_at ''
  for ((i = 0; i < ${#words[@]} - 1; i++)); do
    word=${words[i]}
    if [[ -n $waiting ]]; then
      waiting=
    elif [[ $word == -* ]]; then
      FUNCTION_value "$command $word"
      waiting=$value
    elif [[ " $commands " == *" $word "* ]]; then
      command=${command:+$command }$word
      FUNCTION_at "$command"
    fi
  done
  if [[ -n $others ]]; then
    declare -F "$others" >/dev/null || { declare -F __load_completion >/dev/null && __load_completion OTHERS; }
    declare -F "$others" >/dev/null && "$others"
    return
  fi
  word=${words[${#words[@]} - 1]}
  if [[ -z $waiting ]]; then
    if [[ $word == -* ]]; then
      waiting=$options
    else
      waiting=${commands:-$arguments}
    fi
  fi
  case $waiting in
    @text) ;;
    @live*)
      mapfile -t COMPREPLY < <(compgen -W "$(PROGRAM ${waiting#@live } 2>/dev/null)" -- "$word") ;;
    @file)
      compopt -o filenames 2>/dev/null
      mapfile -t COMPREPLY < <(compgen -f -- "$word") ;;
    @folder)
      compopt -o filenames 2>/dev/null
      mapfile -t COMPREPLY < <(compgen -d -- "$word") ;;
    *) mapfile -t COMPREPLY < <(compgen -W "$waiting" -- "$word") ;;
  esac
}
complete -F FUNCTION PROGRAM
)BASH";

// ---- zsh

std::string zsh_value(const CLI::Option& option, const std::string& program) {
  const ValueType value = type_of_value(option);
  const std::string name = option.get_positional() ? option.get_name(true) : "value";
  switch (value.kind) {
    case ValueKind::kNothing:
      return "";
    case ValueKind::kWords:
      return ":" + name + ":(" + value.words + ")";
    case ValueKind::kFile:
      return ":" + name + ":_files";
    case ValueKind::kFolder:
      return ":" + name + ":_files -/";
    case ValueKind::kText:
      return ":" + name + ": ";
    case ValueKind::kLive:
      return ":" + name + ":($(" + program + " " + value.words + " 2>/dev/null))";
  }
  return "";
}

std::string zsh_purpose(const std::string& text) {
  return "[" + with_backslashes(short_of(text), "[]\\") + "]";
}

std::string zsh_specs(const CLI::App& command, const std::string& program) {
  std::string out = " \\\n    '(- *)--help[Tell the options]'";
  for (const CLI::Option* option : named_options_of(command)) {
    const auto names = names_of(*option);
    const std::string before = takes_several(*option) ? "*" : "(" + joined(names, " ") + ")";
    const std::string value = zsh_value(*option, program);
    for (const std::string& name : names) {
      const char* joint = value.empty() ? "" : name.starts_with("--") ? "=" : "+";
      out +=
          " \\\n    " + in_quotes(before + name + joint + zsh_purpose(purpose_of(*option)) + value);
    }
  }
  for (const CLI::Option* argument : arguments_of(command))
    out += " \\\n    " +
           in_quotes((takes_several(*argument) ? "*" : "") + zsh_value(*argument, program));
  return out;
}

std::string zsh_function(const Completed& place, const std::string& function,
                         const Manual& manual) {
  const std::string own = function + (place.path.empty() ? "" : "__" + identifier(place.path));
  const auto parts = commands_in(*place.command);
  if (place.is_of_others) {
    // Its command line begins with the name of its program.
    return "\n" + own + "() {\n  words=(" + manual.others.program +
           " \"${words[@]}\")\n  (( CURRENT++ ))\n  (( $+functions[_" + manual.others.program +
           "] )) && _" + manual.others.program + "\n}\n";
  }
  if (parts.empty())
    return "\n" + own + "() {\n  _arguments -s -S" + zsh_specs(*place.command, manual.name) +
           "\n}\n";
  std::string listed;
  std::string chosen;
  for (const CLI::App* part : parts) {
    listed +=
        "        " + in_quotes(part->get_name() + ":" + short_of(part->get_description())) + "\n";
    chosen += "        " + part->get_name() + ") " + function + "__" +
              identifier((place.path.empty() ? "" : place.path + " ") + part->get_name()) + " ;;\n";
  }
  return "\n" + own +
         "() {\n  local curcontext=\"$curcontext\" state state_descr line\n  local -A opt_args\n"
         "  local -a commands\n  _arguments -C -s -S" +
         zsh_specs(*place.command, manual.name) +
         " \\\n    '1: :->command' \\\n    '*:: :->argument'\n"
         "  case $state in\n    command)\n      commands=(\n" +
         listed +
         "      )\n      _describe -t commands command commands ;;\n    argument)\n"
         "      case $words[1] in\n" +
         chosen + "      esac ;;\n  esac\n}\n";
}

// ---- fish

std::string fish_value(const ValueType& value, const std::string& program) {
  switch (value.kind) {
    case ValueKind::kNothing:
      return "";
    case ValueKind::kWords:
      return " -x -a " + in_quotes(value.words);
    case ValueKind::kFile:
      return " -r -F";
    case ValueKind::kFolder:
      return " -x -a '(__fish_complete_directories)'";
    case ValueKind::kText:
      return " -x";
    case ValueKind::kLive:
      return " -x -a '(" + program + " " + value.words + " 2>/dev/null)'";
  }
  return "";
}

// fish knows \' and \\ between quotes.
std::string in_fish_quotes(const std::string& text) {
  return "'" + with_backslashes(text, "'\\") + "'";
}

constexpr const char* kFish = R"(
# Whether the command line names this command, and perhaps one of its parts.
function FUNCTION_at
    set -l words (commandline -opc)
    test (count $words) -gt (count $argv); or return 1
    for i in (seq (count $argv))
        test $words[(math $i + 1)] = $argv[$i]; or return 1
    end
end

# Whether it names this one, and nothing further.
function FUNCTION_is
    test (count (commandline -opc)) -eq (math (count $argv) + 1); and FUNCTION_at $argv
end

complete -c PROGRAM -f
)";

}  // namespace

std::string as_bash_completion(const CLI::App& app, const Manual& manual) {
  const std::string function = "_" + identifier(manual.name);
  std::string at;
  std::map<std::string, std::string> takers;  // by what they take
  for (const Completed& place : places_of(app, manual)) {
    std::string commands;
    for (const CLI::App* part : commands_in(*place.command))
      commands += (commands.empty() ? "" : " ") + part->get_name();
    std::string options = "--help";
    for (const CLI::Option* option : named_options_of(*place.command)) {
      const std::string value = bash_value(type_of_value(*option));
      for (const std::string& name : names_of(*option)) {
        options += " " + name;
        if (value.empty()) continue;
        std::string& names = takers[value];
        names += (names.empty() ? "" : " | \\\n      ") + in_quotes(place.path + " " + name);
      }
    }
    at += "    " + in_quotes(place.path) + ")";
    if (place.is_of_others) {
      at += " others=_" + identifier(manual.others.program) + " ;;\n";
      continue;
    }
    at += "\n      commands=" + in_quotes(commands) + "\n      options=" + in_quotes(options);
    const auto arguments = arguments_of(*place.command);
    if (!arguments.empty())
      at += "\n      arguments=" + bash_value(type_of_value(*arguments.front()));
    at += " ;;\n";
  }
  std::string values;
  for (const auto& [value, names] : takers)
    values += "    " + names + ")\n      value=" + value + " ;;\n";
  return opening(manual, "bash") +
         filled(
             "\n# What there is at a command: its commands, its options, and what its first "
             "argument "
             "is.\nFUNCTION_at() {\n  commands= options= arguments=@text others=\n  case $1 in\n" +
                 at +
                 "  esac\n}\n\n# What an option of a command takes: some of these words, a @file, "
                 "a "
                 "@folder, @live names, @text, or nothing.\nFUNCTION_value() {\n  value=\n  case "
                 "$1 in\n" +
                 values + "  esac\n}\n" + kBash,
             {{"FUNCTION", function}, {"PROGRAM", manual.name}, {"OTHERS", manual.others.program}});
}

std::string as_zsh_completion(const CLI::App& app, const Manual& manual) {
  const std::string function = "_" + manual.name;  // is the file's name, too
  std::string out = "#compdef " + manual.name + "\n" + opening(manual, "zsh");
  for (const Completed& place : places_of(app, manual))
    out += zsh_function(place, function, manual);
  return out + "\nif [[ $funcstack[1] == " + function + " ]]; then\n  " + function +
         " \"$@\"\nelse\n  compdef " + function + " " + manual.name + "\nfi\n";
}

std::string as_fish_completion(const CLI::App& app, const Manual& manual) {
  const std::string function = "__" + identifier(manual.name);
  std::string out =
      opening(manual, "fish") + filled(kFish, {{"FUNCTION", function}, {"PROGRAM", manual.name}});
  const std::string complete = "complete -c " + manual.name + " -n ";
  for (const Completed& place : places_of(app, manual)) {
    const std::string path = place.path.empty() ? "" : " " + place.path;
    if (place.is_of_others) {
      out += complete + "'" + function + "_at" + path + "' -a '(complete -C \"" +
             manual.others.program +
             " \"(string join \" \" -- (commandline -opc)[2..])\" \"(commandline -ct))'\n";
      continue;
    }
    for (const CLI::App* part : commands_in(*place.command))
      out += complete + "'" + function + "_is" + path + "' -a " + part->get_name() + " -d " +
             in_fish_quotes(short_of(part->get_description())) + "\n";
    const std::string here =
        complete + "'" + function + (place.path.empty() ? "_is" : "_at") + path + "'";
    out += here + " -l help -d 'Tell the options'\n";
    for (const CLI::Option* option : named_options_of(*place.command)) {
      out += here;
      for (const std::string& name : option->get_snames()) out += " -s " + name;
      for (const std::string& name : option->get_lnames()) out += " -l " + name;
      out += fish_value(type_of_value(*option), manual.name) + " -d " +
             in_fish_quotes(short_of(purpose_of(*option))) + "\n";
    }
    for (const CLI::Option* argument : arguments_of(*place.command)) {
      const ValueType value = type_of_value(*argument);
      if (value.kind == ValueKind::kFile || value.kind == ValueKind::kFolder) out += here + " -F\n";
      if (value.kind == ValueKind::kWords) out += here + " -a " + in_quotes(value.words) + "\n";
      if (value.kind == ValueKind::kLive) out += here + fish_value(value, manual.name) + "\n";
    }
  }
  return out;
}

}  // namespace culprit

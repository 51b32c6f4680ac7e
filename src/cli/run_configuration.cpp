#include "cli/run_configuration.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <set>
#include <sstream>
#include <string_view>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "base/closest.h"
#include "base/environment.h"
#include "base/joined.h"
#include "base/name_grammar.h"
#include "base/text_file.h"
#include "base/wrapped.h"
#include "cli/run_options.h"
#include "live/rule_trust.h"
#include "terminal/help.h"
#include "terminal/listed.h"
#include "terminal/other_tools.h"
#include "terminal/wrong_call.h"

namespace culprit::cli {
namespace {

constexpr const char* kRulesKey = "rules";

// "web", "rules"; empty: it cannot stand in the file.
std::string key_of(const CLI::Option& option) {
  if (option.get_positional()) return kRulesKey;
  if (!option.get_configurable() || option.get_lnames().empty()) return "";
  return option.get_lnames().front();
}

// A file or a named pipe; the pipe of "<(...)" in a shell has no name that another user could replace.
bool can_be_changed(const std::string& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  const bool is_own =
      path == "/dev/stdin" || path.starts_with("/dev/fd/") || path.starts_with("/proc/self/fd/");
  return is_regular_file(status) || (is_fifo(status) && !is_own);
}

bool is_flag(const CLI::Option& option) { return option.get_items_expected_max() == 0; }

// The last line of the file that gives `key`; 0: none does.
int line_of_key(const std::string& text, const std::string& key) {
  int found = 0;
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    const auto begin = line.find_first_not_of(" \t\"'");
    if (begin == std::string::npos || line.compare(begin, key.size(), key) != 0) continue;
    const auto end = line.find_first_not_of(" \t\"'", begin + key.size());
    if (end == std::string::npos || line[end] == '=') found = number;
  }
  return found;
}

struct ConfigurationFile {
  std::string name;
  std::string text;

  std::string place(const std::string& key) const {
    const int line = line_of_key(text, key);
    return line > 0 ? fmt::format("{}:{}: ", name, line) : name + ": ";
  }
};

// The option that `key` was meant to be: dry-run of "--dry_run" or "CULPRIT_DRY_RUN".
std::string as_option(std::string key) {
  key.erase(0, std::min(key.find_first_not_of('-'), key.size()));
  std::transform(key.begin(), key.end(), key.begin(), [](unsigned char c) {
    return c == '_' ? '-' : static_cast<char>(std::tolower(c));
  });
  constexpr std::string_view kVariable = "culprit-";
  if (key.starts_with(kVariable)) key.erase(0, kVariable.size());
  return key;
}

// As TOML writes it.
std::string toml_value(const std::string& value) {
  std::string out = "\"";
  for (const char c : value) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

// A line that has no '=': "settle: 5s", as YAML and JSON write it, or "web true".
Error no_setting(const ConfigurationFile& file, const std::string& line,
                 const std::vector<std::string>& known) {
  const std::string cause = file.place(line) + "'" + printable(line) + "' is no setting; ";
  if (line.starts_with("export "))
    return Error{cause + "set the variable where culprit starts: in the shell, or in its unit"};
  const auto first = std::min(line.find_first_not_of("\"'"), line.size());
  const auto end = line.find_first_of(": \t\"'", first);
  const std::string key = as_option(line.substr(first, end - first));
  if (std::find(known.begin(), known.end(), key) == known.end())
    return Error{cause + "write settle = \"5s\", and # in front of a comment"};
  const auto begin = line.find_first_not_of(": \t\"'", end);
  std::string value = begin == std::string::npos ? "" : line.substr(begin);
  while (!value.empty() && std::string_view(", \t\"'").find(value.back()) != std::string_view::npos)
    value.pop_back();
  const bool is_plain = value == "true" || value == "false";
  return Error{cause + "write " + key + " = " + printable(is_plain ? value : toml_value(value))};
}

// `value` with the home folder for its "~". Errors: only a shell can read it.
Expected<std::string> without_shell(const std::string& value) {
  constexpr std::string_view kHome = "$HOME/";
  if (value.starts_with(kHome))
    return Error{"no shell reads '" + printable(value) + "' here; write " +
                 toml_value("~/" + value.substr(kHome.size()))};
  if (value.starts_with('$'))
    return Error{"no shell reads '" + printable(value) + "' here; write the variable's value"};
  if (!value.starts_with("~/")) return value;
  const std::string home = environment("HOME");
  if (home.empty()) return Error{"'~' stands for no folder, as HOME is not set; write it in full"};
  return home + value.substr(1);
}

Error unknown_key(const ConfigurationFile& file, const std::string& key,
                  const std::vector<std::string>& known) {
  if (key.find_first_of(": \t") != std::string::npos) return no_setting(file, key, known);
  const std::string plain = as_option(key);
  const bool is_known = std::find(known.begin(), known.end(), plain) != known.end();
  const std::string near = is_known ? plain : closest(plain, {known.begin(), known.end()});
  const std::string advice(advice_about("--" + plain, "run"));
  return Error{file.place(key) + "culprit run has no option '" + printable(key) + "'; " +
               (!near.empty()     ? "did you mean '" + near + "'?"
                : !advice.empty() ? advice
                                  : "culprit run --print-config lists all")};
}

// Whether the list that begins at `open` has no end before the next setting.
bool is_open_list(const std::string& text, std::size_t open) {
  char quote = 0;  // of the text that is open
  for (std::size_t at = open; at < text.size(); ++at) {
    const char c = text[at];
    if (quote == '"' && c == '\\') {
      ++at;
    } else if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '#') {
      at = std::min(text.find('\n', at), text.size());
    } else if (c == ']' || c == '=') {
      return c == '=';
    }
  }
  return true;
}

// The first line whose text or list has no end; 0: none.
int line_of_open_value(const std::string& text) {
  std::size_t at = 0;  // where the line begins
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    const std::size_t line_begin = std::exchange(at, at + line.size() + 1);
    const auto equals = line.find('=');
    if (equals == std::string::npos || line.find('#') < equals) continue;
    const auto begin = line.find_first_not_of(" \t", equals + 1);
    const bool is_text = begin != std::string::npos && (line[begin] == '"' || line[begin] == '\'');
    const bool is_list = begin != std::string::npos && line[begin] == '[';
    if (is_list && is_open_list(text, line_begin + begin)) return number;
    // A text over several lines begins with three quotes.
    if (is_text && line.compare(begin, 3, std::string(3, line[begin])) != 0 &&
        line.find(line[begin], begin + 1) == std::string::npos)
      return number;
  }
  return 0;
}

Error given_twice(const ConfigurationFile& file, const std::string& key) {
  return Error{file.place(key) + key + " is given twice; keep one"};
}

// The words that stand for one line of the file. Errors: its value is wrong.
Expected<std::vector<std::string>> words_of_item(const ConfigurationFile& file,
                                                 const CLI::ConfigItem& item, CLI::Option& option) {
  if (item.inputs.size() > 1 && option.get_positional())
    return Error{file.place(item.name) + "rules is one file; INCLUDE in it reads others"};
  if (item.inputs.size() > 1 && option.get_items_expected_max() <= 1)
    return given_twice(file, item.name);
  const std::string& value = item.inputs.empty() ? std::string() : item.inputs.front();
  if (is_flag(option)) {
    if (value == "false") return std::vector<std::string>{};
    if (value == "true") return std::vector<std::string>{"--" + item.name};
    return Error{file.place(item.name) + item.name + " is true or false, not '" + printable(value) +
                 "'"};
  }
  // The default in place of a certificate, say, would be a surprise.
  if (std::ranges::any_of(item.inputs, &std::string::empty) || item.inputs.empty())
    return Error{file.place(item.name) + item.name +
                 " is empty; write a value, or remove the line for the default"};
  std::vector<std::string> values;
  for (const std::string& each : item.inputs) {
    auto plain = without_shell(each);
    if (!plain) return Error{file.place(item.name) + item.name + ": " + plain.error()};
    values.push_back(std::move(*plain));
  }
  try {
    option.add_result(values);
    option.run_callback();
  } catch (const CLI::Error& error) {
    return Error{file.place(item.name) + words_of_invalid_value(error.what())};
  }
  if (option.get_positional()) return values;
  std::vector<std::string> words;
  for (const std::string& each : values) words.push_back("--" + item.name + "=" + each);
  return words;
}

// "rules: my.rules", whose '.' CLI11 takes for that of a section; empty: `item` is another line.
std::string line_without_section(const std::string& text, const CLI::ConfigItem& item) {
  if (item.parents.empty()) return "";
  const std::string line = joined(item.parents, ".") + "." + item.name;
  return line.find(": ") != std::string::npos && text.find(line) != std::string::npos ? line : "";
}

Expected<std::vector<std::string>> words_of_file(const ConfigurationFile& file, CLI::App& run) {
  if (const int line = line_of_open_value(file.text); line > 0)
    return Error{
        fmt::format("{}:{}: this value has no end; write the closing quote, or the ] of its list",
                    file.name, line)};
  std::istringstream text(file.text);
  std::vector<CLI::ConfigItem> items;
  try {
    items = CLI::ConfigTOML().from_config(text);
  } catch (const CLI::Error& error) {
    return Error{file.name + ": " + error.what()};
  }
  std::vector<std::string> known;
  for (const CLI::Option* option : options_in(run)) {
    if (const std::string key = key_of(*option); !key.empty()) known.push_back(key);
  }
  std::vector<std::string> words;
  std::set<std::string> given;
  for (const CLI::ConfigItem& item : items) {
    if (const std::string line = line_without_section(file.text, item); !line.empty())
      return no_setting(file, line, known);
    if (!item.parents.empty())
      return Error{file.place("[" + item.parents.front() + "]") +
                   "the file has no sections; write each option on a line of its own"};
    const bool is_known = std::find(known.begin(), known.end(), item.name) != known.end();
    if (!is_known) return unknown_key(file, item.name, known);
    CLI::Option* option = run.get_option(item.name == kRulesKey ? "RULES" : "--" + item.name);
    const bool is_first = given.insert(item.name).second;
    if (!is_first && option->get_items_expected_max() <= 1) return given_twice(file, item.name);
    if (option->count() > 0) continue;  // by the command line or the environment
    auto more = words_of_item(file, item, *option);
    if (!more) return more;
    words.insert(words.end(), more->begin(), more->end());
    if (is_flag(*option) && !more->empty()) option->add_result("true");
  }
  return words;
}

std::string toml_values(const std::vector<std::string>& values) {
  if (values.size() == 1) return toml_value(values.front());
  return "[" + joined(values, ", ", toml_value) + "]";
}

std::string default_in_words(const CLI::Option& option) {
  if (is_flag(option)) return " = false";
  const std::string value = option.get_default_str();
  return value.empty() ? " is not set" : " = " + toml_value(value);
}

// Every option with its value; a comment where it has its default.
std::string as_toml(const CLI::App& run) {
  std::string out = "# The options of culprit run. Use it with: culprit run --config FILE\n";
  for (const CLI::Option* option : options_in(run)) {
    const std::string key = key_of(*option);
    if (key.empty()) continue;
    std::istringstream purpose(wrapped(purpose_of(*option), 98));
    out += "\n";
    for (std::string line; std::getline(purpose, line);) out += "# " + line + "\n";
    if (option->count() > 0)
      out += key + " = " +
             (is_flag(*option) ? (option->as<bool>() ? "true" : "false")
                               : toml_values(option->results())) +
             "\n";
    else
      out += "# " + key + default_in_words(*option) + "\n";
  }
  return out;
}

}  // namespace

Expected<RunConfiguration> with_configuration(std::vector<std::string> words) {
  CLI::App app;
  CLI::App* run = app.add_subcommand("run");
  RunOptions options;
  options.add_to(*run);
  run->get_option("RULES")->required(false);
  try {
    app.parse(std::vector<std::string>(words.rbegin(), words.rend()));
  } catch (const CLI::ParseError&) {
    return RunConfiguration{std::move(words), ""};
  }
  RunConfiguration out{std::move(words), ""};
  if (!options.config.empty()) {
    if (can_be_changed(options.config)) {
      if (auto trusted = live::trust_rules(options.config); !trusted) return Error{trusted.error()};
    }
    auto text = read_text(options.config);
    std::error_code error;
    const bool is_there = std::filesystem::exists(options.config, error);
    if (!text)
      return Error{text.error() +
                   (is_there ? "" : "\nculprit run --print-config > culprit.toml writes one")};
    const auto more = words_of_file({options.config, std::move(*text)}, *run);
    if (!more) return Error{more.error()};
    // Behind a "--" everything is the name of a rule file.
    const auto end = std::find(out.words.begin(), out.words.end(), "--");
    out.words.insert(end, more->begin(), more->end());
  }
  if (options.prints_config) out.printed = as_toml(*run);
  return out;
}

}  // namespace culprit::cli

#include "terminal/help.h"

#include <sstream>
#include <string_view>
#include <vector>

#include <fmt/core.h>
#include <fmt/format.h>

#include "base/closest.h"
#include "base/name_grammar.h"
#include "base/wrapped.h"
#include "terminal/command.h"
#include "terminal/console.h"
#include "terminal/listed.h"

namespace culprit {
namespace {

constexpr std::size_t kNames = 30;
constexpr std::size_t kTexts = 70;

class HelpFormatter : public CLI::Formatter {
 public:
  HelpFormatter() {
    column_width(kNames);
    label("SUBCOMMAND", "COMMAND");
    label("Positionals", "Arguments");
  }

  std::string make_option_opts(const CLI::Option* option) const override {
    const std::string value = option->get_positional() ? "" : value_of(*option);
    return value.empty() ? "" : " " + value;
  }
  std::string make_option_desc(const CLI::Option* option) const override {
    return wrapped(purpose_of(*option), kTexts);
  }
  // For a subcommand, the first line is enough.
  std::string make_subcommand(const CLI::App* command) const override {
    const std::string& text = command->get_description();
    std::stringstream out;
    CLI::detail::format_help(out, command->get_display_name(true),
                             wrapped(text.substr(0, text.find('\n')), kTexts), kNames);
    return out.str();
  }
  std::string make_description(const CLI::App* command) const override {
    return wrapped(CLI::Formatter::make_description(command), kNames + kTexts);
  }
};

}  // namespace

std::string value_of(const CLI::Option& option) {
  if (option.get_items_expected_max() == 0) return "";
  const std::string type = option.get_type_name();
  const std::size_t brace = type.find('{');
  const std::string value =
      brace != std::string::npos ? type.substr(brace) : type.substr(0, type.find(':'));
  return (value.empty() ? "TEXT" : value) + (option.get_items_expected_max() > 1 ? " ..." : "");
}

std::string purpose_of(const CLI::Option& option) {
  const std::string& text = option.get_description();
  const std::string fallback = option.get_default_str();
  const bool is_told = fallback.empty() || text.find("(default") != std::string::npos;
  return is_told ? text : text + " (default: " + fallback + ")";
}

void add_help(CLI::App& app, int& exit_code) {
  auto words = std::make_shared<std::vector<std::string>>();
  CLI::App* command = app.add_subcommand("help", "Show the help of a command");
  command->add_option("COMMAND", *words, "A command, as in: help run");
  command->callback([&app, words, &exit_code] {
    const CLI::App* about = &app;
    std::string path;
    for (const std::string& word : *words) {
      const CLI::App* part = command_named(*about, word);
      if (part == nullptr) {
        std::vector<std::string_view> known;
        for (const CLI::App* each : commands_in(*about)) known.push_back(each->get_name());
        const std::string near = closest(word, known);
        const bool is_program = about == &app;
        std::string remedy = is_program      ? "; " + app.get_name() + " help lists them"
                             : known.empty() ? "; " + app.get_name() + " help " +
                                                   about->get_name() + " lists its options"
                                             : fmt::format("; it has {}", fmt::join(known, ", "));
        if (!near.empty()) remedy = "; did you mean '" + near + "'?";
        exit_code = fail((is_program ? "there is" : about->get_name() + " has") + " no command '" +
                             printable(word) + "'" + remedy,
                         kUsage);
        return;
      }
      path += (path.empty() ? "" : " ") + about->get_name();
      about = part;
    }
    // The command `help` itself is chosen, and would be shown in place of `app`.
    const auto* formatter = dynamic_cast<const CLI::Formatter*>(about->get_formatter().get());
    if (formatter == nullptr) return;
    const std::string name = (path.empty() ? "" : path + " ") + about->get_name();
    say_text(stdout, formatter->make_help(about, name, CLI::AppFormatMode::Normal));
  });
}

std::shared_ptr<CLI::FormatterBase> help_formatter() { return std::make_shared<HelpFormatter>(); }

}  // namespace culprit

#include "terminal/manual.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <system_error>

#include <fmt/core.h>

#include "base/name_grammar.h"
#include "base/text_file.h"
#include "terminal/command.h"
#include "terminal/completion.h"
#include "terminal/console.h"
#include "terminal/help.h"
#include "terminal/listed.h"

namespace culprit {
namespace {

// ---- what the program says of itself

std::vector<std::string> groups_in(const CLI::App& app) {
  std::vector<std::string> groups;
  for (const CLI::App* command : commands_in(app)) {
    if (std::find(groups.begin(), groups.end(), command->get_group()) == groups.end())
      groups.push_back(command->get_group());
  }
  return groups;
}

// "-n, --lines INT", "RULES"
std::string heading_of(const CLI::Option& option) {
  if (option.get_positional()) {
    const std::string several = option.get_items_expected_max() > 1 ? " ..." : "";
    return option.get_required() ? option.get_name(true) + several
                                 : "[" + option.get_name(true) + several + "]";
  }
  std::string names;
  for (const std::string& name : option.get_snames()) names += (names.empty() ? "-" : ", -") + name;
  for (const std::string& name : option.get_lnames())
    names += (names.empty() ? "--" : ", --") + name;
  const std::string value = value_of(option);
  return value.empty() ? names : names + " " + value;
}

// ---- man(7)

// Escapes requests at the beginning of a line, and escape characters.
std::string for_man(const std::string& text) {
  std::string out;
  for (const char c : text) {
    const bool is_first = out.empty() || out.back() == '\n';
    if (is_first && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if (c == '\n')
      out += "\n.br\n";
    else
      out += c;
  }
  return out;
}

void man_entries(std::string& out, const char* title, const Manual::Entries& entries) {
  if (entries.empty()) return;
  out += std::string(".SH ") + title + "\n";
  for (const auto& [what, text] : entries)
    out += ".TP\n.B " + for_man(what) + "\n" + for_man(text) + "\n";
}

void man_command(std::string& out, const CLI::App& command, const std::string& path) {
  out +=
      ".SS " + for_man(usage_of(command, path)) + "\n" + for_man(command.get_description()) + "\n";
  for (const CLI::Option* option : options_in(command))
    out += ".TP\n.B " + for_man(heading_of(*option)) + "\n" + for_man(purpose_of(*option)) + "\n";
  for (const CLI::App* part : commands_in(command))
    man_command(out, *part, path + " " + part->get_name());
}

// ---- Markdown

// In a cell of a table, outside of code.
std::string for_cell(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '|' || c == '<' || c == '*' || c == '_') out += '\\';
    if (c == '\n')
      out += "<br>";
    else
      out += c;
  }
  return out;
}

std::string code_in_cell(const std::string& text) {
  std::string out = "`";
  for (const char c : text) out += c == '|' ? std::string("\\|") : std::string(1, c);
  return out + "`";
}

void markdown_table(std::string& out, const std::string& head, const Manual::Entries& entries) {
  if (entries.empty()) return;
  out += "\n| " + head + " | |\n| --- | --- |\n";
  for (const auto& [what, text] : entries)
    out += "| " + code_in_cell(what) + " | " + for_cell(text) + " |\n";
}

void markdown_command(std::string& out, const CLI::App& command, const std::string& path) {
  out += "\n### " + path + "\n\n" + command.get_description() + "\n\n    " +
         usage_of(command, path) + "\n";
  Manual::Entries entries;
  for (const CLI::Option* option : options_in(command))
    entries.emplace_back(heading_of(*option), purpose_of(*option));
  markdown_table(out, "option", entries);
  for (const CLI::App* part : commands_in(command))
    markdown_command(out, *part, path + " " + part->get_name());
}

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return std::toupper(c); });
  return text;
}

}  // namespace

std::string usage_of(const CLI::App& command, const std::string& path) {
  std::string usage = path;
  const auto options = options_in(command);
  if (std::any_of(options.begin(), options.end(),
                  [](const CLI::Option* o) { return !o->get_positional(); }))
    usage += " [OPTIONS]";
  for (const CLI::Option* option : options) {
    if (option->get_positional()) usage += " " + heading_of(*option);
  }
  return commands_in(command).empty() ? usage : usage + " COMMAND";
}

const Manual::Entries& exit_statuses() {
  static const Manual::Entries all = {
      {"0", "Success; nothing is wrong."},
      {"1",
       "Failure; the reason is on the standard error output. Or a problem was found: with the "
       "robot (status, doctor), a file (check, fmt --check), a test (test), a record (audit, "
       "replay)."},
      {"2",
       "Usage error: an unknown command or option, an invalid value of an option, or an invalid "
       "environment variable. Nothing was done."},
      {"3", "Warnings, and no error (doctor, status)."}};
  return all;
}

std::string examples_of(const Manual& manual) {
  std::string text = "Examples:\n";
  for (const auto& [command, purpose] : manual.examples)
    text += fmt::format("  {:<34} {}\n", command, purpose);
  text += "culprit COMMAND --help prints the options of a command.";
  return text;
}

std::string as_man_page(const CLI::App& app, const Manual& manual) {
  std::string out = ".\\\" Made by " + manual.name + " manual; do not edit.\n.TH " +
                    upper(manual.name) + " 1 \"\" \"culprit\" \"User commands\"\n.SH NAME\n" +
                    for_man(manual.name) + " \\- " + for_man(manual.purpose) +
                    "\n.SH SYNOPSIS\n.B " + for_man(manual.name) +
                    "\n.I COMMAND\n.RI [ OPTIONS ]\n.SH DESCRIPTION\n";
  for (const std::string& paragraph : manual.description)
    out += (&paragraph == manual.description.data() ? "" : ".PP\n") + for_man(paragraph) + "\n";
  for (const std::string& group : groups_in(app)) {
    out += ".SH " + for_man(upper(group)) + "\n";
    for (const CLI::App* command : commands_in(app)) {
      if (command->get_group() == group)
        man_command(out, *command, manual.name + " " + command->get_name());
    }
  }
  man_entries(out, "FILES", manual.files);
  man_entries(out, "ENVIRONMENT", manual.environment);
  man_entries(out, "EXIT STATUS", exit_statuses());
  man_entries(out, "EXAMPLES", manual.examples);
  if (!manual.see_also.empty()) out += ".SH SEE ALSO\n" + for_man(manual.see_also) + "\n";
  return out;
}

std::string as_man_page_of(const CLI::App& command, const Manual& manual) {
  const std::string path = manual.name + " " + command.get_name();
  const std::string page = manual.name + "-" + command.get_name();
  const std::string& description = command.get_description();
  std::string out = ".\\\" Made by " + manual.name + " manual; do not edit.\n.TH " + upper(page) +
                    " 1 \"\" \"culprit\" \"User commands\"\n.SH NAME\n" + for_man(page) + " \\- " +
                    for_man(description.substr(0, description.find('\n'))) + "\n.SH SYNOPSIS\n.B " +
                    for_man(usage_of(command, path)) + "\n.SH DESCRIPTION\n" +
                    for_man(description) + "\n";
  Manual::Entries options;
  for (const CLI::Option* option : options_in(command))
    options.emplace_back(heading_of(*option), purpose_of(*option));
  man_entries(out, "OPTIONS", options);
  const auto parts = commands_in(command);
  if (!parts.empty()) out += ".SH COMMANDS\n";
  for (const CLI::App* part : parts) man_command(out, *part, path + " " + part->get_name());
  man_entries(out, "EXIT STATUS", exit_statuses());
  Manual::Entries examples;
  for (const auto& example : manual.examples) {
    if ((example.first + " ").starts_with(path + " ")) examples.push_back(example);
  }
  man_entries(out, "EXAMPLES", examples);
  return out + ".SH SEE ALSO\n" + for_man(manual.name) + "(1)\n";
}

std::string as_markdown(const CLI::App& app, const Manual& manual) {
  std::string out =
      "# " + manual.name + ": commands and options\n\n<!-- Made by `" + manual.name +
      " manual --format markdown`; do not edit. -->\n\nFor everybody who types a command of " +
      manual.name +
      ". Afterwards you know its options, its exit status and the files that it reads.\n";
  for (const std::string& paragraph : manual.description) out += "\n" + paragraph + "\n";
  out += "\n## How a command ends\n";
  markdown_table(out, "exit status", exit_statuses());
  for (const std::string& group : groups_in(app)) {
    out += "\n## " + group + "\n";
    for (const CLI::App* command : commands_in(app)) {
      if (command->get_group() == group)
        markdown_command(out, *command, manual.name + " " + command->get_name());
    }
  }
  out += "\n## Files and environment\n";
  markdown_table(out, "file", manual.files);
  markdown_table(out, "variable", manual.environment);
  return out;
}

namespace {

// "culprit-run.1" and so on, for each command of the program's own.
int write_man_pages(const CLI::App& app, const Manual& manual, const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  for (const CLI::App* command : commands_in(app)) {
    if (!manual.others.heading.empty() && command->get_group() == manual.others.heading) continue;
    const std::string file = folder + "/" + manual.name + "-" + command->get_name() + ".1";
    const auto written = write_text(file, as_man_page_of(*command, manual));
    if (!written) return fail(written.error());
  }
  return kOk;
}

}  // namespace

void add_manual(CLI::App& app, const Manual& manual, int& exit_code) {
  using Format = std::string (*)(const CLI::App&, const Manual&);
  static const std::map<std::string, Format> formats = {{"man", as_man_page},
                                                        {"markdown", as_markdown},
                                                        {"bash", as_bash_completion},
                                                        {"zsh", as_zsh_completion},
                                                        {"fish", as_fish_completion}};
  auto format = std::make_shared<std::string>("man");
  auto about = std::make_shared<std::string>();
  auto folder = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("manual", "Print the manual")->group("");
  command
      ->add_option("--format", *format,
                   "man for man(1), or markdown; bash, zsh or fish: what completes its commands "
                   "and options there")
      ->check(CLI::IsMember({"man", "markdown", "bash", "zsh", "fish"}))
      ->capture_default_str();
  command->add_option("COMMAND", *about, "The command whose page for man(1) is printed");
  command->add_option("--pages", *folder, "Write a page for man(1) for each command to this folder")
      ->type_name("FOLDER");
  command->callback([&app, &manual, &exit_code, format, about, folder] {
    if (!folder->empty()) {
      exit_code = write_man_pages(app, manual, *folder);
      return;
    }
    const CLI::App* one = command_named(app, *about);
    if (one == nullptr && !about->empty()) {
      exit_code = fail("there is no command '" + printable(*about) + "'", kUsage);
      return;
    }
    say_text(stdout,
             one != nullptr ? as_man_page_of(*one, manual) : formats.at(*format)(app, manual));
    exit_code = kOk;
  });
}

}  // namespace culprit

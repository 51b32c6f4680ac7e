#include "init/launch_text.h"

#include <algorithm>
#include <cctype>

#include "base/invariant.h"
#include "base/joined.h"

namespace culprit::init {
namespace {

bool is_plain(unsigned char c) {
  return std::isalnum(c) != 0 ||
         std::string_view("_@%+=:,./~-").find(static_cast<char>(c)) != std::string_view::npos;
}

// One argument of a row: 'two words', 'it'\''s'.
std::string argument(const std::string& text) {
  if (!text.empty() && std::all_of(text.begin(), text.end(), is_plain)) return text;
  std::string quoted = "'";
  for (const char c : text) {
    if (c == '\'')
      quoted += R"('\'')";
    else
      quoted += c;
  }
  return quoted + "'";
}

// A text of the rule language.
std::string text(const std::string& content) {
  std::string quoted = "\"";
  for (const char c : content) {
    if (c == '"' || c == '\\') quoted += '\\';
    if (c == '\n')
      quoted += "\\n";
    else if (c == '\t')
      quoted += "\\t";
    else
      quoted += c;
  }
  return quoted + "\"";
}

std::string row(const std::vector<std::string>& arguments) {
  return joined(arguments, " ", argument);
}

}  // namespace

std::string launch_text(const Start& start) {
  CULPRIT_ASSERT(!start.command.empty());
  std::string clauses = "LAUNCH " + text(row(start.command));
  if (!start.environment.empty()) clauses += " ENV " + text(row(start.environment));
  if (!start.folder.empty()) clauses += " CWD " + text(start.folder);
  return clauses;
}

std::string composed_text(const Recipe& recipe, const std::string& parameter_file) {
  std::string clauses = "IN " + recipe.container + " PLUGIN " + recipe.plugin;
  if (!recipe.plugin.starts_with(recipe.package + "::")) clauses += " PACKAGE " + recipe.package;
  if (!recipe.parameters.empty()) clauses += " PARAMETERS " + text(parameter_file);
  std::vector<std::string> remaps;
  for (const auto& [from, to] : recipe.remaps) remaps.push_back(from + ":=" + to);
  if (!remaps.empty()) clauses += " REMAP " + text(row(remaps));
  return clauses;
}

}  // namespace culprit::init

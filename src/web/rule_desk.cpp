#include "web/rule_desk.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <vector>

#include "base/name_grammar.h"
#include "base/text_file.h"
#include "language/checker.h"
#include "rule_files/rule_files.h"
#include "web/rule_commands.h"

namespace culprit::web {
namespace {

// FNV-1a. It distinguishes versions that people made; there is no gain in forging one.
std::string version_of(const std::string& text) {
  std::uint64_t hash = 14695981039346656037u;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211u;
  return std::to_string(hash);
}

namespace fs = std::filesystem;

bool is_below(const fs::path& file, const fs::path& folder) {
  const fs::path relative = file.lexically_relative(folder);
  return !relative.empty() && *relative.begin() != "..";
}

// Whole, with every link followed.
fs::path real(const fs::path& path) {
  std::error_code error;
  const fs::path found = fs::weakly_canonical(fs::absolute(path), error);
  return error ? fs::absolute(path).lexically_normal() : found;
}

}  // namespace

RuleLoader RuleDesk::loader() const {
  if (fixed_) return nullptr;
  return [this](const std::string& file, const std::string& from) -> Expected<Source> {
    const fs::path includer =
        from.empty() || from == kTextOfPage ? fs::path(path_) : fs::path(from);
    const fs::path beside = real(includer.parent_path() / file);
    const fs::path installed = real(rule_files::installed() / file);
    const bool may_be = is_below(beside, real(path_).parent_path()) ||
                        is_below(beside, real(rule_files::installed())) ||
                        (fs::path(file).is_relative() &&
                         is_below(installed, real(rule_files::installed())) && !fs::exists(beside));
    if (may_be || includes(beside)) return rule_files::load(file, includer.string());
    return Error{"from the page, only files in the folder of " + path_ +
                 " and below, and installed ones, can be included for the first time"};
  };
}

// Whether the file as it is includes `file`, itself or by another one.
bool RuleDesk::includes(const std::filesystem::path& file) const {
  const auto now = rule_files::read(path_);
  if (!now) return false;
  for (std::uint32_t f = 1; f < now->source.file_count(); ++f) {
    if (real(now->source.file(f).name()) == file) return true;
  }
  return false;
}

// Rules with mistakes do not show what they execute, neither before nor after.
std::string RuleDesk::changed_command(const std::string& text) const {
  const auto now = rule_files::read(path_);
  std::error_code error;
  const bool is_new = !fs::exists(path_, error);
  const auto before = now ? check(*now).rules : std::nullopt;
  const auto after = check(expand(Source(path_, text), loader())).rules;
  if (!before && !is_new)
    return "the file has mistakes, so that this could change what is executed";
  if (!after) return "the text has mistakes, so that it could change what is executed";
  const auto old = before ? commands_of(*before) : std::vector<std::string>();
  const auto next = commands_of(*after);
  std::vector<std::string> changed;
  std::set_symmetric_difference(old.begin(), old.end(), next.begin(), next.end(),
                                std::back_inserter(changed));
  return changed.empty() ? "" : "this changes what is executed: " + printable(changed.front());
}

Expected<RuleDesk::Content> RuleDesk::read() const {
  if (fixed_) return Content{*fixed_, version_of(*fixed_)};
  std::error_code error;
  if (!std::filesystem::exists(path_, error) && !error) return Content{"", version_of("")};
  if (std::filesystem::is_directory(path_, error))
    return Error{"'" + path_ + "' is a folder; name a rule file in it"};
  if (!std::filesystem::is_regular_file(path_, error))
    return Error{"'" + path_ + "' is no regular file, and so no rule file"};
  auto text = read_text(path_);
  if (!text) return Error{text.error()};
  std::string version = version_of(*text);
  return Content{std::move(*text), std::move(version)};
}

std::variant<std::string, RuleDesk::Refusal> RuleDesk::save(const std::string& text,
                                                            const std::string& version) {
  if (fixed_)
    return Refusal{Problem::kNotWritten,
                   path_ + " is part of the program; save the text elsewhere"};
  const MutexLock lock(saving_);
  const auto now = read();
  if (!now) return Refusal{Problem::kNotWritten, now.error()};
  if (now->version != version)
    return Refusal{
        Problem::kChangedMeanwhile,
        path_ + " was changed by another program since you opened it; nothing is written"};
  const std::string command = commands_ == Commands::kStay ? changed_command(text) : "";
  if (!command.empty())
    return Refusal{Problem::kChangesCommands,
                   command +
                       "; the page may change that only of a culprit that was started with "
                       "--edit-rules. Nothing is written"};
  if (const auto written = write_text(path_, text); !written)
    return Refusal{Problem::kNotWritten, written.error()};
  return version_of(text);
}

}  // namespace culprit::web

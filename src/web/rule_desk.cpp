#include "web/rule_desk.h"

#include <filesystem>

#include "base/text_file.h"

namespace culprit::web {
namespace {

// FNV-1a. It tells versions apart that people made; nobody gains by making two alike.
std::string version_of(const std::string& text) {
  std::uint64_t hash = 14695981039346656037u;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211u;
  return std::to_string(hash);
}

}  // namespace

Expected<RuleDesk::Content> RuleDesk::read() const {
  if (fixed_) return Content{*fixed_, version_of(*fixed_)};
  std::error_code error;
  if (!std::filesystem::exists(path_, error) && !error) return Content{"", version_of("")};
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
    return Refusal{Problem::kChangedMeanwhile,
                   path_ + " was changed by somebody else since you opened it; nothing is written"};
  if (const auto written = write_text(path_, text); !written)
    return Refusal{Problem::kNotWritten, written.error()};
  return version_of(text);
}

}  // namespace culprit::web

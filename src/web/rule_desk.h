// The rule file that a page edits. Many pages may have it open, and editors beside them: a client
// that saves names the version that it changed, so that no change of another is overwritten.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>

#include "base/expected.h"
#include "base/mutex.h"
#include "language/reuse/expansion.h"

namespace culprit::web {

// The name of a page's text in messages.
inline constexpr const char* kTextOfPage = "rules";

// All members may be called from any thread.
class RuleDesk {
 public:
  // Whether a page may change what is executed (rule_commands.h) as well.
  enum class Commands : std::uint8_t { kMayChange, kStay };
  // A file, which may be new.
  explicit RuleDesk(std::string path, Commands commands = Commands::kMayChange)
      : path_(std::move(path)), commands_(commands) {}
  // Rules without a file, which cannot be saved.
  RuleDesk(std::string name, std::string text) : path_(std::move(name)), fixed_(std::move(text)) {}

  struct Content {
    std::string text;
    std::string version;  // another one for another text
  };
  const std::string& path() const { return path_; }
  bool can_save() const { return !fixed_; }

  // Errors: the file cannot be read. One that is not there yet is empty.
  Expected<Content> read() const;

  // Finds the files that a page's text includes: beside the file and below, among the installed rules, and those that the file itself includes already. No page
  // reads anything else of this computer. Rules without a file can include nothing. The desk must outlive it.
  RuleLoader loader() const;

  enum class Problem : std::uint8_t { kChangedMeanwhile, kChangesCommands, kNotWritten };
  struct Refusal {
    Problem problem;
    std::string message;
  };
  // Writes the file as a whole or not at all (language/text_file.h), if it is still `version`.
  // Gives the new version, or why it was not written.
  std::variant<std::string, Refusal> save(const std::string& text, const std::string& version);

 private:
  bool includes(const std::filesystem::path& file) const;
  // How the text would change what is executed; empty: not at all.
  std::string changed_command(const std::string& text) const;

  const std::string path_;
  const std::optional<std::string> fixed_;
  const Commands commands_ = Commands::kMayChange;
  Mutex saving_;
};

}  // namespace culprit::web

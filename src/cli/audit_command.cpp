#include <algorithm>
#include <charconv>
#include <memory>

#include <fmt/core.h>

#include "base/amount.h"
#include "cli/commands.h"
#include "cli/journal_file.h"
#include "journal/json.h"
#include "journal/verify.h"

namespace culprit::cli {
namespace {

struct VerifyOptions {
  JournalOption journal;
  std::string noted;
  bool json = false;
};

Json to_json(const journal::Verification& result) {
  return {{"whole", result.findings.empty()},
          {"rows", result.rows},
          {"first", result.first},
          {"findings", result.findings},
          {"newest", fmt::format("{}:{}", result.newest.id, journal::to_hex(result.newest.hash))}};
}

// "1234:<64 hexadecimal digits>"
std::optional<journal::Link> link_from(const std::string& text) {
  journal::Link link;
  const char* end = text.data() + text.size();
  const auto [colon, error] = std::from_chars(text.data(), end, link.id);
  if (error != std::errc() || end - colon != 65 || *colon != ':') return std::nullopt;
  for (std::size_t i = 0; i < link.hash.size(); ++i) {
    const char* digits = colon + 1 + 2 * i;
    const auto [rest, bad] = std::from_chars(digits, digits + 2, link.hash[i], 16);
    if (bad != std::errc() || rest != digits + 2) return std::nullopt;
  }
  return link;
}

int verify(const VerifyOptions& options) {
  std::optional<journal::Link> noted;
  if (!options.noted.empty()) {
    noted = link_from(options.noted);
    if (!noted) return fail("--noted wants <row>:<hash>, as this command prints it"), kUsage;
  }
  const auto journal = options.journal.open();
  if (!journal) return fail(journal.error());
  const auto result = journal::verify(*journal, noted);
  if (!result) return fail(result.error());
  if (options.json) {
    fmt::print("{}\n", to_line(to_json(*result)));
    return result->findings.empty() ? kOk : kFailed;
  }
  constexpr std::size_t kShown = 20;
  for (std::size_t i = 0; i < std::min(kShown, result->findings.size()); ++i)
    fmt::print("{}\n", result->findings[i]);
  if (result->findings.size() > kShown)
    fmt::print("... and {} more\n", result->findings.size() - kShown);
  const bool is_whole = result->findings.empty();
  fmt::print(
      "{}{}: {}\n", amount_of(static_cast<std::size_t>(result->rows), "row"),
      result->first > 1 ? fmt::format(" ({} older ones were dropped)", result->first - 1) : "",
      is_whole ? "all as they were written" : "NOT as they were written");
  fmt::print("newest {}:{}\n", result->newest.id, journal::to_hex(result->newest.hash));
  return is_whole ? kOk : kFailed;
}

}  // namespace

void add_audit(CLI::App& app, int& exit_code) {
  CLI::App* audit = app.add_subcommand("audit", "Verify the integrity of the journal");
  audit->require_subcommand(1);
  auto options = std::make_shared<VerifyOptions>();
  CLI::App* command =
      audit->add_subcommand("verify", "Check every row against the chain of hashes");
  options->journal.add_to(*command);
  command->add_option("--noted", options->noted,
                      "<row>:<hash> of an earlier run; it must still be in the chain");
  command->add_flag("--json", options->json, "As one JSON document");
  command->callback([options, &exit_code] { exit_code = verify(*options); });
}

}  // namespace culprit::cli

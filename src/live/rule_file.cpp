#include "live/rule_file.h"

#include <fmt/core.h>

#include "language/improvise.h"
#include "live/rule_trust.h"
#include "rule_files/rule_files.h"

namespace culprit::live {

Expected<LoadedRules> read_rules(const std::string& path, Strictness strictness, Colour colour) {
  auto rules = rule_files::read(path);
  if (!rules) return Error{rules.error()};
  Checked checked = check(*rules, strictness);
  std::string remarks = render(checked.diagnostics, rules->source, colour);
  if (!checked.rules) return Error{fmt::format("{} has errors\n{}", path, remarks)};
  return LoadedRules{std::move(*checked.rules), std::move(rules->source), std::move(remarks)};
}

Expected<LoadedRules> improvised(LoadedRules loaded, const std::string& path) {
  const std::string more = improvised_rules(loaded.rules);
  if (more.empty()) return loaded;
  Source source = loaded.source.followed_by(more);
  Checked checked = check(source);
  if (!checked.rules) {
    const std::string why = render(checked.diagnostics, source, Colour::kOff);
    return Error{fmt::format("{} cannot be improvised on: name nothing \"{}...\"\n{}", path,
                             kImprovised, why)};
  }
  return LoadedRules{std::move(*checked.rules), std::move(source), std::move(loaded.remarks)};
}

Expected<LoadedRules> trusted_rules(const std::string& path, bool improvises, Colour colour) {
  auto loaded = read_rules(path, Strictness::kLenient, colour);
  if (!loaded) return loaded;
  for (std::uint32_t f = 0; f < loaded->source.file_count(); ++f) {
    const std::string& file = loaded->source.file(f).name();
    if (const auto trusted = trust_rules(file); !trusted) return Error{trusted.error()};
  }
  return improvises ? improvised(std::move(*loaded), path) : std::move(loaded);
}

}  // namespace culprit::live

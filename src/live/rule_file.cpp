#include "live/rule_file.h"

#include <fmt/core.h>

#include "language/improvise.h"
#include "live/rule_trust.h"

namespace culprit::live {

Expected<LoadedRules> read_rules(const std::string& path, Strictness strictness, Colour colour) {
  const auto source = Source::read(path);
  if (!source) return Error{source.error()};
  Checked checked = check(*source, strictness);
  std::string remarks;
  for (const Diagnostic& d : checked.diagnostics) remarks += render(d, *source, colour);
  if (!checked.rules) return Error{fmt::format("{} has errors\n{}", path, remarks)};
  return LoadedRules{std::move(*checked.rules), std::string(source->text()), std::move(remarks)};
}

Expected<LoadedRules> improvised(LoadedRules loaded, const std::string& path) {
  const std::string more = improvised_rules(loaded.rules);
  if (more.empty()) return loaded;
  const Source source(path, loaded.text + more);
  Checked checked = check(source);
  if (!checked.rules) {
    std::string why;
    for (const Diagnostic& d : checked.diagnostics) why += render(d, source, Colour::kOff);
    return Error{fmt::format("{} cannot be improvised on: name nothing \"{}...\"\n{}", path,
                             kImprovised, why)};
  }
  return LoadedRules{std::move(*checked.rules), loaded.text + more, std::move(loaded.remarks)};
}

Expected<LoadedRules> trusted_rules(const std::string& path, bool improvises, Colour colour) {
  auto loaded = read_rules(path, Strictness::kLenient, colour);
  if (!loaded) return loaded;
  if (const auto trusted = trust_rules(path); !trusted) return Error{trusted.error()};
  return improvises ? improvised(std::move(*loaded), path) : std::move(loaded);
}

}  // namespace culprit::live

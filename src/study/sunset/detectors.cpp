#include "study/sunset/detectors.h"

#include <array>

namespace culprit::study {
namespace {

using Change = std::pair<std::string_view, std::string_view>;

constexpr std::array kPhis = {
    Change{"CONST silence       = 350ms\n", "CONST suspicion     = 8\n"},
    Change{"age(", "phi("},
    Change{"> silence", "> suspicion"},
};

void replace_all(std::string& text, const Change& change) {
  for (std::size_t at = text.find(change.first); at != std::string::npos;
       at = text.find(change.first, at + change.second.size()))
    text.replace(at, change.first.size(), change.second);
}

}  // namespace

Expected<std::pair<std::string, Detectors>> parse_profile(std::string_view text) {
  const std::size_t colon = text.find(':');
  const std::string profile(text.substr(0, colon));
  if (colon == std::string_view::npos) return std::pair(profile, Detectors::kOwn);
  const std::string_view detectors = text.substr(colon + 1);
  if (detectors == "age") return std::pair(profile, Detectors::kAge);
  if (detectors == "phi") return std::pair(profile, Detectors::kPhi);
  return Error{"there are no detectors '" + std::string(detectors) + "'; there are own, age, phi"};
}

std::string with_phi(std::string text) {
  for (const Change& change : kPhis) replace_all(text, change);
  return text;
}

}  // namespace culprit::study

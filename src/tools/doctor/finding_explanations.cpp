#include "doctor/finding_explanations.h"

#include <algorithm>
#include <cctype>

#include "base/markdown.h"
#include "base/wrapped.h"
#include "doctor/findings_text.h"

namespace culprit::doctor {
namespace {

constexpr std::string_view kFound = "\n\n*Found:* ";
constexpr std::string_view kToDo = "\n\n*To do:* ";
constexpr std::size_t kColumns = 80;

std::vector<Explanation> explanations_in(std::string_view page) {
  std::vector<Explanation> all;
  for (const auto& [heading, text] : markdown_sections(page))
    all.push_back({std::string(heading), std::string(text_between(text, "**", ".** ")),
                   std::string(text_between(text, ".** ", kFound)),
                   std::string(text_between(text, kFound, kToDo)),
                   std::string(text_between(text, kToDo, "\n"))});
  return all;
}

std::string upper(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return out;
}

}  // namespace

const std::vector<Explanation>& explanations() {
  static const std::vector<Explanation> all = explanations_in(kFindingsText);
  return all;
}

const Explanation* find_explanation(std::string_view code) {
  const auto& all = explanations();
  const auto found = std::ranges::find(all, upper(code), &Explanation::code);
  return found == all.end() ? nullptr : &*found;
}

std::string page(const Explanation& e) {
  return e.code + ": " + e.title + "\n\n" + wrapped(e.why, kColumns) + "\n\nFound:\n\n" +
         wrapped(e.found, kColumns) + "\n\nTo do:\n\n" + wrapped(e.remedy, kColumns) + "\n";
}

std::string_view findings_page() { return kFindingsText; }

}  // namespace culprit::doctor

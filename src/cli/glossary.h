// The terms of culprit. Their source is docs/glossary.md, which is compiled in: there is no second list.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace culprit::cli {

struct Term {
  std::string name;     // "upstream, downstream"; as the page writes it, without markup
  std::string section;  // "The robot"
  std::string meaning;  // plain text
  // "upstream", "downstream", "coupling", "κ": each in lower case.
  std::vector<std::string> words;
};

// In the order of the page.
const std::vector<Term>& glossary();

// The term that `word` names, in any case, singular or plural; null if there is none.
const Term* find_term(std::string_view word);

// The nearest word of the glossary; empty if none is near.
std::string nearest_term(std::string_view word);

// One term for a terminal.
std::string page(const Term& term);

}  // namespace culprit::cli

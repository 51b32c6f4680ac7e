#include "cli/glossary.h"

#include <algorithm>
#include <cctype>

#include "base/closest.h"
#include "base/wrapped.h"
#include "cli/glossary_text.h"

namespace culprit::cli {
namespace {

std::string_view without_blanks(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

// Without the markup of Markdown: `code`, *emphasis*, [text](target), \\|.
std::string plain_text(std::string_view markdown) {
  std::string out;
  for (std::size_t i = 0; i < markdown.size(); ++i) {
    if (markdown.substr(i).starts_with(" ([")) {  // a reference to a page
      if (const auto end = markdown.find("))", i); end != std::string_view::npos) {
        i = end + 1;
        continue;
      }
    }
    const char c = markdown[i];
    if (c == '`' || c == '*' || c == '[') continue;
    if (c == '\\' && i + 1 < markdown.size()) {
      out += markdown[++i];
      continue;
    }
    if (c == ']' && i + 1 < markdown.size() && markdown[i + 1] == '(') {
      i = std::min(markdown.find(')', i), markdown.size());
      continue;
    }
    if (c != ']') out += c;
  }
  return out;
}

std::string lower_case_of(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}

// Each word by itself, as in "coupling (κ)" and "upstream, downstream"; with blanks for underscores,
// as find_term reads them.
std::vector<std::string> words_of_term(const std::string& name) {
  std::vector<std::string> words;
  std::string word;
  const auto end_word = [&] {
    const auto trimmed = without_blanks(word);
    if (!trimmed.empty()) words.push_back(lower_case_of(trimmed));
    word.clear();
  };
  for (const char c : name) {
    if (c == ',' || c == '(' || c == ')' || c == '/')
      end_word();
    else
      word += c == '_' ? ' ' : c;
  }
  end_word();
  return words;
}

std::vector<Term> terms_in(std::string_view page) {
  std::vector<Term> terms;
  std::string section;
  while (!page.empty()) {
    const auto end = std::min(page.find('\n'), page.size());
    const std::string_view line = page.substr(0, end);
    page.remove_prefix(std::min(end + 1, page.size()));
    if (line.starts_with("## ")) section = plain_text(line.substr(3));
    if (!line.starts_with("| ") || line.starts_with("| ---") || line.starts_with("| word |"))
      continue;
    const auto middle = line.find(" | ", 2);
    if (middle == std::string_view::npos) continue;
    const auto last = line.rfind('|');
    Term term;
    term.name = plain_text(without_blanks(line.substr(2, middle - 2)));
    term.section = section;
    term.meaning = plain_text(without_blanks(line.substr(middle + 3, last - middle - 3)));
    term.words = words_of_term(term.name);
    terms.push_back(std::move(term));
  }
  return terms;
}

bool is_called(const Term& term, const std::string& word) {
  return std::find(term.words.begin(), term.words.end(), word) != term.words.end();
}

}  // namespace

const std::vector<Term>& glossary() {
  static const std::vector<Term> all = terms_in(kGlossaryText);
  return all;
}

const Term* find_term(std::string_view word) {
  std::string wanted = lower_case_of(without_blanks(word));
  std::replace(wanted.begin(), wanted.end(), '_', ' ');
  std::vector<std::string> forms = {wanted};
  if (wanted.ends_with("ies")) forms.push_back(wanted.substr(0, wanted.size() - 3) + "y");
  if (wanted.ends_with('s')) forms.push_back(wanted.substr(0, wanted.size() - 1));
  if (wanted.ends_with('y')) forms.push_back(wanted.substr(0, wanted.size() - 1) + "ies");
  forms.push_back(wanted + "s");
  for (const std::string& form : forms) {
    for (const Term& term : glossary()) {
      if (is_called(term, form) || lower_case_of(term.name) == form) return &term;
    }
  }
  return nullptr;
}

std::string nearest_term(std::string_view word) {
  std::vector<std::string_view> known;
  for (const Term& term : glossary())
    known.insert(known.end(), term.words.begin(), term.words.end());
  return closest(lower_case_of(word), known);
}

std::string page(const Term& term) {
  constexpr std::size_t kColumns = 100;
  return term.name + "  (" + term.section + ")\n\n" + wrapped(term.meaning, kColumns) + "\n";
}

}  // namespace culprit::cli

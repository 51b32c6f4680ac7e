// Instantiates a template for one USE: puts its arguments in, and makes its names fit among all
// others.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "language/reuse/composed_text.h"
#include "language/scanner.h"
#include "language/source.h"
#include "language/syntax.h"

namespace culprit {

// The argument for a parameter, as it is written, with its quotes.
struct TemplateArgument {
  std::string written;
  Place place;
  bool is_verbatim = true;  // `place` holds `written` byte for byte
  std::uint32_t step = Step::kNone;
};

// The arguments, by parameter. Empty if `use`, which stands in `text`, gives too few or too many.
// The template is in file `file`.
std::optional<std::vector<TemplateArgument>> arguments_of(const ComposedText& text,
                                                          const syntax::Use& use,
                                                          const syntax::Template& pattern,
                                                          std::uint32_t file,
                                                          const std::vector<Step>& steps);
std::string wrong_count(const syntax::Use& use, const syntax::Template& pattern);
// "driver(name, topic, hz = 10)"
std::string usage_of(const syntax::Template& pattern);

// The template's lines with the arguments in them. `source` is file `file`, `lexemes` are its. If they become larger than
// `most` bytes, those that come after are left out.
ComposedText filled_in(const syntax::Template& pattern, std::uint32_t file, const Source& source,
                       const std::vector<Lexeme>& lexemes,
                       const std::vector<TemplateArgument>& arguments, std::uint32_t step,
                       std::size_t most);

// The piece that the byte at `offset` is of. @pre there is one.
const Piece& piece_of(const ComposedText& text, std::uint32_t offset);

// The names that are declared so far, and what becomes of those of a template.
class DeclaredNames {
 public:
  void add(const syntax::File& tree);

  // Other names for the constants of `tree` whose names are taken. They are taken from now on.
  std::vector<Replacement> own_constants(const syntax::File& tree);
  // Between these, what `tree` declares is known, too; it is the inside of a template.
  void enter(const syntax::File& tree) { inside_.push_back(&tree); }
  void leave() { inside_.pop_back(); }
  // The names of `tree`, the tree of `source`, in the namespace `space`.
  std::vector<Replacement> below(const std::string& space, const syntax::File& tree,
                                 const Source& source) const;
  // Components of `tree` that are declared already become comments, and are called as those are.
  std::vector<Replacement> giving_way(const syntax::File& tree, const Source& source) const;

 private:
  bool has_component(const std::string& name) const;

  std::set<std::string> taken_;                    // by constants, components and signals
  std::map<std::string, int> tried_;               // of each constant, the last number behind it
  std::map<std::string, std::string> components_;  // their nodes, by name; empty: not declared
  std::map<std::string, std::string> by_node_;     // the names of components
  std::vector<const syntax::File*> inside_;
};

}  // namespace culprit

#include "language/reuse/expansion.h"

#include <algorithm>
#include <array>
#include <deque>
#include <filesystem>
#include <map>
#include <set>

#include "language/parser.h"
#include "language/reuse/composed_text.h"
#include "language/reuse/instance.h"

namespace culprit {
namespace {

// Far above what people write; they bound what a hostile file can cost.
constexpr std::size_t kMaxFiles = 256;
constexpr std::size_t kMaxDepth = 16;                       // of templates that use templates
constexpr std::size_t kMaxUses = 10'000;                    // nested ones included
constexpr std::size_t kMaxRules = 10'000;                   // from templates
constexpr std::size_t kMaxExpanded = std::size_t{4} << 20;  // bytes, likewise
constexpr std::size_t kEnoughMistakes = 200;
constexpr const char* kTooLarge = "all files together are larger than 64 MiB";

// A text on its way, with its tree.
struct Unit {
  explicit Unit(ComposedText composed)
      : text(std::move(composed)), source("", text.text), tree(parse(source, said)) {}

  ComposedText text;
  Source source;
  std::vector<Diagnostic> said;
  syntax::File tree;
};

// The text around a USE or an INCLUDE: a unit, or one of the files.
struct Surroundings {
  const ComposedText& text;
  const Source& source;
  const syntax::File& tree;
  std::optional<std::uint32_t> file{};
};

// The line of `span`, with its end.
Span line_of(const Source& source, Span span) {
  const std::uint32_t number = source.position(span.begin).line;
  const auto size = static_cast<std::uint32_t>(source.text().size());
  return {source.line(number).begin,
          number < source.line_count() ? source.line(number + 1).begin : size};
}

class Expander {
 public:
  explicit Expander(const RuleLoader& load) : load_(load) {}

  Expansion expand(Source root) {
    add_file(std::move(root), Step::kNone, {});
    if (mistakes_.empty()) find_templates();
    if (mistakes_.empty()) {
      for (const File& file : files_) names_.add(file.tree);
      ComposedText all = file_text(0);
      if (all.text.size() > Source::kMaxSize)
        blame(0, {Code::kEndlessTemplate, Severity::kError, {}, kTooLarge, ""});
      if (mistakes_.empty())
        return {Source(all.text, sources(), all.pieces, steps_), {}, known_templates()};
    }
    std::stable_sort(
        mistakes_.begin(), mistakes_.end(),
        [](const Diagnostic& a, const Diagnostic& b) { return a.span.begin < b.span.begin; });
    return {Source(wreck_.text, sources(), wreck_.pieces, steps_), std::move(mistakes_),
            known_templates()};
  }

 private:
  struct File {
    Source source;
    syntax::File tree;
    std::vector<Lexeme> lexemes;
    std::uint32_t step;
    std::vector<std::optional<std::uint32_t>> included;  // by each INCLUDE; empty: was there
    std::uint32_t wreck_begin = Step::kNone;             // where wreck_ has it
  };
  struct Known {
    std::uint32_t file;
    const syntax::Template* pattern;
  };

  std::vector<Source> sources() const {
    std::vector<Source> all;
    for (const File& file : files_) all.push_back(file.source);
    return all;
  }

  std::map<std::string, KnownTemplate> known_templates() const {
    std::map<std::string, KnownTemplate> all;
    for (std::uint32_t f = 0; f < files_.size(); ++f) {
      for (const syntax::Template& each : files_[f].tree.templates)
        all.try_emplace(each.name.text, KnownTemplate{usage_of(each), {f, each.name.span}});
    }
    return all;
  }

  // ---- Files

  static std::string key_of(const Source& source) {
    return std::filesystem::path(source.name()).lexically_normal().string();
  }

  void add_file(Source source, std::uint32_t step, std::vector<std::string> open) {
    const auto index = static_cast<std::uint32_t>(files_.size());
    File& file = files_.emplace_back(File{std::move(source), {}, {}, step, {}});
    open.push_back(key_of(file.source));
    known_files_.insert(open.back());
    std::vector<Diagnostic> said;
    file.tree = parse(file.source, said, &file.lexemes);
    for (Diagnostic& d : said) blame(index, std::move(d));
    for (const syntax::Include& include : file.tree.includes)
      file.included.push_back(add_included(index, include, open));
  }

  std::optional<std::uint32_t> add_included(std::uint32_t from, const syntax::Include& include,
                                            const std::vector<std::string>& open) {
    const auto refuse = [&](std::string cause, std::string remedy) {
      blame(from, {Code::kCannotInclude, Severity::kError, include.file.span, std::move(cause),
                   std::move(remedy)});
      return std::nullopt;
    };
    if (files_.size() >= kMaxFiles)
      return refuse("this includes more than " + std::to_string(kMaxFiles) + " files", "");
    if (!load_) return refuse("no other file can be read here", "write its rules into this one");
    auto loaded = load_(include.file.text, files_[from].source.name());
    if (!loaded) {
      const bool is_missing = loaded.error().starts_with("there is no ") &&
                              loaded.error().find("did you mean") == std::string::npos;
      return refuse(loaded.error(), is_missing ? "correct the name, or put the file there" : "");
    }
    size_ += loaded->text().size();
    if (size_ > Source::kMaxSize) return refuse(kTooLarge, "");
    const std::string key = key_of(*loaded);
    if (const auto above = std::find(open.begin(), open.end(), key); above != open.end()) {
      std::string cycle;
      for (auto each = above; each != open.end(); ++each) cycle += *each + " includes ";
      return refuse("files include one another: " + cycle + key, "leave one of the INCLUDEs out");
    }
    if (known_files_.contains(key)) return std::nullopt;
    const auto index = static_cast<std::uint32_t>(files_.size());
    steps_.push_back({Step::Kind::kInclude, {from, include.span}, files_[from].step});
    add_file(std::move(*loaded), static_cast<std::uint32_t>(steps_.size() - 1), open);
    return index;
  }

  void find_templates() {
    for (std::uint32_t f = 0; f < files_.size(); ++f) {
      for (const syntax::Template& pattern : files_[f].tree.templates) {
        const auto [first, is_new] = templates_.try_emplace(pattern.name.text, Known{f, &pattern});
        if (is_new) continue;
        const Source& other = files_[first->second.file].source;
        const Position at = other.position(first->second.pattern->name.span.begin);
        blame(f, {Code::kDuplicateName, Severity::kError, pattern.name.span,
                  "there is a template '" + pattern.name.text + "' already, in " + other.name() +
                      ":" + std::to_string(at.line),
                  "give this one another name"});
      }
    }
  }

  ComposedText whole(std::uint32_t index) const {
    const File& file = files_[index];
    ComposedText text;
    const auto size = static_cast<std::uint32_t>(file.source.text().size());
    text.add(file.source.text(), {0, {index, {0, size}}, true, file.step});
    return text;
  }

  ComposedText file_text(std::uint32_t index) {
    const File& file = files_[index];
    ComposedText text = spliced({whole(index), file.source, file.tree, index}, {});
    if (!text.text.empty() && text.text.back() != '\n')
      text.add_instead("\n", text, {text.size() - 1, text.size()});
    return text;
  }

  // ---- What statements become

  // The text with what its statements become. `open`: the templates that it stands in.
  ComposedText spliced(const Surroundings& unit, const std::vector<const syntax::Template*>& open) {
    std::map<std::uint32_t, std::function<void(ComposedText&)>> becomes;  // by place
    std::map<std::uint32_t, Span> lines;
    for (std::size_t i = 0; i < unit.tree.includes.size(); ++i) {
      const Span span = unit.tree.includes[i].span;
      lines[span.begin] = line_of(unit.source, span);
      becomes[span.begin] = [this, &unit, i](ComposedText& out) {
        if (const auto included = files_[*unit.file].included[i]) {
          const ComposedText text = file_text(*included);
          out.add(text, {0, text.size()});
        }
      };
    }
    for (const syntax::Use& use : unit.tree.uses) {
      lines[use.span.begin] = line_of(unit.source, use.span);
      becomes[use.span.begin] = [this, &unit, &use, &open](ComposedText& out) {
        const ComposedText text = instance(unit, use, open);
        out.add(text, {0, text.size()});
      };
    }
    for (const syntax::Template& pattern : unit.tree.templates)
      lines[pattern.span.begin] = pattern.span;

    ComposedText out;
    std::uint32_t done = 0;
    for (const auto& [begin, line] : lines) {
      out.add(unit.text, {done, line.begin});
      done = line.end;
      const auto what = becomes.find(begin);
      if (what == becomes.end()) continue;
      out.add_instead("# ", unit.text, {line.begin, line.begin});
      out.add(unit.text, line);
      if (out.text.back() != '\n') out.add_instead("\n", unit.text, {line.end - 1, line.end});
      what->second(out);
    }
    out.add(unit.text, {done, unit.text.size()});
    return out;
  }

  void refuse_use(const Surroundings& unit, Code code, Span span, std::string cause,
                  std::string remedy, std::optional<Edit> fix = {}) {
    Diagnostic d{code, Severity::kError, span, std::move(cause), std::move(remedy), fix};
    unit.file ? blame(*unit.file, std::move(d)) : blame(unit.text, {std::move(d)});
  }

  // The template that is used. Null, and said, if there is none, or if it would have no end.
  const Known* used_template(const Surroundings& unit, const syntax::Use& use,
                             const std::vector<const syntax::Template*>& open) {
    const std::string& name = use.pattern.text;
    const auto known = templates_.find(name);
    if (known == templates_.end()) {
      std::vector<std::string_view> all;
      for (const auto& [each, where] : templates_) all.push_back(each);
      const std::string near = closest(name, all);
      refuse_use(unit, Code::kUnknownTemplate, use.pattern.span,
                 "there is no template '" + name + "'",
                 near.empty() ? "INCLUDE the file that has it, as in INCLUDE \"packs/nav2.rules\""
                              : "did you mean '" + near + "'?",
                 replacement(use.pattern.span, near));
      return nullptr;
    }
    if (std::find(open.begin(), open.end(), known->second.pattern) != open.end()) {
      std::string cycle;
      for (const syntax::Template* each : open) cycle += each->name.text + " uses ";
      refuse_use(unit, Code::kEndlessTemplate, use.pattern.span,
                 "template '" + name + "' would use itself: " + cycle + name,
                 "leave one of the USEs out");
      return nullptr;
    }
    if (open.size() >= kMaxDepth) {
      refuse_use(unit, Code::kEndlessTemplate, use.pattern.span,
                 "templates use one another more than " + std::to_string(kMaxDepth) + " deep",
                 "leave some of them out");
      return nullptr;
    }
    return &known->second;
  }

  ComposedText instance(const Surroundings& unit, const syntax::Use& use,
                        std::vector<const syntax::Template*> open) {
    if (mistakes_.size() >= kEnoughMistakes || is_too_much_) return {};
    const Known* known = used_template(unit, use, open);
    if (known == nullptr) return {};
    const syntax::Template& pattern = *known->pattern;
    const auto arguments = arguments_of(unit.text, use, pattern, known->file, steps_);
    if (!arguments) {
      refuse_use(unit, Code::kTemplateArguments, use.span, wrong_count(use, pattern),
                 "it is USE " + usage_of(pattern));
      return {};
    }

    ++uses_;
    const Piece& piece = piece_of(unit.text, use.span.begin);
    steps_.push_back({Step::Kind::kUse,
                      origin_of(use.span, unit.text.pieces, steps_, unit.text.size()).place,
                      piece.step});
    const File& file = files_[known->file];
    const auto step = static_cast<std::uint32_t>(steps_.size() - 1);
    ComposedText filled = filled_in(pattern, known->file, file.source, file.lexemes, *arguments,
                                    step, kMaxExpanded - expanded_);
    if (!fits(unit, use, filled.text.size())) return {};
    Unit body(std::move(filled));
    if (!body.said.empty()) {
      std::vector<Diagnostic> said = of_arguments(body);
      for (Diagnostic& each : said) compare_order(each, body, pattern);
      blame(body.text, std::move(said));
      return {};
    }
    rules_ += body.tree.rules.size();
    if (!fits(unit, use, 0)) return {};
    change(unit, use, body, names_.own_constants(body.tree));
    if (!body.tree.uses.empty()) {
      open.push_back(&pattern);
      names_.enter(body.tree);
      ComposedText text = spliced({body.text, body.source, body.tree}, open);
      names_.leave();
      body = Unit(std::move(text));
      open.pop_back();
    }
    if (use.in) change(unit, use, body, names_.below(use.in->text, body.tree, body.source));
    if (open.empty()) {
      change(unit, use, body, names_.giving_way(body.tree, body.source));
      names_.add(body.tree);
    }
    return std::move(body.text);
  }

  // Counts what `use` adds. False, and said once, if it is too much.
  bool fits(const Surroundings& unit, const syntax::Use& use, std::size_t bytes) {
    const auto refuse = [&](const std::string& what) {
      is_too_much_ = true;
      refuse_use(unit, Code::kEndlessTemplate, use.pattern.span,
                 "with this USE, templates expand to more than " + what,
                 "use fewer templates, or write fewer USEs into them");
      return false;
    };
    if (is_too_much_) return false;
    expanded_ += bytes;
    if (uses_ > kMaxUses) return refuse(std::to_string(kMaxUses) + " USEs");
    if (rules_ > kMaxRules) return refuse(std::to_string(kMaxRules) + " rules");
    if (expanded_ > kMaxExpanded) return refuse("4 MiB of text");
    return true;
  }

  // The template's lines are right by themselves: one mistake for each argument that does not fit.
  std::vector<Diagnostic> of_arguments(const Unit& body) const {
    std::vector<Diagnostic> kept;
    std::set<std::uint32_t> seen;
    for (const Diagnostic& d : body.said) {
      const Origin origin = origin_of(d.span, body.text.pieces, steps_, body.text.size());
      if (origin.goes_in && seen.insert(origin.place.span.begin).second) kept.push_back(d);
    }
    if (kept.empty()) kept.push_back(body.said.front());
    return kept;
  }

  // A full name where a name or a value belongs: most often two arguments were exchanged.
  void compare_order(Diagnostic& said, const Unit& body, const syntax::Template& pattern) const {
    const Origin origin = origin_of(said.span, body.text.pieces, steps_, body.text.size());
    const std::string_view written = files_[origin.place.file].source.text(origin.place.span);
    if (!origin.goes_in || said.code != Code::kSyntax || !written.starts_with('/')) return;
    said.cause = "'" + std::string(written) +
                 "' does not fit here: it is the full name of a topic or a node";
    said.remedy = "compare the order of the arguments: USE " + usage_of(pattern);
    said.fix.reset();
  }

  // `body` is what `use`, which stands in `unit`, becomes.
  void change(const Surroundings& unit, const syntax::Use& use, Unit& body,
              std::vector<Replacement> by) {
    std::size_t bytes = 0;
    for (const Replacement& each : by) bytes += each.text.size();
    if (!by.empty() && fits(unit, use, bytes)) body = Unit(replaced(body.text, std::move(by)));
  }

  // ---- Mistakes

  // In a file.
  void blame(std::uint32_t index, Diagnostic diagnostic) {
    File& file = files_[index];
    if (file.wreck_begin == Step::kNone) {
      file.wreck_begin = wreck_.size();
      const ComposedText text = whole(index);
      wreck_.add(text, {0, text.size()});
    }
    add_mistake(std::move(diagnostic), file.wreck_begin);
  }

  // In a text on its way.
  void blame(const ComposedText& text, std::vector<Diagnostic> diagnostics) {
    if (!mistakes_.empty() && wreck_.text.size() + text.text.size() > Source::kMaxSize) return;
    const std::uint32_t begin = wreck_.size();
    wreck_.add(text, {0, text.size()});
    for (Diagnostic& d : diagnostics) add_mistake(std::move(d), begin);
  }

  void add_mistake(Diagnostic diagnostic, std::uint32_t offset) {
    const auto moved = [offset](Span span) { return Span{span.begin + offset, span.end + offset}; };
    diagnostic.span = moved(diagnostic.span);
    if (diagnostic.fix) diagnostic.fix->span = moved(diagnostic.fix->span);
    mistakes_.push_back(std::move(diagnostic));
  }

  const RuleLoader& load_;
  std::deque<File> files_;  // what points into them stays right
  std::set<std::string> known_files_;
  std::map<std::string, Known, std::less<>> templates_;
  std::vector<Step> steps_;
  DeclaredNames names_;
  std::size_t size_ = 0;              // of the files that are included
  std::size_t expanded_ = 0;          // bytes of what templates became
  std::size_t uses_ = 0;              // of templates
  std::size_t rules_ = 0;             // of what they became
  bool is_too_much_ = false;          // and was said
  std::vector<Diagnostic> mistakes_;  // their spans are of wreck_
  ComposedText wreck_;                // what has mistakes, one behind the other
};

}  // namespace

bool has_reuse(const Source& source) {
  constexpr std::array<std::string_view, 3> kWords = {"INCLUDE", "TEMPLATE", "USE"};
  for (std::uint32_t number = 1; number <= source.line_count(); ++number) {
    const std::string_view line = unindented(source.text(source.line(number)));
    const char first = line.empty() ? '\0' : line.front();
    if (first != 'I' && first != 'T' && first != 'U') continue;
    for (const std::string_view word : kWords) {
      if (line.starts_with(word) &&
          Scanner(line, {0, static_cast<std::uint32_t>(line.size())}).next().text == word)
        return true;
    }
  }
  return false;
}

Expansion expand(Source source, const RuleLoader& load) {
  if (!has_reuse(source)) return {std::move(source), {}, {}};
  return Expander(load).expand(std::move(source));
}

}  // namespace culprit

#include "language/reuse/instance.h"

#include <algorithm>
#include <array>

#include "language/occurrences.h"

namespace culprit {
namespace {

// Topics of ROS, for all robots of a domain.
constexpr std::array<std::string_view, 4> kOfNoRobot = {"/clock", "/diagnostics",
                                                        "/parameter_events", "/rosout"};

bool is_quoted(std::string_view text) {
  return text.size() >= 2 && text.front() == '"' && text.back() == '"';
}

std::string_view without_quotes(std::string_view text) {
  return is_quoted(text) ? text.substr(1, text.size() - 2) : text;
}

}  // namespace

const Piece& piece_of(const ComposedText& text, std::uint32_t offset) {
  const auto after =
      std::upper_bound(text.pieces.begin(), text.pieces.end(), offset,
                       [](std::uint32_t at, const Piece& p) { return at < p.begin; });
  return after == text.pieces.begin() ? *after : *std::prev(after);
}

std::optional<std::vector<TemplateArgument>> arguments_of(const ComposedText& text,
                                                          const syntax::Use& use,
                                                          const syntax::Template& pattern,
                                                          std::uint32_t file,
                                                          const std::vector<Step>& steps) {
  if (use.arguments.size() > pattern.parameters.size()) return std::nullopt;
  std::vector<TemplateArgument> all;
  for (std::size_t i = 0; i < pattern.parameters.size(); ++i) {
    if (i < use.arguments.size()) {
      const Span span = use.arguments[i].span;
      const Origin origin = origin_of(span, text.pieces, steps, text.size());
      const Piece& piece = piece_of(text, span.begin);
      all.push_back({text.text.substr(span.begin, span.end - span.begin), origin.place,
                     origin.is_exact, piece.argument ? piece.argument_step : piece.step});
      continue;
    }
    const auto& usual = pattern.parameters[i].usual;
    if (!usual) return std::nullopt;
    all.push_back({usual->text, {file, usual->span}, false, Step::kNone});
  }
  return all;
}

std::string wrong_count(const syntax::Use& use, const syntax::Template& pattern) {
  const std::size_t count = use.arguments.size();
  const bool is_too_many = count > pattern.parameters.size();
  return "template '" + pattern.name.text + "' gets too " + (is_too_many ? "many" : "few") +
         " arguments: " + std::to_string(count);
}

std::string usage_of(const syntax::Template& pattern) {
  std::string out = pattern.name.text;
  const char* separator = "(";
  for (const auto& [name, usual] : pattern.parameters) {
    out += separator + name.text + (usual ? " = " + usual->text : "");
    separator = ", ";
  }
  return pattern.parameters.empty() ? out : out + ")";
}

ComposedText filled_in(const syntax::Template& pattern, std::uint32_t file, const Source& source,
                       const std::vector<Lexeme>& lexemes,
                       const std::vector<TemplateArgument>& arguments, std::uint32_t step,
                       std::size_t most) {
  ComposedText out;
  const std::string_view text = source.text();
  std::uint32_t done = pattern.lines.begin;
  const auto copy_up_to = [&](std::uint32_t end) {
    out.add(text.substr(done, end - done), {0, {file, {done, end}}, true, step});
  };
  auto lexeme = std::lower_bound(
      lexemes.begin(), lexemes.end(), pattern.lines.begin,
      [](const Lexeme& each, std::uint32_t begin) { return each.span.begin < begin; });
  for (; lexeme != lexemes.end() && lexeme->span.begin < pattern.lines.end; ++lexeme) {
    for (std::uint32_t at = lexeme->span.begin; at < lexeme->span.end; ++at) {
      const auto length =
          static_cast<std::uint32_t>(hole_length(text.substr(at, lexeme->span.end - at)));
      if (length == 0) continue;
      const auto parameter = std::find_if(
          pattern.parameters.begin(), pattern.parameters.end(),
          [&](const auto& each) { return each.name.text == text.substr(at + 1, length - 2); });
      if (parameter == pattern.parameters.end()) continue;  // of a quoted text
      if (out.text.size() > most) return out;
      const TemplateArgument& argument =
          arguments[static_cast<std::size_t>(parameter - pattern.parameters.begin())];
      copy_up_to(at);
      done = at + length;
      const bool is_whole = lexeme->span == Span{at, done};
      Piece piece{0,
                  {file, {at, done}},
                  false,
                  step,
                  argument.place,
                  argument.is_verbatim && is_whole,
                  argument.step};
      out.add(is_whole ? std::string_view(argument.written) : without_quotes(argument.written),
              piece);
      at = done - 1;
    }
  }
  copy_up_to(pattern.lines.end);
  if (!out.text.empty() && out.text.back() != '\n')
    out.add_instead("\n", out, {out.size() - 1, out.size()});
  return out;
}

// ---- Names

void DeclaredNames::add(const syntax::File& tree) {
  for (const syntax::Constant& c : tree.constants) taken_.insert(c.name.text);
  for (const syntax::Signal& s : tree.signals) taken_.insert(s.name.text);
  for (const syntax::Group& g : tree.groups) taken_.insert(g.name.text);
  for (const syntax::Component& c : tree.components) {
    taken_.insert(c.name.text);
    components_.try_emplace(c.name.text, c.node ? c.node->text : "");
    if (c.node) by_node_.try_emplace(c.node->text, c.name.text);
  }
}

std::vector<Replacement> DeclaredNames::own_constants(const syntax::File& tree) {
  std::map<std::string, std::string> renamed;
  for (const syntax::Constant& c : tree.constants) {
    std::string name = c.name.text;
    int& tried = tried_.try_emplace(c.name.text, 1).first->second;
    while (!taken_.insert(name).second) name = c.name.text + "_" + std::to_string(++tried);
    if (name != c.name.text) renamed.try_emplace(c.name.text, name);
  }
  std::vector<Replacement> out;
  if (renamed.empty()) return out;
  for (const Occurrence& o : occurrences(tree)) {
    const auto other = renamed.find(o.name);
    if (o.kind == Occurrence::Kind::kConstant && other != renamed.end())
      out.push_back({o.span, other->second});
  }
  return out;
}

bool DeclaredNames::has_component(const std::string& name) const {
  return components_.contains(name) ||
         std::any_of(inside_.begin(), inside_.end(), [&](const syntax::File* tree) {
           return std::any_of(tree->components.begin(), tree->components.end(),
                              [&](const syntax::Component& c) { return c.name.text == name; });
         });
}

namespace {

std::set<std::string> own_names(const syntax::File& tree) {
  std::set<std::string> own;
  for (const syntax::Component& c : tree.components) own.insert(c.name.text);
  for (const syntax::Signal& s : tree.signals) own.insert(s.name.text);
  for (const syntax::Group& g : tree.groups) own.insert(g.name.text);
  return own;
}

}  // namespace

std::vector<Replacement> DeclaredNames::below(const std::string& space, const syntax::File& tree,
                                              const Source& source) const {
  std::string prefix = space.substr(1) + "_";
  std::replace(prefix.begin(), prefix.end(), '/', '_');
  const std::set<std::string> own = own_names(tree);
  std::vector<Replacement> out;
  const auto insert = [&](std::uint32_t at, const std::string& text) {
    out.push_back({{at, at}, text});
  };
  const auto full_name = [&](const syntax::Name& name) {
    if (!name.text.starts_with('/') ||
        std::find(kOfNoRobot.begin(), kOfNoRobot.end(), name.text) != kOfNoRobot.end())
      return;
    const bool quoted = source.text()[name.span.begin] == '"';
    insert(name.span.begin + (quoted ? 1 : 0), space);
  };
  for (const syntax::Component& c : tree.components) {
    for (const syntax::Name& other : c.other_nodes) full_name(other);
    if (c.node) {
      full_name(*c.node);
    } else {
      // The node of that name: now, in that namespace.
      insert(c.name.span.end, " NODE " + space + "/" + c.name.text);
    }
    if (c.container) full_name(*c.container);
  }
  for (const Occurrence& o : occurrences(tree)) {
    using enum Occurrence::Kind;
    switch (o.kind) {
      case kRule:
        insert(o.span.begin, prefix);
        break;
      case kSignal:
        if (own.contains(o.name)) insert(o.span.begin, prefix);
        break;
      case kComponent:
        if (own.contains(o.name)) {
          insert(o.span.begin, prefix);
        } else if (!o.name.starts_with('/') && !has_component(o.name)) {
          insert(o.span.begin, space + "/");
        } else {
          full_name({o.name, o.span});
        }
        break;
      case kTopic:
      case kService:
      case kAction:
        full_name({o.name, o.span});
        break;
      case kConstant:
      case kParameter:
      case kStrategy:
      case kFunction:
      case kDiagnostic:
      case kTemplate:
      case kHole:
      case kFile:
        break;
    }
  }
  return out;
}

namespace {

// Null: neither has it.
const std::string* known_in(const std::map<std::string, std::string>& first,
                            const std::map<std::string, std::string>& second,
                            const std::string& key) {
  for (const auto* each : {&first, &second}) {
    if (const auto found = each->find(key); found != each->end()) return &found->second;
  }
  return nullptr;
}

}  // namespace

std::vector<Replacement> DeclaredNames::giving_way(const syntax::File& tree,
                                                   const Source& source) const {
  std::map<std::string, std::string> names;  // of this tree, beside components_
  std::map<std::string, std::string> nodes;  // likewise, beside by_node_
  std::map<std::string, std::string> stands_for;
  std::vector<Replacement> out;
  std::set<std::uint32_t> commented;  // where the names of those stand
  for (const syntax::Component& c : tree.components) {
    const std::string node = c.node ? c.node->text : "";
    const std::string* same_node = known_in(by_node_, nodes, node);
    const std::string* same_name = known_in(components_, names, c.name.text);
    std::string other;
    if (c.node && same_node != nullptr) {
      other = *same_node;
    } else if (same_name != nullptr && (node.empty() || same_name->empty() || *same_name == node)) {
      other = c.name.text;
    }
    if (other.empty()) {
      names.try_emplace(c.name.text, node);
      if (c.node) nodes.try_emplace(node, c.name.text);
      continue;
    }
    const std::uint32_t line = source.line(source.position(c.name.span.begin).line).begin;
    out.push_back({{line, line}, "# declared elsewhere: "});
    commented.insert(c.name.span.begin);
    if (other != c.name.text) stands_for.try_emplace(c.name.text, other);
  }
  if (stands_for.empty()) return out;
  for (const Occurrence& o : occurrences(tree)) {
    const auto other = stands_for.find(o.name);
    const bool is_it = o.kind == Occurrence::Kind::kComponent && other != stands_for.end();
    if (is_it && !commented.contains(o.span.begin)) out.push_back({o.span, other->second});
  }
  return out;
}

}  // namespace culprit

#include "language/test_ebnf.h"

#include <algorithm>
#include <stdexcept>

#include "language/scanner.h"

namespace culprit {

struct Grammar::Node {
  enum class Kind {
    kEmpty,
    kTerminal,
    kSpecial,
    kProduction,
    kSequence,
    kChoice,
    kRepetition,
    kExcept
  };
  Kind kind = Kind::kEmpty;
  std::string text;        // of a terminal; the name of a production or a special sequence
  bool is_spaced = false;  // blanks may stand in front of it
  std::vector<std::unique_ptr<Node>> children;  // a sequence and an exception have two
};

namespace {

using Node = Grammar::Node;
using Kind = Node::Kind;
using NodePtr = std::unique_ptr<Node>;

constexpr int kEndless = 1000000;

bool is_token(const std::string& production) {
  return production.front() >= 'A' && production.front() <= 'Z';
}
bool is_word_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

NodePtr make(Kind kind, std::string text = "") {
  auto node = std::make_unique<Node>();
  node->kind = kind;
  node->text = std::move(text);
  return node;
}
NodePtr make(Kind kind, NodePtr first, NodePtr second) {
  auto node = make(kind);
  node->children.push_back(std::move(first));
  if (second) node->children.push_back(std::move(second));
  return node;
}

// ---- The text of a grammar

class Reader {
 public:
  explicit Reader(const std::string& text) : text_(text) {}

  std::map<std::string, NodePtr> grammar() {
    std::map<std::string, NodePtr> bodies;
    for (skip(); at_ < text_.size(); skip()) {
      const std::string name = word();
      inside_token_ = is_token(name);
      expect('=');
      if (!bodies.emplace(name, choice()).second) fail(name + " is defined twice");
      expect(';');
    }
    return bodies;
  }

 private:
  NodePtr choice() {
    NodePtr node = sequence();
    if (!sees('|')) return node;
    auto all = make(Kind::kChoice, std::move(node), nullptr);
    while (takes('|')) all->children.push_back(sequence());
    return all;
  }

  NodePtr sequence() {
    NodePtr first = exception();
    return takes(',') ? make(Kind::kSequence, std::move(first), sequence()) : std::move(first);
  }

  NodePtr exception() {
    NodePtr all = piece();
    return takes('-') ? make(Kind::kExcept, std::move(all), piece()) : std::move(all);
  }

  NodePtr piece() {
    if (takes('(')) return closed(choice(), ')');
    if (takes('[')) return closed(make(Kind::kChoice, choice(), make(Kind::kEmpty)), ']');
    if (takes('{')) return closed(make(Kind::kRepetition, choice(), nullptr), '}');
    for (const char quote : {'"', '\''}) {
      if (takes(quote)) return spaced(make(Kind::kTerminal, until(quote)));
    }
    if (takes('?')) {
      const std::string name = until('?');
      return make(Kind::kSpecial, name.substr(1, name.size() - 2));
    }
    NodePtr production = make(Kind::kProduction, word());
    return is_token(production->text) ? spaced(std::move(production)) : std::move(production);
  }

  NodePtr spaced(NodePtr node) const {
    node->is_spaced = !inside_token_;
    return node;
  }
  NodePtr closed(NodePtr node, char close) {
    expect(close);
    return node;
  }

  std::string word() {
    skip();
    const std::size_t begin = at_;
    while (at_ < text_.size() && is_word_character(text_[at_])) ++at_;
    if (at_ == begin) fail("a name is missing");
    return text_.substr(begin, at_ - begin);
  }
  std::string until(char quote) {
    const std::size_t end = text_.find(quote, at_);
    if (end == std::string::npos || end < at_ + 1) fail("a quotation is empty or open");
    const std::string out = text_.substr(at_, end - at_);
    at_ = end + 1;
    return out;
  }

  void skip() {
    while (at_ < text_.size()) {
      if (text_.compare(at_, 2, "(*") == 0)
        at_ = std::min(text_.find("*)", at_), text_.size() - 2) + 2;
      else if (is_blank(text_[at_]) || text_[at_] == '\n')
        ++at_;
      else
        return;
    }
  }
  bool sees(char c) {
    skip();
    return at_ < text_.size() && text_[at_] == c;
  }
  bool takes(char c) {
    const bool seen = sees(c);
    if (seen) ++at_;
    return seen;
  }
  void expect(char c) {
    if (!takes(c)) fail(std::string("expected ") + c);
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw std::runtime_error("grammar: " + what + " in front of: " + text_.substr(at_, 40));
  }

  const std::string& text_;
  std::size_t at_ = 0;
  bool inside_token_ = false;
};

void demand_definitions(const Node& node, const std::map<std::string, NodePtr>& bodies,
                        const Grammar::Specials& specials) {
  const bool known = (node.kind != Kind::kProduction || bodies.contains(node.text)) &&
                     (node.kind != Kind::kSpecial || specials.contains(node.text));
  if (!known) throw std::runtime_error("grammar: " + node.text + " is not defined");
  for (const NodePtr& child : node.children) demand_definitions(*child, bodies, specials);
}

// ---- Taking a text apart: where each piece can end, once for each place.

class Derivation {
 public:
  using Ends = std::set<std::size_t>;

  Derivation(const std::map<std::string, NodePtr>& bodies, const Grammar::Specials& specials,
             const std::string& text)
      : bodies_(bodies), specials_(specials), text_(text) {}

  const Ends& ends(const Node& node, std::size_t at) {
    const auto [found, is_new] = known_.try_emplace({&node, at});
    if (is_new) {
      Ends all = find_ends(node, node.is_spaced ? skip_blanks(at) : at);
      known_[{&node, at}] = std::move(all);
    }
    return known_[{&node, at}];
  }

  // @pre `node` can stand from `begin` to `end`. Longer pieces come first.
  void mark(const Node& node, std::size_t begin, std::size_t end, Grammar::Productions& used) {
    if (node.is_spaced) begin = skip_blanks(begin);
    switch (node.kind) {
      case Kind::kProduction:
        used.insert(node.text);
        return mark(*bodies_.at(node.text), begin, end, used);
      case Kind::kChoice:
        for (const NodePtr& child : node.children) {
          if (ends(*child, begin).contains(end)) return mark(*child, begin, end, used);
        }
        return;
      case Kind::kExcept:
        return mark(*node.children[0], begin, end, used);
      case Kind::kSequence:
        return mark_parts(*node.children[0], *node.children[1], begin, end, used);
      case Kind::kRepetition:
        while (begin != end) begin = mark_first(*node.children[0], node, begin, end, used);
        return;
      default:
        return;
    }
  }

 private:
  void mark_parts(const Node& first, const Node& rest, std::size_t begin, std::size_t end,
                  Grammar::Productions& used) {
    mark(rest, mark_first(first, rest, begin, end, used), end, used);
  }

  // Gives where `first` ends, so that `rest` can follow.
  std::size_t mark_first(const Node& first, const Node& rest, std::size_t begin, std::size_t end,
                         Grammar::Productions& used) {
    const Ends middles = ends(first, begin);
    for (auto middle = middles.rbegin(); middle != middles.rend(); ++middle) {
      // A repetition goes on, or it would go on for ever.
      const bool repeats = rest.kind == Kind::kRepetition && rest.children[0].get() == &first;
      if (repeats && *middle == begin) continue;
      if (!ends(rest, *middle).contains(end)) continue;
      mark(first, begin, *middle, used);
      return *middle;
    }
    throw std::logic_error("a derivation that is not one");
  }

  Ends find_ends(const Node& node, std::size_t at) {
    switch (node.kind) {
      case Kind::kEmpty:
        return {at};
      case Kind::kTerminal: {
        const std::size_t end = at + node.text.size();
        const bool grows_on = node.is_spaced && is_word_character(node.text.back()) &&
                              end < text_.size() && is_word_character(text_[end]);
        return text_.compare(at, node.text.size(), node.text) == 0 && !grows_on ? Ends{end}
                                                                                : Ends{};
      }
      case Kind::kSpecial: {
        const auto length = specials_.at(node.text).match(text_, at);
        return length ? Ends{at + *length} : Ends{};
      }
      case Kind::kProduction:
        return ends(*bodies_.at(node.text), at);
      case Kind::kChoice: {
        Ends all;
        for (const NodePtr& child : node.children) all.merge(Ends(ends(*child, at)));
        return all;
      }
      case Kind::kExcept: {
        Ends all = ends(*node.children[0], at);
        for (const std::size_t end : ends(*node.children[1], at)) all.erase(end);
        return all;
      }
      case Kind::kSequence: {
        Ends all;
        for (const std::size_t middle : Ends(ends(*node.children[0], at)))
          all.merge(Ends(ends(*node.children[1], middle)));
        return all;
      }
      case Kind::kRepetition: {
        Ends all = {at};
        // Ends lie behind beginnings, so the set grows only behind the place at hand.
        for (auto from = all.begin(); from != all.end(); ++from)
          all.merge(Ends(ends(*node.children[0], *from)));
        return all;
      }
    }
    return {};
  }

  std::size_t skip_blanks(std::size_t at) const {
    while (at < text_.size() && is_blank(text_[at])) ++at;
    return at;
  }

  const std::map<std::string, NodePtr>& bodies_;
  const Grammar::Specials& specials_;
  const std::string& text_;
  std::map<std::pair<const Node*, std::size_t>, Ends> known_;
};

// ---- Making sentences

class Sentence {
 public:
  Sentence(const std::map<std::string, NodePtr>& bodies, const Grammar::Specials& specials,
           std::mt19937& random, Grammar::Productions& used)
      : bodies_(bodies), specials_(specials), random_(random), used_(used) {
    find_heights();
  }

  std::string make(const std::string& production, int depth) {
    used_.insert(production);
    return make(*bodies_.at(production), depth - 1, is_short(production) ? 1 : 3);
  }

 private:
  // A number with an exponent of three digits is out of range.
  static bool is_short(const std::string& production) { return production == "Exponent"; }

  std::string make(const Node& node, int depth, int repetitions) {
    switch (node.kind) {
      case Kind::kEmpty:
        return "";
      case Kind::kTerminal:
        return blanks(node) + node.text;
      case Kind::kSpecial: {
        const auto& samples = specials_.at(node.text).samples;
        return samples[below(samples.size())];
      }
      case Kind::kProduction:
        return blanks(node) + make(node.text, depth);
      case Kind::kSequence: {
        std::string first = make(*node.children[0], depth, repetitions);
        return first + make(*node.children[1], depth, repetitions);
      }
      case Kind::kChoice:
        return make(choose(node, depth), depth, repetitions);
      case Kind::kRepetition: {
        std::string out;
        // Few: what repeats is nested in what repeats, and the sizes multiply.
        const int most = depth > height(*node.children[0]) ? repetitions : 0;
        for (int n = 0; n < most && below(3) == 0; ++n)
          out += make(*node.children[0], depth, repetitions);
        return out;
      }
      case Kind::kExcept:
        // Deeper and deeper: the shortest ones may all be excepted.
        for (;; ++depth) {
          const std::string out = make(*node.children[0], depth, repetitions);
          if (!Derivation(bodies_, specials_, out).ends(*node.children[1], 0).contains(out.size()))
            return out;
        }
    }
    return "";
  }

  const Node& choose(const Node& choice, int depth) {
    std::vector<const Node*> fitting;
    for (const NodePtr& child : choice.children) {
      if (height(*child) <= std::max(depth, height(choice))) fitting.push_back(child.get());
    }
    return *fitting[below(fitting.size())];
  }

  std::string blanks(const Node& node) {
    static const std::vector<std::string> kBlanks = {" ", "  ", "\t", " \r"};
    return node.is_spaced ? kBlanks[below(kBlanks.size())] : "";
  }

  std::size_t below(std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random_);
  }

  // How deep the shortest sentence of each production nests: the least fixed point.
  void find_heights() {
    for (const auto& [name, body] : bodies_) heights_[name] = kEndless;
    for (bool changed = true; changed;) {
      changed = false;
      for (const auto& [name, body] : bodies_) {
        const int now = std::min(kEndless, height(*body) + 1);
        if (now < heights_[name]) changed = true;
        heights_[name] = std::min(heights_[name], now);
      }
    }
  }

  int height(const Node& node) const {
    switch (node.kind) {
      case Kind::kProduction:
        return heights_.at(node.text);
      case Kind::kChoice: {
        int least = kEndless;
        for (const NodePtr& child : node.children) least = std::min(least, height(*child));
        return least;
      }
      case Kind::kSequence:
        return std::max(height(*node.children[0]), height(*node.children[1]));
      case Kind::kExcept:
        return height(*node.children[0]);
      case Kind::kSpecial:
        return specials_.at(node.text).samples.empty() ? kEndless : 0;
      default:
        return 0;
    }
  }

  const std::map<std::string, NodePtr>& bodies_;
  const Grammar::Specials& specials_;
  std::mt19937& random_;
  Grammar::Productions& used_;
  std::map<std::string, int> heights_;
};

}  // namespace

Grammar::Grammar(const std::string& text, Specials specials) : specials_(std::move(specials)) {
  bodies_ = Reader(text).grammar();
  for (const auto& [name, body] : bodies_) demand_definitions(*body, bodies_, specials_);
}

Grammar::~Grammar() = default;

Grammar::Productions Grammar::productions() const {
  Productions names;
  for (const auto& [name, body] : bodies_) names.insert(name);
  return names;
}

std::string Grammar::sentence(const std::string& start, int depth, std::mt19937& random,
                              Productions& used) const {
  return Sentence(bodies_, specials_, random, used).make(start, depth);
}

std::optional<Grammar::Productions> Grammar::derive(const std::string& start,
                                                    const std::string& text) const {
  Derivation derivation(bodies_, specials_, text);
  const Node& body = *bodies_.at(start);
  if (!derivation.ends(body, 0).contains(text.size())) return std::nullopt;
  Productions used = {start};
  derivation.mark(body, 0, text.size(), used);
  return used;
}

}  // namespace culprit

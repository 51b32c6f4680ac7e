#include "rule_test/answer_reader.h"

#include <set>
#include <string>
#include <vector>

#include "language/foreign_words.h"

namespace culprit::rule_test {
namespace {

using syntax::Name;

class AnswerReader {
 public:
  AnswerReader(Scanner& scanner, LineReader& read, Names& names, const RuleSet& rules,
               Scenario& scenario)
      : s_(scanner), read_(read), names_(names), rules_(rules), scenario_(scenario) {}

  // Everywhere in the rules where this component is adapted in this way.
  bool adaptation() {
    const auto name = read_.component_reference(s_);
    const auto component = name ? names_.component(*name) : std::nullopt;
    if (!component) return false;
    const Token word = s_.next();
    const auto type = syntax::adaptation_type(word.text);
    if (!type) return unknown_adaptation(*component, word);
    std::optional<Name> subject;
    if (!is_answer(s_.peek().text) && has_place(*component, *type)) {
      if (has_place(*component, *type, ""))
        return read_.unexpected_clause(s_.next(), kAnswers,
                                       s_.at_end() ? "add for example TAKES 2s" : "");
      subject = read_.name_or_text(s_, kAnswersText);
      if (!subject) return false;
    }
    std::vector<Place> places;
    for (std::size_t i = 0; i < rules_.strategies.size(); ++i) {
      const auto& adaptations = rules_.strategies[i].adaptations;
      for (std::size_t a = 0; a < adaptations.size(); ++a) {
        const bool same = adaptations[a].component == *component && adaptations[a].type == *type &&
                          (!subject || adaptations[a].subject == subject->text);
        if (same) places.push_back({StrategyId(i), a});
      }
    }
    if (places.empty())
      return read_.fail(Code::kUnknownName,
                        {name->span.begin, (subject ? subject->span : word.span).end},
                        "no strategy of the rules adapts " + name->text + " in this way",
                        adaptations_of(*component));
    return answers(places);
  }

  bool strategy() {
    const auto name = read_.name_or_text(s_, "a strategy");
    const auto id = name ? names_.strategy(*name) : std::nullopt;
    return id && answers({{*id, std::nullopt}});
  }

 private:
  struct Place {
    StrategyId strategy;
    std::optional<std::size_t> adaptation;  // nothing: all of them
  };
  static constexpr const char* kAnswersText = "HEALS, TAKES, REFUSED or UNANSWERED";
  static inline const std::vector<std::string_view> kAnswers = {"HEALS", "TAKES", "REFUSED",
                                                                "UNANSWERED"};

  template <class Take>
  void each_adaptation(ComponentId component, Take take) const {
    for (const Strategy& strategy : rules_.strategies) {
      for (const Adaptation& adaptation : strategy.adaptations) {
        if (adaptation.component == component) take(adaptation);
      }
    }
  }

  bool has_place(ComponentId component, syntax::AdaptationType type,
                 std::optional<std::string_view> subject = {}) const {
    bool is_there = false;
    each_adaptation(component, [&](const Adaptation& a) {
      is_there = is_there || (a.type == type && (!subject || a.subject == *subject));
    });
    return is_there;
  }

  // "they use restart, set_parameter focus"; empty: the rules leave the component alone.
  std::string adaptations_of(ComponentId component) const {
    std::set<std::string> ways;
    each_adaptation(component, [&](const Adaptation& a) {
      ways.insert(std::string(syntax::keyword(a.type)) + (a.subject.empty() ? "" : " ") +
                  a.subject);
    });
    std::string list;
    for (const std::string& way : ways) list += (list.empty() ? "they use " : ", ") + way;
    return list;
  }

  bool unknown_adaptation(ComponentId component, const Token& word) {
    std::string near = closest(word.text, syntax::adaptation_keywords());
    if (near.empty()) near = adaptation_of_other_tools(word.text);
    return read_.fail_token(
        word, "an adaptation, such as restart or set_parameter",
        near.empty() ? adaptations_of(component) : "did you mean " + near + "?");
  }

  static bool is_answer(std::string_view word) {
    return word == "HEALS" || word == "TAKES" || word == "REFUSED" || word == "UNANSWERED";
  }

  bool answers(const std::vector<Place>& places) {
    do {
      const Token word = s_.next();
      if (word.text == "HEALS") {
        if (!heals(places)) return false;
      } else if (word.text == "TAKES") {
        const auto time = read_.duration(s_, "how long it takes");
        if (!time) return false;
        answer(places, {}, time);
      } else if (word.text == "REFUSED") {
        answer(places, Answer::Manner::kRefuses, {});
      } else if (word.text == "UNANSWERED") {
        answer(places, Answer::Manner::kNeverAnswers, {});
      } else {
        return read_.unexpected_clause(word, kAnswers);
      }
    } while (!s_.at_end());
    return true;
  }

  void answer(const std::vector<Place>& places, std::optional<Answer::Manner> manner,
              std::optional<Duration> takes) {
    for (const Place& place : places) {
      const std::size_t count = rules_[place.strategy].adaptations.size();
      for (std::size_t a = 0; a < count; ++a) {
        if (place.adaptation && *place.adaptation != a) continue;
        scenario_.answers.push_back({place.strategy, a, manner, takes});
      }
    }
  }

  // "HEALS /topic signal AFTER 300ms"
  bool heals(const std::vector<Place>& places) {
    Cure cure;
    do {
      if (const Token& next = s_.peek();
          next.kind == Token::Kind::kDuration && !cure.subjects.empty())
        return read_.fail(Code::kSyntax, next.span, "AFTER is missing before this",
                          "write AFTER in front of it",
                          Edit{{next.span.begin, next.span.begin}, "AFTER "});
      if (const Token& next = s_.peek();
          !cure.subjects.empty() && (next.text == "IN" || next.text == "WITHIN"))
        return read_.fail(Code::kSyntax, next.span,
                          "unexpected '" + std::string(next.text) + "' in front of a time",
                          "did you mean AFTER?", Edit{next.span, "AFTER"});
      const auto name = read_.name_or_text(s_, "a topic or a signal");
      const auto subject = name ? names_.topic_or_signal(*name) : std::nullopt;
      if (!subject) return false;
      cure.subjects.push_back(*subject);
    } while (!s_.at_end() && !is_answer(s_.peek().text) && s_.peek().text != "AFTER");
    if (s_.peek().text == "AFTER") {
      s_.next();
      const auto after = read_.duration(s_, "how long after it took effect");
      if (!after) return false;
      cure.after = *after;
    }
    for (const Place& place : places) {
      cure.strategy = place.strategy;
      cure.adaptation = place.adaptation;
      scenario_.cures.push_back(cure);
    }
    return true;
  }

  Scanner& s_;
  LineReader& read_;
  Names& names_;
  const RuleSet& rules_;
  Scenario& scenario_;
};

}  // namespace

bool read_answers_of_adaptation(Scanner& scanner, LineReader& read, Names& names,
                                const RuleSet& rules, Scenario& scenario) {
  return AnswerReader(scanner, read, names, rules, scenario).adaptation();
}

bool read_answers_of_strategy(Scanner& scanner, LineReader& read, Names& names,
                              const RuleSet& rules, Scenario& scenario) {
  return AnswerReader(scanner, read, names, rules, scenario).strategy();
}

}  // namespace culprit::rule_test

#include "drill/write_back.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "language/parser.h"

namespace culprit::drill {
namespace {

constexpr std::string_view kMark = "drill ";

// Edits of a text, and of the comment at the end of each line that they touch.
class Edits {
 public:
  explicit Edits(std::string_view text) : text_(text) {}

  // Not if that is what stands there.
  void replace(Span span, const std::string& with, const std::string& why) {
    if (text_.substr(span.begin, span.end - span.begin) == with) return;
    edits_[span.begin] = {span, with};
    notes_[end_of_line(span.begin)] = why;
  }

  // The value behind a word of the statement; the word is added where it is missing.
  void set_clause(Span statement, const std::string& word, const std::string& value,
                  const std::string& why) {
    const std::string_view text = text_.substr(statement.begin, statement.end - statement.begin);
    const std::size_t at = text.find(" " + word + " ");
    if (at == std::string_view::npos)
      return replace({statement.end, statement.end}, " " + word + " " + value, why);
    const std::size_t from = text.find_first_not_of(' ', at + word.size() + 2);
    if (from == std::string_view::npos) return;
    const std::size_t end = std::min(text.find(' ', from), text.size());
    replace({statement.begin + static_cast<std::uint32_t>(from),
             statement.begin + static_cast<std::uint32_t>(end)},
            value, why);
  }

  std::string done() const {
    std::map<std::uint32_t, std::pair<Span, std::string>> all = edits_;
    for (const auto& [end, why] : notes_) {
      const std::string_view line = text_.substr(begin_of_line(end), end - begin_of_line(end));
      const std::size_t old = line.rfind(kMark);
      const std::size_t comment = line.find('#');
      if (comment == std::string_view::npos) {
        all[end] = {{end, end}, "    # " + why};
      } else if (old != std::string_view::npos && old > comment) {
        const auto begin = static_cast<std::uint32_t>(begin_of_line(end) + old);
        all[begin] = {{begin, end}, why};
      } else {
        all[end] = {{end, end}, "; " + why};
      }
    }
    std::string out;
    std::uint32_t from = 0;
    for (const auto& [begin, edit] : all) {
      out += text_.substr(from, begin - from);
      out += edit.second;
      from = edit.first.end;
    }
    return out + std::string(text_.substr(from));
  }

  std::uint32_t begin_of_line(std::size_t at) const {
    const std::size_t before = at == 0 ? std::string_view::npos : text_.rfind('\n', at - 1);
    return before == std::string_view::npos ? 0 : static_cast<std::uint32_t>(before + 1);
  }
  std::uint32_t end_of_line(std::size_t at) const {
    std::size_t end = text_.find('\n', at);
    if (end == std::string_view::npos) end = text_.size();
    while (end > at && (text_[end - 1] == '\r' || text_[end - 1] == ' ')) --end;
    return static_cast<std::uint32_t>(end);
  }

 private:
  std::string_view text_;
  std::map<std::uint32_t, std::pair<Span, std::string>> edits_;
  std::map<std::uint32_t, std::string> notes_;  // by the end of a line
};

class WriteBack {
 public:
  WriteBack(const syntax::File& file, std::string_view text, const Results& results)
      : file_(file), results_(results), edits_(text) {}

  WrittenBack done() {
    for (const StrategyResult& each : results_.strategies) strategy(each);
    thresholds();
    for (const ThresholdMeasure& each : results_.thresholds) hold(each);
    for (const auto& [component, times] : results_.starts) ready(component, times);
    return {dependencies(edits_.done()), std::move(unwritten_)};
  }

 private:
  std::string why(int times) const {
    return fmt::format("{}{}, {} times", kMark, results_.date, times);
  }

  const syntax::Strategy* find(const StrategyResult& wanted) const {
    for (const syntax::Rule& rule : file_.rules) {
      for (const syntax::Strategy& each : rule.strategies) {
        if (rule.name.text == wanted.rule && each.name.text == wanted.strategy) return &each;
      }
    }
    return nullptr;
  }

  void strategy(const StrategyResult& result) {
    if (result.tried < kRepeats) return;
    const syntax::Strategy* written = find(result);
    if (written == nullptr) {
      unwritten_.push_back(fmt::format("{}.{}: it stands in another file, or in a template",
                                       result.rule, result.strategy));
      return;
    }
    // A probability of 0 % is none of the language.
    const int percent =
        std::max(1, static_cast<int>(std::lround(100.0 * result.helped / result.tried)));
    edits_.replace(written->probability.span, std::to_string(percent), why(result.tried));
    edits_.replace(written->confidence.span, std::to_string(std::min(100, result.tried)),
                   why(result.tried));
    const auto times = static_cast<int>(result.effects.size());
    if (times < kRepeats) return;
    const std::string impact = std::to_string(impact_of(result.effects, results_.cycle));
    // The strategy's impact is the largest of its steps: which of several adaptations took so long is not known.
    if (written->adaptations.size() == 1)
      edits_.replace(written->adaptations.front().impact.span, impact, why(times));
  }

  std::string in_unit(const ThresholdMeasure& measure, double value) const {
    if (!measure.of.is_duration) return fmt::format("{:g}", value);
    return culprit::to_string(std::chrono::duration_cast<std::chrono::milliseconds>(
        from_seconds(value) + std::chrono::microseconds(500)));
  }

  // A constant that several rules use fits all of them.
  void thresholds() {
    std::map<std::uint32_t, std::vector<const ThresholdMeasure*>> by_place;
    for (const ThresholdMeasure& each : results_.thresholds)
      by_place[each.of.span.begin].push_back(&each);
    for (const auto& [place, measures] : by_place) {
      const auto is_proven = [](const ThresholdMeasure* each) { return each->is_proven(); };
      if (std::ranges::all_of(measures, is_proven)) continue;
      std::optional<double> value;
      std::size_t values = 0;
      bool are_all_measured = true;
      for (const ThresholdMeasure* each : measures) {
        // How far beyond its healthy values a signal is a failure, only a fault shows.
        const bool is_known = each->of.what != Comparison::What::kSignal || each->faulty;
        const auto proposed = is_known ? each->proposed() : std::nullopt;
        are_all_measured &= proposed.has_value() && each->of.is_above == measures[0]->of.is_above;
        if (!proposed) continue;
        value = !value              ? *proposed
                : each->of.is_above ? std::max(*value, *proposed)
                                    : std::min(*value, *proposed);
        values += each->values;
      }
      if (!value || !are_all_measured) continue;
      edits_.replace(measures[0]->of.span, in_unit(*measures[0], *value),
                     fmt::format("{}{}, {} values", kMark, results_.date, values));
    }
  }

  // Where no threshold separates healthy values from faulty ones, their duration may.
  void hold(const ThresholdMeasure& measure) {
    // A healthy value that is beyond it for longer shows no failure: the rule ends a safe stop, say.
    constexpr double kLongest = 2;  // seconds
    if (measure.longest_beyond <= 0 || measure.longest_beyond > kLongest || !measure.faulty ||
        measure.proposed())
      return;
    const auto written = std::ranges::find_if(
        file_.rules, [&](const syntax::Rule& r) { return r.name.text == measure.of.rule; });
    if (written == file_.rules.end() || !written->policies) return;
    const auto milliseconds = std::chrono::milliseconds(
        static_cast<std::int64_t>(std::ceil(2 * 1000 * measure.longest_beyond)));
    if (written->policies->hold_for && *written->policies->hold_for >= milliseconds) return;
    edits_.set_clause(written->policies->span, "FOR", culprit::to_string(milliseconds),
                      fmt::format("{}{}, {} values", kMark, results_.date, measure.values));
  }

  // A start may take as long as the longest that was measured. Without READY each start is one try; that stays.
  void ready(const std::string& component, const std::vector<double>& times) {
    const auto written = std::ranges::find_if(
        file_.components, [&](const syntax::Component& c) { return c.name.text == component; });
    if (written == file_.components.end() || !written->ready || times.size() < kRepeats) return;
    const std::chrono::seconds longest = ready_of(times);
    if (*written->ready >= longest) return;
    edits_.set_clause({written->name.span.begin, edits_.end_of_line(written->name.span.begin)},
                      "READY", culprit::to_string(Duration(longest)),
                      fmt::format("{}{}, {} starts", kMark, results_.date, times.size()));
  }

  // Behind the last COMPONENT or DEPENDENCY line; at the end if there is none.
  std::string dependencies(std::string text) const {
    std::string lines;
    for (const HiddenDependency& each : results_.hidden)
      lines += fmt::format("DEPENDENCY {} ON {}    # {}{}: silent in all {} faults of {}\n",
                           each.consumer, each.producer, kMark, results_.date, each.times,
                           each.producer);
    if (lines.empty()) return text;
    std::size_t at = text.size();
    for (const char* keyword : {"\nCOMPONENT ", "\nDEPENDENCY "}) {
      const std::size_t last = text.rfind(keyword);
      if (last == std::string::npos) continue;
      const std::size_t end = text.find('\n', last + 1);
      at = end == std::string::npos ? text.size() : end + 1;
    }
    if (at == text.size() && !text.ends_with('\n')) lines.insert(0, "\n");
    return text.insert(at, lines);
  }

  const syntax::File& file_;
  const Results& results_;
  Edits edits_;
  std::vector<std::string> unwritten_;
};

}  // namespace

Expected<WrittenBack> write_back(const std::string& name, const std::string& text,
                                 const Results& results) {
  const Source source(name, text);
  std::vector<Diagnostic> mistakes;
  const syntax::File file = parse(source, mistakes);
  const auto is_error = [](const Diagnostic& each) { return each.severity == Severity::kError; };
  if (std::ranges::any_of(mistakes, is_error))
    return Error{"'" + name + "' has errors by now; culprit check shows them"};
  return WriteBack(file, source.text(), results).done();
}

}  // namespace culprit::drill

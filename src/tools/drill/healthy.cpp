#include "drill/healthy.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <iterator>
#include <limits>
#include <map>

namespace culprit::drill {
namespace {

using syntax::Expression;
using syntax::Operator;

constexpr std::size_t kFewestValues = 10;
constexpr double kPauses = 3;  // silence is so many times the longest healthy pause

// The measured side of a comparison; nothing: it cannot be measured.
std::optional<Comparison> subject_in(const Expression& side) {
  Comparison out;
  if (side.kind == Expression::Kind::kName) {
    out.what = Comparison::What::kSignal;
    out.subject = side.name.text;
    return out;
  }
  const bool is_of_topic = side.kind == Expression::Kind::kCall && !side.children.empty() &&
                           side.children[0].kind == Expression::Kind::kName &&
                           side.children[0].children.empty();
  if (!is_of_topic || (side.name.text != "age" && side.name.text != "rate")) return std::nullopt;
  out.what = side.name.text == "age" ? Comparison::What::kAge : Comparison::What::kRate;
  out.subject = side.children[0].name.text;
  return out;
}

class Comparisons {
 public:
  explicit Comparisons(const syntax::File& file) {
    for (const syntax::Constant& each : file.constants)
      if (each.value.kind == Expression::Kind::kLiteral) constants_[each.name.text] = &each.value;
    for (const syntax::Rule& rule : file.rules) {
      rule_ = rule.name.text;
      if (rule.trigger) look(*rule.trigger);
    }
  }
  std::vector<Comparison> found;

 private:
  void look(const Expression& expression) {
    for (const Expression& child : expression.children) look(child);
    if (expression.kind != Expression::Kind::kBinary) return;
    const bool is_greater =
        expression.op == Operator::kGreater || expression.op == Operator::kGreaterEqual;
    const bool is_less = expression.op == Operator::kLess || expression.op == Operator::kLessEqual;
    if (!is_greater && !is_less) return;
    add(expression.children[0], expression.children[1], is_greater);
    add(expression.children[1], expression.children[0], is_less);
  }

  void add(const Expression& side, const Expression& limit, bool is_above) {
    auto out = subject_in(side);
    const Expression* number = &limit;
    if (limit.kind == Expression::Kind::kName) {
      const auto constant = constants_.find(limit.name.text);
      if (constant == constants_.end()) return;
      number = constant->second;
    }
    if (!out || number->kind != Expression::Kind::kLiteral || constants_.contains(out->subject))
      return;
    const syntax::Literal& literal = *number->literal;
    if (const auto* duration = std::get_if<Duration>(&literal)) {
      out->threshold = seconds(*duration);
      out->is_duration = true;
    } else if (const auto* whole = std::get_if<std::int64_t>(&literal)) {
      out->threshold = static_cast<double>(*whole);
    } else if (const auto* real = std::get_if<double>(&literal)) {
      out->threshold = *real;
    } else {
      return;
    }
    out->rule = rule_;
    out->is_above = is_above;
    if (number != &limit) out->constant = limit.name.text;
    out->span = number->span;
    found.push_back(std::move(*out));
  }

  std::map<std::string, const Expression*> constants_;
  std::string rule_;
};

std::optional<double> number_in(const Value& value) {
  // Diagnostics tell all values as texts.
  if (const auto* text = std::get_if<std::string>(&value)) {
    const Value read = value_from_text(*text);
    return std::holds_alternative<std::string>(read) ? std::nullopt : number_in(read);
  }
  if (const auto* whole = std::get_if<std::int64_t>(&value)) return static_cast<double>(*whole);
  if (const auto* real = std::get_if<double>(&value)) return *real;
  return std::nullopt;
}

// The course of one comparison's value.
class Meter {
 public:
  Meter(ThresholdMeasure& measure, Duration window, const std::vector<FaultyStretch>& faulty)
      : measure_(measure), window_(seconds(window)), faulty_(faulty) {}

  // A message of its topic.
  void arrived(double at) {
    if (measure_.of.what == Comparison::What::kAge) {
      if (last_) add(at, at - *last_, at - *last_ - measure_.of.threshold);
    } else {
      while (!arrivals_.empty() && arrivals_.front() <= at - window_) arrivals_.pop_front();
      if (first_ && at - *first_ > window_)
        add(at, static_cast<double>(arrivals_.size()) / window_, 0);
      arrivals_.push_back(at);
    }
    if (!first_) first_ = at;
    last_ = at;
  }

  void read(double at, double value) {
    const bool is_beyond =
        measure_.of.is_above ? value > measure_.of.threshold : value < measure_.of.threshold;
    if (!is_beyond || stretch(at) != nullptr) beyond_since_.reset();
    if (is_beyond && !beyond_since_) beyond_since_ = at;
    add(at, value, is_beyond ? at - *beyond_since_ : 0);
  }

  void end() {
    if (extremes_.empty()) return;
    double mildest = extremes_.begin()->second;
    for (const auto& [from, extreme] : extremes_)
      mildest = measure_.of.is_above ? std::min(mildest, extreme) : std::max(mildest, extreme);
    measure_.faulty = mildest;
  }

 private:
  const FaultyStretch* stretch(double at) const {
    for (const FaultyStretch& each : faulty_) {
      if (at >= each.from && at < each.until) return &each;
    }
    return nullptr;
  }

  void add(double at, double value, double beyond) {
    // A pause that a fault began is no healthy one, nor is that in which it ended.
    const FaultyStretch* fault = stretch(at);
    if (fault == nullptr && measure_.of.what != Comparison::What::kSignal && last_)
      fault = stretch(*last_);
    if (fault == nullptr && std::isfinite(value)) {
      if (measure_.values == 0) measure_.least = measure_.most = value;
      ++measure_.values;
      measure_.least = std::min(measure_.least, value);
      measure_.most = std::max(measure_.most, value);
      measure_.longest_beyond = std::max(measure_.longest_beyond, beyond);
    } else if (fault != nullptr && std::isfinite(value) &&
               std::ranges::find(fault->rules, measure_.of.rule) != fault->rules.end()) {
      const auto [extreme, is_new] = extremes_.try_emplace(fault->from, value);
      if (!is_new)
        extreme->second = measure_.of.is_above ? std::max(extreme->second, value)
                                               : std::min(extreme->second, value);
    }
  }

  ThresholdMeasure& measure_;
  const double window_;
  const std::vector<FaultyStretch>& faulty_;
  std::deque<double> arrivals_;
  std::optional<double> first_;
  std::optional<double> last_;
  std::optional<double> beyond_since_;
  std::map<double, double> extremes_;  // by the beginning of the stretch
};

// The window of rate(topic) in the rules.
Duration window_of(const Comparison& comparison, const RuleSet& rules) {
  for (const Input& input : rules.inputs) {
    if (input.kind == Input::Kind::kRate && rules[input.topic].name == comparison.subject)
      return input.window;
  }
  return std::chrono::seconds(1);
}

// To two digits that count.
double rounded(double number) {
  if (number == 0 || !std::isfinite(number)) return number;
  const double power = std::pow(10, std::floor(std::log10(std::abs(number))) - 1);
  return std::round(number / power) * power;
}

}  // namespace

std::vector<Comparison> comparisons_in(const syntax::File& file) {
  return std::move(Comparisons(file).found);
}

std::optional<double> ThresholdMeasure::proposed() const {
  if (values < kFewestValues) return std::nullopt;
  switch (of.what) {
    // A repair ends the silence, so nothing is known of how long it would have been.
    case Comparison::What::kAge:
      return of.is_above ? std::optional(rounded(kPauses * most)) : std::nullopt;
    case Comparison::What::kRate:
      if (of.is_above) return std::nullopt;
      break;
    case Comparison::What::kSignal:
      break;
  }
  const double edge = of.is_above ? most : least;
  if (faulty) {
    const bool are_apart = of.is_above ? *faulty > edge : *faulty < edge;
    // Thousands of values show how far healthy ones go, a few faults how far faulty ones do.
    return are_apart ? std::optional(rounded(edge + (*faulty - edge) / 4)) : std::nullopt;
  }
  if (of.what == Comparison::What::kRate) return rounded(least / 2);
  if (least == most) return std::nullopt;
  return rounded(of.is_above ? most + (most - least) : least - (most - least));
}

bool ThresholdMeasure::is_proven() const {
  constexpr double kClose = 1.25;
  constexpr double kMuchLonger = 2;
  if (values < kFewestValues) return false;
  if (of.what == Comparison::What::kAge)
    return of.is_above && of.threshold >= kClose * most &&
           of.threshold <= kMuchLonger * kPauses * most;
  const bool spares_healthy = of.is_above ? most < of.threshold : least > of.threshold;
  const bool shows_faulty =
      faulty && (of.is_above ? *faulty > of.threshold : *faulty < of.threshold);
  return spares_healthy && shows_faulty;
}

double ThresholdMeasure::most_an_hour() const {
  constexpr double kRuleOfThree = 3;  // of n values none was beyond: 95 % certain of less than 3/n
  constexpr double kHour = 3600;
  return looked > 0 ? kRuleOfThree * kHour / looked : std::numeric_limits<double>::infinity();
}

Expected<std::vector<ThresholdMeasure>> measure(replay::Recording& recording, double at_start,
                                                const std::vector<Comparison>& comparisons,
                                                const std::vector<FaultyStretch>& faulty) {
  const RuleSet& rules = recording.rules();
  const Time start = recording.session().start;
  std::vector<ThresholdMeasure> measures;
  for (const Comparison& each : comparisons) measures.push_back({.of = each});
  std::vector<Meter> meters;
  for (ThresholdMeasure& each : measures)
    meters.emplace_back(each, window_of(each.of, rules), faulty);
  if (auto rewound = recording.rewind(); !rewound) return Error{rewound.error()};
  double looked = 0;
  for (journal::Step step;;) {
    const auto more = recording.next(step);
    if (!more) return Error{more.error()};
    if (!*more) break;
    for (const Observation& observation : step.observations) {
      const double at = at_start + seconds(observation.at - start);
      const auto* sample = std::get_if<SampleArrived>(&observation.what);
      const auto* read = std::get_if<SignalRead>(&observation.what);
      for (std::size_t i = 0; i < meters.size(); ++i) {
        const bool is_of_topic = comparisons[i].what != Comparison::What::kSignal;
        if (sample != nullptr && is_of_topic && rules[sample->topic].name == comparisons[i].subject)
          meters[i].arrived(at);
        if (read == nullptr || is_of_topic || rules[read->signal].name != comparisons[i].subject)
          continue;
        if (const auto number = number_in(read->value)) meters[i].read(at, *number);
      }
    }
    looked = seconds(step.now - start);
  }
  for (const FaultyStretch& each : faulty) looked -= std::max(0.0, each.until - each.from);
  for (std::size_t i = 0; i < meters.size(); ++i) {
    meters[i].end();
    measures[i].looked = looked;
  }
  return measures;
}

void add(ThresholdMeasure& sum, const ThresholdMeasure& more) {
  if (sum.values == 0) {
    sum.least = more.least;
    sum.most = more.most;
  } else if (more.values > 0) {
    sum.least = std::min(sum.least, more.least);
    sum.most = std::max(sum.most, more.most);
  }
  sum.values += more.values;
  sum.longest_beyond = std::max(sum.longest_beyond, more.longest_beyond);
  sum.looked += more.looked;
  if (!more.faulty) return;
  const bool is_milder =
      !sum.faulty || (sum.of.is_above ? *more.faulty < *sum.faulty : *more.faulty > *sum.faulty);
  if (is_milder) sum.faulty = more.faulty;
}

Expected<std::vector<ThresholdMeasure>> measure_all(const journal::Reader& journal,
                                                    const std::vector<Comparison>& comparisons,
                                                    const std::vector<FaultyStretch>& faulty) {
  std::optional<std::vector<ThresholdMeasure>> sum;
  std::int64_t before = 0;
  for (double until = std::numeric_limits<double>::infinity();;) {
    const auto row = journal.newest(journal::kind::kSession, before);
    if (!row) return Error{row.error()};
    if (!*row) break;
    const double at_start = static_cast<double>((*row)->at) / 1e9;
    auto recording = replay::Recording::open(journal, (*row)->id);
    if (!recording && sum) break;  // a later one is measured
    if (!recording) return Error{recording.error()};
    std::vector<FaultyStretch> meanwhile;
    std::ranges::copy_if(faulty, std::back_inserter(meanwhile), [&](const FaultyStretch& each) {
      return each.from >= at_start && each.from < until;
    });
    const auto measured = measure(*recording, at_start, comparisons, meanwhile);
    if (!measured) return Error{measured.error()};
    if (!sum) {
      sum = *measured;
    } else {
      for (std::size_t i = 0; i < sum->size(); ++i) add((*sum)[i], (*measured)[i]);
    }
    until = at_start;
    before = (*row)->id;
  }
  if (!sum) return Error{"the journal has no run"};
  return std::move(*sum);
}

}  // namespace culprit::drill

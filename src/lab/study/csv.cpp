#include "study/csv.h"

#include <optional>

#include <fmt/core.h>

#include "study/paper_claims.h"

namespace culprit::study {
namespace {

std::string quoted(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"') out += '"';
    out += c;
  }
  return out + "\"";
}

std::string field(double value) { return fmt::format("{}", value); }
std::string field(bool value) { return value ? "true" : "false"; }

class Line {
 public:
  explicit Line(std::string& out) : out_(out) {}
  ~Line() { out_ += '\n'; }
  Line(const Line&) = delete;
  Line& operator=(const Line&) = delete;

  Line& text(std::string_view value) {
    if (!is_first_) out_ += ',';
    is_first_ = false;
    out_ += quoted(value);
    return *this;
  }
  Line& number(double value) { return text(field(value)); }
  Line& truth(bool value) { return text(field(value)); }
  Line& number_if(bool exists, double value) { return exists ? number(value) : text(""); }

 private:
  std::string& out_;
  bool is_first_ = true;
};

std::string compact(const PaperSwitches& switches) {
  std::string text;
  for (const char c : label(switches))
    if (c != ' ') text += c;
  return text;
}

std::string_view name(published::Significance significance) {
  switch (significance) {
    case published::Significance::kNotSignificant:
      return "none";
    case published::Significance::kBetter:
      return "better";
    case published::Significance::kWorse:
      return "worse";
  }
  return "none";
}

constexpr std::string_view kConfigurationFields =
    "dependencies,criticality,impact,planner,profile,probabilities";

Line& add(const Configuration& configuration, Line& line) {
  return line.truth(configuration.switches.dependencies)
      .truth(configuration.switches.criticality)
      .truth(configuration.switches.impact)
      .text(configuration.planner)
      .text(configuration.profile)
      .text(configuration.probabilities == Probabilities::kIdeal ? "ideal" : "misspecified");
}

void metric_line(std::string& out, const Row& row, Metric metric,
                 const MeanComparison* comparison) {
  const Summary& summary = row[metric];
  const bool exists = summary.count() > 0;
  const std::optional<Interval> interval = summary.interval();
  Line line(out);
  add(row.configuration, line)
      .text(std::to_string(row.runs))
      .text(traits(metric).key)
      .text(std::to_string(summary.count()))
      .number_if(exists, summary.mean())
      .number_if(exists, summary.sd())
      .text(std::to_string(summary.independent().count()))
      .number_if(interval.has_value(), interval ? interval->low : 0)
      .number_if(interval.has_value(), interval ? interval->high : 0)
      .text(std::to_string(summary.censored()));
  if (comparison == nullptr) {
    line.text("").text("").text("");
  } else {
    line.number(comparison->theirs.mean).number(comparison->theirs.sd).truth(comparison->is_within);
  }
}

constexpr std::string_view kClaimFields =
    "planner,profile,claim,test,comparison,first,first_mean,first_sd,first_count,second,second_"
    "mean,"
    "second_sd,second_count,bound,margin,part_p,part_p_against,p,p_against,verdict\n";

std::string_view name(Comparison comparison) {
  switch (comparison) {
    case Comparison::kMore:
      return "more";
    case Comparison::kAlike:
      return "alike";
    case Comparison::kAbove:
      return "above";
    case Comparison::kBelow:
      return "below";
    case Comparison::kNear:
      break;
  }
  return "near";
}

void add(const Group& group, Line& line) {
  const bool exists = group.values.count() > 0;
  line.text(group.name)
      .number_if(exists, group.values.mean())
      .number_if(group.values.count() > 1, group.values.sample_sd())
      .number_if(exists, static_cast<double>(group.values.count()));
}

void add_claims(std::string_view planner, std::string_view profile,
                const std::vector<Claim>& claims, std::string& out) {
  for (const Claim& claim : claims) {
    for (const ClaimPart& part : claim.parts) {
      Line line(out);
      line.text(planner)
          .text(profile)
          .text(claim.text)
          .text(claim.test)
          .text(name(part.comparison));
      add(part.first, line);
      add(part.second, line);
      line.number(part.bound).number(part.margin).number(part.p).number(part.p_against);
      line.number(claim.p).number(claim.p_against).text(to_string(claim.verdict));
    }
  }
}

}  // namespace

std::string metrics_csv(const CampaignResult& result) {
  std::string out(kConfigurationFields);
  out +=
      ",runs,metric,count,mean,sd,independent,ci_low,ci_high,censored,published_mean,published_sd,"
      "is_within\n";
  for (const Row& row : result.rows) {
    const std::vector<MeanComparison> comparisons = compare_means(row);
    for (std::size_t i = 0; i < kMetricCount; ++i)
      metric_line(out, row, static_cast<Metric>(i),
                  i < comparisons.size() ? &comparisons[i] : nullptr);
  }
  return out;
}

std::string effects_csv(const CampaignResult& result) {
  std::string out =
      "planner,profile,metric,from,to,difference,ci_low,ci_high,p,percent,verdict,"
      "published_percent,published_verdict,same_sign\n";
  for (const Ablation& ablation : ablations(result)) {
    for (const Effect& effect : ablation.effects) {
      for (std::size_t i = 0; i < kPublishedMetrics.size(); ++i) {
        const Change& change = effect.changes[i];
        Line(out)
            .text(ablation.planner)
            .text(ablation.profile)
            .text(traits(kPublishedMetrics[i]).key)
            .text(compact(effect.published->without))
            .text(compact(effect.published->with))
            .number(change.difference.estimate)
            .number(change.difference.low)
            .number(change.difference.high)
            .number(change.difference.p)
            .number_if(change.percent.has_value(), change.percent.value_or(0))
            .text(name(change.significance))
            .number(change.theirs.percent)
            .text(name(change.theirs.significance))
            .truth(change.has_same_sign());
      }
    }
  }
  return out;
}

std::string values_csv(const CampaignResult& result) {
  std::string out(kConfigurationFields);
  out += ",metric,value,count\n";
  for (const Row& row : result.rows) {
    for (std::size_t i = 0; i < kMetricCount; ++i) {
      const auto metric = static_cast<Metric>(i);
      for (const auto& [value, count] : row[metric].distribution().counts()) {
        Line line(out);
        add(row.configuration, line)
            .text(traits(metric).key)
            .number(value)
            .text(std::to_string(count));
      }
    }
  }
  return out;
}

std::string claims_csv(const Findings& findings) {
  std::string out(kClaimFields);
  for (const Ablation& ablation : ablations(findings.campaign))
    add_claims(ablation.planner, ablation.profile, paper_claims(findings, ablation), out);
  return out;
}

std::string claims_csv(std::string_view planner, std::string_view profile,
                       const std::vector<Claim>& claims) {
  std::string out(kClaimFields);
  add_claims(planner, profile, claims, out);
  return out;
}

}  // namespace culprit::study

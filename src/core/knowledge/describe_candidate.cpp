// Candidates of a decision in words: the evidence for each, why it was not chosen, and what ends its wait.
#include <algorithm>
#include <cstdio>

#include "knowledge/describe.h"

namespace culprit {

std::string_view to_string(Condition condition) {
  switch (condition) {
    case Condition::kTried:
      return "tried";
    case Condition::kInvalid:
      return "invalid";
    case Condition::kAdapting:
      return "adapting";
    case Condition::kAffected:
      return "affected";
    case Condition::kDependency:
      return "dependency";
    case Condition::kOneEach:
      return "other_chosen";
    case Condition::kDownstream:
      return "downstream";
    case Condition::kSuspect:
      return "suspect";
    case Condition::kSettling:
      return "settling";
    case Condition::kInTheWay:
      return "in_the_way";
    case Condition::kWithheld:
      return "withheld";
    case Condition::kUnheard:
      return "unheard";
  }
  return "";
}

std::string_view to_string(EvidenceSource source) {
  switch (source) {
    case EvidenceSource::kKernel:
      return "kernel";
    case EvidenceSource::kMeasured:
      return "measured";
    case EvidenceSource::kAnswer:
      return "answer";
    case EvidenceSource::kAlarm:
      return "alarm";
    case EvidenceSource::kGraph:
      return "graph";
    case EvidenceSource::kLearned:
      return "learned";
    case EvidenceSource::kModel:
      return "model";
  }
  return "";
}

std::string describe(const Evidence& evidence) {
  const bool is_answer = evidence.source == EvidenceSource::kAnswer;
  std::string age;
  if (evidence.age) {
    const std::string time = two_decimals(seconds(*evidence.age)) + " s";
    age = is_answer ? ", " + time + " before" : ", for " + time;
  }
  if (is_answer) return evidence.text + age + " (answer)";
  char weight[16];
  (void)std::snprintf(weight, sizeof weight, "%+.1f", evidence.log_odds);
  return evidence.text + age + " (" + std::string(to_string(evidence.source)) + ", " + weight + ")";
}

std::string describe_exclusion(const Candidate& candidate, const RuleSet& rules) {
  const std::string& strategy = rules[candidate.strategy].name;
  const std::string& component = rules[candidate.component].name;
  const std::string because = candidate.failure ? " (" + rules[*candidate.failure].name + ")" : "";
  const auto& own = rules[candidate.strategy].components;
  const bool is_own = std::binary_search(own.begin(), own.end(), candidate.component);
  if (!candidate.excluded) return strategy + " is chosen";
  switch (*candidate.excluded) {
    case Condition::kTried:
      return strategy + " was tried already";
    case Condition::kInvalid:
      return strategy + " is not possible now: " + candidate.remark;
    case Condition::kAdapting:
      return component + " is being adapted";
    case Condition::kAffected:
      return component + " is affected by a strategy chosen just now";
    case Condition::kDependency:
      if (!candidate.failure && !candidate.remark.empty()) {
        return is_own ? component + " " + candidate.remark
                      : "it depends on " + component + ", which " + candidate.remark;
      }
      return "it depends on " + component + ", which may be the cause" + because;
    case Condition::kOneEach:
      return "another strategy was chosen for the same failure";
    case Condition::kDownstream:
      return "it depends on " + component + ", which is being adapted" + because;
    case Condition::kSuspect:
      if (!candidate.remark.empty())
        return is_own ? component + " was " + candidate.remark
                      : "it depends on " + component + ", which was " + candidate.remark;
      return "it depends on " + component + ", which may still prove to be the cause" + because;
    case Condition::kSettling:
      if (candidate.failure == rules[candidate.strategy].rule) return candidate.remark;
      if (!candidate.remark.empty())
        return "it may only show that " + component + " " + candidate.remark;
      return "it is expected to clear now that " + rules[*candidate.failure].name + " is resolved";
    case Condition::kInTheWay:
      return strategy + " would delay the repair of " + rules[*candidate.failure].name;
    case Condition::kWithheld:
      return strategy + " is withheld: " + candidate.remark;
    case Condition::kUnheard:
      return is_own ? component + " " + candidate.remark
                    : "it depends on " + component + ", which " + candidate.remark;
  }
  return "";
}

std::string describe_end_of_wait(const Candidate& candidate, const RuleSet& rules) {
  if (!candidate.excluded || !candidate.within) return "";
  const std::string time = two_decimals(seconds(*candidate.within)) + " s";
  const std::string& component = rules[candidate.component].name;
  const Strategy& strategy = rules[candidate.strategy];
  std::vector<std::string> own;
  for (const ComponentId c : strategy.components) own.push_back(rules[c].name);
  const std::string are_responsible =
      listed(own) + (own.size() == 1 ? " is" : " are") + " held responsible";
  switch (*candidate.excluded) {
    case Condition::kDependency:
      return "if " + component + " is not back within " + time + ", " + are_responsible;
    case Condition::kSuspect:
      if (!candidate.failure)
        return "if " + component + " does not answer within " + time + ", " + component +
               " is held responsible";
      return "if " + rules[*candidate.failure].name + " does not fire within " + time + ", " +
             are_responsible;
    case Condition::kSettling:
      return "if " + rules[strategy.rule].name + " still fails after " + time + ", " +
             are_responsible;
    case Condition::kTried:
    case Condition::kInvalid:
    case Condition::kAdapting:
    case Condition::kAffected:
    case Condition::kOneEach:
    case Condition::kDownstream:
    case Condition::kInTheWay:
    case Condition::kWithheld:
    case Condition::kUnheard:
      break;
  }
  return "";
}

}  // namespace culprit

#include "diagnose/evidence.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <span>

#include "diagnose/known_down.h"
#include "diagnose/questions.h"
#include "diagnose/touched.h"

namespace culprit::diagnose {
namespace {

double logit(double p) { return std::log(p / (1 - p)); }

double bounded(double log_odds) { return std::clamp(log_odds, -kSurely, kSurely); }

// ln X, where 0 is a thousandth.
double log_of(double explained) { return std::log(std::max(explained, std::exp(-kSurely))); }

EvidenceSource source_of(Trouble trouble) {
  switch (trouble) {
    case Trouble::kExited:
    case Trouble::kStopped:
      return EvidenceSource::kKernel;
    case Trouble::kHung:
    case Trouble::kSilent:
      return EvidenceSource::kMeasured;
    case Trouble::kLeft:
    case Trouble::kStarting:
    case Trouble::kNotActive:
    case Trouble::kNotYetActive:
    case Trouble::kNeverSeen:
      return EvidenceSource::kGraph;
  }
  return EvidenceSource::kGraph;
}

class Collector {
 public:
  Collector(const Otherwise& otherwise, const Examination& found, const Knowledge& knowledge)
      : otherwise_(otherwise),
        causes_(found.causes()),
        diagnosis_(found.diagnosis()),
        troubles_(found.troubles()),
        knowledge_(knowledge) {}

  std::vector<PieceOfEvidence> own(std::size_t i) {
    const double explained = diagnosis_.explained(i);
    for (const ComponentId c : touched_by(causes_[i].rule, knowledge_)) {
      if (is_known_down(causes_[i].rule, knowledge_)) {
        if (!is_known_down(c, knowledge_)) continue;
        add(EvidenceSource::kKernel, name(c) + " exited or is stopped",
            knowledge_.components[c].process_since, logit(kKnownDown));
      } else if (explained > 0 && diagnosis_.prior(i) > 0.5 && knowledge_.components[c].hangs()) {
        const auto& trouble = troubles_[c.index];
        add(EvidenceSource::kMeasured, name(c) + " hangs by itself",
            trouble ? trouble->onset.latest : kLongAgo, logit(kKnownDown));
      }
    }
    if (all_.size() == 1) change(otherwise_.with_prior(kCoincidence));
    if (explained <= 0) {
      add(EvidenceSource::kMeasured, "nothing upstream is wrong", kLongAgo, kSurely);
    } else if (all_.empty()) {
      add(EvidenceSource::kModel, "two faults at once are rare", kLongAgo, logit(kCoincidence));
    }
    if (explained > 0)
      add(EvidenceSource::kModel, "causes do not always pass on", kLongAgo, -log_of(explained));
    const std::size_t members = causes_.loops()[causes_.loop_of(i)].size();
    if (members > 1) {
      const double own = std::min(diagnosis_.against_others(i), 1 - std::exp(-kSurely));
      add(EvidenceSource::kModel,
          "it is one of a feedback loop of " + std::to_string(members) + " failures", kLongAgo,
          logit(diagnosis_.of(i)) - logit(own));
    }
    add_clock_step(i);
    return heaviest_first();
  }

  std::vector<PieceOfEvidence> other(std::size_t j, std::size_t i) {
    const CauseNode& node = causes_[j];
    const double weight = std::log(Coupling::kUsual) + kSurely;
    switch (node.kind) {
      case CauseNode::Kind::kFailure:
        add(EvidenceSource::kAlarm, name(node.rule) + " fires", node.onset.latest, weight);
        break;
      case CauseNode::Kind::kImminent:
        add(EvidenceSource::kMeasured, name(node.rule) + " is about to fire", node.onset.latest,
            weight);
        break;
      case CauseNode::Kind::kTrouble:
        add(source_of(node.trouble),
            name(node.component) + " " + std::string(to_string(node.trouble)), node.onset.latest,
            weight);
        break;
      case CauseNode::Kind::kUnsupplied:
        add(EvidenceSource::kGraph, "no node offers " + node.channel, kLongAgo, weight);
        break;
    }
    change(otherwise_.without(j));
    const double timely = causes_.timely(j, i);
    const double kappa = diagnosis_.kappa(j, i);
    if (timely < 1) {
      add(EvidenceSource::kMeasured, name(causes_[i].rule) + " did not follow at once",
          node.onset.latest, std::log(timely));
      change(otherwise_.if_passed(j, kappa));
    }
    if (kappa != Coupling::kUsual) {
      add(EvidenceSource::kLearned,
          kappa > Coupling::kUsual ? "they cleared together before"
                                   : "one stayed before when the other cleared",
          kLongAgo, std::log(kappa / Coupling::kUsual));
      change(otherwise_.if_passed(j, Coupling::kUsual * timely));
    }
    return heaviest_first();
  }

 private:
  // It decides nothing about who is responsible, and tells why a node may have fallen silent.
  void add_clock_step(std::size_t i) {
    constexpr Duration kNearby = std::chrono::seconds(10);
    const auto& step = knowledge_.clock_step;
    const Onset& began = causes_[i].onset;
    if (step && later(began.latest, kNearby) >= step->at &&
        began.earliest <= later(step->at, std::max(kNearby, -step->by)))
      add(EvidenceSource::kMeasured, step->in_words(), step->at, 0);
  }
  void add(EvidenceSource source, std::string text, Time since, double log_odds) {
    std::optional<Duration> age;
    if (since != kLongAgo && since <= knowledge_.now) age = knowledge_.now - since;
    all_.push_back({{source, std::move(text), age, bounded(log_odds)}});
  }
  // Without the last piece, `next` would be the likeliest.
  void change(std::size_t next) {
    if (next != otherwise_.likeliest()) all_.back().otherwise = next;
  }
  std::vector<PieceOfEvidence> heaviest_first() {
    std::stable_sort(all_.begin(), all_.end(),
                     [](const PieceOfEvidence& a, const PieceOfEvidence& b) {
                       return std::abs(a.evidence.log_odds) > std::abs(b.evidence.log_odds);
                     });
    return std::move(all_);
  }
  const std::string& name(RuleId rule) const { return knowledge_.rules[rule].name; }
  const std::string& name(ComponentId component) const { return knowledge_.rules[component].name; }

  const Otherwise& otherwise_;
  const Causes& causes_;
  const Diagnosis& diagnosis_;
  std::span<const std::optional<TroubleSeen>> troubles_;  // by component
  const Knowledge& knowledge_;
  std::vector<PieceOfEvidence> all_;
};

}  // namespace

std::vector<PieceOfEvidence> evidence_for(std::size_t j, std::size_t i, const Otherwise& otherwise,
                                          const Examination& found, const Knowledge& knowledge) {
  Collector collector(otherwise, found, knowledge);
  return i == j ? collector.own(i) : collector.other(j, i);
}

namespace {

// Empty if the outcome of the question is unknown: culprit was deaf meanwhile.
std::optional<Evidence> answer_of(const std::string& name, const ComponentState& state, Time now) {
  const Questioned& questioned = state.questioned;
  const auto told = [&](const char* what, Time when) {
    return Evidence{EvidenceSource::kAnswer, name + what, now - when};
  };
  if (state.answered >= questioned.at) return told(" answered", state.answered);
  if (questioned.unanswered) return told(" did not answer", *questioned.unanswered);
  if (questioned.is_open) return told(" was asked, and may still answer", questioned.at);
  if (questioned.is_pointless) return told(" did not answer, nor ever before", questioned.at);
  return std::nullopt;
}

}  // namespace

std::vector<Evidence> answers_about(RuleId failure, const Knowledge& knowledge) {
  const auto asked_at = [&](ComponentId c) { return knowledge.components[c].questioned.at; };
  const Time begun = onset_of(failure, knowledge).latest;
  const std::vector<ComponentId>& own = knowledge.rules[failure].components;
  std::vector<ComponentId> asked = knowledge.graph.upstream(own);
  asked.insert(asked.end(), own.begin(), own.end());
  std::erase_if(asked,
                [&](ComponentId c) { return asked_at(c) == kLongAgo || asked_at(c) < begun; });
  std::ranges::stable_sort(asked, std::ranges::greater(), asked_at);
  asked.resize(std::min(asked.size(), kMostQuestions));
  std::vector<Evidence> answers;
  for (const ComponentId c : asked) {
    if (auto answer = answer_of(knowledge.rules[c].name, knowledge.components[c], knowledge.now))
      answers.push_back(std::move(*answer));
  }
  return answers;
}

}  // namespace culprit::diagnose

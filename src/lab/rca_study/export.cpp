#include "rca_study/export.h"

#include <cmath>

#include <fmt/core.h>

#include "json/json.h"
#include "knowledge/describe.h"
#include "rca_study/benchmark_files.h"
#include "simulation/random.h"

namespace culprit::study::rca {
namespace {

double in_milliseconds(double s) { return std::round(s * 1000) / 1000; }

Json names_of(const RcaScenario& scenario, const std::vector<std::size_t>& components) {
  Json names = Json::array();
  for (const std::size_t c : components) names.push_back(scenario.components[c].name);
  return names;
}

// {"a": [...], "b": [...]} with each entry on a line of its own.
std::string entry_by_entry(const Json& lists) {
  std::string text;
  for (const auto& [name, entries] : lists.items()) {
    text += fmt::format("{}\"{}\": [", text.empty() ? "{\n" : ",\n", name);
    const char* separator = "\n";
    for (const Json& entry : entries) {
      text += separator + to_line(entry);
      separator = ",\n";
    }
    text += "]";
  }
  return text + "\n}\n";
}

std::string graph_of(const RcaScenario& scenario) {
  Json graph{{"components", Json::array()}, {"topics", Json::array()}};
  for (const RcaComponent& c : scenario.components)
    graph["components"].push_back({{"name", c.name},
                                   {"level", culprit::to_string(c.criticality)},
                                   {"watched", !c.is_unwatched}});
  for (const RcaTopic& topic : scenario.topics) {
    std::vector<std::size_t> subscribers;
    for (const Subscription& s : topic.subscribers) {
      if (!s.is_hidden) subscribers.push_back(s.component);
    }
    Json& json =
        graph["topics"].emplace_back(Json{{"name", topic.name},
                                          {"publishers", names_of(scenario, topic.publishers)},
                                          {"subscribers", names_of(scenario, subscribers)}});
    if (topic.is_ignored) json["ignored"] = true;
  }
  return entry_by_entry(graph);
}

std::string signals_of(const RcaCase& made) {
  std::string text = "time_s";
  for (const std::size_t c : made.watched) text += "," + made.scenario.components[c].name;
  text += "\n";
  for (std::size_t t = 0; t < made.times_s.size(); ++t) {
    text += fmt::format("{}", in_milliseconds(made.times_s[t]));
    for (const bool is_ill : made.readings[t]) text += is_ill ? ",1" : ",0";
    text += "\n";
  }
  return text;
}

std::string events_of(const RcaCase& made) {
  std::string text = "time_s,component,event\n";
  for (const CaseEvent& event : made.events)
    text += fmt::format("{},{},{}\n", in_milliseconds(event.at_s),
                        made.scenario.components[event.component].name, to_string(event.kind));
  return text;
}

Json truth_json(const RcaCase& made) {
  const RcaScenario& scenario = made.scenario;
  Json truth{
      {"causes", Json::array()}, {"effects", Json::array()}, {"common_causes", Json::array()}};
  for (const CaseCause& cause : made.truth.causes) {
    Json repairs = Json::array();
    for (const Repair repair : cause.repairs) repairs.push_back(to_string(repair));
    truth["causes"].push_back({{"component", scenario.components[cause.fault.component].name},
                               {"kind", cause.kind},
                               {"at_s", in_milliseconds(cause.fault.at_s)},
                               {"repairs", std::move(repairs)}});
  }
  for (const CaseEffect& effect : made.truth.effects)
    truth["effects"].push_back({{"component", scenario.components[effect.component].name},
                                {"since_s", in_milliseconds(effect.since_s)},
                                {"causes", names_of(scenario, effect.causes)}});
  for (const CommonCause& cause : scenario.common_causes)
    truth["common_causes"].push_back(
        {{"components", names_of(scenario, {cause.first, cause.second})},
         {"at_s", in_milliseconds(cause.at_s)},
         {"lasts_s", in_milliseconds(cause.lasts_s)}});
  return truth;
}

Json answer_json(const RcaScenario& scenario, const Advice& advice) {
  Json repairs = Json::array();
  for (const Proposal& proposal : advice.repairs)
    repairs.push_back({{"component", scenario.components[proposal.component].name},
                       {"repair", to_string(proposal.repair)},
                       {"at_s", in_milliseconds(proposal.at_s)}});
  return {{"ranked", names_of(scenario, advice.ranked)},
          {"causes", names_of(scenario, advice.causes)},
          {"repairs", std::move(repairs)}};
}

// An object with each member on a line of its own.
std::string member_by_member(const Json& object) {
  std::string text;
  for (const auto& [name, value] : object.items())
    text += fmt::format("{}\"{}\": {}", text.empty() ? "{\n" : ",\n", name, to_line(value));
  return text + "\n}\n";
}

class Exporter {
 public:
  Exporter(const CaseExport& wanted, const WriteFile& write, const GoOn& go_on)
      : wanted_(wanted), write_(write), go_on_(go_on) {}

  Expected<void> run() {
    write("README.md", fmt::format("{}\n---\n\n{}\n", kCasesReadme, wanted_.command));
    write("score.py", kScorer);
    write_cases(wanted_.seed, wanted_.cases, false);
    if (wanted_.hidden_seed) write_cases(*wanted_.hidden_seed, wanted_.hidden_cases, true);
    for (const auto& [robot, cases] : wanted_.others) write_others(robot, cases, false);
    for (const auto& [robot, cases] : wanted_.hidden_others) write_others(robot, cases, true);
    return error_ ? Expected<void>(*error_) : Expected<void>();
  }

 private:
  // A folder of cases, and what is written beside it.
  struct Set {
    std::string folder;  // "public"
    std::string prefix;  // of the files beside it
    bool is_hidden = false;
    std::size_t cases = 0;
    Json truths = Json::object();
    std::map<std::string, Json> answers{};  // by adviser
  };

  void write_cases(std::uint64_t seed, std::size_t count, bool is_hidden) {
    Set set = is_hidden ? Set{"hidden", "hidden-", true} : Set{"public", ""};
    Tries tries{seed};
    const std::size_t total = wanted_.cases + (wanted_.hidden_seed ? wanted_.hidden_cases : 0);
    for (std::size_t i = 0; i < count && !error_; ++i) {
      const auto made = next_case(wanted_.settings[i % wanted_.settings.size()], tries);
      if (!made) return;
      write_case(set, *made);
      if (go_on_ && !go_on_(++done_, total)) complain("it was interrupted");
    }
    finish(set);
  }

  void write_others(const std::string& robot, const std::vector<RcaCase>& cases, bool is_hidden) {
    const std::string folder = (is_hidden ? "hidden-" : "") + robot;
    Set set{folder, folder + "-", is_hidden};
    for (const RcaCase& made : cases) write_case(set, made);
    finish(set);
  }

  // Graph, signals, events, rules, and the truth of a public case.
  void write_case(Set& set, const RcaCase& made) {
    const std::string name = fmt::format("case-{:04}", ++set.cases);
    const std::string folder = set.folder + "/" + name + "/";
    write(folder + "graph.json", graph_of(made.scenario));
    write(folder + "signals.csv", signals_of(made));
    write(folder + "events.csv", events_of(made));
    write(folder + "robot.rules", made.rules);
    Json truth = truth_json(made);
    if (!set.is_hidden) write(folder + "truth.json", entry_by_entry(truth));
    set.truths[name] = std::move(truth);
    for (const auto& [adviser, advice] : made.advice)
      set.answers.try_emplace(adviser, Json::object()).first->second[name] =
          answer_json(made.scenario, advice);
  }

  // The truths of hidden cases, and the answers of the advisers.
  void finish(const Set& set) {
    if (set.is_hidden) write(set.prefix + "truth.json", member_by_member(set.truths));
    for (const auto& [adviser, of_all] : set.answers)
      write(fmt::format("{}answers-{}.json", set.prefix, adviser), member_by_member(of_all));
  }

  struct Tries {
    std::uint64_t seed = 0;
    std::uint64_t done = 0;
  };

  std::optional<RcaCase> next_case(const RcaSetting& setting, Tries& tries) {
    for (std::size_t k = 0; k < CaseExport::kMostTries; ++k) {
      const std::uint64_t seed = simulation::mix(simulation::mix(tries.seed) + tries.done++);
      auto made = case_of(generate(setting, seed), wanted_.advisers, wanted_.objective);
      if (made) return made;
    }
    complain(
        fmt::format("in none of {} robots of {} components with {} faults, each fault has an "
                    "effect that shows; use fewer faults, fewer unwatched components or a "
                    "higher --pass",
                    CaseExport::kMostTries, setting.components, setting.faults));
    return std::nullopt;
  }

  void write(const std::string& path, const std::string& text) {
    if (error_) return;
    if (const auto written = write_(path, text); !written) complain(written.error());
  }

  void complain(const std::string& message) {
    if (!error_) error_ = Error{message};
  }

  const CaseExport& wanted_;
  const WriteFile& write_;
  const GoOn& go_on_;
  std::uint64_t done_ = 0;
  std::optional<Error> error_;
};

}  // namespace

Expected<void> export_cases(const CaseExport& wanted, const WriteFile& write, const GoOn& go_on) {
  return Exporter(wanted, write, go_on).run();
}

}  // namespace culprit::study::rca

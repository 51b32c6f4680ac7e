#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include <fmt/core.h>

#include "base/amount.h"
#include "base/live_clock.h"
#include "base/name_grammar.h"
#include "base/text_file.h"
#include "cli/commands.h"
#include "cli/journal_file.h"
#include "journal/session.h"
#include "journal/writer.h"
#include "knowledge/event_words.h"

namespace culprit::cli {
namespace {

constexpr const char* kFormat = "culprit-beliefs";

struct BeliefsOptions {
  JournalOption journal;
  std::string rule;
  std::string output;
  std::vector<std::string> files;
  bool all = false;
  bool json = false;
};

// The document that export writes and import reads.
Json document_of(const journal::Learned& learned) {
  Json document = {{"format", kFormat}, {"format_version", 1}};
  document.update(journal::to_json(learned));
  return document;
}

double learned_of(double now, double prior) { return now - prior; }

void show_couplings(const std::vector<journal::LearnedCoupling>& all) {
  if (all.empty()) return;
  fmt::print("\n{:<28} {:<28} {:>8} {:>8} {:>10}\n", "when this was resolved", "this cleared",
             "yes", "no", "unaffected");
  for (const journal::LearnedCoupling& each : all)
    fmt::print("{:<28} {:<28} {:>8.6g} {:>8.6g} {:>10.6g}\n", each.cause, each.effect,
               each.coupling.cleared, each.coupling.stayed, each.coupling.spared);
}

void show_latencies(const std::vector<journal::LearnedLatency>& all) {
  std::string late;
  std::string transient;
  for (const journal::LearnedLatency& each : all) {
    const auto part = journal::transients_from(each);
    if (!part)
      late += fmt::format("{:<28} {:>8} {:>6.3g} s {:>6.3g} s\n", each.rule, each.count,
                          each.least_s, each.most_s);
    if (part && part->second.cleared > 0)
      transient += fmt::format("{:<28} {:>8} {:>6.3g} s\n", part->first, each.count, each.most_s);
  }
  if (!late.empty())
    fmt::print("\nHow late rules are\n{:<28} {:>8} {:>8} {:>8}\n{}", "rule", "count", "from", "to",
               late);
  if (!transient.empty())
    fmt::print("\nFailures that cleared by themselves\n{:<28} {:>8} {:>8}\n{}", "rule", "count",
               "within", transient);
}

// The pairs that began together more than once, and how often the rarer of both failures began.
std::string pairs_in(const std::vector<journal::LearnedCoincidence>& all) {
  std::map<std::string_view, int> began;
  for (const journal::LearnedCoincidence& each : all) {
    if (each.rule == each.other) began[each.rule] = each.count;
  }
  std::string pairs;
  for (const journal::LearnedCoincidence& each : all) {
    if (each.rule == each.other || each.count < Coincidences::kLeast) continue;
    pairs += fmt::format("{:<28} {:<28} {:>8} {:>8}\n", each.rule, each.other, each.count,
                         std::min(began[each.rule], began[each.other]));
  }
  return pairs;
}

void show_pairs(const std::string& pairs) {
  if (pairs.empty()) return;
  fmt::print("\nFailures that begin together\n{:<28} {:<28} {:>8} {:>8}\n{}", "rule", "rule",
             "together", "of", pairs);
}

// How many outcomes of each strategy, as "strategy of Rule", are pending.
using Pending = std::map<std::string, int>;

void follow(const Json& event, Pending& pending) {
  const std::string type = journal::text_of(event, "type");
  const int change = type == words_of<OutcomePending>().name   ? 1
                     : type == words_of<OutcomeCounted>().name ? -1
                                                               : 0;
  if (change == 0) return;
  int& count =
      pending[journal::text_of(event, "strategy") + " of " + journal::text_of(event, "rule")];
  count = std::max(0, count + change);
}

// In the latest run. One that was stopped waits for none.
Expected<Pending> pending_in(const journal::Reader& journal) {
  Pending pending;
  const auto session = journal.newest(journal::kind::kSession);
  if (!session) return Error{session.error()};
  if (!*session) return pending;
  const Json begin = parse_json((*session)->body);
  const Json past = begin.is_object() ? begin.value("past", Json::array()) : Json::array();
  for (const Json& each : past) follow(each, pending);
  auto rows = journal.entries(journal::Which::kReadable, (*session)->id + 1);
  if (!rows) return Error{rows.error()};
  journal::Entry entry;
  auto more = rows->next(entry);
  for (; more && *more; more = rows->next(entry)) {
    if (entry.kind == journal::kind::kEvent) follow(parse_json(entry.body), pending);
    if (entry.kind == journal::kind::kEnd) pending.clear();
  }
  if (!more) return Error{more.error()};
  std::erase_if(pending, [](const auto& each) { return each.second == 0; });
  return pending;
}

void show_pending(const Pending& pending) {
  std::size_t all = 0;
  std::string lines;
  for (const auto& [strategy, count] : pending) {
    all += static_cast<std::size_t>(count);
    lines += fmt::format("  {}{}\n", escape_controls(strategy),
                         count == 1 ? "" : fmt::format(" ({})", count));
  }
  if (all > 0)
    fmt::print("\n{} pending, not counted yet\n{}", amount_of(all, "outcome is", "outcomes are"),
               lines);
}

int show(const BeliefsOptions& options) {
  const auto journal = options.journal.open();
  if (!journal) return fail(journal.error());
  auto learned = journal->learned();
  if (!learned) return fail(learned.error());
  const auto pending = pending_in(*journal);
  if (!pending) return fail(pending.error());
  if (options.json) {
    fmt::print("{}\n", to_line(document_of(*learned)));
    return kOk;
  }
  std::erase_if(learned->couplings, [](const auto& each) { return each.coupling == Coupling(); });
  std::erase_if(learned->latencies, [](const auto& each) { return each.count == 0; });
  const std::string pairs = pairs_in(learned->coincidences);
  if (!learned->has_outcomes() && pairs.empty()) {
    fmt::print(
        "nothing was learned yet: the outcome of a repair counts after it has held for a minute "
        "(culprit run --healthy)\n");
    show_pending(*pending);
    return kOk;
  }
  fmt::print("{:<28} {:<28} {:>7} {:>7} {:>8} {:>8}\n", "rule", "strategy", "rules", "now",
             "helped", "did not");
  for (const journal::LearnedBelief& each : learned->beliefs)
    fmt::print("{:<28} {:<28} {:>5.1f} % {:>5.1f} % {:>8.6g} {:>8.6g}\n", each.rule, each.strategy,
               100 * each.prior.mean().value, 100 * each.belief.mean().value,
               learned_of(each.belief.alpha, each.prior.alpha),
               learned_of(each.belief.beta, each.prior.beta));
  show_couplings(learned->couplings);
  show_latencies(learned->latencies);
  show_pairs(pairs);
  show_pending(*pending);
  return kOk;
}

int write_out(const BeliefsOptions& options) {
  const auto journal = options.journal.open();
  if (!journal) return fail(journal.error());
  const auto learned = journal->learned();
  if (!learned) return fail(learned.error());
  const auto written = write_text(options.output, to_indented(document_of(*learned)) + "\n");
  return written ? kOk : fail(written.error());
}

Expected<journal::Learned> read_file(const std::string& path) {
  const auto text = read_text(path);
  if (!text) return Error{text.error()};
  const Json document = parse_json(*text);
  if (journal::text_of(document, "format") != kFormat ||
      journal::integer_of(document, "format_version") != 1)
    return Error{"'" + path + "' is not what culprit beliefs export writes"};
  auto learned = journal::learned_from_json(document);
  if (!learned) return Error{"'" + path + "': " + learned.error()};
  return learned;
}

Expected<journal::Writer> open_writer(const BeliefsOptions& options) {
  const auto file = options.journal.file();
  if (!file) return Error{file.error()};
  return journal::Writer::open(*file, {});
}

int read_in(const BeliefsOptions& options) {
  journal::Learned added;
  for (const std::string& path : options.files) {
    const auto learned = read_file(path);
    if (!learned) return fail(learned.error());
    journal::merge(added, *learned);
  }
  auto writer = open_writer(options);
  if (!writer) return fail(writer.error());
  auto learned = writer->learned();
  if (!learned) return fail(learned.error());
  journal::merge(*learned, added);
  const auto written =
      writer->append({{}, *learned}, wall_now(), journal::Durability::kPowerFailure);
  if (!written) return fail(written.error());
  fmt::print("{} beliefs, {} couplings and {} latencies added to '{}'\n", added.beliefs.size(),
             added.couplings.size(), added.latencies.size(), writer->path().string());
  return kOk;
}

int reset(const BeliefsOptions& options) {
  if (options.rule.empty() && !options.all)
    return fail("say which rule to forget, or --all", kUsage);
  if (!options.rule.empty() && options.all)
    return fail("give a rule or --all, and not both", kUsage);
  auto writer = open_writer(options);
  if (!writer) return fail(writer.error());
  const auto count = writer->forget(options.rule, wall_now());
  if (!count) return fail(count.error());
  if (*count == 0 && !options.all)
    return fail("nothing was learned about a rule '" + printable(options.rule) +
                "'; culprit beliefs show lists the rules");
  fmt::print("{} forgotten\n", amount_of(*count, "belief"));
  return kOk;
}

}  // namespace

void add_beliefs(CLI::App& app, int& exit_code) {
  CLI::App* beliefs = app.add_subcommand(
      "beliefs", "Success rates and latencies that culprit has learned on this robot");
  beliefs->require_subcommand(1);
  const auto add = [&](const char* name, const char* help, int (*run)(const BeliefsOptions&)) {
    auto options = std::make_shared<BeliefsOptions>();
    CLI::App* command = beliefs->add_subcommand(name, help);
    options->journal.add_to(*command);
    command->callback([options, run, &exit_code] { exit_code = run(*options); });
    return std::pair(command, options);
  };
  const auto shown =
      add("show", "Each strategy's success rate: the rules' guess, and the learned one", show);
  shown.first->add_flag("--json", shown.second->json, "As export writes it");
  const auto out = add("export", "Write the learned rates as JSON", write_out);
  out.first->add_option("-o,--output", out.second->output, "Output file (default: stdout)")
      ->type_name("FILE");
  const auto in = add("import", "Add the outcomes of other robots", read_in);
  in.first->add_option("FILE", in.second->files, "A file that culprit beliefs export wrote")
      ->type_name("FILE")
      ->required();
  const auto forget = add("reset", "Forget the learned rates", reset);
  forget.first->add_option("RULE", forget.second->rule, "Forget the rates of this rule");
  forget.first->add_flag("--all", forget.second->all, "Forget the rates of all rules");
}

}  // namespace culprit::cli

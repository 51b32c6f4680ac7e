#include "journal/learned_copy.h"

#include <algorithm>
#include <tuple>

#include "journal/entry.h"
#include "journal/sealed_file.h"
#include "journal/session.h"

namespace culprit::journal {
namespace {

std::optional<Hash> hash_from_hex(const std::string& digits) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  Hash hash{};
  if (digits.size() != 2 * hash.size()) return std::nullopt;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    const auto value = kDigits.find(digits[i]);
    if (value == std::string_view::npos) return std::nullopt;
    hash[i / 2] = static_cast<unsigned char>(hash[i / 2] << 4 | value);
  }
  return hash;
}

void replace(Learned& learned, const LearnedBelief& news) {
  std::erase_if(learned.beliefs, [&](const LearnedBelief& old) {
    return old.rule == news.rule && old.strategy == news.strategy;
  });
  learned.beliefs.push_back(news);
}

void replace(Learned& learned, const LearnedCoupling& news) {
  std::erase_if(learned.couplings, [&](const LearnedCoupling& old) {
    return old.cause == news.cause && old.effect == news.effect;
  });
  learned.couplings.push_back(news);
}

void replace(Learned& learned, const LearnedLatency& news) {
  std::erase_if(learned.latencies,
                [&](const LearnedLatency& old) { return old.rule == news.rule; });
  learned.latencies.push_back(news);
}

void forget(Learned& learned, const std::string& rule) {
  std::erase_if(learned.beliefs,
                [&](const LearnedBelief& each) { return rule.empty() || each.rule == rule; });
  std::erase_if(learned.couplings, [&](const LearnedCoupling& each) {
    return rule.empty() || each.cause == rule || each.effect == rule;
  });
  std::erase_if(learned.latencies, [&](const LearnedLatency& each) {
    return rule.empty() || each.rule == rule || each.rule.starts_with(rule + " ");
  });
}

void follow(Learned& learned, std::string_view kind, const Json& body) {
  if (!body.is_object()) return;
  if (body.contains("forgotten")) return forget(learned, text_of(body, "forgotten"));
  if (kind == kind::kCoupling)
    return replace(learned, LearnedCoupling{text_of(body, "cause"),
                                            text_of(body, "effect"),
                                            {number_of(body, "cleared"), number_of(body, "stayed"),
                                             number_of(body, "spared")}});
  if (kind == kind::kLatency)
    return replace(
        learned, LearnedLatency{text_of(body, "rule"), static_cast<int>(integer_of(body, "count")),
                                number_of(body, "least_s"), number_of(body, "most_s")});
  const Json prior = body.value("prior", Json());
  const bool has_prior =
      prior.is_array() && prior.size() == 2 && prior[0].is_number() && prior[1].is_number();
  if (!has_prior) return;
  replace(learned, LearnedBelief{text_of(body, "rule"),
                                 text_of(body, "strategy"),
                                 {number_of(body, "alpha"), number_of(body, "beta")},
                                 {prior[0].get<double>(), prior[1].get<double>()}});
}

}  // namespace

std::filesystem::path learned_beside(const std::filesystem::path& journal) {
  return journal.string() + "-learned";
}

Expected<void> write_copy(const std::filesystem::path& path, const LearnedCopy& copy) {
  const Json json = {{"row", copy.newest.id},
                     {"hash", to_hex(copy.newest.hash)},
                     {"learned", to_json(copy.learned)}};
  return write_sealed(path, to_line(json) + "\n");
}

Expected<std::optional<LearnedCopy>> read_copy(const std::filesystem::path& path) {
  const auto text = read_sealed(path);
  if (!text) return Error{text.error()};
  if (!*text) return std::optional<LearnedCopy>();
  const Json json = parse_json(**text);
  const auto hash = hash_from_hex(text_of(json, "hash"));
  auto learned = learned_from_json(json.is_object() ? json.value("learned", Json()) : Json());
  if (!hash || !learned) return Error{"cannot read '" + path.string() + "': it is damaged"};
  return std::optional(LearnedCopy{{integer_of(json, "row"), *hash}, std::move(*learned)});
}

Json body_of(const LearnedBelief& learned) {
  return {{"rule", learned.rule},
          {"strategy", learned.strategy},
          {"alpha", learned.belief.alpha},
          {"beta", learned.belief.beta},
          {"prior", {learned.prior.alpha, learned.prior.beta}}};
}

Json body_of(const LearnedCoupling& learned) {
  return {{"cause", learned.cause},
          {"effect", learned.effect},
          {"cleared", learned.coupling.cleared},
          {"stayed", learned.coupling.stayed},
          {"spared", learned.coupling.spared}};
}

Json body_of(const LearnedLatency& learned) {
  return {{"rule", learned.rule},
          {"count", learned.count},
          {"least_s", learned.least_s},
          {"most_s", learned.most_s}};
}

Expected<Learned> brought_up_to_date(const LearnedCopy& copy, const Database& journal) {
  auto rows = journal.prepare(
      "SELECT kind, body FROM entry WHERE kind <> 'steps' AND id > ?1 AND kind IN ('belief', "
      "'coupling', 'latency') ORDER BY id");
  if (!rows) return Error{rows.error()};
  rows->bind(1, copy.newest.id);
  Learned learned = copy.learned;
  auto row = rows->step();
  for (; row && *row; row = rows->step()) {
    const std::string kind(rows->bytes(0));
    follow(learned, kind, parse_json(rows->bytes(1)));
  }
  if (!row) return Error{row.error()};
  return learned;
}

bool is_same(Learned a, Learned b) {
  for (Learned* each : {&a, &b}) {
    std::sort(each->beliefs.begin(), each->beliefs.end(), [](const auto& x, const auto& y) {
      return std::tie(x.rule, x.strategy) < std::tie(y.rule, y.strategy);
    });
    std::sort(each->couplings.begin(), each->couplings.end(), [](const auto& x, const auto& y) {
      return std::tie(x.cause, x.effect) < std::tie(y.cause, y.effect);
    });
    std::ranges::sort(each->latencies, {}, &LearnedLatency::rule);
  }
  return a.beliefs == b.beliefs && a.couplings == b.couplings && a.latencies == b.latencies;
}

}  // namespace culprit::journal

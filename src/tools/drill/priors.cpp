#include "drill/priors.h"

#include "drill/trial.h"
#include "journal/reader.h"
#include "journal/writer.h"

namespace culprit::drill {

Expected<Priors> add_priors(const std::filesystem::path& drilled,
                            const std::filesystem::path& robot, std::int64_t now) {
  const auto reader = journal::Reader::open(drilled);
  if (!reader) return Error{reader.error()};
  auto added = reader->learned();
  if (!added) return Error{added.error()};
  added->beliefs.clear();
  // The drill chose which failures began together.
  added->coincidences.clear();
  // Rules that the drill added are in no file.
  const auto is_own = [](const std::string& rule) { return rule.starts_with(kOwnRules); };
  std::erase_if(added->couplings,
                [&](const auto& each) { return is_own(each.cause) || is_own(each.effect); });
  // Failures that cleared by themselves did so because the drill took its fault back.
  std::erase_if(added->latencies, [&](const auto& each) {
    return each.count == 0 || is_own(each.rule) || journal::transients_from(each);
  });
  const Priors counted{added->couplings.size(), added->latencies.size()};
  if (counted.couplings + counted.latencies == 0) return counted;
  auto writer = journal::Writer::open(robot, {});
  if (!writer) return Error{writer.error()};
  auto learned = writer->learned();
  if (!learned) return Error{learned.error()};
  journal::merge(*learned, *added);
  if (auto written = writer->append({{}, *learned}, now, journal::Durability::kPowerFailure);
      !written)
    return Error{written.error()};
  return counted;
}

}  // namespace culprit::drill

#include "shards/shard_file.h"

#include <limits>

#include "study/json_fields.h"
#include "study/run_record.h"
#include "study/sealed_line.h"
#include "suave_study/suave_record.h"

namespace culprit::study {
namespace {

template <class C>
Expected<AnyShardReader> any(Expected<ShardReader<C>> reader) {
  if (!reader) return Error{reader.error()};
  return AnyShardReader(std::move(*reader));
}

}  // namespace

template <class C>
std::string header_line(const ShardHeader<C>& header) {
  return beginning_line({std::string(C::kStudy), header.shard, to_json(header.campaign)});
}

template <class Run>
std::string run_line(RunId id, const Run& run) {
  return sealed_line({{"row", id.row}, {"run", id.run}, {"metrics", *to_json(run)}});
}

std::string end_line(std::uint64_t runs) { return sealed_line({{"runs", runs}}); }

template <class C>
Expected<ShardReader<C>> ShardReader<C>::open(std::istream& in, std::string name) {
  ShardLines lines(in, std::move(name));
  const Expected<ShardBeginning> beginning = read_beginning(lines);
  if (!beginning) return Error{beginning.error()};
  return open(std::move(lines), *beginning);
}

template <class C>
Expected<ShardReader<C>> ShardReader<C>::open(ShardLines lines, const ShardBeginning& beginning) {
  if (beginning.study != C::kStudy) {
    return Error{lines.name() + ": is of the study '" + beginning.study + "', not of '" +
                 std::string(C::kStudy) + "'; shards of one campaign belong together"};
  }
  Expected<C> campaign = campaign_from_json<C>(beginning.campaign);
  if (!campaign)
    return Error{lines.name() + ": has a wrong header: campaign is wrong: " + campaign.error()};
  return ShardReader(std::move(lines), {std::move(*campaign), beginning.shard});
}

template <class C>
Expected<std::optional<typename ShardKind<C>::Run>> ShardReader<C>::next() {
  using Line = ShardLines::Line;
  const Line line = lines_.read();
  if (is_complete_ && line != Line::kNone)
    return lines_.error("there is something after the last line");
  if (line == Line::kTooLong) return lines_.error("the line is too long");
  if (line != Line::kWhole) return std::optional<Run>();
  const std::optional<Json> json = unsealed(lines_.text());
  if (!json) return lines_.error("the line is damaged: its checksum does not fit");
  return json->contains("metrics") ? run(*json) : end(*json);
}

template <class C>
Expected<std::optional<typename ShardKind<C>::Run>> ShardReader<C>::run(const Json& json) {
  if (runs_ == size(header_.shard, header_.campaign))
    return lines_.error("there are more runs than the shard has");
  const RunId expected = header_.campaign[campaign_index(header_.shard, runs_)];
  JsonFields fields(json);
  if (fields.natural("row", std::numeric_limits<std::uint32_t>::max()) != expected.row ||
      fields.natural("run", std::numeric_limits<std::uint32_t>::max()) != expected.run) {
    return lines_.error("here should be run " + std::to_string(expected.run) + " of row " +
                        std::to_string(expected.row));
  }
  Expected<Run> run = run_from_json<Run>(fields.object("metrics"));
  if (!run) fields.complain_inside("metrics", run.error());
  const std::string complaint = fields.complaint();
  if (!complaint.empty()) return lines_.error(complaint);
  ++runs_;
  return std::optional<Run>(std::move(*run));
}

template <class C>
Expected<std::optional<typename ShardKind<C>::Run>> ShardReader<C>::end(const Json& json) {
  JsonFields fields(json);
  const std::uint64_t runs = fields.natural("runs", std::numeric_limits<std::uint64_t>::max());
  const std::string complaint = fields.complaint();
  if (!complaint.empty()) return lines_.error(complaint);
  if (runs != runs_ || runs != size(header_.shard, header_.campaign)) {
    return lines_.error("the last line says " + std::to_string(runs) + " runs, but there are " +
                        std::to_string(runs_) + " before it");
  }
  is_complete_ = true;
  return next();  // there must be nothing more
}

template std::string header_line(const ShardHeader<Campaign>&);
template std::string header_line(const ShardHeader<SuaveCampaign>&);
template std::string run_line(RunId, const RunMetrics&);
template std::string run_line(RunId, const SuaveRun&);
template class ShardReader<Campaign>;
template class ShardReader<SuaveCampaign>;

Expected<AnyShardReader> open_shard(std::istream& in, std::string name) {
  ShardLines lines(in, std::move(name));
  const Expected<ShardBeginning> beginning = read_beginning(lines);
  if (!beginning) return Error{beginning.error()};
  if (beginning->study == Campaign::kStudy)
    return any(ShardReader<Campaign>::open(std::move(lines), *beginning));
  if (beginning->study == SuaveCampaign::kStudy)
    return any(ShardReader<SuaveCampaign>::open(std::move(lines), *beginning));
  return Error{lines.name() + ": is of a study '" + beginning->study +
               "' that this culprit does not know; use the culprit that wrote it"};
}

}  // namespace culprit::study

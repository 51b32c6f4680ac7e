#include "study/single_run.h"

#include "study/rca/campaign_json.h"
#include "study/shards/run_record.h"
#include "study/shards/shard_kind.h"
#include "study/shards/suave_record.h"
#include "study/sunset/study.h"

namespace culprit::study {
namespace {

Expected<SingleRun> run_again(const Campaign& campaign, RunId id) {
  const auto study = SunsetStudy::make(campaign.rows, campaign.seed);
  if (!study) return Error{study.error()};
  return study->single_run(id);
}

Expected<SingleRun> run_again(const SuaveCampaign& campaign, RunId id) {
  return single_run(campaign, id);
}

Expected<SingleRun> run_again(const rca::RcaCampaign& campaign, RunId id) {
  return rca::single_run(campaign, id);
}

std::size_t rows_of(const Campaign& campaign) { return campaign.rows.size(); }
std::size_t rows_of(const SuaveCampaign& campaign) { return campaign.managers.size(); }
std::size_t rows_of(const rca::RcaCampaign& campaign) { return campaign.rows(); }

std::uint32_t runs_of(const auto& campaign) { return campaign.runs; }
std::uint32_t runs_of(const rca::RcaCampaign& campaign) { return campaign.episodes; }

template <class C>
Expected<SingleRun> play_of(const Expected<C>& campaign, RunId id) {
  if (!campaign) return Error{"the campaign is wrong: " + campaign.error()};
  if (id.row >= rows_of(*campaign) || id.run >= runs_of(*campaign))
    return Error{"the campaign has no run " + std::to_string(id.run) + " of row " +
                 std::to_string(id.row) + "; both count from 0"};
  return run_again(*campaign, id);
}

}  // namespace

Expected<SingleRun> play_again(std::string_view study, const nlohmann::ordered_json& campaign,
                               RunId id) {
  if (study == ShardKind<Campaign>::kName)
    return play_of(campaign_from_json<Campaign>(campaign), id);
  if (study == ShardKind<SuaveCampaign>::kName)
    return play_of(campaign_from_json<SuaveCampaign>(campaign), id);
  if (study == rca::kStudyName) return play_of(rca::campaign_from_json(campaign), id);
  return Error{"there is no study '" + std::string(study) + "'; there are sunset, suave and rca"};
}

}  // namespace culprit::study

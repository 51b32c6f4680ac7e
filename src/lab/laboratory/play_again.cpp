#include "laboratory/play_again.h"

#include "rca_study/campaign_json.h"
#include "study/run_record.h"
#include "suave_study/suave_record.h"
#include "sunset_study/study.h"

namespace culprit::lab {
namespace {

Expected<study::SingleRun> run_again(const study::Campaign& campaign, study::RunId id) {
  const auto study = study::SunsetStudy::make(campaign.rows, campaign.seed);
  if (!study) return Error{study.error()};
  return study->single_run(id);
}

Expected<study::SingleRun> run_again(const study::SuaveCampaign& campaign, study::RunId id) {
  return study::single_run(campaign, id);
}

Expected<study::SingleRun> run_again(const study::rca::RcaCampaign& campaign, study::RunId id) {
  return study::rca::single_run(campaign, id);
}

std::size_t rows_of(const study::Campaign& campaign) { return campaign.rows.size(); }
std::size_t rows_of(const study::SuaveCampaign& campaign) { return campaign.managers.size(); }
std::size_t rows_of(const study::rca::RcaCampaign& campaign) { return campaign.rows(); }

std::uint32_t runs_of(const auto& campaign) { return campaign.runs; }
std::uint32_t runs_of(const study::rca::RcaCampaign& campaign) { return campaign.episodes; }

template <class C>
Expected<study::SingleRun> play_of(const Expected<C>& campaign, study::RunId id) {
  if (!campaign) return Error{"the campaign is wrong: " + campaign.error()};
  if (id.row >= rows_of(*campaign) || id.run >= runs_of(*campaign))
    return Error{"the campaign has no run " + std::to_string(id.run) + " of row " +
                 std::to_string(id.row) + "; both count from 0"};
  return run_again(*campaign, id);
}

}  // namespace

Expected<study::SingleRun> play_again(std::string_view study, const Json& campaign,
                                      study::RunId id) {
  if (study == study::Campaign::kStudy)
    return play_of(study::campaign_from_json<study::Campaign>(campaign), id);
  if (study == study::SuaveCampaign::kStudy)
    return play_of(study::campaign_from_json<study::SuaveCampaign>(campaign), id);
  if (study == study::rca::RcaCampaign::kStudy)
    return play_of(study::rca::campaign_from_json(campaign), id);
  return Error{"there is no study '" + std::string(study) + "'; there are sunset, suave and rca"};
}

}  // namespace culprit::lab

// The studies in virtual time: how long the paper's ablation on SUNSET, all managers of SUAVE and a
// fifth of the root-cause benchmark take on one core, and whether more runs need more memory.
#include <chrono>
#include <fstream>
#include <string>

#include <benchmark/benchmark.h>

#include "claims.h"
#include "rca_study/campaign.h"
#include "study/campaign_result.h"
#include "suave_study/campaign.h"
#include "sunset_study/study.h"

namespace culprit::bench {
namespace {

using Clock = std::chrono::steady_clock;

// The memory of this process, in MiB.
double resident() {
  std::ifstream in("/proc/self/statm");
  double pages = 0;
  in >> pages >> pages;
  return pages * 4096 / (1 << 20);
}

study::Campaign ablation(std::uint32_t runs) {
  study::Campaign campaign;
  for (int row = 0; row < 8; ++row)
    campaign.rows.push_back(
        {{(row & 4) != 0, (row & 2) != 0, (row & 1) != 0}, "paper", "paper", {}});
  campaign.runs = runs;
  campaign.seed = 1;
  return campaign;
}

void play(const study::Campaign& campaign) {
  const auto study = study::SunsetStudy::make(campaign.rows, campaign.seed);
  study::CampaignFold fold(campaign);
  for (std::uint64_t i = 0; i < campaign.size(); ++i) fold.add(study->run(campaign[i]));
  benchmark::DoNotOptimize(fold.result());
}

void sunset_study(benchmark::State& state) {
  for (auto _ : state) {
    play(ablation(18));
    const double after_144_runs = resident();
    const auto begin = Clock::now();
    play(ablation(162));
    const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
    claim("the paper's ablation, 8 x 162 runs of SUNSET, on one core", seconds, 5, "s");
    claim("memory that nine times as many runs need more", resident() - after_144_runs, 1, "MiB");
  }
}
BENCHMARK(sunset_study)->Iterations(1)->Unit(benchmark::kSecond);

void suave_study(benchmark::State& state) {
  study::SuaveCampaign campaign;
  campaign.plan = *suave::model::find_mission_plan("extended");
  campaign.generation = *suave::model::find_generation("era");
  for (const study::SuaveContender& each : study::suave_contenders())
    campaign.managers.push_back(each.name);
  campaign.runs = 100;
  campaign.seed = 1;
  for (auto _ : state) {
    const auto begin = Clock::now();
    benchmark::DoNotOptimize(study::run_campaign(campaign, 1));
    const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
    claim("SUAVE's extended mission, 6 managers x 100 runs, on one core", seconds, 10, "s");
  }
}
BENCHMARK(suave_study)->Iterations(1)->Unit(benchmark::kSecond);

// culprit study rca has five times as many episodes, and may take 10 s.
void rca_study(benchmark::State& state) {
  study::rca::RcaCampaign campaign;
  campaign.settings = {{200, 3, 0, false}};
  campaign.planners = {"naive", "first-failing", "topological", "random-walk", "paper", "bayes"};
  campaign.episodes = 20;
  campaign.seed = 1;
  for (auto _ : state) {
    const auto begin = Clock::now();
    benchmark::DoNotOptimize(study::rca::run_campaign(campaign, 1, nullptr));
    const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
    claim("root causes on 200 components, 6 planners x 20 episodes, on one core", seconds, 2, "s");
  }
}
BENCHMARK(rca_study)->Iterations(1)->Unit(benchmark::kSecond);

}  // namespace
}  // namespace culprit::bench

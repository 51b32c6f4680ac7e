#include "cli/single_run_route.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <sys/resource.h>
#include <thread>
#include <unistd.h>

#include "study/single_run.h"

namespace culprit::cli {
namespace {

using web::Json;

constexpr int kLowest = 19;

std::optional<std::uint32_t> natural(const Json& body, const char* member) {
  constexpr auto kMost = std::numeric_limits<std::uint32_t>::max();
  const auto found = body.find(member);
  if (found == body.end() || !found->is_number_unsigned() || *found > kMost) return std::nullopt;
  return found->get<std::uint32_t>();
}

Json to_json(const study::TimelineEntry& incident) {
  return {{"t", std::round(incident.time_s * 1000) / 1000},
          {"kind", study::name(incident.kind)},
          {"component", incident.component},
          {"text", incident.text}};
}

// As the live stream has them. What nobody has words for is left out, as there.
Json to_json(const study::SingleRun& run) {
  std::vector<Json> events;
  for (const study::TimelineEntry& incident : run.incidents) events.push_back(to_json(incident));
  for (const Event& event : run.events) {
    Json json = web::to_json(event, run.rules, Time{});
    if (!json["text"].get_ref<const std::string&>().empty()) events.push_back(std::move(json));
  }
  std::stable_sort(events.begin(), events.end(), [](const Json& a, const Json& b) {
    return a["t"].get<double>() < b["t"].get<double>();
  });
  return {{"scenario", run.scenario},
          {"is_told", run.is_told},
          {"end", run.end_s},
          {"events", std::move(events)}};
}

Expected<study::SingleRun> play_as_guest(const std::string& study, const Json& campaign,
                                         study::RunId id) {
  std::optional<Expected<study::SingleRun>> run;
  std::thread guest([&] {
    setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kLowest);
    run = study::play_again(study, campaign, id);
  });
  guest.join();
  return std::move(*run);
}

web::Answer answer(const Json& body, std::mutex& playing) {
  const auto study = web::text_of(body, "study");
  const auto campaign = body.is_object() ? body.find("campaign") : body.end();
  if (!study || campaign == body.end())
    return web::refuse(400, "send 'study' and 'campaign' as they stand in the campaign's result");
  const auto row = natural(body, "row");
  const auto run = natural(body, "run");
  if (!row || !run) return web::refuse(400, "'row' and 'run' have to be whole numbers from 0");
  const std::unique_lock lock(playing, std::try_to_lock);
  if (!lock) return web::refuse(409, "another run is being played; ask again in a moment");
  const auto played = play_as_guest(*study, *campaign, {*row, *run});
  if (!played) return web::refuse(422, played.error());
  return {200, to_json(*played)};
}

}  // namespace

web::Route single_run_route() {
  return {web::Method::kPost, "/api/studies/run",
          [playing = std::make_shared<std::mutex>()](const Json& body) {
            return answer(body, *playing);
          }};
}

}  // namespace culprit::cli

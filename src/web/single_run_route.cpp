#include <limits>
#include <memory>
#include <optional>

#include "base/environment.h"
#include "base/mutex.h"
#include "base/text_file.h"
#include "web/aside.h"
#include "web/calls.h"

namespace culprit::web {
namespace {

std::optional<std::uint32_t> natural(const Json& body, const char* member) {
  constexpr auto kMost = std::numeric_limits<std::uint32_t>::max();
  const auto found = body.find(member);
  if (found == body.end() || !found->is_number_unsigned() || *found > kMost) return std::nullopt;
  return found->get<std::uint32_t>();
}

constexpr int kMostSecondsOfRun = 600;

http::Answer play(const Json& request) {
  const auto laboratory = find_laboratory();
  if (!laboratory) return http::refuse(503, laboratory.error());
  const auto folder = TemporaryFolder::make("aside");
  if (!folder) return http::refuse(503, folder.error());
  const std::string wish = *folder / "request.json";
  if (const auto written = write_text(wish, to_line(request)); !written)
    return http::refuse(503, written.error());
  const auto played =
      run_aside({laboratory->string(), "play-again", wish}, *folder, kMostSecondsOfRun);
  if (!played) return http::refuse(503, "the run could not be played: " + played.error());
  if (played->status != 0) return http::refuse(422, played->text);
  Json body = parse_json(played->text);
  if (!body.is_object()) return http::refuse(503, "culprit-lab gave no run: " + played->text);
  return {200, std::move(body)};
}

http::Answer answer(const Json& body, Mutex& playing) {
  const auto study = http::text_of(body, "study");
  const auto campaign = body.is_object() ? body.find("campaign") : body.end();
  if (!study || campaign == body.end())
    return http::refuse(400, "send 'study' and 'campaign' as they stand in the campaign's result");
  const auto row = natural(body, "row");
  const auto run = natural(body, "run");
  if (!row || !run) return http::refuse(400, "'row' and 'run' have to be whole numbers from 0");
  if (!playing.try_lock())
    return http::refuse(409, "another run is being played; ask again in a moment");
  const MutexLock lock(playing, std::adopt_lock);
  return play({{"study", *study}, {"campaign", *campaign}, {"row", *row}, {"run", *run}});
}

}  // namespace

http::Route single_run_route() {
  return {
      http::Method::kPost, "/api/studies/run",
      [playing = std::make_shared<Mutex>()](const Json& body) { return answer(body, *playing); },
      http::Role::kOperate};
}

}  // namespace culprit::web

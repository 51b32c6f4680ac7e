#include <memory>

#include "base/environment.h"
#include "base/mutex.h"
#include "base/text_file.h"
#include "language/checker.h"
#include "live/run_journal.h"
#include "web/aside.h"
#include "web/calls.h"

namespace culprit::web {
namespace {

constexpr double kMostBack = 7 * 86'400;  // s
constexpr int kMostSecondsOfReplay = 60;

http::Answer look_back(const std::string& rules, std::int64_t seconds,
                       const std::filesystem::path& journal) {
  const auto folder = TemporaryFolder::make("aside");
  if (!folder) return http::refuse(503, folder.error());
  const std::string file = *folder / "my.rules";
  if (const auto written = write_text(file, rules); !written)
    return http::refuse(503, written.error());
  const auto looked =
      run_aside({(own_folder() / "culprit").string(), "replay", journal.string(), "--rules", file,
                 "--since", std::to_string(seconds) + "s", "--json"},
                *folder, kMostSecondsOfReplay);
  if (!looked) return http::refuse(503, "the journal could not be replayed: " + looked.error());
  if (looked->status != 0) return http::refuse(422, looked->text);
  Json body = parse_json(looked->text);
  if (!body.is_object()) return http::refuse(503, "the replay gave nothing: " + looked->text);
  return {200, std::move(body)};
}

http::Answer answer(const Json& body, const JournalOf& journal_of, Mutex& replaying) {
  const auto text = http::text_of(body, "text");
  const auto seconds = body.is_object() ? body.find("seconds") : body.end();
  const bool is_given = body.is_object() && seconds != body.end() && seconds->is_number();
  if (!text || !is_given || !(*seconds >= 1) || !(*seconds <= kMostBack))
    return http::refuse(
        400, "send the rules as 'text', and how far to look back as 'seconds', a week at most");
  if (!check(Source("rules", *text)).rules)
    return http::refuse(422, "the rules have errors; mend them first");
  const auto journal = journal_of(*text);
  if (!journal) return http::refuse(404, journal.error());
  if (!replaying.try_lock())
    return http::refuse(409, "another replay is going on; ask again in a moment");
  const MutexLock lock(replaying, std::adopt_lock);
  return look_back(*text, seconds->get<std::int64_t>(), *journal);
}

}  // namespace

http::Route hindsight_route(JournalOf journal_of) {
  return {http::Method::kPost, "/api/rules/replay",
          [journal_of = std::move(journal_of), replaying = std::make_shared<Mutex>()](
              const Json& body) { return answer(body, journal_of, *replaying); },
          http::Role::kLook};
}

Expected<std::filesystem::path> usual_journal(const std::string& rules) {
  const auto checked = check(Source("rules", rules)).rules;
  const std::string robot = checked ? checked->robot : "";
  const std::filesystem::path journal = live::default_journal(default_state_folder(), robot);
  std::error_code error;
  if (!std::filesystem::exists(journal, error))
    return Error{"nothing was recorded of " +
                 (robot.empty() ? std::string("a robot without a name") : robot) +
                 ": culprit run writes " + journal.string()};
  return journal;
}

}  // namespace culprit::web

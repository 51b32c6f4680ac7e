#include "web/single_run_route.h"

#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <stdlib.h>
#include <sys/wait.h>

#include "base/environment.h"
#include "base/mutex.h"
#include "base/text_file.h"
#include "owners/spawn.h"

namespace culprit::web {
namespace {

namespace fs = std::filesystem;

std::optional<std::uint32_t> natural(const Json& body, const char* member) {
  constexpr auto kMost = std::numeric_limits<std::uint32_t>::max();
  const auto found = body.find(member);
  if (found == body.end() || !found->is_number_unsigned() || *found > kMost) return std::nullopt;
  return found->get<std::uint32_t>();
}

// Gone with all that is in it.
class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "culprit-run-XXXXXX").string();
    if (mkdtemp(name.data()) != nullptr) path_ = name;
  }
  ~Folder() {
    std::error_code error;
    if (!path_.empty()) fs::remove_all(path_, error);
  }
  Folder(const Folder&) = delete;

  std::string file(const char* name) const { return (path_ / name).string(); }

 private:
  fs::path path_;
};

Answer play(const Json& request) {
  const auto laboratory = find_laboratory();
  if (!laboratory) return refuse(503, laboratory.error());
  const Folder folder;
  const std::string wish = folder.file("request.json");
  const std::string out = folder.file("answer");
  if (const auto written = write_text(wish, request.dump()); !written)
    return refuse(503, written.error());
  owners::Program player{{"nice", "-n", "19", laboratory->string(), "play-again", wish}, {}, out};
  player.lifetime = owners::Lifetime::kStarter;
  const auto pid = owners::spawn(player);
  if (!pid) return refuse(503, pid.error());
  int status = 0;
  waitpid(*pid, &status, 0);
  const auto text = read_text(out);
  if (!text) return refuse(503, text.error());
  if (!WIFEXITED(status)) return refuse(503, "culprit-lab was killed while it played the run");
  if (WEXITSTATUS(status) != 0) return refuse(422, *text);
  Json body = Json::parse(*text, nullptr, false);
  if (!body.is_object()) return refuse(503, "culprit-lab gave no run: " + *text);
  return {200, std::move(body)};
}

Answer answer(const Json& body, Mutex& playing) {
  const auto study = text_of(body, "study");
  const auto campaign = body.is_object() ? body.find("campaign") : body.end();
  if (!study || campaign == body.end())
    return refuse(400, "send 'study' and 'campaign' as they stand in the campaign's result");
  const auto row = natural(body, "row");
  const auto run = natural(body, "run");
  if (!row || !run) return refuse(400, "'row' and 'run' have to be whole numbers from 0");
  if (!playing.try_lock()) return refuse(409, "another run is being played; ask again in a moment");
  const MutexLock lock(playing, std::adopt_lock);
  return play({{"study", *study}, {"campaign", *campaign}, {"row", *row}, {"run", *run}});
}

}  // namespace

Route single_run_route() {
  return {
      Method::kPost, "/api/studies/run",
      [playing = std::make_shared<Mutex>()](const Json& body) { return answer(body, *playing); }};
}

}  // namespace culprit::web

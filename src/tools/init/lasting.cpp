#include "init/lasting.h"

#include <algorithm>
#include <filesystem>

#include "base/environment.h"
#include "base/text_file.h"
#include "init/marks.h"

namespace culprit::init {
namespace {

namespace fs = std::filesystem;

// "/left/camera" of "my.rules": "my.left_camera.params.yaml"; its second file "my.left_camera.2.params.yaml".
std::string copy_beside(const std::string& rules, const std::string& node, int place) {
  std::string name = node.substr(node.find_first_not_of('/'));
  std::replace(name.begin(), name.end(), '/', '_');
  if (place > 1) name += "." + std::to_string(place);
  fs::path path(rules);
  return path.replace_extension(name + ".params.yaml").native();
}

}  // namespace

bool is_temporary(const std::string& path) {
  std::vector<std::string> folders{"/tmp", "/var/tmp", "/dev/shm", "/run"};
  if (const std::string own = environment("TMPDIR"); !own.empty()) folders.push_back(own);
  return std::ranges::any_of(folders, [&](std::string folder) {
    while (folder.size() > 1 && folder.ends_with('/')) folder.pop_back();
    return path.starts_with(folder + "/");
  });
}

Kept keep_parameters(RobotProfile& seen, const std::string& rules) {
  Kept kept;
  for (auto& [node, start] : seen.starts) {
    int place = 0;
    for (std::size_t i = 0; i + 1 < start.command.size(); ++i) {
      if (start.command[i] != "--params-file") continue;
      ++place;
      std::string& file = start.command[i + 1];
      if (!is_temporary(file)) continue;
      const auto text = read_text(file);
      if (!text) {
        kept.notes.push_back(node + ": its parameter file " + file +
                             " cannot be read, so no redeploy would find it: name another in its "
                             "LAUNCH");
      } else if (rules.empty()) {
        kept.notes.push_back(node + ": its parameter file " + file +
                             " is temporary: with -o, culprit keeps a copy beside the rules");
      } else {
        file = copy_beside(rules, node, place);
        kept.files.push_back({file, with_mark(*text)});
      }
    }
  }
  return kept;
}

}  // namespace culprit::init

#include "owners/launch_note.h"

#include <fstream>
#include <system_error>

namespace culprit::owners {
namespace {

std::filesystem::path note_of(const std::filesystem::path& folder, const std::string& component) {
  return folder / (component + ".launcher");
}

}  // namespace

void note_launch(const std::filesystem::path& folder, const std::string& component, int launcher) {
  if (folder.empty()) return;  // a supervisor without logs keeps nothing
  std::error_code error;
  const std::filesystem::path note = note_of(folder, component);
  const std::string text = launcher == 0 ? "" : to_text(launcher);
  if (text.empty()) {
    std::filesystem::remove(note, error);
    return;
  }
  std::filesystem::create_directories(folder, error);
  const std::filesystem::path draft = note.string() + ".new";
  {
    std::ofstream out(draft, std::ios::trunc);
    out << text << '\n';
    if (!out.flush()) return;
  }
  std::filesystem::rename(draft, note, error);
}

PlaceHeld noted_launch(const std::filesystem::path& folder, const std::string& component) {
  if (folder.empty()) return {};
  std::ifstream in(note_of(folder, component));
  std::string text;
  std::getline(in, text);
  return place_in(text);
}

}  // namespace culprit::owners

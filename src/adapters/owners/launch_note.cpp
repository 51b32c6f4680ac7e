#include "owners/launch_note.h"

#include <algorithm>
#include <fstream>
#include <system_error>

namespace culprit::owners {
namespace {

// "0-sunset-camera.launcher": a component's name has no hyphen.
std::filesystem::path note_of(const std::filesystem::path& folder, std::string component) {
  std::ranges::replace(component, '/', '-');
  return folder / (component + ".launcher");
}

bool write_note(const std::filesystem::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::trunc);
  out << text << '\n';
  return static_cast<bool>(out.flush());
}

}  // namespace

void note_launch(const std::filesystem::path& folder, const std::string& component, int launcher) {
  if (folder.empty()) return;  // a supervisor without logs keeps nothing
  std::error_code error;
  const std::filesystem::path note = note_of(folder, component);
  const std::string text = launcher == 0 ? "" : to_text(launcher);
  const std::filesystem::path draft = note.string() + ".new";
  if (!text.empty()) {
    std::filesystem::create_directories(folder, error);
    if (write_note(draft, text)) {
      std::filesystem::rename(draft, note, error);
      if (!error) return;
    }
  }
  // Not the launcher before this one either.
  std::filesystem::remove(note, error);
  std::filesystem::remove(draft, error);
}

PlaceHeld noted_launch(const std::filesystem::path& folder, const std::string& component) {
  if (folder.empty()) return {};
  std::ifstream in(note_of(folder, component));
  std::string text;
  std::getline(in, text);
  return place_in(text);
}

}  // namespace culprit::owners

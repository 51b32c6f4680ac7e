// Which launcher had started a component, noted beside its log, so that the next culprit knows after this one was
// killed. Best effort: where the note cannot be written, the next culprit knows of no launcher.
#pragma once

#include <filesystem>
#include <string>

#include "owners/mark.h"

namespace culprit::owners {

// `component`: with its robot, "0/sunset/camera" (mark.h): robots of one machine may share the folder. `launcher`: 0 forgets it.
void note_launch(const std::filesystem::path& folder, const std::string& component, int launcher);

// Launcher 0: none is noted.
PlaceHeld noted_launch(const std::filesystem::path& folder, const std::string& component);

}  // namespace culprit::owners

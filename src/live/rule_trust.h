// Who could change what culprit does? The author of its rule file decides what is done to the
// robot, and which programs run as culprit's user. The author of its journal decides which process
// belongs to which component, and which actions were under way. So only that user and root may be
// able to write these files, or to replace them.
#pragma once

#include <filesystem>
#include <string>

#include "base/expected.h"

namespace culprit::live {

// Errors: the file or a folder above it belongs to another user, or is writable for its group or
// for all. A group that is its owner's alone, as Debian gives each user one, is no other. In a
// folder with the sticky bit, such as /tmp, users can only replace their own files.
Expected<void> trust_rules(const std::string& path);

// The same for the SETUP of a launch command, a shell script. A missing file is an error, too.
Expected<void> trust_setup(const std::string& path);

// The same for culprit's own data: the state folder, the journal, and the files beside it. A
// missing file is judged by the folder that it will be made in.
Expected<void> trust_state(const std::filesystem::path& folder,
                           const std::filesystem::path& journal);

// Takes the rights of others off this user's journal and what is kept beside it: an older culprit left them.
void make_private(const std::filesystem::path& journal);

}  // namespace culprit::live

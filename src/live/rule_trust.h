// Who could change what culprit does? Whoever writes its rule file says what is done to the robot,
// and which programs are started as culprit's user. Whoever writes its journal says which process
// is whose, and what was under way. So nobody but that user and root may be able to write them, or
// to put others in their place.
#pragma once

#include <filesystem>
#include <string>

#include "base/expected.h"

namespace culprit::live {

// Errors: the file or a folder above it belongs to somebody else, or is writable for its group or
// for all. A group that is its owner's alone, as Debian gives each user one, is no other; in a
// folder with the sticky bit, such as /tmp, nobody replaces what is not his own.
Expected<void> trust_rules(const std::string& path);

// Likewise of the SETUP of a launch command, a file of shell. An error, too: it is not there.
Expected<void> trust_setup(const std::string& path);

// Likewise of where culprit keeps what it knows: the state folder, the journal, and what is kept
// beside that. What is not there yet is judged by the folder that it will be made in.
Expected<void> trust_state(const std::filesystem::path& folder,
                           const std::filesystem::path& journal);

// Takes the rights of others off this user's journal and what is kept beside it: an older culprit left them.
void make_private(const std::filesystem::path& journal);

}  // namespace culprit::live

// How a command ends.
#pragma once

#include <string>

namespace culprit {

// Exit codes: all is well; what was asked for did not succeed; it was asked for wrongly.
constexpr int kOk = 0;
constexpr int kFailed = 1;
constexpr int kUsage = 2;
constexpr int kWarnings = 3;  // and no error

// Says on stderr why it cannot be done, with what steers a terminal escaped: names and texts in it may be those of
// strangers. Gives `exit_code`.
int fail(const std::string& why, int exit_code = kFailed);

// Why `path` cannot be a folder, which may not be there yet: it is a file. Empty: it can.
std::string trouble_of_folder(const std::string& path);

}  // namespace culprit

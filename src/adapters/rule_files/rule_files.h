// Rule files on disk, with the files that they INCLUDE.
//
// The name in an INCLUDE is looked up in the folder of the file that includes, then among the rules
// that were installed with culprit. Only regular files whose name ends in ".rules" are read.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "language/reuse/expansion.h"

namespace culprit::rule_files {

// share/culprit/rules beside the bin of the running program; it need not be there.
const std::filesystem::path& installed();

// For expand(): one file, by its name in an INCLUDE of `from`. Errors: there is none; the message
// lists the folders that were searched, and a similar name.
Expected<Source> load(const std::string& file, const std::string& from);

// The rules of the file at `path`, put together. Errors: it cannot be read. Faults of an included
// file are mistakes in the result.
Expected<Expansion> read(const std::string& path);

// The names that an INCLUDE of `from` could use: files in the folder of `from` and below, and
// installed ones. At most a few hundred, sorted.
std::vector<std::string> includable(const std::string& from);

// The files named *<extension> in `path` and the folders below, sorted; `path` itself if it is no
// folder. Folders and files whose names begin with a point are passed over. Errors: there is none.
Expected<std::vector<std::string>> files_in(const std::string& path, const std::string& extension);

}  // namespace culprit::rule_files

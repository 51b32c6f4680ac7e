// Repair of a damaged shard file: it is kept under another name, and the shard goes on behind the last line before the damage.
#pragma once

#include <filesystem>

#include "shards/shard_file.h"

namespace culprit::study {

// Gives what the damaged file is called now. Errors: the file is not damaged, or is recognizably
// none of this campaign and shard; it is left as it was.
template <class C>
Expected<std::filesystem::path> set_damage_aside(const std::filesystem::path& path,
                                                 const ShardHeader<C>& header);

}  // namespace culprit::study

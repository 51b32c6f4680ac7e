// Which shard a process of a cluster is: what its scheduler says in the environment.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "shards/shard.h"

namespace culprit::study {

// A variable of the environment; empty: it is not set.
using Variable = std::function<std::string(const char* name)>;

// "2/4" as it stands; "auto", or "auto/4" where the scheduler does not say how many there are:
//
//     Slurm          SLURM_ARRAY_TASK_ID, from _MIN on in steps of _STEP; _COUNT of them
//     Kubernetes     JOB_COMPLETION_INDEX, from 0 on; it does not say of how many
//     GNU parallel   PARALLEL_SEQ, from 1 on; it does not say of how many
//
// Errors: none of these is set, or several are; or it is beyond the count.
Expected<Shard> shard_of(std::string_view text, const Variable& variable);

}  // namespace culprit::study

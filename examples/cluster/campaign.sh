#!/bin/sh
# The paper's evaluation on SUNSET in eight shards, as many at once as there are processors. To go on after an
# interruption, run it again. CULPRIT_STUDY in the environment is another campaign.
set -eu
mkdir -p shards
# shellcheck disable=SC2086 # a list of words
seq 8 | parallel -n0 --halt soon,fail=1 "${CULPRIT:-culprit}" study \
  ${CULPRIT_STUDY:-sunset --ablation --planner paper --planner bayes --runs 1620} \
  --jobs 1 --shard auto/8 --shard-file shards/sunset-%.shard

// Working off a campaign's runs, all of them or a shard, with a progress line, until it is done or
// interrupted: what the studies of culprit study have in common.
//
// C is a campaign (shards/shard_kind.h); `play` makes a run of it from a RunId, on several
// threads, or an error, which ends the work. `signals` say when to stop.
#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

#include "laboratory/commands.h"
#include "shards/shard_damage.h"
#include "shards/shard_writer.h"
#include "study/ordered_work.h"
#include "terminal/console.h"
#include "terminal/progress.h"

namespace culprit::lab {

struct ShardOptions {
  std::string shard = "1/1";
  std::string file;

  bool is_sharded() const { return shard != "1/1" || !file.empty(); }
  // Which one this is. Errors: no shard is named.
  Expected<study::Shard> which() const;
  // The file of `its`: "%" stands for its number.
  std::string file_of(const study::Shard& its) const;
  // --shard, --shard-file
  void add_to(CLI::App& command);
};

// The runs from `done` to `total`, in order; `take` gets each and says whether it was kept.
template <class Play, class Take>
void work_off(std::uint64_t done, std::uint64_t total, unsigned jobs, const StopSignals& signals,
              Progress& progress, Play play, Take take) {
  study::work_in_order(done, total, jobs, play, [&](std::uint64_t i, auto run) {
    if (run) progress.show(i + 1);
    return take(std::move(run)) && !signals.stopped();
  });
}

// The whole campaign; nothing if it was interrupted or a run failed, which is said. It is what
// `progress` begins with.
template <class C, class Play>
std::optional<typename study::ShardKind<C>::Result> run_whole(const C& campaign, unsigned jobs,
                                                              const StopSignals& signals,
                                                              Progress& progress, Play play) {
  using Run = typename study::ShardKind<C>::Run;
  typename study::ShardKind<C>::Fold fold(campaign);
  std::string trouble;
  work_off(
      0, campaign.size(), jobs, signals, progress,
      [&](std::uint64_t i) { return Expected<Run>(play(campaign[i])); },
      [&](Expected<Run> run) {
        if (run) {
          fold.add(std::move(*run));
        } else {
          trouble = run.error();
        }
        return run.has_value();
      });
  if (fold.is_complete()) return std::move(fold).result();
  progress.end();
  if (!trouble.empty() && !signals.stopped()) {
    fail(trouble + "; nothing is written", kFailed);
    return std::nullopt;
  }
  fail("interrupted; with --shard-file the same command could go on", kFailed);
  return std::nullopt;
}

// The writer of a shard; a file that is damaged is set aside first, which is said.
template <class C>
Expected<study::ShardWriter<C>> open_shard(const std::string& file,
                                           const study::ShardHeader<C>& header) {
  auto writer = study::ShardWriter<C>::open(file, header);
  if (writer) return writer;
  const auto aside = study::set_damage_aside<C>(file, header);
  if (!aside) return writer;
  fmt::print(stderr,
             "culprit: {} was damaged; it is kept as {}, and the lost runs are played again\n",
             file, aside->string());
  return study::ShardWriter<C>::open(file, header);
}

// A shard, into its file. Gives an exit code.
template <class C, class Play>
int fill_shard(const C& campaign, const ShardOptions& options, unsigned jobs,
               const StopSignals& signals, Play play) {
  using Run = typename study::ShardKind<C>::Run;
  const auto shard = options.which();
  if (!shard) return fail(shard.error(), kUsage);
  if (options.file.empty())
    return fail("--shard needs --shard-file, where its runs are kept for `culprit study merge`",
                kUsage);
  const std::string file = options.file_of(*shard);
  const study::ShardHeader<C> header{campaign, *shard};
  auto writer = open_shard(file, header);
  if (!writer) return fail(writer.error(), kFailed);
  if (writer->done() > 0)
    fmt::print(stderr, "culprit: {} of {} runs are there already\n", writer->done(),
               writer->size());
  std::string trouble;
  Progress progress(writer->done(), writer->size());
  work_off(
      writer->done(), writer->size(), jobs, signals, progress,
      [&](std::uint64_t i) {
        return Expected<Run>(play(campaign[study::campaign_index(*shard, i)]));
      },
      [&](const Expected<Run>& run) {
        const auto appended = run ? writer->append(*run) : Expected<void>(Error{run.error()});
        if (!appended) trouble = appended.error();
        return appended.has_value();
      });
  progress.end();
  if (!trouble.empty() && !signals.stopped()) return fail(trouble, kFailed);
  if (!writer->is_complete())
    return fail(fmt::format("interrupted after {} of {} runs; the same command goes on from there",
                            writer->done(), writer->size()),
                kFailed);
  fmt::print(stderr, "culprit: {} has its {} runs\n", file, writer->size());
  return kOk;
}

}  // namespace culprit::lab

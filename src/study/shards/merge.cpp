#include "study/shards/merge.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <deque>
#include <fstream>
#include <optional>

#include "study/shards/shard_file.h"

namespace culprit::study {
namespace {

// What the two are not agreed on; empty if they are.
std::string disagreement(const ShardHeader& ours, const ShardHeader& theirs) {
  const auto differ = [](const std::string& what, const auto& a, const auto& b) {
    return "has " + what + " " + b + ", but the first file has " + a;
  };
  const Campaign& a = ours.campaign;
  const Campaign& b = theirs.campaign;
  if (a.version != b.version) return differ("culprit version", a.version, b.version);
  if (a.seed != b.seed) return differ("seed", std::to_string(a.seed), std::to_string(b.seed));
  if (a.runs != b.runs)
    return differ("a number of runs of", std::to_string(a.runs), std::to_string(b.runs));
  if (a.rows != b.rows) return "has other configurations than the first file";
  if (a.command != b.command)
    return "was made by '" + b.command + "', but the first file by '" + a.command + "'";
  if (ours.shard.count != theirs.shard.count)
    return differ("shard", label(ours.shard), label(theirs.shard));
  return "";
}

Error missing(const ShardHeader& header, const std::vector<const ShardReader*>& by_number) {
  std::string list;
  int told = 0;
  for (std::uint32_t i = 0; i < header.shard.count; ++i) {
    if (by_number[i] != nullptr) continue;
    if (++told > 10) {
      list += " and more";
      break;
    }
    list += (list.empty() ? "" : ", ") + label(Shard{i + 1, header.shard.count});
  }
  return {"of the shards of '" + header.campaign.command + "' these are missing: " + list +
          "; run them with --shard and merge all"};
}

// The shards by their number: all there, of one campaign, each once.
Expected<std::vector<ShardReader*>> in_order(std::deque<ShardReader>& readers) {
  const ShardHeader& first = readers.front().header();
  for (const ShardReader& reader : readers) {
    const std::string problem = disagreement(first, reader.header());
    if (!problem.empty())
      return Error{reader.name() + ": " + problem + "; merge the shards of one campaign only"};
  }
  std::vector<ShardReader*> by_number(first.shard.count);
  for (ShardReader& reader : readers) {
    ShardReader*& place = by_number[reader.header().shard.number - 1];
    if (place != nullptr) {
      return Error{place->name() + " and " + reader.name() + " are both shard " +
                   label(reader.header().shard) + "; leave one of them out"};
    }
    place = &reader;
  }
  if (std::find(by_number.begin(), by_number.end(), nullptr) != by_number.end())
    return missing(first, {by_number.begin(), by_number.end()});
  return by_number;
}

Error unfinished(const ShardReader& reader) {
  const ShardHeader& header = reader.header();
  return {reader.name() + ": holds " + std::to_string(reader.runs()) + " of " +
          std::to_string(size(header.shard, header.campaign)) + " runs; run shard " +
          label(header.shard) + " again, it goes on where it stopped"};
}

Expected<CampaignResult> fold(const std::vector<ShardReader*>& shards) {
  CampaignFold fold(shards.front()->header().campaign);
  while (!fold.is_complete()) {
    ShardReader& shard = *shards[fold.size() % shards.size()];
    const Expected<std::optional<RunMetrics>> run = shard.next();
    if (!run) return Error{run.error()};
    if (!run->has_value()) return unfinished(shard);
    fold.add(**run);
  }
  for (ShardReader* shard : shards) {
    const Expected<std::optional<RunMetrics>> end = shard->next();
    if (!end) return Error{end.error()};
    if (!shard->is_complete()) return unfinished(*shard);
  }
  return std::move(fold).result();
}

}  // namespace

Expected<CampaignResult> merge(std::span<const ShardSource> shards) {
  if (shards.empty()) return Error{"there is nothing to merge; name the shard files"};
  std::deque<ShardReader> readers;
  for (const ShardSource& source : shards) {
    Expected<ShardReader> reader = ShardReader::open(*source.in, source.name);
    if (!reader) return Error{reader.error()};
    readers.push_back(std::move(*reader));
  }
  const Expected<std::vector<ShardReader*>> ordered = in_order(readers);
  if (!ordered) return Error{ordered.error()};
  return fold(*ordered);
}

Expected<CampaignResult> merge_files(const std::vector<std::string>& paths) {
  std::deque<std::ifstream> files;
  std::vector<ShardSource> sources;
  for (const std::string& path : paths) {
    files.emplace_back(path, std::ios::binary);
    if (!files.back())
      return Error{path + ": cannot be read: " + std::string(std::strerror(errno))};
    sources.push_back({path, &files.back()});
  }
  return merge(sources);
}

}  // namespace culprit::study

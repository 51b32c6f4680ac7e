#include "shards/merge.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <deque>
#include <fstream>
#include <optional>

#include "shards/shard_file.h"

namespace culprit::study {
namespace {

// The difference between the two; empty if they agree.
template <class C>
std::string disagreement(const ShardHeader<C>& ours, const ShardHeader<C>& theirs) {
  const auto differ = [](const std::string& what, const auto& a, const auto& b) {
    return "has " + what + " " + b + ", but the first file has " + a;
  };
  const C& a = ours.campaign;
  const C& b = theirs.campaign;
  if (a.version != b.version) return differ("culprit version", a.version, b.version);
  if (a.seed != b.seed) return differ("seed", std::to_string(a.seed), std::to_string(b.seed));
  if (a.runs != b.runs)
    return differ("a number of runs of", std::to_string(a.runs), std::to_string(b.runs));
  if (a.command != b.command)
    return "was made by '" + b.command + "', but the first file by '" + a.command + "'";
  if (a != b) return "has other configurations than the first file";
  if (ours.shard.count != theirs.shard.count)
    return differ("shard", label(ours.shard), label(theirs.shard));
  return "";
}

template <class C>
Error missing(const ShardHeader<C>& header, const std::vector<const ShardReader<C>*>& by_number) {
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
template <class C>
Expected<std::vector<ShardReader<C>*>> in_order(std::deque<ShardReader<C>>& readers) {
  const ShardHeader<C>& first = readers.front().header();
  for (const ShardReader<C>& reader : readers) {
    const std::string problem = disagreement(first, reader.header());
    if (!problem.empty())
      return Error{reader.name() + ": " + problem + "; merge the shards of one campaign only"};
  }
  std::vector<ShardReader<C>*> by_number(first.shard.count);
  for (ShardReader<C>& reader : readers) {
    ShardReader<C>*& place = by_number[reader.header().shard.number - 1];
    if (place != nullptr) {
      return Error{place->name() + " and " + reader.name() + " are both shard " +
                   label(reader.header().shard) + "; leave one of them out"};
    }
    place = &reader;
  }
  if (std::find(by_number.begin(), by_number.end(), nullptr) != by_number.end())
    return missing<C>(first, {by_number.begin(), by_number.end()});
  return by_number;
}

template <class C>
Error unfinished(const ShardReader<C>& reader) {
  const ShardHeader<C>& header = reader.header();
  return {reader.name() + ": holds " + std::to_string(reader.runs()) + " of " +
          std::to_string(size(header.shard, header.campaign)) + " runs; run shard " +
          label(header.shard) + " again, it goes on where it stopped"};
}

template <class C>
Expected<Merged> fold(const std::vector<ShardReader<C>*>& shards) {
  using Run = typename ShardKind<C>::Run;
  typename ShardKind<C>::Fold fold(shards.front()->header().campaign);
  while (!fold.is_complete()) {
    ShardReader<C>& shard = *shards[fold.size() % shards.size()];
    const Expected<std::optional<Run>> run = shard.next();
    if (!run) return Error{run.error()};
    if (!run->has_value()) return unfinished(shard);
    fold.add(**run);
  }
  for (ShardReader<C>* shard : shards) {
    const Expected<std::optional<Run>> end = shard->next();
    if (!end) return Error{end.error()};
    if (!shard->is_complete()) return unfinished(*shard);
  }
  return Merged(std::move(fold).result());
}

template <class C>
Expected<Merged> merge(ShardReader<C> first, std::span<const ShardSource> others) {
  std::deque<ShardReader<C>> readers;
  readers.push_back(std::move(first));
  for (const ShardSource& source : others) {
    Expected<ShardReader<C>> reader = ShardReader<C>::open(*source.in, source.name);
    if (!reader) return Error{reader.error()};
    readers.push_back(std::move(*reader));
  }
  const Expected<std::vector<ShardReader<C>*>> ordered = in_order(readers);
  if (!ordered) return Error{ordered.error()};
  return fold(*ordered);
}

}  // namespace

Expected<Merged> merge(std::span<const ShardSource> shards) {
  if (shards.empty()) return Error{"there is nothing to merge; name the shard files"};
  Expected<AnyShardReader> first = open_shard(*shards.front().in, shards.front().name);
  if (!first) return Error{first.error()};
  return std::visit([&](auto& reader) { return merge(std::move(reader), shards.subspan(1)); },
                    *first);
}

Expected<Merged> merge_files(const std::vector<std::string>& paths) {
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

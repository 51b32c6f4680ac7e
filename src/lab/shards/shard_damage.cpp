#include "shards/shard_damage.h"

#include <fstream>
#include <sstream>

#include "study/sealed_line.h"

namespace culprit::study {
namespace {

namespace fs = std::filesystem;

Expected<std::string> content_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream content;
  content << in.rdbuf();
  if (!in || !content) return Error{path.string() + ": cannot be read"};
  return std::move(content).str();
}

// Bytes of the lines before the damage; nothing: there is none.
template <class C>
std::optional<std::size_t> intact_bytes(const std::string& content, const ShardHeader<C>& header) {
  std::istringstream in(content);
  auto reader = ShardReader<C>::open(in, "");
  if (!reader) return 0;
  std::size_t intact = header_line(header).size();
  while (true) {
    const auto run = reader->next();
    if (!run) return intact;
    if (!run->has_value()) return std::nullopt;
    intact = static_cast<std::size_t>(reader->good_bytes());
  }
}

fs::path free_name(const fs::path& path) {
  for (int n = 1;; ++n) {
    fs::path name = path.string() + ".damaged-" + std::to_string(n);
    if (!fs::exists(name)) return name;
  }
}

}  // namespace

template <class C>
Expected<fs::path> set_damage_aside(const fs::path& path, const ShardHeader<C>& header) {
  const auto content = content_of(path);
  if (!content) return Error{content.error()};
  const std::string first = header_line(header);
  // A damaged first line is ours if nearly all of it is intact: no other file begins like this.
  const std::string_view beginning = std::string_view(first).substr(0, 24);
  const bool is_ours = content->starts_with(first);
  if (!is_ours) {
    const bool is_whole = unsealed(content->substr(0, content->find('\n'))).has_value();
    if (is_whole || !content->starts_with(beginning))
      return Error{path.string() + ": is of another campaign"};
  }
  const auto intact = is_ours ? intact_bytes(*content, header) : std::optional<std::size_t>(0);
  if (!intact) return Error{path.string() + ": is not damaged"};
  const fs::path aside = free_name(path);
  std::error_code error;
  fs::copy_file(path, aside, error);
  if (!error) fs::resize_file(path, *intact, error);
  if (error) return Error{path.string() + ": is damaged, and cannot be mended: " + error.message()};
  return aside;
}

template Expected<fs::path> set_damage_aside(const fs::path&, const ShardHeader<Campaign>&);
template Expected<fs::path> set_damage_aside(const fs::path&, const ShardHeader<SuaveCampaign>&);

}  // namespace culprit::study

#include "shards/shard_writer.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <sys/file.h>
#include <unistd.h>
#include <utility>

#include "study/run_record.h"
#include "suave_study/suave_record.h"

namespace culprit::study {
namespace {

// Empty, or the beginning of a header that the process did not live to finish.
bool is_unbegun(const std::filesystem::path& path, const std::string& header) {
  std::ifstream in(path, std::ios::binary);
  std::string text(header.size(), '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  return text.size() < header.size() && header.starts_with(text);
}

}  // namespace

template <class C>
ShardWriter<C>::ShardWriter(int file, std::filesystem::path path, ShardHeader<C> header)
    : file_(file), path_(std::move(path)), header_(std::move(header)) {}

template <class C>
ShardWriter<C>::ShardWriter(ShardWriter&& other) noexcept
    : file_(std::exchange(other.file_, -1)),
      path_(std::move(other.path_)),
      header_(std::move(other.header_)),
      done_(other.done_),
      bytes_(other.bytes_) {}

template <class C>
ShardWriter<C>::~ShardWriter() {
  if (file_ >= 0) ::close(file_);  // which ends the lock, too
}

template <class C>
Error ShardWriter<C>::error(const std::string& what) const {
  return {path_.string() + ": " + what};
}

template <class C>
Expected<ShardWriter<C>> ShardWriter<C>::open(const std::filesystem::path& path,
                                              const ShardHeader<C>& header, const Found& found) {
  const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  ShardWriter writer(file, path, header);
  if (file < 0) return writer.error(std::string("cannot be opened: ") + std::strerror(errno));
  if (::flock(file, LOCK_EX | LOCK_NB) != 0)
    return writer.error("another process writes it; wait for that, or choose another file");
  if (const Expected<void> resumed = writer.resume(found); !resumed) return Error{resumed.error()};
  return writer;
}

template <class C>
Expected<void> ShardWriter<C>::resume(const Found& found) {
  const std::string header = header_line(header_);
  if (is_unbegun(path_, header)) {
    // A campaign may have fewer runs than shards.
    return write(is_complete() ? header + end_line(0) : header);
  }

  std::ifstream in(path_, std::ios::binary);
  Expected<ShardReader<C>> reader = ShardReader<C>::open(in, path_.string());
  if (!reader) return Error{reader.error()};
  const ShardHeader<C>& theirs = reader->header();
  if (theirs.campaign != header_.campaign || theirs.shard != header_.shard) {
    return error("belongs to another campaign or shard (" + theirs.campaign.command + ", shard " +
                 label(theirs.shard) + ", culprit " + theirs.campaign.version +
                 "); choose another file");
  }
  while (true) {
    const Expected<std::optional<Run>> run = reader->next();
    if (!run) return Error{run.error()};
    if (!run->has_value()) break;
    if (found) found(**run);
  }
  done_ = reader->runs();
  bytes_ = reader->good_bytes();
  if (reader->is_complete()) return {};
  // Half a line is dropped; of a file with all runs, the last line may be what did not get through.
  if (const Expected<void> dropped = drop_rest(); !dropped) return dropped;
  return write(is_complete() ? end_line(done_) : "");
}

template <class C>
Expected<void> ShardWriter<C>::append(const Run& run) {
  if (const auto json = to_json(run); !json) return error(json.error());
  std::string lines = run_line(next(), run);
  if (done_ + 1 == size()) lines += end_line(done_ + 1);
  const Expected<void> written = write(lines);
  if (written) ++done_;
  return written;
}

template <class C>
Expected<void> ShardWriter<C>::write(const std::string& lines) {
  for (std::size_t at = 0; at < lines.size();) {
    const ssize_t count =
        ::pwrite(file_, lines.data() + at, lines.size() - at, static_cast<off_t>(bytes_ + at));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {
      const Error failure = error(std::string("cannot be written: ") + std::strerror(errno));
      (void)drop_rest();  // if it fails, too, whoever goes on drops it
      return failure;
    }
    at += static_cast<std::size_t>(count);
  }
  bytes_ += lines.size();
  return {};
}

template <class C>
Expected<void> ShardWriter<C>::drop_rest() {
  if (::ftruncate(file_, static_cast<off_t>(bytes_)) == 0) return {};
  return error(std::string("cannot be written: ") + std::strerror(errno));
}

template class ShardWriter<Campaign>;
template class ShardWriter<SuaveCampaign>;

}  // namespace culprit::study

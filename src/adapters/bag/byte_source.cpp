#include "bag/byte_source.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <zstd.h>

namespace culprit::bag {

bool is_compressed(const std::filesystem::path& path) {
  return path.extension() == ".zstd" || path.extension() == ".zst";
}

void ByteSource::Close::operator()(ZSTD_DCtx_s* context) const { ZSTD_freeDCtx(context); }

Expected<ByteSource> ByteSource::open(const std::filesystem::path& path) {
  ByteSource source;
  source.file_.reset(std::fopen(path.c_str(), "rbe"));
  if (source.file_ == nullptr) return Error{std::strerror(errno)};
  std::error_code error;
  source.size_ = std::filesystem::file_size(path, error);
  if (error) return Error{error.message()};
  if (is_compressed(path)) source.zstd_.reset(ZSTD_createDCtx());
  return source;
}

bool ByteSource::move_to(std::uint64_t place) {
  if (place == position_) return true;
  if (zstd_ == nullptr) {
    if (place > size_ || fseeko(file_.get(), static_cast<off_t>(place), SEEK_SET) != 0)
      return false;
    position_ = place;
    return true;
  }
  if (place < position_ && !begin_anew()) return false;
  std::array<char, std::size_t{64} << 10> block{};
  while (position_ < place) {
    const std::size_t wanted = std::min<std::uint64_t>(place - position_, block.size());
    if (read(block.data(), wanted) < wanted) return false;
  }
  return true;
}

bool ByteSource::begin_anew() {
  if (fseeko(file_.get(), 0, SEEK_SET) != 0) return false;
  ZSTD_DCtx_reset(zstd_.get(), ZSTD_reset_session_only);
  compressed_.clear();
  used_ = position_ = 0;
  is_in_frame_ = false;
  trouble_.clear();
  return true;
}

std::size_t ByteSource::read(char* to, std::size_t size) {
  const std::size_t got = zstd_ != nullptr ? decompress(to, size) : read_file(to, size);
  position_ += got;
  return got;
}

std::size_t ByteSource::read_file(char* to, std::size_t size) {
  const std::size_t got = std::fread(to, 1, size, file_.get());
  if (got < size && std::ferror(file_.get()) != 0)
    trouble_ = std::string("it cannot be read on: ") + std::strerror(errno);
  return got;
}

std::size_t ByteSource::decompress(char* to, std::size_t size) {
  ZSTD_outBuffer out{to, size, 0};
  while (out.pos < out.size && trouble_.empty()) {
    if (used_ == compressed_.size()) {
      compressed_.resize(ZSTD_DStreamInSize());
      compressed_.resize(read_file(compressed_.data(), compressed_.size()));
      used_ = 0;
    }
    ZSTD_inBuffer in{compressed_.data(), compressed_.size(), used_};
    const std::size_t before = out.pos;
    const std::size_t left = ZSTD_decompressStream(zstd_.get(), &out, &in);
    used_ = in.pos;
    if (ZSTD_isError(left) != 0) {
      trouble_ = std::string("its compression is damaged (") + ZSTD_getErrorName(left) + ")";
    } else if (!compressed_.empty() || out.pos != before) {
      is_in_frame_ = left != 0;
    } else {  // All is read, and all has come out.
      if (is_in_frame_ && trouble_.empty()) trouble_ = "its compressed data are cut short";
      break;
    }
  }
  return out.pos;
}

}  // namespace culprit::bag

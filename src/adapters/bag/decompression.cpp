#include "bag/decompression.h"

#include <algorithm>
#include <new>
#include <zstd.h>

#include <lz4frame.h>

namespace culprit::bag {
namespace {

// More room at the end of `out`, of which `used` is taken: twice as much each time, so that memory
// is asked for as it is filled, whatever a size in the file claims. False if there may be no more.
bool make_room(std::string& out, std::size_t used, std::size_t most) {
  constexpr std::size_t kFirst = std::size_t{64} << 10;
  if (used < out.size()) return true;
  if (used >= most) return false;
  out.resize(std::min(most, std::max(kFirst, 2 * used)));
  return true;
}

}  // namespace

void Decompressor::Free::operator()(ZSTD_DCtx_s* context) const { ZSTD_freeDCtx(context); }
void Decompressor::Free::operator()(LZ4F_dctx_s* context) const {
  LZ4F_freeDecompressionContext(context);
}

Decompressed Decompressor::operator()(Compression compression, std::string_view bytes,
                                      std::size_t most, std::string& out) {
  out.clear();
  if (bytes.empty()) return Decompressed::kWhole;
  if (compression == Compression::kZstd) return zstd(bytes, most, out);
  if (compression == Compression::kLz4) return lz4(bytes, most, out);
  out = bytes.substr(0, most);
  return bytes.size() > most ? Decompressed::kTooLong : Decompressed::kWhole;
}

Decompressed Decompressor::zstd(std::string_view bytes, std::size_t most, std::string& out) {
  if (zstd_ == nullptr) zstd_.reset(ZSTD_createDCtx());
  if (zstd_ == nullptr) throw std::bad_alloc();
  ZSTD_DCtx_reset(zstd_.get(), ZSTD_reset_session_only);
  ZSTD_inBuffer in{bytes.data(), bytes.size(), 0};
  std::size_t used = 0;
  std::size_t left = 1;  // 0: at the end of a frame
  Decompressed result = Decompressed::kWhole;
  while (in.pos < in.size || left != 0) {
    const bool has_room = make_room(out, used, most);
    // Without room, it may still come to the end of a frame.
    ZSTD_outBuffer into{out.data(), out.size(), used};
    const std::size_t before = in.pos;
    left = ZSTD_decompressStream(zstd_.get(), &into, &in);
    if (ZSTD_isError(left) != 0) {
      result = Decompressed::kDamaged;
      break;
    }
    const bool is_stuck = into.pos == used && in.pos == before;
    used = into.pos;
    if (is_stuck) {
      if (left != 0) result = has_room ? Decompressed::kCut : Decompressed::kTooLong;
      break;
    }
  }
  out.resize(used);
  return result;
}

Decompressed Decompressor::lz4(std::string_view bytes, std::size_t most, std::string& out) {
  if (lz4_ == nullptr) {
    LZ4F_dctx* context = nullptr;
    if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0)
      throw std::bad_alloc();
    lz4_.reset(context);
  }
  LZ4F_resetDecompressionContext(lz4_.get());
  std::size_t used = 0;
  std::size_t left = 1;  // 0: at the end of a frame
  Decompressed result = Decompressed::kWhole;
  while (!bytes.empty() || left != 0) {
    const bool has_room = make_room(out, used, most);
    std::size_t written = out.size() - used;
    std::size_t taken = bytes.size();
    left = LZ4F_decompress(lz4_.get(), out.data() + used, &written, bytes.data(), &taken, nullptr);
    if (LZ4F_isError(left) != 0) {
      result = Decompressed::kDamaged;
      break;
    }
    used += written;
    bytes.remove_prefix(taken);
    if (written == 0 && taken == 0) {
      if (left != 0) result = has_room ? Decompressed::kCut : Decompressed::kTooLong;
      break;
    }
  }
  out.resize(used);
  return result;
}

bool is_zstd(std::string_view bytes) { return bytes.starts_with("\x28\xb5\x2f\xfd"); }

}  // namespace culprit::bag

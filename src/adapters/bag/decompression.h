// Takes compressed bytes apart, with an end to what comes out: few bytes can claim to be many.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

struct ZSTD_DCtx_s;
struct LZ4F_dctx_s;

namespace culprit::bag {

enum class Compression : std::uint8_t { kNone, kZstd, kLz4 };

enum class Decompressed : std::uint8_t {
  kWhole,
  kCut,      // the bytes end too early; what they hold is there
  kTooLong,  // more than `most` would come out
  kDamaged
};

// One thread.
class Decompressor {
 public:
  // Sets `out` to what `bytes` (frames of Zstandard or LZ4) hold, `most` bytes of it at most.
  Decompressed operator()(Compression compression, std::string_view bytes, std::size_t most,
                          std::string& out);

 private:
  struct Free {
    void operator()(ZSTD_DCtx_s* context) const;
    void operator()(LZ4F_dctx_s* context) const;
  };

  Decompressed zstd(std::string_view bytes, std::size_t most, std::string& out);
  Decompressed lz4(std::string_view bytes, std::size_t most, std::string& out);

  std::unique_ptr<ZSTD_DCtx_s, Free> zstd_;
  std::unique_ptr<LZ4F_dctx_s, Free> lz4_;
};

// Whether `bytes` begin like a frame of Zstandard.
bool is_zstd(std::string_view bytes);

}  // namespace culprit::bag

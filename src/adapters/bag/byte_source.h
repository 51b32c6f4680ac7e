// The bytes of a file from its beginning to its end; of a `.zst`/`.zstd` file, what is compressed
// in it.
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/expected.h"

struct ZSTD_DCtx_s;

namespace culprit::bag {

// Whether a file of this name is compressed.
bool is_compressed(const std::filesystem::path& path);

class ByteSource {
 public:
  static Expected<ByteSource> open(const std::filesystem::path& path);

  // Goes on reading at this byte. False if there are fewer. Going back in a compressed file reads it
  // anew.
  bool move_to(std::uint64_t place);

  // How many bytes it could read: fewer than `size` at the end only.
  std::size_t read(char* to, std::size_t size);
  // The place of the next byte.
  std::uint64_t position() const { return position_; }
  // Why it ended too early, for people; empty if it did not.
  const std::string& trouble() const { return trouble_; }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
    void operator()(ZSTD_DCtx_s* context) const;
  };
  ByteSource() = default;
  std::size_t read_file(char* to, std::size_t size);
  std::size_t decompress(char* to, std::size_t size);
  bool begin_anew();

  std::unique_ptr<std::FILE, Close> file_;
  std::unique_ptr<ZSTD_DCtx_s, Close> zstd_;  // of a compressed file
  std::vector<char> compressed_;              // read and not decompressed yet: from used_ on
  std::size_t used_ = 0;
  bool is_in_frame_ = false;
  std::uint64_t size_ = 0;  // of the file
  std::uint64_t position_ = 0;
  std::string trouble_;
};

}  // namespace culprit::bag

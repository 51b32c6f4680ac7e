#include "journal/entry.h"

#include <openssl/evp.h>

namespace culprit::journal {
namespace {

void append_number(std::string& out, std::uint64_t number) {
  for (int shift = 56; shift >= 0; shift -= 8) out += static_cast<char>(number >> shift);
}

}  // namespace

struct Hasher::State {
  EVP_MD* algorithm = EVP_MD_fetch(nullptr, "SHA256", nullptr);
  EVP_MD_CTX* context = EVP_MD_CTX_new();
  std::string buffer;

  ~State() {
    EVP_MD_CTX_free(context);
    EVP_MD_free(algorithm);
  }
};

Hasher::Hasher() : state_(std::make_unique<State>()) {}
Hasher::~Hasher() = default;
Hasher::Hasher(Hasher&&) noexcept = default;
Hasher& Hasher::operator=(Hasher&&) noexcept = default;

Hash Hasher::link(const Hash& previous, const Entry& entry) {
  std::string& buffer = state_->buffer;
  buffer.assign(previous.begin(), previous.end());
  append_number(buffer, static_cast<std::uint64_t>(entry.id));
  append_number(buffer, static_cast<std::uint64_t>(entry.at));
  append_number(buffer, entry.kind.size());
  buffer += entry.kind;
  buffer += entry.body;
  return of(buffer);
}

Hash Hasher::of(std::string_view bytes) {
  EVP_DigestInit_ex(state_->context, state_->algorithm, nullptr);
  return end_with(bytes);
}

Hash Hasher::of(const Hash& before, std::string_view bytes) {
  EVP_DigestInit_ex(state_->context, state_->algorithm, nullptr);
  EVP_DigestUpdate(state_->context, before.data(), before.size());
  return end_with(bytes);
}

Hash Hasher::end_with(std::string_view bytes) {
  Hash hash{};
  EVP_DigestUpdate(state_->context, bytes.data(), bytes.size());
  EVP_DigestFinal_ex(state_->context, hash.data(), nullptr);
  return hash;
}

std::string to_hex(const Hash& hash) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (const unsigned char byte : hash) {
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
  }
  return text;
}

}  // namespace culprit::journal

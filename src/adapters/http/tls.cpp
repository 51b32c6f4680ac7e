#include "http/tls.h"

#include <algorithm>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>

#include <openssl/err.h>
#include <openssl/ssl.h>

namespace culprit::http {
namespace {

using TlsClock = std::chrono::steady_clock;

std::string openssl_reason() {
  const unsigned long code = ERR_get_error();
  ERR_clear_error();
  const char* reason = code == 0 ? nullptr : ERR_reason_error_string(code);
  return reason == nullptr ? "it is no PEM file of that kind" : reason;
}

}  // namespace

Expected<std::shared_ptr<const TlsContext>> TlsContext::load(const std::string& certificate,
                                                             const std::string& key) {
  struct stat status {};
  if (stat(certificate.c_str(), &status) != 0)
    return Error{"cannot read the certificate '" + certificate + "': " + std::strerror(errno)};
  if (stat(key.c_str(), &status) != 0)
    return Error{"cannot read the key '" + key + "': " + std::strerror(errno)};
  if ((status.st_mode & (S_IRWXG | S_IRWXO)) != 0)
    return Error{"others can read the key '" + key + "'; chmod 600 it"};
  std::signal(SIGPIPE, SIG_IGN);  // OpenSSL writes to sockets whose other end may be gone
  SSL_CTX* const context = SSL_CTX_new(TLS_server_method());
  if (context == nullptr) return Error{"TLS cannot be used: " + openssl_reason()};
  std::shared_ptr<const TlsContext> made(new TlsContext(context));
  SSL_CTX_set_min_proto_version(context, TLS1_2_VERSION);
  SSL_CTX_set_options(context, SSL_OP_NO_RENEGOTIATION | SSL_OP_NO_COMPRESSION);
  SSL_CTX_set_mode(context, SSL_MODE_ENABLE_PARTIAL_WRITE | SSL_MODE_ACCEPT_MOVING_WRITE_BUFFER);
  SSL_CTX_set_session_cache_mode(context, SSL_SESS_CACHE_OFF);
  if (SSL_CTX_use_certificate_chain_file(context, certificate.c_str()) != 1)
    return Error{"cannot use the certificate '" + certificate + "': " + openssl_reason()};
  if (SSL_CTX_use_PrivateKey_file(context, key.c_str(), SSL_FILETYPE_PEM) != 1 ||
      SSL_CTX_check_private_key(context) != 1)
    return Error{"cannot use the key '" + key + "': " + openssl_reason()};
  return made;
}

TlsContext::~TlsContext() { SSL_CTX_free(context_); }

std::unique_ptr<TlsConnection> TlsConnection::accept(const TlsContext& context, int socket,
                                                     std::chrono::milliseconds patience) {
  SSL* const connection = SSL_new(context.get());
  if (connection == nullptr) return nullptr;
  std::unique_ptr<TlsConnection> made(new TlsConnection(connection, socket));
  fcntl(socket, F_SETFL, fcntl(socket, F_GETFL) | O_NONBLOCK);
  if (SSL_set_fd(connection, socket) != 1) return nullptr;
  if (made->until_done([&] { return SSL_accept(connection); }, patience) <= 0) return nullptr;
  return made;
}

// Sends close_notify if that needs no waiting.
TlsConnection::~TlsConnection() {
  ERR_clear_error();
  SSL_shutdown(connection_);
  ERR_clear_error();
  SSL_free(connection_);
}

// The result of `step` once the socket was ready for it; 0: the client has ended the connection.
template <class Step>
int TlsConnection::until_done(Step step, std::chrono::milliseconds patience) {
  const auto end = TlsClock::now() + patience;
  while (true) {
    ERR_clear_error();
    const int done = step();
    if (done > 0) return done;
    const int why = SSL_get_error(connection_, done);
    if (why == SSL_ERROR_ZERO_RETURN) return 0;
    if (why != SSL_ERROR_WANT_READ && why != SSL_ERROR_WANT_WRITE) return -1;
    pollfd wanted{socket_, static_cast<short>(why == SSL_ERROR_WANT_READ ? POLLIN : POLLOUT), 0};
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - TlsClock::now()).count();
    if (left <= 0) return -1;
    const int ready = poll(&wanted, 1, static_cast<int>(std::min<std::int64_t>(left, INT_MAX)));
    if (ready == 0 || (ready < 0 && errno != EINTR)) return -1;
  }
}

ssize_t TlsConnection::read(char* to, std::size_t size, std::chrono::milliseconds patience) {
  const int most = static_cast<int>(std::min<std::size_t>(size, INT_MAX));
  return until_done([&] { return SSL_read(connection_, to, most); }, patience);
}

ssize_t TlsConnection::write(const char* bytes, std::size_t size,
                             std::chrono::milliseconds patience) {
  if (size == 0) return 0;
  const int most = static_cast<int>(std::min<std::size_t>(size, INT_MAX));
  const int written = until_done([&] { return SSL_write(connection_, bytes, most); }, patience);
  return written > 0 ? written : -1;
}

bool TlsConnection::has_pending() const { return SSL_pending(connection_) > 0; }

}  // namespace culprit::http

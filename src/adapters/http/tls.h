// TLS for a server: a certificate with its key, and connections that have a limit of time for each step.
//
//     auto context = TlsContext::load("robot.crt", "robot.key");
//     auto connection = TlsConnection::accept(*context, socket, std::chrono::seconds(10));
//
// TLS 1.2 and newer. Clients show no certificate: tokens show who they are (access.h).
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <string>
#include <sys/types.h>

#include "base/expected.h"

struct ssl_ctx_st;
struct ssl_st;

namespace culprit::http {

class TlsContext {
 public:
  // Two PEM files: the certificate, followed by those that lead to its authority; and its key, which only this user may
  // read. Errors: one cannot be read or is none; the key is open to others, or is not the certificate's.
  static Expected<std::shared_ptr<const TlsContext>> load(const std::string& certificate,
                                                          const std::string& key);
  ~TlsContext();
  TlsContext(const TlsContext&) = delete;

  ssl_ctx_st* get() const { return context_; }

 private:
  explicit TlsContext(ssl_ctx_st* context) : context_(context) {}
  ssl_ctx_st* context_;
};

// The server's side of a connection. Does not own the socket, and makes it non-blocking.
class TlsConnection {
 public:
  // Null: the client does not speak TLS, or not within `patience`.
  static std::unique_ptr<TlsConnection> accept(const TlsContext& context, int socket,
                                               std::chrono::milliseconds patience);
  ~TlsConnection();
  TlsConnection(const TlsConnection&) = delete;

  // So many bytes, at least one; 0: the client sends no more; -1: it fails, or takes longer than `patience`.
  ssize_t read(char* to, std::size_t size, std::chrono::milliseconds patience);
  ssize_t write(const char* bytes, std::size_t size, std::chrono::milliseconds patience);
  // Whether read() gives something without waiting for the socket.
  bool has_pending() const;

 private:
  TlsConnection(ssl_st* connection, int socket) : connection_(connection), socket_(socket) {}
  template <class Step>
  int until_done(Step step, std::chrono::milliseconds patience);

  ssl_st* connection_;
  int socket_;
};

}  // namespace culprit::http

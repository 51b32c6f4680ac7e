// A PostgreSQL server over libpq, with owners and errors as values.
//
// No call waits longer than its limit, and each heeds a stop within a tenth of a second. The
// exception is the look-up of a host's name, which libpq does itself.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/expected.h"
#include "base/time.h"

struct pg_conn;

namespace culprit::fleet {

// Where the database is, as libpq takes it: "postgresql://host/database?sslmode=verify-full", or
// "service=fleet". Without a password: those of files are libpq's to read.
struct Address {
  std::string text;
};

// Errors: it is none, or has a password in it. They do not repeat it.
Expected<Address> address_from(const std::string& text);

using Field = std::optional<std::string>;  // nothing: NULL
using Row = std::vector<Field>;
using Rows = std::vector<Row>;

std::int64_t integer_in(const Field& field);
double real_in(const Field& field);
std::string text_in(const Field& field);

class Postgres {
 public:
  static constexpr Duration kPatience = std::chrono::seconds(20);

  // `stop` must outlive the server. Errors: in one line, without secrets.
  static Expected<Postgres> connect(const Address& address, const std::atomic<bool>& stop,
                                    Duration patience = kPatience);

  // One statement, with parameters $1, $2 ... as texts.
  Expected<Rows> query(const std::string& sql, const std::vector<Field>& parameters = {});
  // Several statements, without results.
  Expected<void> run(const std::string& sql);

  // The SQLSTATE of what failed last; empty: the server gave none.
  const std::string& state() const { return state_; }
  // Restores the state of an earlier failure, which is the one that matters.
  void set_state(std::string state) { state_ = std::move(state); }
  // Whether it is the rows that were sent which it does not take, and not us, or anything.
  bool blames_rows() const;
  // Whether the connection is of any use after an error.
  bool is_usable() const;
  std::string user() const;

 private:
  struct Close {
    void operator()(pg_conn* connection) const;
  };
  Postgres(pg_conn* connection, const std::atomic<bool>& stop, Duration patience)
      : connection_(connection), stop_(&stop), patience_(patience) {}
  Error error(const std::string& what);
  Expected<void> wait(bool for_writing, Time until);
  Expected<void> establish();
  Expected<Rows> results();

  std::unique_ptr<pg_conn, Close> connection_;
  const std::atomic<bool>* stop_;
  Duration patience_;
  std::string state_;
};

}  // namespace culprit::fleet

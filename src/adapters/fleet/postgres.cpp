#include "fleet/postgres.h"

#include <cstdlib>
#include <poll.h>

#include "base/live_clock.h"
#include "fleet/libpq.h"

namespace culprit::fleet {
namespace {

struct FreeOptions {
  void operator()(PQconninfoOption* options) const { libpq().conninfo_free(options); }
};
using ConnectionOptions = std::unique_ptr<PQconninfoOption, FreeOptions>;

struct FreeResult {
  void operator()(PGresult* result) const { libpq().clear(result); }
};
using Result = std::unique_ptr<PGresult, FreeResult>;

// libpq's messages have several lines, and blanks at their ends.
std::string one_line(std::string_view text) {
  std::string line;
  for (const char c : text) {
    const bool is_blank = c == '\n' || c == '\t' || c == ' ' || c == '\r';
    if (!is_blank) {
      line += static_cast<unsigned char>(c) < 0x20 ? '?' : c;
    } else if (!line.empty() && line.back() != ' ') {
      line += ' ';
    }
  }
  while (!line.empty() && line.back() == ' ') line.pop_back();
  constexpr std::size_t kLongestLine = 400;
  if (line.size() > kLongestLine) line.resize(kLongestLine);
  return line;
}

bool is_secret(std::string_view keyword) {
  return keyword == "password" || keyword == "sslpassword";
}

}  // namespace

Expected<Address> address_from(const std::string& text) {
  if (const auto loaded = load_libpq(); !loaded) return Error{loaded.error()};
  char* complaint = nullptr;
  const ConnectionOptions options(libpq().conninfo_parse(text.c_str(), &complaint));
  libpq().free_memory(complaint);  // it may repeat a password
  if (options == nullptr)
    return Error{
        "this is no address of a PostgreSQL database: write postgresql://HOST/DATABASE, or "
        "service=NAME of a service file"};
  for (const PQconninfoOption* each = options.get(); each->keyword != nullptr; ++each) {
    if (is_secret(each->keyword) && each->val != nullptr && *each->val != '\0')
      return Error{
          "the address of the fleet's database has a password in it, which everybody on this "
          "computer can read: leave it out, and put it into ~/.pgpass (chmod 600), into a file "
          "that the address names with passfile=, or into a service file; and choose another one"};
  }
  return Address{text};
}

std::int64_t integer_in(const Field& field) {
  return field ? std::strtoll(field->c_str(), nullptr, 10) : 0;
}
double real_in(const Field& field) { return field ? std::strtod(field->c_str(), nullptr) : 0; }
std::string text_in(const Field& field) { return field.value_or(""); }

void Postgres::Close::operator()(pg_conn* connection) const { libpq().finish(connection); }

Error Postgres::error(const std::string& what) { return {one_line(what)}; }

bool Postgres::is_usable() const { return libpq().status(connection_.get()) == CONNECTION_OK; }

std::string Postgres::user() const {
  const char* user = libpq().user(connection_.get());
  return user != nullptr ? user : "";
}

// Data that do not fit (22), or break a constraint (23), and what a policy or a type refuses.
bool Postgres::blames_rows() const {
  return state_.starts_with("22") || state_.starts_with("23") || state_ == "42501";
}

Expected<void> Postgres::wait(bool for_writing, Time until) {
  while (true) {
    if (*stop_) return Error{"culprit ends"};
    if (live_now() >= until) return Error{"it does not answer"};
    constexpr int kLookMs = 100;
    pollfd file{libpq().socket(connection_.get()), POLLIN, 0};
    if (for_writing) file.events |= POLLOUT;
    const int ready = poll(&file, 1, kLookMs);
    if (ready > 0) return {};
    if (ready < 0 && errno != EINTR) return Error{"its connection is broken"};
  }
}

Expected<Postgres> Postgres::connect(const Address& address, const std::atomic<bool>& stop,
                                     Duration patience) {
  if (const auto loaded = load_libpq(); !loaded) return Error{loaded.error()};
  const char* const keywords[] = {"dbname", "fallback_application_name", "client_encoding",
                                  nullptr};
  const char* const values[] = {address.text.c_str(), "culprit", "UTF8", nullptr};
  constexpr int kExpands = 1;
  Postgres server(libpq().connect_start_params(keywords, values, kExpands), stop, patience);
  if (server.connection_ == nullptr) return Error{"there is no memory for a connection"};
  if (const auto established = server.establish(); !established) return Error{established.error()};
  const auto set = server.run(
      "SET statement_timeout = '15s'; SET lock_timeout = '5s'; "
      "SET idle_in_transaction_session_timeout = '30s'; SET client_min_messages = 'error'; "
      "SET TimeZone = 'UTC'");
  if (!set) return Error{set.error()};
  return server;
}

Expected<void> Postgres::establish() {
  const Time until = later(live_now(), patience_);
  PGconn* connection = connection_.get();
  if (libpq().status(connection) == CONNECTION_BAD) return error(libpq().error_message(connection));
  libpq().set_notice_processor(
      connection, [](void*, const char*) {}, nullptr);
  auto phase = PGRES_POLLING_WRITING;
  while (phase != PGRES_POLLING_OK) {
    if (phase == PGRES_POLLING_FAILED) return error(libpq().error_message(connection));
    if (const auto ready = wait(phase == PGRES_POLLING_WRITING, until); !ready) return ready;
    phase = libpq().connect_poll(connection);
  }
  if (libpq().set_nonblocking(connection, 1) != 0) return error(libpq().error_message(connection));
  return {};
}

Expected<Rows> Postgres::results() {
  PGconn* connection = connection_.get();
  const Time until = later(live_now(), patience_);
  for (int flushed = libpq().flush(connection); flushed != 0; flushed = libpq().flush(connection)) {
    if (flushed < 0) return error(libpq().error_message(connection));
    if (const auto ready = wait(true, until); !ready) return Error{ready.error()};
    if (libpq().consume_input(connection) == 0) return error(libpq().error_message(connection));
  }
  Rows rows;
  std::optional<Error> failure;
  while (true) {
    while (libpq().is_busy(connection) != 0) {
      if (const auto ready = wait(false, until); !ready) {
        connection_.reset(nullptr);
        return Error{ready.error()};
      }
      if (libpq().consume_input(connection) == 0) return error(libpq().error_message(connection));
    }
    const Result result(libpq().get_result(connection));
    if (result == nullptr) break;
    const auto status = libpq().result_status(result.get());
    if (status != PGRES_TUPLES_OK && status != PGRES_COMMAND_OK) {
      const char* state = libpq().result_error_field(result.get(), PG_DIAG_SQLSTATE);
      const char* message = libpq().result_error_field(result.get(), PG_DIAG_MESSAGE_PRIMARY);
      state_ = state != nullptr ? state : "";
      failure = error(message != nullptr ? message : libpq().result_error_message(result.get()));
      if (status == PGRES_COPY_IN || status == PGRES_COPY_OUT || status == PGRES_COPY_BOTH) break;
      continue;
    }
    for (int r = 0; r < libpq().tuples(result.get()); ++r) {
      Row& row = rows.emplace_back();
      for (int c = 0; c < libpq().fields(result.get()); ++c) {
        if (libpq().get_is_null(result.get(), r, c) != 0) {
          row.emplace_back();
        } else {
          row.emplace_back(
              std::string(libpq().get_value(result.get(), r, c),
                          static_cast<std::size_t>(libpq().get_length(result.get(), r, c))));
        }
      }
    }
  }
  if (failure) return *failure;
  return rows;
}

Expected<Rows> Postgres::query(const std::string& sql, const std::vector<Field>& parameters) {
  state_.clear();
  if (connection_ == nullptr) return Error{"its connection is broken"};
  std::vector<const char*> values;
  for (const Field& each : parameters) values.push_back(each ? each->c_str() : nullptr);
  constexpr int kAsText = 0;
  if (libpq().send_query_params(connection_.get(), sql.c_str(), static_cast<int>(values.size()),
                                nullptr, values.data(), nullptr, nullptr, kAsText) == 0)
    return error(libpq().error_message(connection_.get()));
  return results();
}

Expected<void> Postgres::run(const std::string& sql) {
  state_.clear();
  if (connection_ == nullptr) return Error{"its connection is broken"};
  if (libpq().send_query(connection_.get(), sql.c_str()) == 0)
    return error(libpq().error_message(connection_.get()));
  const auto done = results();
  if (!done) return Error{done.error()};
  return {};
}

}  // namespace culprit::fleet

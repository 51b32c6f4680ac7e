#include "fleet/libpq.h"

#include <dlfcn.h>
#include <string>

namespace culprit::fleet {
namespace {

struct Loaded {
  Libpq functions;
  std::string error;  // empty: it is there
};

Loaded load() {
  Loaded loaded;
  void* const library = dlopen("libpq.so.5", RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    loaded.error = std::string("there is no client library of PostgreSQL here (") + dlerror() +
                   "): install libpq5";
    return loaded;
  }
  const auto find = [&](auto& function, const char* name) {
    void* const symbol = dlsym(library, name);
    if (symbol == nullptr && loaded.error.empty())
      loaded.error = std::string("the client library of PostgreSQL has no ") + name +
                     ": install a newer libpq5";
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(symbol);
  };
  Libpq& all = loaded.functions;
  find(all.clear, "PQclear");
  find(all.connect_poll, "PQconnectPoll");
  find(all.connect_start_params, "PQconnectStartParams");
  find(all.conninfo_free, "PQconninfoFree");
  find(all.conninfo_parse, "PQconninfoParse");
  find(all.consume_input, "PQconsumeInput");
  find(all.error_message, "PQerrorMessage");
  find(all.finish, "PQfinish");
  find(all.flush, "PQflush");
  find(all.free_memory, "PQfreemem");
  find(all.get_result, "PQgetResult");
  find(all.get_is_null, "PQgetisnull");
  find(all.get_length, "PQgetlength");
  find(all.get_value, "PQgetvalue");
  find(all.is_busy, "PQisBusy");
  find(all.fields, "PQnfields");
  find(all.tuples, "PQntuples");
  find(all.result_error_field, "PQresultErrorField");
  find(all.result_error_message, "PQresultErrorMessage");
  find(all.result_status, "PQresultStatus");
  find(all.send_query, "PQsendQuery");
  find(all.send_query_params, "PQsendQueryParams");
  find(all.set_notice_processor, "PQsetNoticeProcessor");
  find(all.set_nonblocking, "PQsetnonblocking");
  find(all.socket, "PQsocket");
  find(all.status, "PQstatus");
  find(all.user, "PQuser");
  return loaded;
}

// Once for all, and for as long as the process runs.
const Loaded& loaded() {
  static const Loaded all = load();
  return all;
}

}  // namespace

Expected<void> load_libpq() {
  if (!loaded().error.empty()) return Error{loaded().error};
  return {};
}

const Libpq& libpq() { return loaded().functions; }

}  // namespace culprit::fleet

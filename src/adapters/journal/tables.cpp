#include "journal/tables.h"

#include <algorithm>
#include <string>

#include "journal/schema.h"

namespace culprit::journal {
namespace {

Expected<Link> link_from(const Database& database, std::string_view sql) {
  auto statement = database.prepare(sql);
  if (!statement) return Error{statement.error()};
  const auto row = statement->step();
  if (!row) return Error{row.error()};
  if (!*row) return Link{};
  const auto hash = hash_from(statement->bytes(1));
  if (!hash) return Error{"it is damaged (a hash has not 32 bytes)"};
  return Link{statement->integer(0), *hash};
}

}  // namespace

std::optional<Hash> hash_from(std::string_view bytes) {
  Hash hash;
  if (bytes.size() != hash.size()) return std::nullopt;
  std::copy(bytes.begin(), bytes.end(), hash.begin());
  return hash;
}

Expected<Learned> read_learned(const Database& database) {
  Learned learned;
  auto beliefs = database.prepare(
      "SELECT rule, strategy, alpha, beta, prior_alpha, prior_beta FROM belief "
      "ORDER BY rule, strategy");
  if (!beliefs) return Error{beliefs.error()};
  auto row = beliefs->step();
  for (; row && *row; row = beliefs->step())
    learned.beliefs.push_back({std::string(beliefs->bytes(0)),
                               std::string(beliefs->bytes(1)),
                               {beliefs->real(2), beliefs->real(3)},
                               {beliefs->real(4), beliefs->real(5)}});
  if (!row) return Error{row.error()};
  const std::string spared = has_exposure(database) ? "spared" : "0";
  auto couplings = database.prepare("SELECT cause, effect, cleared, stayed, " + spared +
                                    " FROM coupling ORDER BY cause, effect");
  if (!couplings) return Error{couplings.error()};
  row = couplings->step();
  for (; row && *row; row = couplings->step())
    learned.couplings.push_back({std::string(couplings->bytes(0)),
                                 std::string(couplings->bytes(1)),
                                 {couplings->real(2), couplings->real(3), couplings->real(4)}});
  if (!row) return Error{row.error()};
  if (!has_latencies(database)) return learned;
  auto latencies = database.prepare("SELECT rule, count, least, most FROM latency ORDER BY rule");
  if (!latencies) return Error{latencies.error()};
  row = latencies->step();
  for (; row && *row; row = latencies->step())
    learned.latencies.push_back({std::string(latencies->bytes(0)),
                                 static_cast<int>(latencies->integer(1)), latencies->real(2),
                                 latencies->real(3)});
  if (!row) return Error{row.error()};
  return learned;
}

Expected<Link> newest_link(const Database& database) {
  return link_from(database,
                   "SELECT id, hash FROM (SELECT id, hash FROM entry UNION ALL SELECT id, hash "
                   "FROM anchor) ORDER BY id DESC LIMIT 1");
}

Expected<Link> anchor(const Database& database) {
  return link_from(database, "SELECT id, hash FROM anchor ORDER BY id DESC LIMIT 1");
}

}  // namespace culprit::journal

#include "fleet/test_journal.h"

#include <random>
#include <stdexcept>

#include "journal/json.h"
#include "journal/session.h"

namespace culprit::fleet {

void TestJournal::append(std::string_view kind, const std::string& body) {
  wall_ += 1'000'000'000;
  const auto done = writer_->append({{{0, wall_, std::string(kind), body}}, {}}, wall_,
                                    journal::Durability::kProcessEnd);
  if (!done) throw std::runtime_error(done.error());
}

void TestJournal::begins(const std::string& context, std::int64_t wall) {
  writer_.reset();
  auto writer = journal::Writer::open(path_, {.max_age_ns = std::int64_t{1} << 62});
  if (!writer) throw std::runtime_error(writer.error());
  writer_ = std::move(*writer);
  journal::Session session;
  session.version = "0.1.0";
  session.robot = "rover";
  session.rules_text = kFleetRules;
  session.fleet_context = context;
  session.wall = wall;
  // As two processes never begin at the same nanosecond on the same clocks.
  session.boot = std::to_string(std::random_device()());
  append(journal::kind::kSession, to_line(journal::to_json(session)));
}

void TestJournal::ends() { writer_.reset(); }

void TestJournal::outcome(const std::string& strategy, bool has_helped) {
  event("outcome_counted", R"(,"rule":"Silent","strategy":")" + strategy + R"(","as":")" +
                               (has_helped ? "success" : "failure") + "\"");
}

void TestJournal::event(const std::string& type, const std::string& more) {
  append(journal::kind::kEvent, R"({"type":")" + type + "\"" + more + "}");
}

}  // namespace culprit::fleet

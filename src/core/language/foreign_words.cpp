#include "language/foreign_words.h"

#include <algorithm>
#include <array>
#include <span>
#include <string>

#include "language/component_reader.h"
#include "language/line_reader.h"

namespace culprit {
namespace {

struct ForeignWord {
  std::string_view theirs, ours;
};

constexpr auto kForeignStatements = std::to_array<ForeignWord>({
    {"ALERT", "RULE"},         {"FAILURE", "RULE"},         {"FAULT", "RULE"},
    {"SEVERITY", "POLICIES"},  {"POLICY", "POLICIES"},      {"LEVEL", "POLICIES"},
    {"PRIORITY", "POLICIES"},  {"CRITICALITY", "POLICIES"}, {"IF", "TRIGGER"},
    {"EXPR", "TRIGGER"},       {"ON", "TRIGGER"},           {"CONDITION", "TRIGGER"},
    {"TRIGGERED", "TRIGGER"},  {"REPAIR", "STRATEGY"},      {"ON_FAILURE", "STRATEGY"},
    {"ONFAILURE", "STRATEGY"}, {"RECOVERY", "STRATEGY"},    {"ACTION", "ADAPTATION"},
    {"DO", "ADAPTATION"},      {"ADAPT", "ADAPTATION"},     {"TASK", "ADAPTATION"},
    {"DEPENDS", "DEPENDENCY"}, {"REQUIRES", "DEPENDENCY"},  {"AFTER", "DEPENDENCY"},
    {"LET", "CONST"},          {"DEFINE", "CONST"},         {"CONSTANT", "CONST"},
    {"VAR", "CONST"},          {"VARIABLE", "SIGNAL"},      {"METRIC", "SIGNAL"},
    {"SENSOR", "SIGNAL"},      {"IMPORT", "INCLUDE"},       {"SOURCE", "INCLUDE"},
    {"MACRO", "TEMPLATE"},     {"FUNCTION", "TEMPLATE"},    {"APPLY", "USE"},
    {"PROCESS", "COMPONENT"},  {"SERVICE", "COMPONENT"},    {"GUARD", "INTERLOCK"},
    {"ENDTEMPLATE", "END"},    {"SYSTEM", "ROBOT"},         {"PERIOD", "CYCLE"},
});

// Several of ours: the first that the line may have.
constexpr auto kForeignClauses = std::to_array<ForeignWord>({
    {"HEALED", "RESOLVED"},
    {"FAILS", "REFUSED"},
    {"REJECTED", "REFUSED"},
    {"ERR", "ERROR"},
    {"MISSING", "absent"},
    {"RUNNING", "active"},
    {"COMMAND", "LAUNCH"},
    {"CMD", "LAUNCH"},
    {"EXEC", "LAUNCH"},
    {"EXECUTABLE", "LAUNCH"},
    {"EXECSTART", "LAUNCH"},
    {"START", "LAUNCH"},
    {"RUN", "LAUNCH"},
    {"SERVICE", "UNIT"},
    {"SYSTEMD", "UNIT"},
    {"DOCKER", "CONTAINER docker"},
    {"PODMAN", "CONTAINER podman"},
    {"ENVIRONMENT", "ENV"},
    {"WORKDIR", "CWD"},
    {"DIRECTORY", "CWD"},
    {"MACHINE", "HOST"},
    {"RESTART", "RESPAWNED"},
    {"STARTUP", "READY"},
    {"TIMEOUT", "READY"},
    {"NAME", "NODE"},
    {"NAMESPACE", "NODE"},
    {"PARAMS", "PARAMETERS"},
    {"PARAM", "PARAMETER"},
    {"DIAG", "DIAGNOSTIC"},
    {"MESSAGE", "TOPIC"},
    {"TIMEOUT", "STALE"},
    {"MAX_AGE", "STALE"},
    {"MIN", "RANGE"},
    {"MAX", "RANGE"},
    {"LIMITS", "RANGE"},
    {"BETWEEN", "RANGE"},
    {"RETRIES", "ATTEMPTS"},
    {"RETRY", "ATTEMPTS"},
    {"MAX_ATTEMPTS", "ATTEMPTS"},
    {"TRIES", "ATTEMPTS"},
    {"TIMEOUT", "FOR"},
    {"AFTER", "FOR"},
    {"DEBOUNCE", "FOR"},
    {"DELAY", "FOR"},
    {"DURATION", "FOR"},
    {"SINCE", "FOR"},
    {"ON", "ON_CHANGE"},
    {"EDGE", "ON_CHANGE"},
    {"ONCE", "ON_CHANGE"},
    {"NOTIFY", "REPORT"},
    {"BACKOFF", "COOLDOWN"},
    {"QUIET", "COOLDOWN"},
    {"PAUSE", "COOLDOWN"},
    {"FAILS", "DETECTED"},
    {"FAILED", "DETECTED"},
    {"FIRES", "DETECTED"},
    {"FIRED", "DETECTED"},
    {"RECOVERED", "RESOLVED"},
    {"CLEARED", "RESOLVED"},
    {"FIXED", "RESOLVED"},
    {"REPAIRED", "RESOLVED"},
    {"DIES", "KILLED"},
    {"DEAD", "KILLED"},
    {"CRASHES", "KILLED"},
    {"CRASHED", "KILLED"},
    {"KILL", "KILLED"},
    {"CRASH", "KILLED"},
    {"STOP", "STOPPED"},
    {"PAUSE", "STOPPED"},
    {"FREEZE", "HUNG"},
    {"FROZEN", "HUNG"},
    {"HANGS", "HUNG"},
    {"WITHIN", "BY"},
    {"IN", "BY"},
    {"BEFORE", "BY"},
    {"UNTIL", "BY"},
    {"CRASH", "kill"},
    {"EXIT", "kill"},
    {"STOP", "hang"},
    {"FREEZE", "hang"},
    {"DELAY", "slow"},
    {"LATENCY", "slow"},
    {"DROP", "loss"},
    {"PACKET_LOSS", "loss"},
});

constexpr auto kForeignAdaptations = std::to_array<ForeignWord>({
    {"reboot", "redeploy"},
    {"respawn", "redeploy"},
    {"relaunch", "redeploy"},
    {"reload", "redeploy"},
    {"kill", "redeploy"},
    {"reset", "redeploy"},
    {"restart_node", "redeploy"},
    {"restart_process", "redeploy"},
    {"restart_service", "redeploy"},
    {"launch", "start"},
    {"run", "start"},
    {"enable", "activate"},
    {"disable", "deactivate"},
    {"terminate", "stop"},
    {"shutdown", "stop"},
    {"set", "set_parameter"},
    {"set_param", "set_parameter"},
    {"param_set", "set_parameter"},
    {"increase", "increase_parameter"},
    {"decrease", "decrease_parameter"},
    {"remap", "change_communication"},
    {"call_service", "call"},
    {"service_call", "call"},
    {"switch_mode", "change_mode"},
    {"set_mode", "change_mode"},
});

constexpr auto kForeignFunctions = std::to_array<ForeignWord>({
    {"hz", "rate"},
    {"freq", "rate"},
    {"frequency", "rate"},
    {"increase", "rate"},
    {"irate", "rate"},
    {"count", "rate"},
    {"avg", "mean"},
    {"average", "mean"},
    {"avg_over_time", "mean"},
    {"std", "stddev"},
    {"stdev", "stddev"},
    {"stddev_over_time", "stddev"},
    {"min_over_time", "min"},
    {"max_over_time", "max"},
    {"timeout", "age"},
    {"elapsed", "age"},
    {"since", "age"},
    {"last_seen", "age"},
    {"delay", "age"},
    {"absent", "age"},
    {"missing", "age"},
    {"param", "parameter"},
    {"get_parameter", "parameter"},
    {"state", "lifecycle"},
    {"running", "alive"},
    {"is_alive", "alive"},
    {"up", "alive"},
    {"exists", "alive"},
    {"dead", "!alive"},
    {"down", "!alive"},
    {"crashed", "!alive"},
    {"is_dead", "!alive"},
    {"exited", "!alive"},
    {"status", "level"},
    {"diagnostic", "level"},
    {"mem", "memory"},
    {"ram", "memory"},
    {"cpu_usage", "cpu"},
    {"memory_usage", "memory"},
    {"is_nan", "isnan"},
    {"delta", "changed"},
    {"stuck", "frozen"},
    {"packet_loss", "loss"},
    {"log", "logs"},
    {"errors", "logs"},
});

// The clauses, each with the statement whose line has it.
constexpr auto kClauses = std::to_array<ForeignWord>({
    {"FOR", "POLICIES"},      {"HOLD", "POLICIES"},       {"COOLDOWN", "POLICIES"},
    {"ATTEMPTS", "POLICIES"}, {"ON_CHANGE", "POLICIES"},  {"REPORT", "POLICIES"},
    {"WHEN", "STRATEGY"},     {"LASTRESORT", "STRATEGY"}, {"WITHIN", "STRATEGY"},
    {"FIELD", "SIGNAL"},      {"KEY", "SIGNAL"},          {"STALE", "SIGNAL"},
    {"RANGE", "SIGNAL"},      {"FROM", "SIGNAL"},         {"TOPIC", "SIGNAL"},
    {"DIAGNOSTIC", "SIGNAL"}, {"PARAMETER", "SIGNAL"},    {"MANAGER", "GROUP"},
    {"ON", "DEPENDENCY"},     {"USER", "COMPONENT"},
});

std::string_view our_word(std::span<const ForeignWord> words, std::string_view theirs) {
  const auto found = std::ranges::find(words, theirs, &ForeignWord::theirs);
  return found == words.end() ? "" : found->ours;
}

}  // namespace

std::string_view statement_of_other_tools(std::string_view word) {
  return our_word(kForeignStatements, word);
}

std::string_view clause_of_other_tools(std::string_view word,
                                       std::span<const std::string_view> known) {
  const std::string upper = upper_case(word);
  for (const auto& [theirs, ours] : kForeignClauses) {
    const std::string_view clause = ours.substr(0, ours.find(' '));
    if (theirs == upper && std::ranges::find(known, clause) != known.end()) return ours;
  }
  return "";
}

std::string_view adaptation_of_other_tools(std::string_view word) {
  return our_word(kForeignAdaptations, word);
}

std::string_view function_of_other_tools(std::string_view word) {
  return our_word(kForeignFunctions, word);
}

std::string_view statement_of_clause(std::string_view word) {
  const std::string upper = upper_case(word);
  if (const auto statement = our_word(kClauses, upper); !statement.empty()) return statement;
  const auto of_components = component_clauses();
  const bool is_of_component =
      std::ranges::find(of_components, upper) != of_components.end() && upper != "IN";
  return is_of_component ? "COMPONENT" : "";
}

}  // namespace culprit

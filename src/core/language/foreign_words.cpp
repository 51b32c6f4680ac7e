#include "language/foreign_words.h"

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <utility>

#include "language/component_reader.h"
#include "language/line_reader.h"

namespace culprit {
namespace {

struct ForeignWord {
  std::string_view theirs, ours;
};

constexpr auto kForeignStatements = std::to_array<ForeignWord>({
    {"ALERT", "RULE"},           {"FAILURE", "RULE"},        {"FAULT", "RULE"},
    {"SEVERITY", "POLICIES"},    {"POLICY", "POLICIES"},     {"LEVEL", "POLICIES"},
    {"CRITICALITY", "POLICIES"}, {"IF", "TRIGGER"},          {"EXPR", "TRIGGER"},
    {"ON", "TRIGGER"},           {"CONDITION", "TRIGGER"},   {"TRIGGERED", "TRIGGER"},
    {"REPAIR", "STRATEGY"},      {"ON_FAILURE", "STRATEGY"}, {"ONFAILURE", "STRATEGY"},
    {"RECOVERY", "STRATEGY"},    {"ACTION", "ADAPTATION"},   {"DO", "ADAPTATION"},
    {"ADAPT", "ADAPTATION"},     {"TASK", "ADAPTATION"},     {"DEPENDS", "DEPENDENCY"},
    {"REQUIRES", "DEPENDENCY"},  {"AFTER", "DEPENDENCY"},    {"LET", "CONST"},
    {"DEFINE", "CONST"},         {"CONSTANT", "CONST"},      {"VAR", "CONST"},
    {"VARIABLE", "SIGNAL"},      {"METRIC", "SIGNAL"},       {"SENSOR", "SIGNAL"},
    {"IMPORT", "INCLUDE"},       {"SOURCE", "INCLUDE"},      {"MACRO", "TEMPLATE"},
    {"FUNCTION", "TEMPLATE"},    {"APPLY", "USE"},           {"PROCESS", "COMPONENT"},
    {"SERVICE", "COMPONENT"},    {"GUARD", "INTERLOCK"},     {"ENDTEMPLATE", "END"},
    {"SYSTEM", "ROBOT"},         {"PERIOD", "CYCLE"},
});

// Several of ours: the first that the line may have.
constexpr auto kForeignClauses = std::to_array<ForeignWord>({
    {"HEALED", "RESOLVED"},
    {"SUCCEEDS", "HEALS"},
    {"FIXES", "HEALS"},
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
    {"BACKOFFLIMIT", "ATTEMPTS"},
    {"BACKOFF_LIMIT", "ATTEMPTS"},
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
    {"KEEP_FIRING_FOR", "COOLDOWN"},
    {"QUIET", "COOLDOWN"},
    {"PAUSE", "COOLDOWN"},
    {"FAILS", "DETECTED"},
    {"FAILED", "DETECTED"},
    {"FIRES", "DETECTED"},
    {"FIRED", "DETECTED"},
    {"FIRING", "DETECTED"},
    {"TRIGGERED", "DETECTED"},
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
    {"AT", "BY"},
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
    {"rollout_restart", "redeploy"},
    {"restarted", "redeploy"},
    {"reloaded", "redeploy"},
    {"started", "start"},
    {"stopped", "stop"},
    {"scale", "stop"},
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

// Words for what the language has in another form, or does not need.
struct WordWithoutCounterpart {
  std::string_view line;  // the statement that it stands in; empty: it begins a line
  std::string_view word, remedy;
};

constexpr std::string_view kText = "write # in front of it: a rule has no text of its own";
constexpr std::string_view kSwitch =
    "remove the line; to switch a rule off, put # in front of its lines";
constexpr std::string_view kRank =
    "the criticality on the POLICIES line says which failure comes first: ERROR, then WARNING";
constexpr std::string_view kGrouped =
    "remove the line: culprit groups failures by their root cause";
constexpr std::string_view kWatched = "a rule notices it: RULE, and TRIGGER !alive(camera)";
constexpr std::string_view kNamespace = "write it into the full name, as in NODE /robot/camera";
constexpr std::string_view kAlternatives =
    "write a STRATEGY line for each way: the strategies of a rule are alternatives";
constexpr std::string_view kNoUnit = "remove it: a signal has no unit; a comment may name it";
constexpr std::string_view kDependency = "write a line of its own: DEPENDENCY fusion ON camera";
constexpr std::string_view kArguments = "write the arguments in LAUNCH, behind the program";
constexpr std::string_view kAttempts = "write ATTEMPTS and the number on the POLICIES line";
constexpr std::string_view kImpact =
    "remove it: the impact, the last number of an ADAPTATION, says in cycles how long it may take";
constexpr std::string_view kWhen = "write WHEN on the STRATEGY line, behind its two numbers";
constexpr std::string_view kOwnUser =
    "remove it: culprit acts as its own user; a UNIT needs no root";

constexpr auto kWithoutCounterpart = std::to_array<WordWithoutCounterpart>({
    {"", "DESCRIPTION", kText},
    {"", "COMMENT", kText},
    {"", "NOTE", kText},
    {"", "AUTHOR", kText},
    {"", "SUMMARY", kText},
    {"", "ANNOTATIONS", kText},
    {"", "LABELS", kText},
    {"", "ENABLED", kSwitch},
    {"", "DISABLED", kSwitch},
    {"", "LOG", "remove the line: culprit keeps each step in its journal"},
    {"", "NOTIFY", "write REPORT on the POLICIES line, which notifies a person"},
    {"", "ENDRULE", "remove the line: a rule ends where the next one begins"},
    {"", "PRIORITY", kRank},
    {"", "GROUP_BY", kGrouped},
    {"", "INHIBIT", kGrouped},
    {"", "WATCHDOG", kWatched},
    {"", "PROBE", kWatched},
    {"", "NAMESPACE", kNamespace},
    {"", "HOSTS", "write HOST on the COMPONENT line of each part that runs there"},
    {"", "SEQUENCE", "write STRATEGY in its place: its ADAPTATION lines follow in order"},
    {"", "FALLBACK", kAlternatives},
    {"", "SELECTOR", kAlternatives},
    {"POLICIES", "PRIORITY", "remove it: ERROR comes before WARNING, and that before NON_CRITICAL"},
    {"POLICIES", "SEVERITY", "write only the criticality: POLICIES ERROR"},
    {"POLICIES", "LEVEL", "write only the criticality: POLICIES ERROR"},
    {"POLICIES", "PENDING", "a criticality comes first, then the time: POLICIES WARNING FOR 5min"},
    {"POLICIES", "REPEAT_INTERVAL", "remove it: culprit notifies once for each failure"},
    {"SIGNAL", "UNIT", kNoUnit},
    {"SIGNAL", "UNITS", kNoUnit},
    {"SIGNAL", "NO_DATA", "remove it: STALE 2s makes a value unknown that is older"},
    {"SIGNAL", "DEFAULT", "remove it: a signal without a value is unknown"},
    {"SIGNAL", "TYPE", "remove it: the rules that read a signal show its type"},
    {"COMPONENT", "NAMESPACE", kNamespace},
    {"COMPONENT", "IMAGE",
     "write CONTAINER docker, and the container's name as docker ps shows it"},
    {"COMPONENT", "REPLICAS", "write a COMPONENT line for each"},
    {"COMPONENT", "LIVENESS", kWatched},
    {"COMPONENT", "HEALTHCHECK", kWatched},
    {"COMPONENT", "WATCHDOG", kWatched},
    {"COMPONENT", "ARGS", kArguments},
    {"COMPONENT", "ARGUMENTS", kArguments},
    {"COMPONENT", "OUTPUT", "remove it: culprit keeps what a component prints in its log folder"},
    {"COMPONENT", "RESPAWN_DELAY", "remove it: culprit run --backoff 2s sets this for all"},
    {"COMPONENT", "AFTER", kDependency},
    {"COMPONENT", "REQUIRES", kDependency},
    {"COMPONENT", "WANTS", kDependency},
    {"COMPONENT", "DEPENDS", kDependency},
    {"COMPONENT", "DEPENDS_ON", kDependency},
    {"COMPONENT", "WANTEDBY", "remove it: the file of the unit says that"},
    {"STRATEGY", "PRIORITY", "remove it: probability and impact decide which strategy comes first"},
    {"STRATEGY", "RETRY", kAttempts},
    {"STRATEGY", "RETRIES", kAttempts},
    {"STRATEGY", "TIMEOUT", kImpact},
    {"STRATEGY", "ELSE", kAlternatives},
    {"ADAPTATION", "RETRY", kAttempts},
    {"ADAPTATION", "RETRIES", kAttempts},
    {"ADAPTATION", "TIMEOUT", kImpact},
    {"ADAPTATION", "WHEN", kWhen},
    {"ADAPTATION", "IF", kWhen},
    {"ADAPTATION", "NOTIFY", "remove it: culprit notifies of each repair itself (docs/alerts.md)"},
    {"ADAPTATION", "BECOME", kOwnUser},
    {"ADAPTATION", "SUDO", kOwnUser},
    {"ADAPTATION", "||", kAlternatives},
    {"ADAPTATION", "OR", kAlternatives},
    {"ADAPTATION", "&&", "write the next one on a line of its own that begins with ADAPTATION"},
    {"ADAPTATION", "AND", "write the next one on a line of its own that begins with ADAPTATION"},
});

constexpr std::string_view kItself = "write the signal by itself, as in battery < 0.2";
constexpr std::string_view kSilent = "write age(/topic) > 2s: no message came for that long";
constexpr auto kFunctionsWithoutCounterpart =
    std::to_array<std::pair<std::string_view, std::string_view>>({
        {"any", "join conditions with ||, as in !alive(a) || !alive(b)"},
        {"all", "join conditions with &&, as in alive(a) && alive(b)"},
        {"silent", kSilent},
        {"absent_over_time", kSilent},
        {"len", "rate(/topic) counts messages in Hz, age(/topic) the time since the last one"},
        {"sum", "join the values with +, as in a + b; mean(signal, 10s) is over time"},
        {"histogram_quantile", "max(signal, 10s) and mean(signal, 10s) are over time"},
        {"predict_linear", "culprit does not predict: compare the signal, as in battery < 0.2"},
        {"float", kItself},
        {"int", kItself},
        {"round", kItself},
        {"last", kItself},
        {"value", kItself},
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

std::string_view remedy_of_foreign_word(std::string_view word, std::string_view line) {
  const std::string upper = upper_case(word);
  const auto found = std::ranges::find_if(
      kWithoutCounterpart,
      [&](const WordWithoutCounterpart& each) { return each.line == line && each.word == upper; });
  return found == kWithoutCounterpart.end() ? "" : found->remedy;
}

std::string_view remedy_of_foreign_function(std::string_view word) {
  for (const auto& [theirs, remedy] : kFunctionsWithoutCounterpart) {
    if (theirs == word) return remedy;
  }
  return "";
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

#include "language/foreign_words.h"

#include <algorithm>
#include <array>
#include <span>

#include "language/line_reader.h"

namespace culprit {
namespace {

struct Word {
  std::string_view theirs, ours;
};

constexpr std::array<Word, 7> kStatements = {{{"ALERT", "RULE"},
                                              {"SEVERITY", "POLICIES"},
                                              {"IF", "TRIGGER"},
                                              {"EXPR", "TRIGGER"},
                                              {"CONDITION", "TRIGGER"},
                                              {"ACTION", "ADAPTATION"},
                                              {"DO", "ADAPTATION"}}};

constexpr std::array<Word, 9> kClauses = {{{"COMMAND", "LAUNCH"},
                                           {"CMD", "LAUNCH"},
                                           {"EXEC", "LAUNCH"},
                                           {"EXECUTABLE", "LAUNCH"},
                                           {"START", "LAUNCH"},
                                           {"SERVICE", "UNIT"},
                                           {"SYSTEMD", "UNIT"},
                                           {"DOCKER", "CONTAINER docker"},
                                           {"PODMAN", "CONTAINER podman"}}};

constexpr std::array<Word, 14> kAdaptations = {{{"reboot", "redeploy"},
                                                {"respawn", "redeploy"},
                                                {"relaunch", "redeploy"},
                                                {"reload", "redeploy"},
                                                {"kill", "redeploy"},
                                                {"reset", "redeploy"},
                                                {"launch", "start"},
                                                {"run", "start"},
                                                {"terminate", "stop"},
                                                {"shutdown", "stop"},
                                                {"set", "set_parameter"},
                                                {"set_param", "set_parameter"},
                                                {"remap", "change_communication"},
                                                {"call_service", "call"}}};

std::string_view ours(std::span<const Word> words, std::string_view theirs) {
  const auto found = std::ranges::find(words, theirs, &Word::theirs);
  return found == words.end() ? "" : found->ours;
}

}  // namespace

std::string_view statement_of_other_tools(std::string_view word) { return ours(kStatements, word); }

std::string_view clause_of_other_tools(std::string_view word) {
  return ours(kClauses, upper_case(word));
}

std::string_view adaptation_of_other_tools(std::string_view word) {
  return ours(kAdaptations, word);
}

}  // namespace culprit

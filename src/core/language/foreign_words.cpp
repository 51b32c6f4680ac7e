#include "language/foreign_words.h"

#include <algorithm>
#include <array>
#include <span>

#include "language/line_reader.h"

namespace culprit {
namespace {

struct ForeignWord {
  std::string_view theirs, ours;
};

constexpr std::array<ForeignWord, 7> kForeignStatements = {{{"ALERT", "RULE"},
                                                            {"SEVERITY", "POLICIES"},
                                                            {"IF", "TRIGGER"},
                                                            {"EXPR", "TRIGGER"},
                                                            {"CONDITION", "TRIGGER"},
                                                            {"ACTION", "ADAPTATION"},
                                                            {"DO", "ADAPTATION"}}};

constexpr std::array<ForeignWord, 9> kForeignClauses = {{{"COMMAND", "LAUNCH"},
                                                         {"CMD", "LAUNCH"},
                                                         {"EXEC", "LAUNCH"},
                                                         {"EXECUTABLE", "LAUNCH"},
                                                         {"START", "LAUNCH"},
                                                         {"SERVICE", "UNIT"},
                                                         {"SYSTEMD", "UNIT"},
                                                         {"DOCKER", "CONTAINER docker"},
                                                         {"PODMAN", "CONTAINER podman"}}};

constexpr std::array<ForeignWord, 14> kForeignAdaptations = {{{"reboot", "redeploy"},
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

std::string_view our_word(std::span<const ForeignWord> words, std::string_view theirs) {
  const auto found = std::ranges::find(words, theirs, &ForeignWord::theirs);
  return found == words.end() ? "" : found->ours;
}

}  // namespace

std::string_view statement_of_other_tools(std::string_view word) {
  return our_word(kForeignStatements, word);
}

std::string_view clause_of_other_tools(std::string_view word) {
  return our_word(kForeignClauses, upper_case(word));
}

std::string_view adaptation_of_other_tools(std::string_view word) {
  return our_word(kForeignAdaptations, word);
}

}  // namespace culprit

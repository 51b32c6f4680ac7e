// The command line of sunset-node, suave-node and rover-node: which process of a live robot this one is. CLI11, which reads it,
// takes longer to compile than the rest of such a program; so all have it from here.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace culprit {

// The arguments of one of the programs. Beside a name, --speed and --seed each has one option of
// its own.
struct NodeCommandLine {
  std::string about;                   // "One process of the SUNSET exemplar's robot."
  std::vector<std::string> names;      // of the processes
  std::string environment;             // "SUNSET": --speed may be given as SUNSET_SPEED, too
  std::string seed_of;                 // "flight"
  std::string option;                  // "state"
  std::string option_environment;      // "SUNSET_STATE"
  std::string option_help;             // for --help
  std::vector<std::string> choices{};  // of that option; the first unless given. None: any text
};

struct NodeArguments {
  std::string name;
  double speed = 1;  // robot seconds in a second
  std::uint64_t seed = 1;
  std::string option;  // the value of the program's own one
};

// Empty if the program must exit: after --help, or after an unknown argument, which is reported. Then `exit_code` is set.
std::optional<NodeArguments> parse(const NodeCommandLine& line, int argc, char** argv,
                                   int& exit_code);

}  // namespace culprit

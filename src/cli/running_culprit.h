// The culprits that run on this machine, and which of them is meant.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "http/local_client.h"
#include "live/local_socket.h"

namespace culprit::cli {

struct RunningCulprit {
  int process = 0;
  Json about;  // GET /api/about
  web::LocalClient client;

  // "culprit of rover (process 4711, domain 0)"
  std::string name() const;
};

struct WhichCulprit {
  std::optional<std::uint32_t> domain;
  std::string node_name;

  // The options must live as long as `command`.
  void add_to(CLI::App& command);
};

struct CulpritsHere {
  std::vector<RunningCulprit> answering;
  // A line for each that cannot be asked, and why: it does not answer, is another user's, or has ended
  // without a word.
  std::vector<std::string> others;
};
CulpritsHere culprits_here(const WhichCulprit& which);

// The one that is meant. Errors: there is none, or several, and what to do.
Expected<RunningCulprit> the_culprit(const WhichCulprit& which);

// Why nobody can be asked, in lines.
std::string none_to_ask(const CulpritsHere& here);

// How long an answer is waited for.
inline constexpr Duration kPatienceWithCulprit = std::chrono::seconds(5);

}  // namespace culprit::cli

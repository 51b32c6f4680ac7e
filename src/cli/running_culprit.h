// The culprits that run on this machine, and which of them is meant.
//
// All that may be meant are asked at once and have kTimeToAnswer together, so that no silent one delays an order
// to another one. Which sockets are asked at all: live/local_socket.h.
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
  http::LocalClient client;

  // "culprit of rover (process 4711, domain 0)"
  std::string name() const;
};

struct WhichCulprit {
  std::optional<std::uint32_t> domain;  // nothing: that of ROS_DOMAIN_ID, as for any ROS program
  std::string node_name;
  std::string user;  // whose, for root; empty: root's, and that in /run/culprit
  bool all = false;  // of every domain; for root, of every user

  // The options must live as long as `command`.
  void add_to(CLI::App& command);
  // --all
  void add_all_to(CLI::App& command);
};

struct CulpritsHere {
  std::vector<RunningCulprit> answering;
  // A line for each that was meant and cannot be asked, and why: it does not answer, or has ended without a
  // word.
  std::vector<std::string> others;
  // A line for each user and each domain whose culprits were not meant: how to ask those.
  std::vector<std::string> not_meant;
};
// Errors: ROS_DOMAIN_ID names no domain, or there is no such user.
Expected<CulpritsHere> culprits_here(const WhichCulprit& which);

// The one that is meant. Errors: there is none, or several, and what to do.
Expected<RunningCulprit> the_culprit(const WhichCulprit& which);

// The culprits that one has to be chosen of, in lines.
std::string several_to_choose(const CulpritsHere& here);
// Explains why no culprit can be asked, in lines.
std::string none_to_ask(const CulpritsHere& here);

// Time for all culprits together to say who they are.
inline constexpr Duration kTimeToAnswer = std::chrono::seconds(1);
// Time for the whole answer to each further question, and for an order to be confirmed.
inline constexpr Duration kPatienceWithCulprit = std::chrono::seconds(5);

}  // namespace culprit::cli

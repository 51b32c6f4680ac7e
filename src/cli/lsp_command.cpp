#include <iostream>

#include <fmt/core.h>

#include "cli/commands.h"
#include "lsp/message_stream.h"
#include "lsp/server.h"

namespace culprit::cli {
namespace {

int serve(const std::string& version) {
  lsp::Server server(version,
                     [](const nlohmann::json& message) { lsp::write_message(std::cout, message); });
  while (true) {
    const auto message = lsp::read_message(std::cin);
    if (!message) {
      fmt::print(stderr, "culprit: the client sent {}\n", message.error());
      return kFailed;
    }
    if (!*message || !server.handle(**message)) return server.exit_code();
  }
}

}  // namespace

void add_lsp(CLI::App& app, const std::string& version, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "lsp", "Serve an editor: the Language Server Protocol on standard input and output");
  command->callback([version, &exit_code] { exit_code = serve(version); });
}

}  // namespace culprit::cli

#include "terminal/web_service.h"

#include <fmt/core.h>

#include "base/name_grammar.h"
#include "terminal/console.h"
#include "web/app.h"

namespace culprit {
namespace {

// "localhost:8080"; an address of IPv6 has more than one ':'.
std::string trouble_of_address(const std::string& address) {
  const auto colon = address.find(':');
  if (colon == std::string::npos || address.find(':', colon + 1) != std::string::npos) return "";
  return fmt::format("an address has no port; write --address {} --port {}",
                     printable(address.substr(0, colon)), printable(address.substr(colon + 1)));
}

}  // namespace

void WebOptions::add_to(CLI::App& command) {
  const std::string kGroup = "Web app";
  command
      .add_option(
          "--port", port,
          fmt::format(
              "Port of the web app; 0: any free one (default: {}, or another if that is taken)",
              kUsualPort))
      ->check(CLI::Range(0, 65535))
      ->group(kGroup);
  command
      .add_option("--address", address,
                  "Address of the web app; one that other machines can reach needs --token-file")
      ->check(trouble_of_address)
      ->capture_default_str()
      ->group(kGroup);
  command
      .add_option(
          "--token-file", token_file,
          "Private file with the token that permits everything (default: a new token each time)")
      ->type_name("FILE")
      ->group(kGroup);
  command
      .add_option("--operate-token-file", operate_token_file,
                  "File with a token that permits orders, but no change of rules")
      ->type_name("FILE")
      ->group(kGroup);
  command
      .add_option("--look-token-file", look_token_file,
                  "File with a token that permits only reading")
      ->type_name("FILE")
      ->group(kGroup);
  CLI::Option* const cert =
      command
          .add_option("--web-cert", certificate,
                      "Encrypt (https) with this certificate, a PEM file with its chain")
          ->type_name("FILE")
          ->group(kGroup);
  command.add_option("--web-key", key, "The key of --web-cert, a private PEM file")
      ->type_name("FILE")
      ->needs(cert)
      ->group(kGroup);
  cert->needs(command.get_option("--web-key"));
  command
      .add_option("--allow-host", allowed_hosts,
                  "Host name that browsers may use, beside this machine's addresses")
      ->group(kGroup);
}

namespace {

Expected<http::Access> access_for(const WebOptions& options) {
  http::Access access;
  access.is_local = http::is_loopback(options.address);
  access.allowed_hosts = options.allowed_hosts;
  access.is_encrypted = !options.certificate.empty();
  for (const auto& [file, token] : {std::pair(&options.operate_token_file, &access.operate_token),
                                    std::pair(&options.look_token_file, &access.look_token)}) {
    if (file->empty()) continue;
    auto read = http::read_secret(*file);
    if (!read) return Error{read.error()};
    *token = std::move(*read);
  }
  if (options.token_file.empty()) {
    if (!access.is_local)
      return Error{fmt::format(
          "other machines can reach {}: write a token to a file that only you can read, "
          "and add --token-file FILE",
          options.address)};
    access.token = http::make_token();
    return access;
  }
  auto token = http::read_secret(options.token_file);
  if (!token) return Error{token.error()};
  access.token = std::move(*token);
  const bool are_alike = access.token == access.operate_token ||
                         access.token == access.look_token ||
                         (!access.look_token.empty() && access.look_token == access.operate_token);
  if (are_alike) return Error{"two of the token files hold the same token"};
  return access;
}

}  // namespace

Expected<std::unique_ptr<http::HttpServer>> serve(const WebOptions& options,
                                                  std::vector<http::Route> routes, http::Hub* hub,
                                                  std::FILE* out) {
  auto access = access_for(options);
  if (!access) return Error{access.error()};
  http::HttpServer::Options server{options.address, options.port.value_or(WebOptions::kUsualPort),
                                   std::move(*access)};
  if (!options.certificate.empty()) {
    auto tls = http::TlsContext::load(options.certificate, options.key);
    if (!tls) return Error{tls.error()};
    server.tls = std::move(*tls);
  }
  server.app = web::app();
  server.openapi = web::openapi();
  auto started = http::HttpServer::start(server, routes, hub);
  if (!started && !options.port) {
    server.port = 0;
    started = http::HttpServer::start(server, std::move(routes), hub);
  }
  if (!started) return started;
  if (server.access.is_local) {
    say(out, "See it in a browser: {}\n", (*started)->address());
  } else {
    say(out,
        "See it in a browser: {}://{}:{}/#token=... (the token of {}). Others can reach "
        "this address{}.\n",
        server.tls ? "https" : "http", options.address, (*started)->port(), options.token_file,
        server.tls ? "" : ", and what they send is not encrypted (--web-cert)");
  }
  return started;
}

}  // namespace culprit

// Bodies of calls to the web API, of any content: each is answered, a refusal says why, and what is
// answered can be sent. The first byte chooses the call.
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "http/hub.h"
#include "language/checker.h"
#include "web/calls.h"
#include "web/order_routes.h"

namespace {

using namespace culprit;

constexpr const char* kRules =
    "COMPONENT camera NODE /camera\nRULE Silent\nPOLICIES ERROR\nTRIGGER age(/rgb) > 1s\n"
    "STRATEGY restart 50 10\nADAPTATION camera restart 3\n";

std::vector<http::Route> all_routes() {
  static const RuleSet rules = *check(Source("fuzz.rules", kRules)).rules;
  static web::RuleDesk desk("fuzz.rules", kRules);
  std::vector<http::Route> routes = web::rule_routes(desk);
  static live::OrderKeeper keeper("it is fuzzed");
  static web::OrderDesk orders(keeper.keeping());
  orders.open(rules, [](const Order&) {});
  static http::Hub hub([] {});
  hub.close();  // nobody waits for what becomes of an order
  for (http::Route& route : web::order_routes(orders, hub)) routes.push_back(std::move(route));
  return routes;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::vector<http::Route> routes = all_routes();
  if (size == 0) return 0;
  const std::string text(reinterpret_cast<const char*>(data) + 1, size - 1);
  const Json body = culprit::parse_json(text);
  if (body.is_discarded()) return 0;
  const http::Answer answer = routes[data[0] % routes.size()].answer(body);
  if (answer.status >= 400 && !answer.body.contains("error")) __builtin_trap();
  if (to_line(answer.body).find('\n') != std::string::npos) __builtin_trap();
  return 0;
}

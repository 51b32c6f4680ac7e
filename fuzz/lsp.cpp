// A client's bytes, while a robot is there: every message is answered or refused, and what is sent
// back can be written.
#include <cstddef>
#include <cstdint>
#include <sstream>
#include <string>

#include "language/test_example_robot.h"
#include "lsp/language_server.h"
#include "lsp/message_stream.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace culprit::lsp;
  std::istringstream in(std::string(reinterpret_cast<const char*>(data), size));
  std::ostringstream out;
  LanguageServer server("fuzz",
                        [&out](const culprit::Json& message) { write_message(out, message); });
  server.see(culprit::example_robot());
  while (true) {
    const auto message = read_message(in);
    if (!message || !*message || !server.handle(**message)) return 0;
  }
}

// The language server: what editors ask about rule files (LSP 3.17). It does no I/O of its own.
#pragma once

#include <functional>
#include <map>
#include <set>
#include <string>

#include "json/json.h"
#include "lsp/document.h"

namespace culprit::lsp {

struct Asked;

class LanguageServer {
 public:
  using Send = std::function<void(const Json& message)>;

  // Where documents find the files that they include. `from` is the path of the document; empty: it
  // has none.
  struct Files {
    RuleLoader load;
    std::function<std::vector<std::string>(const std::string& from)> includable;
  };

  // `version` is what the server says of itself.
  LanguageServer(std::string version, Send send, Files files = {})
      : version_(std::move(version)), send_(std::move(send)), files_(std::move(files)) {}

  // One message of the client, of any content; answers and diagnostics go through Send. False when
  // the client said that the server has to end.
  bool handle(const Json& message);

  // Takes the robot's current state for completion, hover and diagnostics. Diagnostics that change
  // are published.
  void see(LiveInventory robot);
  // The robot's names in the open documents. A document that does not parse keeps its earlier
  // names.
  LiveInterest interest() const;

  // 0 if the client asked for the shutdown first, as it has to.
  int exit_code() const { return is_shut_down_ ? 0 : 1; }

 private:
  // An object with the member "result" or the member "error".
  Json answer(const std::string& method, const Json& params);
  void notice(const std::string& method, const Json& params);

  Json answer_about(const Asked& asked, const std::string& what) const;
  Json capabilities() const;

  void open(const std::string& uri, std::string text);
  void read(const std::string& uri, std::string text);
  Expected<Source> load(const std::string& file, const std::string& from) const;
  std::set<std::string> read_includers_of(const std::string& uri);
  void publish(const std::string& uri);
  void publish(const std::set<std::string>& uris);
  // The documents that `document` is about: those in which something is wrong with it, too.
  static std::set<std::string> concerned(const std::string& uri, const Document& document);

  const std::string version_;
  const Send send_;
  const Files files_;
  std::map<std::string, Document> documents_;      // by URI
  std::map<std::string, LiveInterest> interests_;  // by URI
  std::optional<LiveInventory> robot_;             // nothing while none was seen
  bool is_shut_down_ = false;
};

}  // namespace culprit::lsp

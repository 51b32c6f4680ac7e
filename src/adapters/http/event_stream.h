// One page's stream of changes, as server-sent events (WHATWG HTML, "Server-sent events"):
//
//     id: 5f3a-17
//     event: state
//     data: {"t": 12.3, ...}
//
// The first event, "hello", shows whether the stream goes on where the reader left off (its
// Last-Event-ID) or begins again; in that case what the reader has of earlier events is void.
#pragma once

#include <optional>
#include <string>

#include "http/hub.h"

namespace culprit::http {

// Used by one thread.
class EventStream {
 public:
  // The longest time without an event; then it sends a comment, to find out whether the reader is
  // there.
  static constexpr std::chrono::milliseconds kSilence = std::chrono::seconds(1);

  // `hub` must outlive the stream. `last_event_id` is what the reader sent, of any content.
  EventStream(Hub& hub, const std::string& last_event_id);

  // Waits for the next text to send. Nothing: the stream is over.
  std::optional<std::string> next();

 private:
  std::string hello(bool is_resumed) const;

  Hub& hub_;
  const Hub::Reader reader_;
  std::uint64_t sent_ = 0;
  bool is_resumed_ = false;
  bool has_greeted_ = false;
};

}  // namespace culprit::http

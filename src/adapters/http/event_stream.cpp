#include "http/event_stream.h"

#include <charconv>

namespace culprit::http {

EventStream::EventStream(Hub& hub, const std::string& last_event_id) : hub_(hub), reader_(hub) {
  const std::string ours = hub_.name() + "-";
  if (last_event_id.rfind(ours, 0) != 0) return;
  const char* end = last_event_id.data() + last_event_id.size();
  std::uint64_t number = 0;
  const auto read = std::from_chars(last_event_id.data() + ours.size(), end, number);
  if (read.ec != std::errc() || read.ptr != end || number > hub_.last()) return;
  sent_ = number;
  is_resumed_ = true;
}

std::optional<std::string> EventStream::next() {
  // The greeting waits for nothing.
  const auto patience = has_greeted_ ? kSilence : std::chrono::milliseconds(0);
  const Hub::Batch batch = hub_.wait(sent_, patience);
  if (hub_.is_closed()) return std::nullopt;
  std::string text;
  if (!has_greeted_ || (batch.is_gap && !batch.messages.empty())) {
    // A gap in the middle: the reader was so slow that events were forgotten.
    text += hello(is_resumed_ && !batch.is_gap);
    has_greeted_ = true;
    is_resumed_ = true;
  }
  for (const Message& message : batch.messages) {
    text += "id: " + hub_.name() + "-" + std::to_string(message.number) +
            "\nevent: " + std::string(to_string(message.kind)) + "\ndata: " + *message.data +
            "\n\n";
    sent_ = message.number;
  }
  if (text.empty()) text = ": nothing new\n\n";
  return text;
}

std::string EventStream::hello(bool is_resumed) const {
  return std::string("retry: 1000\nevent: hello\ndata: {\"resumed\": ") +
         (is_resumed ? "true" : "false") + "}\n\n";
}

}  // namespace culprit::http

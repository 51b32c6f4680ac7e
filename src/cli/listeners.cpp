#include "cli/listeners.h"

#include <unistd.h>

#include "terminal/command.h"
#include "terminal/console.h"
#include "web/event_json.h"
#include "web/hub_observer.h"

namespace culprit::cli {
namespace {

class ConsoleListener : public live::Listener {
 public:
  void on_event(const Event& event, const RuleSet& rules, Time start) override {
    const std::string text = line(event, rules, start, colour_of(STDOUT_FILENO));
    if (!text.empty()) say(stdout, "{}\n", text);
  }
  void on_announcement(Duration after, const EventWords& words, const std::string& text) override {
    say(stdout, "{}\n", line(words, after, text, colour_of(STDOUT_FILENO)));
  }
  void on_remark(const std::string& lines) override { say_text(stdout, lines); }
  void on_trouble(const std::string& text) override { fail(text); }
};

class JsonListener : public live::Listener {
 public:
  void on_event(const Event& event, const RuleSet& rules, Time start) override {
    Json json = web::to_json(event, rules, start);
    if (!json["text"].get_ref<const std::string&>().empty()) print(std::move(json));
  }
  void on_announcement(Duration after, const EventWords& words, const std::string& text) override {
    Json json{{"t", seconds(after)}};
    json.update(web::to_json(words));
    json["text"] = text;
    print(std::move(json));
  }
  void on_remark(const std::string& lines) override { say_text(stderr, lines); }
  void on_trouble(const std::string& text) override { fail(text); }

 private:
  static void print(Json json) {
    json["clock"] = web::HubObserver::wall_clock();
    say(stdout, "{}\n", to_line(json));
  }
};

}  // namespace

std::unique_ptr<live::Listener> listener_for(Audience audience) {
  if (audience == Audience::kPrograms) return std::make_unique<JsonListener>();
  return std::make_unique<ConsoleListener>();
}

}  // namespace culprit::cli

#include "cli/governor_options.h"

#include <algorithm>
#include <charconv>

#include "journal/history.h"
#include "journal/json.h"
#include "json/json.h"
#include "language/scanner.h"
#include "terminal/seconds_option.h"

namespace culprit::cli {
namespace {

constexpr double kLongest = 86400;  // seconds

std::string intensity_text(const Intensity& intensity) {
  if (intensity.most == 0) return "none";
  return std::to_string(intensity.most) + "/" + to_string(intensity.period);
}

// "20/1h" of "20 per hour" and "20/h"; empty: no count and unit are in it.
std::string meant_intensity(const std::string& text) {
  const std::string count = text.substr(0, text.find_first_not_of("0123456789"));
  const std::string word = text.substr(std::min(text.find_last_of(" /") + 1, text.size()));
  const std::string unit(duration_unit(word == "m" ? "min" : word));
  if (text == "unlimited" || text == "0") return "none";
  const bool has_number = !word.empty() && word[0] >= '0' && word[0] <= '9';  // "20/2d"
  if (count.empty() || (has_number && word != count)) return "";
  return unit.empty() ? count + "/1min" : count + "/1" + unit;
}

// "20/1min": at most 20 in a minute; "none": no limit.
Expected<Intensity> parse_intensity(const std::string& text) {
  if (text == "none") return Intensity{};
  const std::string meant = meant_intensity(text);
  const Error error{"'" + text + "' is no intensity; write " +
                    (meant.empty() ? "for example 5/1min, or none" : meant)};
  const auto slash = text.find('/');
  if (slash == std::string::npos) return error;
  Intensity intensity;
  const auto [end, bad] = std::from_chars(text.data(), text.data() + slash, intensity.most);
  const auto period = typed_duration(text.substr(slash + 1));
  const bool is_count = bad == std::errc() && end == text.data() + slash;
  if (!is_count || intensity.most < 1 || intensity.most > 1'000'000 || !period ||
      *period <= Duration::zero())
    return error;
  if (*period > journal::kPastCounts)
    return Error{"'" + text + "' counts for longer than " + to_string(journal::kPastCounts) +
                 ", and a restart of culprit forgets what is older"};
  intensity.period = *period;
  return intensity;
}

}  // namespace

GovernorOptions::GovernorOptions() {
  const auto recommended = Governor::Options::recommended();
  quiet_seconds = seconds(recommended.quiet_at_start);
  overall = intensity_text(recommended.limits.overall);
  per_kind = intensity_text(recommended.limits.per_kind);
  per_component = intensity_text(recommended.limits.per_component);
  restarts = intensity_text(recommended.limits.restarts);
  backoff_seconds = seconds(recommended.limits.backoff.first);
  backoff_most_seconds = seconds(recommended.limits.backoff.longest);
  healthy_seconds = seconds(recommended.limits.backoff.healthy);
  storm_percent = static_cast<int>(recommended.storm.share * 100 + 0.5);
}

void GovernorOptions::add_to(CLI::App& command) {
  const std::string kGroup = "The governor (docs/governor.md)";
  command.add_flag("--approve", approve, "Ask a person before each strategy")->group(kGroup);
  const auto time = [&](const char* option, double& value, const char* help) {
    add_seconds(command, option, value, help, 0, kLongest)->group(kGroup);
  };
  const auto intensity = [&](const char* option, std::string& value, const char* help) {
    command.add_option(option, value, help)
        ->check([](const std::string& text) {
          const auto parsed = parse_intensity(text);
          return parsed ? std::string() : parsed.error();
        })
        ->capture_default_str()
        ->group(kGroup);
  };
  time("--quiet", quiet_seconds, "Begin no strategy for this time after the start");
  intensity("--intensity", overall, "Limit of strategies per time, or none");
  intensity("--intensity-kind", per_kind,
            "The same for each kind: reconfigurations, lifecycle changes, process restarts");
  intensity("--intensity-component", per_component, "The same for each component");
  intensity("--restarts", restarts,
            "Limit of restarts of a component per time; beyond, a person must look");
  time("--backoff", backoff_seconds,
       "Back-off between restarts of a component, doubled each time; 0: none");
  time("--backoff-most", backoff_most_seconds, "Upper limit of the back-off");
  time("--healthy", healthy_seconds,
       "Time without a failure that proves a recovery; then culprit learns from it, and resets the "
       "count of attempts");
  command
      .add_option(
          "--storm", storm_percent,
          "Stop acting if this percentage of components fails without a common cause; 0: never")
      ->check(CLI::Range(0, 100))
      ->capture_default_str()
      ->group(kGroup);
  command
      .add_flag("--no-evidence", no_evidence,
                "Allow redeploying a running component when only other topics are silent")
      ->group(kGroup);
  command
      .add_flag("--revive", revive,
                "Restart a launch that ended within 2 s of a crash (on_exit=Shutdown())")
      ->group(kGroup);
}

Expected<Governor::Options> GovernorOptions::options() const {
  Governor::Options out = Governor::Options::recommended();
  out.approval = approve ? Approval::kEach : Approval::kNone;
  out.quiet_at_start = from_seconds(quiet_seconds);
  struct Wanted {
    const char* option;
    const std::string& text;
    Intensity& value;
  };
  for (const Wanted& wanted :
       {Wanted{"--intensity", overall, out.limits.overall},
        Wanted{"--intensity-kind", per_kind, out.limits.per_kind},
        Wanted{"--intensity-component", per_component, out.limits.per_component},
        Wanted{"--restarts", restarts, out.limits.restarts}}) {
    const auto parsed = parse_intensity(wanted.text);
    if (!parsed) return Error{wanted.option + (": " + parsed.error())};
    wanted.value = *parsed;
  }
  out.limits.backoff = {from_seconds(backoff_seconds), from_seconds(backoff_most_seconds),
                        from_seconds(healthy_seconds)};
  out.storm.share = storm_percent / 100.0;
  out.needs_evidence = !no_evidence;
  out.revives_in_doubt = revive;
  return out;
}

Json GovernorOptions::to_json() const {
  return {{"approve", approve},
          {"quiet", quiet_seconds},
          {"intensity", overall},
          {"intensity_kind", per_kind},
          {"intensity_component", per_component},
          {"restarts", restarts},
          {"backoff", backoff_seconds},
          {"backoff_most", backoff_most_seconds},
          {"healthy", healthy_seconds},
          {"storm", storm_percent},
          {"no_evidence", no_evidence},
          {"revive", revive}};
}

GovernorOptions GovernorOptions::from_json(const Json& json) {
  GovernorOptions options;
  const auto intensity = [&json](const char* key, std::string& value) {
    if (const std::string text = journal::text_of(json, key); !text.empty()) value = text;
  };
  const auto time = [&json](const char* key, double& value) {
    value = std::clamp(journal::number_of(json, key, value), 0.0, kLongest);
  };
  options.approve = journal::flag_of(json, "approve");
  options.no_evidence = journal::flag_of(json, "no_evidence");
  options.revive = journal::flag_of(json, "revive");
  time("quiet", options.quiet_seconds);
  intensity("intensity", options.overall);
  intensity("intensity_kind", options.per_kind);
  intensity("intensity_component", options.per_component);
  options.restarts = "none";  // of a run that knew no such bound
  intensity("restarts", options.restarts);
  time("backoff", options.backoff_seconds);
  time("backoff_most", options.backoff_most_seconds);
  time("healthy", options.healthy_seconds);
  options.storm_percent = static_cast<int>(
      std::clamp(journal::number_of(json, "storm", options.storm_percent), 0.0, 100.0));
  return options;
}

}  // namespace culprit::cli

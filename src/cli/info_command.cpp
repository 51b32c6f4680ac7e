#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/core.h>

#include "bag/bag_file.h"
#include "bag/bag_info.h"
#include "base/environment.h"
#include "base/name_grammar.h"
#include "cli/bag_words.h"
#include "cli/commands.h"

namespace culprit::cli {
namespace {

namespace fs = std::filesystem;

constexpr double kNanoseconds = 1e9;  // of a second

struct InfoOptions {
  std::vector<fs::path> bags;
  std::vector<fs::path> message_path;
  bool json = false;
};

double info_seconds(std::int64_t nanoseconds) {
  return std::round(static_cast<double>(nanoseconds) / kNanoseconds * 1000) / 1000;
}

const char* format_name(bag::PartFormat format) {
  return format == bag::PartFormat::kMcap ? "MCAP" : "SQLite3";
}

std::string size_text(std::uint64_t bytes) {
  constexpr double kMega = 1e6;
  return bytes < 1'000'000 ? fmt::format("{:.1f} kB", static_cast<double>(bytes) / 1000)
                           : fmt::format("{:.1f} MB", static_cast<double>(bytes) / kMega);
}

Json info_document(const std::string& path, const bag::BagFile& file, bag::BagInfo& info) {
  Json parts = Json::array();
  for (const bag::BagFile::Part& each : file.parts())
    parts.push_back({{"file", each.path.string()},
                     {"format", format_name(each.format)},
                     {"bytes", each.bytes},
                     {"from_s", info_seconds(each.first - info.first())},
                     {"until_s", info_seconds(each.last - info.first())}});
  Json topics = Json::array();
  for (const bag::TopicInfo& each : info.topics()) {
    Json topic{{"topic", each.name},        {"type", each.type},   {"encoding", each.encoding},
               {"messages", each.messages}, {"bytes", each.bytes}, {"undecoded", each.undecoded}};
    if (each.messages > 0) {
      topic["rate_hz"] = std::round(each.rate() * 1000) / 1000;
      topic["first_s"] = info_seconds(each.first - info.first());
      topic["last_s"] = info_seconds(each.last - info.first());
      topic["longest_gap_s"] = info_seconds(each.longest_gap);
      topic["gap_at_s"] = info_seconds(each.gap_at - info.first());
      topic["gap_clock"] = clock_document(each.gap_clock);
    }
    if (!each.why_undecoded.empty()) topic["why_undecoded"] = each.why_undecoded;
    topics.push_back(std::move(topic));
  }
  Json document{{"bag", path},
                {"messages", info.messages()},
                {"late", file.late()},
                {"parts", std::move(parts)},
                {"topics", std::move(topics)}};
  if (info.messages() > 0) {
    document["start"] = clock_document(info.first_clock());
    document["end"] = clock_document(info.last_clock());
    document["duration_s"] = info_seconds(info.last() - info.first());
  }
  add_bag_troubles(document, file, info.first());
  return document;
}

void print_topics(bag::BagInfo& info) {
  const auto topics = info.topics();
  if (topics.empty()) return;
  std::size_t widest = 5;
  std::size_t widest_type = 4;
  for (const bag::TopicInfo& each : topics) {
    widest = std::max(widest, escape_controls(each.name).size());
    widest_type = std::max(widest_type, escape_controls(each.type).size());
  }
  fmt::print("\n  {:<{}}  {:<{}}  {:>9}  {:>9}  longest gap\n", "topic", widest, "type",
             widest_type, "messages", "rate");
  for (const bag::TopicInfo& each : topics) {
    const std::string gap =
        each.messages == 0
            ? "announced, but no message was recorded"
            : fmt::format("{:.3f} s at {:.3f} s ({})", info_seconds(each.longest_gap),
                          info_seconds(each.gap_at - info.first()), clock_text(each.gap_clock));
    fmt::print("  {:<{}}  {:<{}}  {:>9}  {:>9}  {}\n", escape_controls(each.name), widest,
               escape_controls(each.type), widest_type, each.messages,
               each.rate() > 0 ? fmt::format("{:.2f} Hz", each.rate()) : "-", gap);
  }
  for (const bag::TopicInfo& each : topics) {
    if (each.why_undecoded.empty() || each.messages == 0) continue;
    const std::string count = each.undecoded > 0 ? fmt::format("{} of ", each.undecoded) : "";
    fmt::print("  {} cannot be decoded: {}{} {}: {}\n", escape_controls(each.name), count,
               each.messages, each.messages == 1 ? "message" : "messages",
               escape_controls(each.why_undecoded));
  }
}

void print_info(const std::string& path, const bag::BagFile& file, bag::BagInfo& info) {
  fmt::print("{}\n", path);
  for (const bag::BagFile::Part& each : file.parts())
    fmt::print("  {:<10} {} ({})\n", format_name(each.format),
               escape_controls(each.path.filename().string()), size_text(each.bytes));
  if (info.messages() > 0)
    fmt::print("  start      {}\n  end        {}\n  duration   {:.3f} s\n",
               clock_text(info.first_clock()), clock_text(info.last_clock()),
               info_seconds(info.last() - info.first()));
  fmt::print("  messages   {}{}\n", info.messages(),
             file.late() > 0 ? fmt::format(" ({} written after later ones)", file.late()) : "");
  print_topics(info);
  print_bag_troubles(file, info.first());
}

int inform(const InfoOptions& options) {
  int exit_code = kOk;
  Json documents = Json::array();
  for (const fs::path& path : options.bags) {
    auto file = bag::BagFile::open(path);
    if (!file) {
      exit_code = fail(file.error());
      if (options.json) documents.push_back({{"bag", path.string()}, {"error", file.error()}});
      continue;
    }
    ros2::MessageLibrary library(
        ros2::message_directories(options.message_path, environment("AMENT_PREFIX_PATH")));
    bag::BagInfo info(file->contents(), library);
    for (bag::BagMessage message; file->next(message);) info.add(message);
    if (options.json) {
      documents.push_back(info_document(path.string(), *file, info));
    } else {
      if (&path != &options.bags.front()) fmt::print("\n");
      print_info(path.string(), *file, info);
    }
    if (!file->contents().losses().empty()) exit_code = kFailed;
  }
  if (options.json) fmt::print("{}\n", to_line(documents));
  return exit_code;
}

}  // namespace

void add_info(CLI::App& app, int& exit_code) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App* command = app.add_subcommand(
      "info",
      "Show what recordings hold: format, time, topics with rates and longest gaps, and what is "
      "missing or damaged.");
  command->add_option("BAG", options->bags, "Rosbag2 recordings: folders, .db3 or .mcap files")
      ->type_name("FILE")
      ->required();
  command
      ->add_option("--message-path", options->message_path,
                   "Folders with .msg files: <folder>/<package>/msg/<Type>.msg")
      ->type_name("FOLDER");
  command->add_flag("--json", options->json, "One JSON document: a list with one object per bag");
  command->callback([options, &exit_code] { exit_code = inform(*options); });
}

}  // namespace culprit::cli

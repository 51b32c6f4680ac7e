#include "init/update.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <optional>
#include <regex>
#include <string_view>

#include <fmt/format.h>

#include "base/ros_names.h"
#include "base/units.h"
#include "init/marks.h"
#include "init/packs.h"

namespace culprit::init {
namespace {

// A limit is too near the measurements, or too far from them, where a new one would be this many
// times it.
constexpr double kTooShort = 2;
constexpr double kTooLong = 0.25;

struct Block {
  std::size_t at = 0;
  std::size_t lines = 0;
  std::string text{};
};

std::vector<std::string> lines_in(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size() - 1) + 1;
    lines.push_back(text.substr(at, end - at));
    at = end;
  }
  return lines;
}

std::string first_word(const std::string& line) {
  constexpr const char* kSpaces = " \t\r\n";
  const std::size_t begin = line.find_first_not_of(kSpaces);
  if (begin == std::string::npos) return "";
  return line.substr(begin, line.find_first_of(kSpaces, begin) - begin);
}

bool is_comment(const std::string& word) { return word.starts_with('#') || word.starts_with("//"); }

// A file as it is written.
class Written {
 public:
  explicit Written(const std::string& text) : lines_(lines_in(text)) {
    bool in_template = false;
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      const std::string word = first_word(lines_[i]);
      if (word == "TEMPLATE") in_template = true;
      words_.push_back(in_template ? "" : word);
      if (word == "END") in_template = false;
      if (!word.empty() && !is_comment(word)) end_ = i + 1;
    }
    find_blocks();
  }

  const std::vector<std::string>& lines() const { return lines_; }

  // A COMPONENT line or a paragraph with this print; nothing if there is none.
  std::optional<Block> block(std::uint32_t print) const {
    const auto found = blocks_.find(print);
    return found == blocks_.end() ? std::nullopt : std::optional(found->second);
  }

  // Behind the last statement.
  std::size_t end() const { return end_; }
  // Behind the last line of this word, outside of templates.
  std::optional<std::size_t> behind(std::string_view word) const {
    const auto last = std::find(words_.rbegin(), words_.rend(), word);
    if (last == words_.rend()) return std::nullopt;
    return static_cast<std::size_t>(words_.rend() - last);
  }
  // In front of the first line of one of these words, and the comments above it.
  std::size_t before(std::initializer_list<std::string_view> words) const {
    auto first = std::find_first_of(words_.begin(), words_.end(), words.begin(), words.end());
    if (first == words_.end()) return end_;
    while (first != words_.begin() && is_comment(*(first - 1))) --first;
    return static_cast<std::size_t>(first - words_.begin());
  }
  bool has_line(const std::string& beginning) const {
    return std::ranges::any_of(lines_, [&](const std::string& line) {
      const std::size_t at = line.find_first_not_of(" \t");
      return at != std::string::npos && line.compare(at, beginning.size(), beginning) == 0;
    });
  }

 private:
  void find_blocks() {
    Block paragraph;
    const auto end_paragraph = [&] {
      if (paragraph.lines > 0) blocks_[print_of(paragraph.text)] = paragraph;
      paragraph = {};
    };
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      if (words_[i] == "COMPONENT") blocks_[print_of(lines_[i])] = {i, 1, lines_[i]};
      if (first_word(lines_[i]).empty()) {
        end_paragraph();
        continue;
      }
      if (paragraph.lines++ == 0) paragraph.at = i;
      paragraph.text += lines_[i];
    }
    end_paragraph();
  }

  std::vector<std::string> lines_;
  std::vector<std::string> words_;  // the first of each line; empty in templates
  std::size_t end_ = 0;
  std::map<std::uint32_t, Block> blocks_;
};

// By topic, of a rule that a draft wrote.
std::map<std::string, double> limits_in(const std::string& text) {
  static const std::regex kLimit(R"(age\(([^)\s]+)\)\s*>\s*([0-9.]+[a-z]+))");
  std::map<std::string, double> limits;
  for (std::sregex_iterator found(text.begin(), text.end(), kLimit), end; found != end; ++found) {
    if (const auto limit = parse_duration((*found)[2].str()))
      limits[(*found)[1].str()] = seconds(*limit);
  }
  return limits;
}

bool limits_fit(const std::string& before, const std::string& now) {
  const auto old = limits_in(before);
  return std::ranges::all_of(limits_in(now), [&](const auto& each) {
    const auto known = old.find(each.first);
    return known != old.end() && each.second <= kTooShort * known->second &&
           each.second >= kTooLong * known->second;
  });
}

// The measured range of a key, as its proposal states it.
struct Range {
  double least = 0, most = 0;
};
std::optional<Range> range_in(const std::string& proposal) {
  static const std::regex kRange(R"( was ([-+.0-9e]+)\s+to\s+([-+.0-9e]+),)");
  std::smatch found;
  if (!std::regex_search(proposal, found, kRange)) return std::nullopt;
  const auto number = [&](std::size_t group) {
    return std::strtod(found[group].str().c_str(), nullptr);
  };
  return Range{number(1), number(2)};
}

// The new range must lie within the proposed limits (the old range, widened by its span on both sides), and must not be much smaller than the old one.
bool range_fits(const std::string& before, const std::string& now) {
  const auto old = range_in(before);
  const auto seen = range_in(now);
  if (!old || !seen) return false;
  const double span = old->most - old->least;
  return seen->least >= old->least - span && seen->most <= old->most + span &&
         seen->most - seen->least >= kTooLong * span;
}

// A list in comments as it is compared: of each line what it is about as it stands, and the rest without the
// numbers that are never measured twice the same ("40 commands", "process 4711"). Nor is why a topic has no
// rhythm: whether too few messages come or too irregular ones is chance.
std::string without_measures(const std::string& list, const LiveInventory& robot) {
  static const std::regex kNumber(R"((^|[\s(])[-+]?[0-9][-+.0-9e]*)");
  std::string all;
  for (const std::string& line : lines_in(list)) {
    const std::size_t reason = std::min(line.find(": "), line.size());
    const std::string about = line.substr(0, reason);
    all += about;
    if (!about.starts_with("# ") || !robot.topics.contains(about.substr(2)))
      all += std::regex_replace(line.substr(reason), kNumber, "$1#");
  }
  return all;
}

class Updating {
 public:
  Updating(const std::string& text, const RuleSet& rules, const RobotProfile& seen, Packs packs)
      : written_(text), rules_(rules), seen_(seen), packs_(packs) {
    for (const std::string& line : written_.lines()) {
      const auto marks = marks_in(line);
      marks_.insert(marks_.end(), marks.begin(), marks.end());
    }
    for (const Component& each : rules_.components) {
      const std::string node = each.node.empty() ? seen_.robot.node_of(each) : each.node;
      if (!node.empty()) declared_.emplace(node, &each);
    }
    if (seen_.has_dump) return;
    // Only a dump says it of a node: without one it is as the file has it.
    for (const auto& each : declared_) {
      if (each.second->is_respawned) seen_.dump.respawned.insert(each.first);
    }
  }

  Update made() {
    const std::vector<Part> parts = parts_of_draft(seen_, packs_, names());
    for (const Part& part : parts) consider(part);
    if (std::ranges::find(parts, Part::Kind::kLeftOut, &Part::kind) == parts.end()) end_left_out();
    add_new_ones();
    if (!update_.changes.empty()) mark();
    note_what_is_gone();
    std::ranges::stable_sort(update_.changes, {}, &Update::Change::at);
    return std::move(update_);
  }

 private:
  KnownNames names() const {
    KnownNames known;
    for (const auto& each : declared_) known.components[each.first] = each.second->name;
    for (const Component& each : rules_.components) known.taken.insert(each.name);
    for (const Signal& each : rules_.signals) known.taken.insert(each.name);
    for (const Rule& each : rules_.rules) known.taken.insert(each.name);
    return known;
  }

  void consider(const Part& part) {
    const auto mark = mark_of(part);
    if (!mark) return;
    const auto known = std::ranges::find(marks_, mark->about, &Mark::about);
    if (known == marks_.end()) {
      if (is_known(part)) return note_other_start(part);
      new_parts_.push_back(part);
      marks_.push_back(*mark);
      return;
    }
    const auto block = written_.block(known->text);
    if (!block) {  // somebody changed it, or took it away
      note_other_start(part);
      return note_left_out(part);
    }
    if (fits(part, *block)) return;
    replaced_.push_back({block->at, block->lines, lines_in(part.text)});
    known->text = mark->text;
  }

  // Whether a person wrote it, or a part with the same subject.
  bool is_known(const Part& part) const {
    switch (part.kind) {
      case Part::Kind::kComponent:
      case Part::Kind::kRule:
        return declared_.contains(part.subject);
      case Part::Kind::kUse:
        if (!part.node.empty()) return declared_.contains(part.node);
        return written_.has_line("USE " + part.subject.substr(0, part.subject.find_first_of(",)")));
      case Part::Kind::kComment:
        return part.pack.empty() ||
               written_.has_line("USE " +
                                 part.subject.substr(0, part.subject.find_first_of(" ,()")));
      case Part::Kind::kLevel:
        return is_read(part.subject);
      case Part::Kind::kLimit:
        return is_key_read(part.subject);
      case Part::Kind::kInterlock:
        return !rules_.interlocks.empty();
      case Part::Kind::kValues:
        return is_measured(part.subject);
      case Part::Kind::kLeftOut:
        return false;
      case Part::Kind::kHead:
        break;
    }
    return true;
  }

  // `subject`: the status and the key, as rules write them.
  bool is_key_read(const std::string& subject) const {
    return std::ranges::any_of(rules_.signals, [&](const Signal& each) {
      const auto* key = std::get_if<DiagnosticKey>(&each.source);
      return key != nullptr && as_written(key->status) + " " + as_written(key->key) == subject;
    });
  }

  // Whether a signal reads a field of the topic.
  bool is_measured(const std::string& topic) const {
    return std::ranges::any_of(rules_.signals, [&](const Signal& each) {
      const auto* field = std::get_if<TopicField>(&each.source);
      return field != nullptr && rules_[field->topic].name == topic;
    });
  }

  bool is_read(const std::string& status) const {
    const auto is_it = [&](const std::string& name) { return as_written(name) == status; };
    return std::ranges::any_of(rules_.diagnostics, is_it, &StatusLevel::name) ||
           std::ranges::any_of(rules_.signals, [&](const Signal& each) {
             const auto* key = std::get_if<DiagnosticKey>(&each.source);
             return key != nullptr && is_it(key->status);
           });
  }

  bool fits(const Part& part, const Block& block) const {
    switch (part.kind) {
      case Part::Kind::kComponent:
        return print_of(part.text) == print_of(block.text);
      case Part::Kind::kRule:
        return limits_fit(block.text, part.text);
      case Part::Kind::kLimit:
        return range_fits(block.text, part.text);
      case Part::Kind::kInterlock:
      case Part::Kind::kLeftOut:
        return without_measures(block.text, seen_.robot) ==
               without_measures(part.text, seen_.robot);
      case Part::Kind::kHead:
      case Part::Kind::kUse:
      case Part::Kind::kLevel:
      case Part::Kind::kComment:
      case Part::Kind::kValues:
        break;
    }
    return true;
  }

  // For a list that a person has changed.
  void note_left_out(const Part& part) {
    if (part.kind != Part::Kind::kLeftOut) return;
    for (const std::string& line : lines_in(part.text)) {
      const std::size_t reason = line.find(": ");
      if (reason == std::string::npos || written_.has_line(line.substr(0, reason + 1))) continue;
      update_.notes.push_back("left out, and not in the list of the file: " +
                              line.substr(2, line.find_last_not_of('\n') - 1));
    }
  }

  // Removes the list of omissions.
  void end_left_out() {
    const auto mark = mark_of({.kind = Part::Kind::kLeftOut, .subject = kAll, .text = ""});
    const auto known = std::ranges::find(marks_, mark->about, &Mark::about);
    if (known == marks_.end()) return;
    const auto block = written_.block(known->text);
    if (!block) return;
    const bool is_followed_by_a_blank_line =
        block->at + block->lines < written_.lines().size() &&
        first_word(written_.lines()[block->at + block->lines]).empty();
    replaced_.push_back({block->at, block->lines + (is_followed_by_a_blank_line ? 1 : 0), {}});
    marks_.erase(known);
  }

  void note_other_start(const Part& part) {
    const auto declared = declared_.find(part.subject);
    const auto start = seen_.starts.find(part.subject);
    if (part.kind != Part::Kind::kComponent || declared == declared_.end() ||
        start == seen_.starts.end())
      return;
    const Component& component = *declared->second;
    const auto& command = start->second.command;
    if (component.launch.empty() || !component.launch[0].starts_with('/')) return;
    const bool is_same =
        command.size() >= component.launch.size() &&
        std::equal(component.launch.rbegin(), component.launch.rend(), command.rbegin());
    if (!is_same)
      update_.notes.push_back(
          fmt::format("{} runs as `{}`, and not as its LAUNCH says, which stays", component.name,
                      fmt::join(command, " ")));
  }

  void note_what_is_gone() {
    for (const Component& each : rules_.components) {
      const std::string node = each.node.empty() ? seen_.robot.node_of(each) : each.node;
      if (!seen_.robot.nodes.contains(node))
        update_.notes.push_back(
            fmt::format("{} is not there now; its lines in the file stay", each.name));
    }
  }

  void add_new_ones() {
    std::vector<std::string> includes;
    std::vector<std::string> components;
    std::vector<std::string> paragraphs;
    for (const Part& part : new_parts_) {
      if (part.kind == Part::Kind::kComponent) {
        components.push_back(part.text);
        continue;
      }
      if (const std::string include = include_of(part.pack);
          !part.pack.empty() && !written_.has_line(include))
        includes.push_back(include + "\n");
      paragraphs.push_back("\n");
      for (std::string& line : lines_in(part.text)) paragraphs.push_back(std::move(line));
    }
    std::ranges::sort(includes);
    includes.erase(std::unique(includes.begin(), includes.end()), includes.end());
    const std::size_t declarations = written_.before({"COMPONENT", "USE", "TEMPLATE", "RULE"});
    if (const auto behind = written_.behind("INCLUDE")) {
      insert(*behind, std::move(includes));
    } else if (!includes.empty()) {
      includes.push_back("\n");
      insert(declarations, std::move(includes));
    }
    if (const auto behind = written_.behind("COMPONENT")) {
      insert(*behind, std::move(components));
    } else if (!components.empty()) {
      components.push_back("\n");
      insert(declarations, std::move(components));
    }
    insert(written_.end(), std::move(paragraphs));
    update_.changes.insert(update_.changes.end(), replaced_.begin(), replaced_.end());
  }

  void insert(std::size_t at, std::vector<std::string> lines) {
    if (!lines.empty()) update_.changes.push_back({at, 0, std::move(lines)});
  }

  // Where the marks were, else at the end.
  void mark() {
    std::vector<std::string> marks = lines_in(text_of(marks_));
    for (std::size_t i = 0; i < written_.lines().size(); ++i) {
      if (is_of_marks(written_.lines()[i]))
        update_.changes.push_back({i, 1, std::exchange(marks, {})});
    }
    if (marks.empty()) return;
    marks.insert(marks.begin(), "\n");
    insert(written_.lines().size(), std::move(marks));
  }

  const Written written_;
  const RuleSet& rules_;
  RobotProfile seen_;
  const Packs packs_;
  std::vector<Mark> marks_;
  std::map<std::string, const Component*> declared_;  // by node
  std::vector<Part> new_parts_;
  std::vector<Update::Change> replaced_;
  Update update_;
};

}  // namespace

Update update(const std::string& text, const RuleSet& rules, const RobotProfile& seen,
              Packs packs) {
  return Updating(text, rules, seen, packs).made();
}

}  // namespace culprit::init

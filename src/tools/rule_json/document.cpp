#include "rule_json/document.h"

#include <algorithm>
#include <set>
#include <vector>

#include "language/source.h"

namespace culprit::rule_json {
namespace {

constexpr std::size_t kMaxMembers = 64;
constexpr int kDeepest = 100;

// Reads a text and keeps only its mistakes.
class Inspector : public nlohmann::json_sax<Json> {
 public:
  const std::string& complaint() const { return complaint_; }
  // The offset of the first byte that is no JSON; 0 if all is.
  std::size_t offset() const { return offset_; }

  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool start_array(std::size_t) override { return goes_deeper(); }
  bool end_array() override {
    --depth_;
    return true;
  }

  bool start_object(std::size_t) override {
    open_.emplace_back();
    return goes_deeper();
  }
  bool end_object() override {
    open_.pop_back();
    --depth_;
    return true;
  }
  bool key(string_t& name) override {
    if (!open_.back().insert(name).second)
      complaint_ =
          "an object has two members \"" + name + "\"; only one can count, remove the other";
    if (open_.back().size() > kMaxMembers)
      complaint_ = "an object has more than 64 members; no statement has as many";
    return complaint_.empty();
  }

  bool parse_error(std::size_t position, const std::string&, const Json::exception&) override {
    complaint_ = "this is no JSON: a value, a comma or a bracket is missing here";
    offset_ = position;
    return false;
  }

 private:
  bool goes_deeper() {
    if (++depth_ > kDeepest)
      complaint_ = "this is no JSON of rules: it is nested deeper than any statement";
    return complaint_.empty();
  }

  int depth_ = 0;
  std::vector<std::set<std::string>> open_;  // names of the members so far, of each open object
  std::string complaint_;
  std::size_t offset_ = 0;
};

// Where the byte in front of `offset` is, as editors count; nothing for 0.
std::string place(const std::string& name, const std::string& text, std::size_t offset) {
  if (offset == 0) return name;
  const auto last = static_cast<std::uint32_t>(std::min(offset - 1, text.size()));
  const Position at = Source(name, text).position(last);
  return name + ":" + std::to_string(at.line) + ":" + std::to_string(at.column);
}

}  // namespace

Expected<Json> parse_document(const std::string& name, const std::string& text) {
  if (text.size() > Source::kMaxSize) return Error{name + ": this is larger than 64 MiB\n"};
  Inspector inspector;
  Json::sax_parse(text, &inspector);
  if (!inspector.complaint().empty()) {
    return Error{place(name, text, inspector.offset()) + ": " + inspector.complaint() + "\n"};
  }
  return parse_json(text);
}

}  // namespace culprit::rule_json

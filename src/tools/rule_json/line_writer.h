// One statement of the JSON form -> its line of a rule file.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "rule_json/forms.h"
#include "rule_json/spelling.h"

namespace culprit::rule_json {

// The member `name` of what is at `at`, as a JSON pointer (RFC 6901).
std::string pointer(const std::string& at, std::string_view name);

// "did you mean ...?", or the list of all of them.
std::string nearest(std::string_view word, const std::vector<std::string_view>& known);

// A comment of the language, on one line.
bool is_comment(const Json& value);

class LineWriter {
 public:
  // `member` is empty where the statement as a whole is meant.
  using Complain = std::function<void(const std::string& member, const std::string& cause,
                                      const std::string& remedy)>;

  // `statement` is an object, and outlives the writer.
  LineWriter(const Json& statement, Complain complain)
      : statement_(statement), complain_(std::move(complain)) {}

  // Must not be used after a complaint.
  std::string write();

 private:
  const Form* choose_form() const;
  bool has_type_of(const Form& form) const;
  std::string step_word(const Form& form) const;
  void complain_of_kind() const;
  void refuse_other_members(const Form& form) const;
  void add(const Clause& clause);

  const Json& statement_;
  const Complain complain_;
  std::string line_;
};

}  // namespace culprit::rule_json

// A program on another computer, that is talked to over ssh: what it reads and what it prints are the
// two directions of one socket here.
//
// ssh asks nobody anything (BatchMode): what needs a password, or whose key is not known yet, is an
// error. The command is made of plain words that stand in this program, never of what a rule file or
// the network says, so the shell over there has nothing to misread (one reads a variable of that user's own). Whom to connect to, and how, is
// what `ssh computer` takes it from (~/.ssh/config). ssh ends with this object, and with culprit: the
// program over there reads the end of its input then.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/expected.h"
#include "base/time.h"
#include "owners/file_descriptor.h"

namespace culprit::owners {

class RemoteProgram {
 public:
  // What it takes at most until the other computer has let us in, or has not.
  static constexpr Duration kPatience = std::chrono::seconds(4);

  // `host` is as ssh is told it: "robot@rover2". Does not wait. Errors: there is no ssh, or the system
  // gives no process.
  static Expected<RemoteProgram> begin(const std::string& host, std::vector<std::string> words);
  RemoteProgram(RemoteProgram&& other) noexcept;
  RemoteProgram& operator=(RemoteProgram&& other) noexcept;
  ~RemoteProgram();

  // Where it is talked to, without waiting.
  int socket() const { return socket_.get(); }

  // Says no more, and gives whether ssh was let in, and what it ran there has ended by then.
  bool was_let_in(Time until);

  // Why it does not answer, and what to do: what ssh said, that it ended, or that it hangs. For when
  // it did not answer.
  std::string trouble();

 private:
  RemoteProgram(std::string host, std::string program, int pid, FileDescriptor socket,
                FileDescriptor errors)
      : host_(std::move(host)),
        program_(std::move(program)),
        pid_(pid),
        socket_(std::move(socket)),
        errors_(std::move(errors)) {}

  // Its status, once it has ended.
  std::optional<int> status(Time until);
  void end();
  std::string without_its_name(std::string said) const;

  std::string host_;
  std::string program_;
  int pid_ = 0;  // 0: it was reaped
  std::optional<int> status_{};
  FileDescriptor socket_;
  FileDescriptor errors_;
};

// Whether culprit's user is let in there without being asked. Errors say what is wrong and what to do.
// Waits for it, RemoteProgram::kPatience and a second at most.
Expected<void> could_reach(const std::string& host);

}  // namespace culprit::owners

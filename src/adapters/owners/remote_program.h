// A program on another computer, that is talked to over ssh: its input and its output are the two
// directions of one socket here.
//
// ssh never asks for input (BatchMode): a computer that needs a password, or whose key is not known
// yet, is an error. The command consists of plain words from this program, never of text from a
// rule file or the network. So the shell over there has nothing to misread (one word reads a
// variable of that user's own). ssh takes the address and the way to connect from `ssh computer`'s
// configuration (~/.ssh/config). ssh ends with this object, and with culprit: the program over
// there then reads the end of its input.
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
  // Time limit for the other computer to let us in or to refuse.
  static constexpr Duration kPatience = std::chrono::seconds(4);

  // `host` is as ssh takes it: "robot@rover2". Does not wait. Errors: there is no ssh, or the
  // system gives no process.
  static Expected<RemoteProgram> begin(const std::string& host, std::vector<std::string> words);
  RemoteProgram(RemoteProgram&& other) noexcept;
  RemoteProgram& operator=(RemoteProgram&& other) noexcept;
  ~RemoteProgram();

  // Where it is talked to, without waiting.
  int socket() const { return socket_.get(); }

  // Ends the input, and gives whether ssh was let in, and the program there has ended by then.
  bool was_let_in(Time until);

  // Why it does not answer, and what to do: ssh's message, that it ended, or that it hangs. For
  // when it did not answer.
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

// Whether culprit's user is let in there without being asked. Errors give the fault and the remedy.
// Waits for it, RemoteProgram::kPatience and a second at most.
Expected<void> could_reach(const std::string& host);

}  // namespace culprit::owners

// A stand-in for ssh and for the computer that it connects to, for tests: the commands run here, as
// a shell of that computer would run them, unless it is set to refuse, to hang, or to be cut.
#pragma once

#include <string>
#include <vector>

#include "base/test_folder.h"

namespace culprit::owners {

class TestSsh {
 public:
  // A program that looks for ssh meanwhile finds this one. The other computer has two programs: its
  // own `systemd-stdio-bridge`, on this process's system bus (or another one that is set), and
  // `docker`, at this process's engine.
  TestSsh();
  ~TestSsh();

  // It lets us in, from now on.
  void allow() { tell("allow"); }
  // It ends with ssh's own failure, and these words.
  void refuse(const std::string& words) { tell("refuse\n" + words); }
  void hang() { tell("hang"); }
  // It hangs, and writes errors without an end.
  void babble() { tell("babble"); }
  // Lets us in, and has no programs.
  void be_bare() { tell("bare"); }
  // Ends the program that runs: the cable is cut. From now on connections are refused.
  void cut();

  // How it was called, one line each.
  std::vector<std::string> asked() const;

 private:
  void tell(const std::string& how);

  test::TestFolder folder_;
  std::string path_before_;
};

}  // namespace culprit::owners

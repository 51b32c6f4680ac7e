// A stand-in for ssh and for the computer that it connects to, for tests: the commands run here, as a
// shell of that computer would run them, unless it is told to refuse, to hang, or to be cut.
#pragma once

#include <string>
#include <vector>

#include "base/test_folder.h"

namespace culprit::owners {

class TestSsh {
 public:
  // Whoever looks for ssh meanwhile finds this one. The programs of the other computer are its own
  // `systemd-stdio-bridge`, on the bus that is this process's system bus (or the one that it is told),
  // and `docker`, at the engine that is this process's.
  TestSsh();
  ~TestSsh();

  // It lets us in, from now on.
  void allow() { tell("allow"); }
  // It ends with ssh's own failure, and these words.
  void refuse(const std::string& words) { tell("refuse\n" + words); }
  void hang() { tell("hang"); }
  // Lets us in, and has no programs.
  void be_bare() { tell("bare"); }
  // What runs is ended: the cable is cut. From now on it is refused.
  void cut();

  // How it was called, one line each.
  std::vector<std::string> asked() const;

 private:
  void tell(const std::string& how);

  test::TestFolder folder_;
  std::string path_before_;
};

}  // namespace culprit::owners

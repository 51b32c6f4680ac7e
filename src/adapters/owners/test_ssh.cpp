#include "owners/test_ssh.h"

#include <csignal>
#include <cstdlib>
#include <fstream>

namespace culprit::owners {
namespace {

// As ssh(1): options up to "--", the computer, and the words of the command, which go to its shell.
constexpr const char* kSsh = R"(#!/bin/sh
here=$(dirname "$0")
echo "$*" >> "$here/asked"
while [ "$1" != -- ]; do shift; done
shift 2
read -r how < "$here/how"
case $how in
  refuse) sed 1d "$here/how" >&2; exit 255 ;;
  hang) exec sleep 1000 ;;
  babble) exec yes >&2 ;;
  bare) PATH=$here/nothing ;;
  *) PATH=$here/there:$PATH ;;
esac
export PATH
echo $$ >> "$here/running"
exec /bin/sh -c "exec $*"
)";

constexpr const char* kBridge = R"(#!/bin/sh
exec /usr/bin/systemd-stdio-bridge "${1:--p$DBUS_SYSTEM_BUS_ADDRESS}"
)";

// `docker system dial-stdio`: the socket of its engine.
constexpr const char* kDocker = R"(#!/usr/bin/perl
use strict;
use IO::Select;
use IO::Socket::UNIX;
die "unknown command\n" if "@ARGV" ne "system dial-stdio";
my $path = $ENV{DOCKER_HOST} =~ s/^unix:\/\///r;
my $engine = IO::Socket::UNIX->new(Peer => $path) or die "cannot connect to $path\n";
my $ready = IO::Select->new($engine, \*STDIN);
while (1) {
  for my $from ($ready->can_read) {
    my $size = sysread($from, my $part, 65536);
    exit if !$size;
    syswrite($from == $engine ? \*STDOUT : $engine, $part);
  }
}
)";

void write_program(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path) << text;
  std::filesystem::permissions(path, std::filesystem::perms::owner_all);
}

}  // namespace

TestSsh::TestSsh() : path_before_(std::getenv("PATH")) {
  std::filesystem::create_directory(folder_ / "there");
  std::filesystem::create_directory(folder_ / "nothing");
  write_program(folder_ / "ssh", kSsh);
  write_program(folder_ / "there/systemd-stdio-bridge", kBridge);
  write_program(folder_ / "there/docker", kDocker);
  allow();
  setenv("PATH", (folder_.path().string() + ":" + path_before_).c_str(), 1);
}

TestSsh::~TestSsh() { setenv("PATH", path_before_.c_str(), 1); }

// The reader always finds a complete file.
void TestSsh::tell(const std::string& how) {
  std::ofstream(folder_ / "new") << how << "\n";
  std::filesystem::rename(folder_ / "new", folder_ / "how");
}

void TestSsh::cut() {
  refuse("ssh: connect to host rover2 port 22: No route to host");
  std::ifstream running(folder_ / "running");
  for (int pid = 0; running >> pid;) kill(pid, SIGKILL);
}

std::vector<std::string> TestSsh::asked() const {
  std::ifstream file(folder_ / "asked");
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

}  // namespace culprit::owners

#!/bin/sh
# in_own_machine.sh <command...>: runs it as if on a machine of its own: its processes, its network (a loopback that
# carries multicast) and its shared memory are nobody else's, and no process outlives it. So live tests may run side by
# side. Needs the right to make namespaces.
exec unshare --net --pid --fork --kill-child --mount-proc sh -euc '
  mount -t tmpfs shared_memory /dev/shm
  ip link set lo up multicast on
  ip route add 224.0.0.0/4 dev lo
  "$@"' in_own_machine.sh "$@"

#!/bin/sh
# Tries what a service has no business to do; prints each thing that it may.
refused=yes
# may_not WHAT COMMAND...
may_not() {
  what=$1
  shift
  if "$@" > /dev/null 2>&1; then
    echo "it may $what"
    refused=no
  fi
}
may_not "read root's files" cat /etc/shadow
may_not "read users' homes" ls /home/ada
may_not "write to /etc" touch /etc/cargobay.touched
may_not "write to /usr" touch /usr/touched
may_not "write to /var/lib of others" touch /var/lib/touched
may_not "open the disk" head -c 1 /dev/vda
may_not "open a device that is for everybody" sh -c ': < /dev/net/tun'
may_not "write to the kernel's log" sh -c 'echo x > /dev/kmsg'
may_not "read the memory of the machine" head -c 1 /dev/mem
may_not "see other processes" test -e /proc/1/status
may_not "change the kernel's settings" sh -c 'echo 1 > /proc/sys/kernel/sysrq'
may_not "load a module" modprobe dummy
may_not "become root" runuser -u root true
may_not "become root by su" su -c true
may_not "mount" mount -t tmpfs none /mnt
may_not "make a namespace" unshare --user true
may_not "set the clock" date -s now
may_not "tell systemd what to do" systemctl set-environment CARGOBAY_TRIED=1
may_not "signal others" kill -0 1
# Refused by a port where nobody listens, the network was reached.
may_not "reach other machines" python3 -c '
import socket
try:
    socket.create_connection(("10.0.2.2", 9), 3)
except ConnectionRefusedError:
    pass'
may_not "use raw sockets" python3 -c 'import socket; socket.socket(socket.AF_PACKET, socket.SOCK_RAW)'
may_not "make a file set-uid" sh -c 'touch x && chmod 4755 x'
may_not "run code that it wrote" python3 -c 'import mmap; mmap.mmap(-1, 4096, prot=mmap.PROT_READ | mmap.PROT_WRITE | mmap.PROT_EXEC)'
# What it needs, it may.
python3 -c 'import os; os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(90))' || echo "no SCHED_FIFO 90"
touch mine || echo "no state directory"
rm -f mine x /etc/cargobay.touched /usr/touched /var/lib/touched 2> /dev/null || true
[ "$refused" = no ] || echo "all of it is refused"

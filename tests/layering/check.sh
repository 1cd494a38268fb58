#!/usr/bin/env bash
# Checks every #include of the four layers against the arrows in rooms.txt.
# usage: check.sh [ROOT]; prints FILE:LINE: reason for each violation, exit 1 if there is any.
# An arrow that no file uses is a violation too: the table must describe what exists.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=${1:-$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)}
cd "$root"

for layer in oi rt gpio hal; do
  [[ -d $layer ]] || { echo "check.sh: $root has no folder $layer" >&2; exit 2; }
done

mapfile -t files < <(find oi rt gpio hal -type f \
  \( -name '*.hpp' -o -name '*.cpp' -o -name '*.h' -o -name '*.c' -o -name '*.inc' \) | sort)
((${#files[@]})) || { echo "check.sh: no sources under $root" >&2; exit 2; }

awk '
function has(list, word) { return index(" " list " ", " " word " ") > 0 }
function bad(reason) { printf "%s:%d: %s\n", FILENAME, FNR, reason; found = 1 }

BEGIN {
  # What oi may use: no I/O, no clock, no heap, no exceptions.
  pure = "algorithm array bit bitset cassert cctype charconv chrono climits cmath compare concepts" \
         " cstddef cstdint cstring initializer_list iterator limits numbers numeric optional ranges" \
         " ratio span string_view system_error tuple type_traits utility variant version"
  standard = pure " any atomic barrier cerrno cfenv cfloat cinttypes clocale complex" \
         " condition_variable coroutine csetjmp csignal cstdarg cstdio cstdlib ctime cuchar cwchar" \
         " cwctype deque exception execution filesystem forward_list fstream functional future" \
         " iomanip ios iosfwd iostream istream latch list locale map memory memory_resource mutex" \
         " new ostream queue random regex scoped_allocator semaphore set shared_mutex" \
         " source_location sstream stack stdexcept stop_token streambuf string strstream" \
         " syncstream thread typeindex typeinfo unordered_map unordered_set valarray vector"
  # C, POSIX, the kernel and the compiler, by name or by folder.
  posix = "assert.h ctype.h cxxabi.h dirent.h dlfcn.h errno.h fcntl.h float.h getopt.h grp.h ifaddrs.h inttypes.h" \
         " langinfo.h limits.h link.h locale.h malloc.h math.h mqueue.h netdb.h poll.h pthread.h pty.h pwd.h sched.h" \
         " semaphore.h setjmp.h signal.h spawn.h stdarg.h stdbool.h stddef.h stdint.h stdio.h stdlib.h" \
         " string.h strings.h syslog.h termios.h time.h unistd.h utmp.h wchar.h"
}

# ROOM: the rooms that its files may include
FILENAME == rooms {
  if ($0 ~ /^#/ || NF == 0) next
  from = $1; sub(/:$/, "", from)
  for (i = 2; i <= NF; ++i) {
    if (!($i in known)) bad(from " is below " $i " and must not include it")
    arrow[from, $i]; line_of[from, $i] = FNR
  }
  known[from]
  next
}

FNR == 1 {
  layer = FILENAME; sub(/\/.*/, "", layer)
  room = FILENAME; sub(/\/[^\/]*$/, "", room)        # oi, oi/text, hal/sim/line, ...
  header = FILENAME !~ /\.(cpp|c)$/
  if (!(room in known)) bad(room " is not in " rooms)
}

/^[ \t]*#[ \t]*(include|import|include_next)/ {
  line = $0
  sub(/^[ \t]*#[ \t]*[a-z_]+[ \t]*/, "", line)
  if (line ~ /^"/) {
    sub(/^"/, "", line); sub(/".*/, "", line)
    # Installed side by side.
    if (FILENAME != "hal/c/cargobay.hpp" || line != "cargobay.h") ours(line)
  } else if (line ~ /^</) {
    sub(/^</, "", line); sub(/>.*/, "", line); theirs(line)
  } else {
    bad("computed include: name the file")
  }
}

# Files that users name are read and written in just two places, each with its one rule.
/(^|[^a-z_])fopen *\(|O_CREAT|ofstream/ && !/^[ \t]*\/\// && FILENAME !~ /^hal\/(file\/output_file|port\/low_latency)\.cpp$/ {
  bad("files are written by hal/file/output_file.hpp")
}
/<fstream>/ && room ~ /^hal\/(c|cli|sim)(\/|$)/ { bad("files are read by hal/file/read_input.hpp") }

function ours(path,   to) {
  to = path
  if (path ~ /(^|\/)\.\.?\// || !sub(/\/[^\/]*$/, "", to) || to !~ /^(oi|rt|gpio|hal)(\/|$)/) {
    bad("\"" path "\" is not a path from the repository root into a layer"); return
  }
  if (to != room && !((room, to) in arrow)) { bad(room " must not include " to " (" path ")"); return }
  used[room, to]
  if ((getline ignored < path) < 0) bad("no such file: " path)
  close(path)
}

function theirs(path) {
  if (path ~ /^(oi|rt|gpio|hal)\//) { bad("ours goes in quotes: " path); return }
  if (layer == "oi") {
    if (!has(pure, path)) bad("oi does no I/O, has no clock and no heap: <" path ">")
    return
  }
  if (has(standard, path) || has(posix, path) || path ~ /^(sys|linux|asm|net|netinet|arpa|sanitizer)\/[a-z_0-9-]+\.h$/) return
  if (path ~ /^Eigen\//) {
    if (layer != "rt") bad("Eigen belongs to rt: <" path ">")
    return
  }
  if (path ~ /^(CLI|toml\+\+|nlohmann|fmt)\//) {
    if (room == "hal/export" ? path !~ /^nlohmann/ : room !~ /^hal\/(cli|web)/ && room !~ /^hal\/(config|feed|feed\/message|learnt)$/) bad("only hal/cli, hal/config, hal/export, hal/feed, hal/learnt and hal/web may include <" path ">")
    else if (header) bad("third-party header in a header: <" path ">")
    return
  }
  if (path ~ /^(libwebsockets|qrencode|openssl\/ssl)\.h$/ && room ~ /^hal\/web/ && !header) return
  if (path == "curses.h" && room == "hal/cli/view" || path == "libevdev/libevdev.h" && room == "hal/gamepad" || path == "gpiod.h" && layer == "gpio" || path == "libserialport.h" && layer == "hal") {
    if (header) bad("third-party header in a header: <" path ">")
    return
  }
  bad(layer " does not know <" path ">")
}

END {
  for (pair in arrow) {
    split(pair, ends, SUBSEP)
    if (pair in used) continue
    printf "%s:%d: nothing in %s includes %s\n", rooms, line_of[pair], ends[1], ends[2]
    found = 1
  }
  exit found
}
' rooms="$here/rooms.txt" "$here/rooms.txt" "${files[@]}"

#!/usr/bin/env bash
# Makes the man pages of the command and of each of its subcommands from their --help, by help2man.
# cargobay.toml.5 is written by hand.
# usage: docs/man/make.sh [--check] [COMMAND]
#   --check  changes nothing; exit 1 where a page is not what would be made, 77 without help2man
#   COMMAND  the program to ask; by itself build/release/cargobay
# NAME.inc beside the pages is what help2man adds to NAME.1; common.inc goes to each subcommand.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
check=0 program=$here/../../build/release/cargobay
for argument in "$@"; do
  case $argument in
    --check) check=1 ;;
    -*)
      sed -n '2,7s/^# \{0,1\}//p' "$0" >&2
      exit 2
      ;;
    *) program=$argument ;;
  esac
done
[[ -x $program ]] || { echo "make.sh: there is no $program: build it first" >&2; exit 2; }
if ! command -v help2man > /dev/null; then
  echo "make.sh: help2man is missing: apt-get install help2man" >&2
  ((check)) && exit 77
  exit 2
fi

made=$(mktemp -d)
trap 'rm -rf "$made"' EXIT

# The help as help2man reads it best: usage first, and nothing that is for the terminal alone.
# shellcheck disable=SC2016
cat > "$made/rearranged" << 'END'
#!/usr/bin/env bash
set -euo pipefail
if [[ $1 == --version ]]; then exec "$CARGOBAY_ASKED" --version; fi
"$CARGOBAY_ASKED" $CARGOBAY_SUBCOMMAND --help | awk -v name="cargobay $CARGOBAY_SUBCOMMAND" '
  # CLI11 2.5 has its headings in capitals.
  function heading(text) { return toupper(substr(text, 1, 1)) tolower(substr(text, 2)) }
  # "drive   Close the loop.": of each subcommand its first sentence.
  function close_subcommand() {
    if (subcommand == "") return
    match(subcommand, /[.:]( |$)/)
    rest = rest (RSTART ? substr(subcommand, 1, RSTART - 1) "." : subcommand) "\n"
    subcommand = ""
  }
  /^`cargobay COMMAND --help`/ { next }
  # A usage line within the description is the better one: it names the arguments.
  !done && index($0, name " [") == 1 { usage = $0; next }
  !done && /^[Uu][Ss][Aa][Gg][Ee]: / {
    if (usage == "") { usage = $0; sub(/^[^:]*: */, "", usage) }
    done = 1
    next
  }
  # What is said of an argument goes on until there is another.
  !done && /^  \[?[A-Z]+\.*\]?: / {
    sub(/: +/, "  ")
    argument = 1
  }
  !done && argument && !/^  / { description = substr(description, 1, length(description) - 1) " " }
  !done { description = description $0 "\n"; next }
  /^(OPTIONS|SUBCOMMANDS|POSITIONALS):$/ { $0 = heading($0) }
  /^[^ ]/ || /^$/ { close_subcommand(); listing = /^Subcommands:/ }
  listing && /^  [a-z]/ { close_subcommand(); subcommand = $0; next }
  listing && subcommand != "" { sub(/^ +/, " "); subcommand = subcommand $0; next }
  # Options, on one line with what they do, the same from each version of CLI11: what an option
  # takes is named once, and its default is in brackets.
  /^  -/ {
    head = $0
    tail = ""
    if (match($0, /[^ ]  +[^ ]/)) {
      head = substr($0, 1, RSTART)
      tail = substr($0, RSTART + RLENGTH - 1)
    }
    sub(/ +$/, "", head)
    sub(/,--/, ", --", head)
    if (head ~ /^  --[a-z-]+\{/) { sub(/\{/, "[=", head); sub(/\}/, "]", head) }
    if (match(head, /(TEXT|FLOAT|INT|\]|\})=[^ =]+$/)) {
      value = head
      sub(/.*=/, "", value)
      sub(/=[^=]*$/, " [" value "]", head)
    }
    sub(/ (TEXT|FLOAT|UINT|INT):/, " ", head)
    if (tail == "" && (getline tail) > 0) sub(/^ +/, "", tail)
    $0 = head "  " tail
  }
  { rest = rest $0 "\n" }
  END { close_subcommand(); printf "Usage: %s\n\n%s%s", usage, description, rest }
'
END
chmod 755 "$made/rearranged"

# page NAME SUBCOMMAND...: makes NAME.1.
page() {
  local name=$1 includes=()
  shift
  [[ ! -f $here/$name.inc ]] || includes+=(--include "$here/$name.inc")
  (($# == 0)) || includes+=(--include "$here/common.inc")
  # One line, and without the command's own name.
  local purpose
  purpose=$(CARGOBAY_ASKED=$program CARGOBAY_SUBCOMMAND="$*" "$made/rearranged" --help |
    sed -n '3,$p' | tr '\n' ' ' | sed -E 's/[.:;].*//; s/^(.)/\L\1/')
  [[ $name != cargobay ]] || purpose='real-time control of the iRobot Create, and a virtual Create'
  CARGOBAY_ASKED=$program CARGOBAY_SUBCOMMAND="$*" SOURCE_DATE_EPOCH=0 \
    help2man --no-info --name "$purpose" --source cargobay --manual "Cargobay" --section 1 \
    --version-string "$("$program" --version)" "${includes[@]}" "$made/rearranged" > "$made/page"
  # The same each day, and with each version of help2man; examples keep their lines.
  sed -E -e 's/^(\.TH ).*/\1'"${name^^}"' 1 "" "cargobay" "Cargobay"/' \
    -e '/^\.\\" DO NOT MODIFY/c .\\" Made by docs/man/make.sh from the help of the command.' \
    -e "s/rearranged/$name/g" -e 's/^cargobay \\- /'"$name"' \\- /' "$made/page" |
    awk '
      /^\.SH/ { if (kept) print ".RE\n.fi"; kept = 0; examples = /^\.SH "?EXAMPLES/ }
      examples && /^\.IP$/ { print kept ? ".PP" : ".PP\n.nf\n.RS"; kept = 1; next }
      { print }
    ' > "$made/$name.1"
}

# Names under "Subcommands:" in the help of the command.
subcommands() {
  "$program" "$@" --help |
    sed -nE '/^(Subcommands|SUBCOMMANDS):/,/^$/s/^  ([a-z][a-z-]*)  .*/\1/p'
}

page cargobay
for subcommand in $(subcommands); do
  page "cargobay-$subcommand" "$subcommand"
  for further in $(subcommands "$subcommand"); do
    page "cargobay-$subcommand-$further" "$subcommand" "$further"
  done
done
# A program of its own, beside the command; it may not have been built.
if [[ -x ${program%/*}/cargobay-web ]]; then
  program=${program%/*}/cargobay-web page cargobay-web
elif [[ -f $here/cargobay-web.1 ]]; then
  cp "$here/cargobay-web.1" "$made"
fi
rm -f "$made/page"

status=0
for file in "$made"/*.1; do
  name=${file##*/}
  if cmp -s "$file" "$here/$name"; then continue; fi
  if ((check)); then
    echo "docs/man/$name is not what the command says; run docs/man/make.sh"
    diff -u "$here/$name" "$file" | head -n 20 || true
    status=1
  else
    cp "$file" "$here/$name"
    echo "$name"
  fi
done
# Of a subcommand that is gone.
for file in "$here"/*.1; do
  [[ -e $file && ! -e $made/${file##*/} ]] || continue
  if ((check)); then
    echo "docs/man/${file##*/}: no such command"
    status=1
  else
    rm "$file"
  fi
done
exit "$status"

#!/usr/bin/env bash
# Writes C: a call of every function that the header declares, with harmless arguments, and what its
# comment says. The tests in tests/capi/derived ask the comment what to expect, so a new function is
# tested without an entry in any list.
# usage: tests/capi/every_function.sh HEADER > every_function.h
set -euo pipefail
header=${1:?usage: tests/capi/every_function.sh HEADER}

awk '
function trim(text) { gsub(/^[ \t]+|[ \t]+$/, "", text); return text }

# The argument for a parameter: of its type or, if that is not harmless enough, of its name.
function argument(parameter, first,    name, type) {
  parameter = trim(parameter)
  match(parameter, /[a-z0-9_]+$/)
  name = substr(parameter, RSTART)
  type = trim(substr(parameter, 1, RSTART - 1))
  if (first && type ~ /^struct cargobay_(robot|sim|histogram)\*$/) return "(" type ")handle"
  if (name == "packet") return "CARGOBAY_PACKET_WALL_SIGNAL"
  if (name == "packets") return "given_packets"
  if (name == "bytes") return "given_bytes"
  if (name == "rtttl") return "\"t:d=4:c\""
  if (name == "line") return "\"state\""
  if (name == "path" && type == "const char*") return "\"/dev/null/none\""
  if (type == "const char*") return "\"leds none 0 0\""
  if (type == "double") return "0.0"
  if (type == "size_t") return "1"
  if (type ~ /^(u?int[0-9]+_t|int)$/) return "0"
  if (type ~ /^(cargobay_control|void\*)$/) return "NULL"
  if (type ~ /^struct cargobay_(robot|sim|histogram)\*$/) return "NULL"
  if (type ~ /^(const )?struct cargobay_[a-z_]+\*$/) {
    sub(/^const /, "", type)
    sub(/\*$/, "", type)
    return "given(sizeof(" type "))"
  }
  if (type ~ /^struct cargobay_[a-z_]+$/) return "*(" type "*)given(sizeof(" type "))"
  if (type ~ /\*$/) return "given_room()"
  print "every_function.sh: no argument for \"" parameter "\"" > "/dev/stderr"
  failed = 1
  return "0"
}

function declare(text,    result, name, list, count, parameters, i, calls, kind) {
  gsub(/[ \t]+/, " ", text)
  match(text, /cargobay_[a-z0-9_]+\(/)
  result = trim(substr(text, 1, RSTART - 1))
  name = substr(text, RSTART, RLENGTH - 1)
  list = substr(text, RSTART + RLENGTH)
  sub(/\).*/, "", list)
  kind = "0"
  calls = ""
  if (trim(list) != "void") {
    count = split(list, parameters, ",")
    for (i = 1; i <= count; ++i) calls = calls (i > 1 ? ", " : "") argument(parameters[i], i == 1)
    if (calls ~ /^\(struct cargobay_robot\*\)handle/) kind = "of_robot"
    if (calls ~ /^\(struct cargobay_sim\*\)handle/) kind = "of_sim"
    if (calls ~ /^\(struct cargobay_histogram\*\)handle/) kind = "of_histogram"
  }
  names[++functions] = name
  kinds[functions] = kind == "0" ? "of_none" : kind
  said[name] = comment " " group
  print "static inline int call_" name "(void* handle) {"
  if (kind == "0") print "  (void)handle;"
  if (result == "int") print "  return LOADED(" functions - 1 ", " name ")(" calls ");"
  else print "  (void)LOADED(" functions - 1 ", " name ")(" calls ");\n  return 0;"
  print "}"
}

BEGIN {
  print "/* Made of cargobay.h by tests/capi/every_function.sh. */"
  print "#ifndef EVERY_FUNCTION_H\n#define EVERY_FUNCTION_H\n"
  print "#include <string.h>\n\n#include \"cargobay.h\"\n"
  print "/* How the program reaches a function: by its name, or loaded by dlopen(). */"
  print "#ifndef LOADED\n#define LOADED(index, function) function\n#endif\n"
  print "static const uint32_t given_packets[] = {CARGOBAY_PACKET_WALL_SIGNAL};"
  print "static const uint8_t given_bytes[] = {153};"
  print "/* A zeroed struct; its first member is this `size`. */"
  print "static inline void* given(size_t size) {"
  print "  static union {\n    uint32_t size;\n    double aligned;\n    unsigned char bytes[16384];\n  } room;"
  print "  memset(&room, 0, sizeof room);\n  room.size = (uint32_t)size;\n  return &room;\n}"
  print "/* Room for whatever comes out. */"
  print "static inline void* given_room(void) {\n  static union {\n    double aligned;\n    unsigned char bytes[4096];\n  } room;"
  print "  return &room;\n}\n"
}
/^\/\*\*/ { comment = ""; inside = 1 }
inside {
  line = $0
  gsub(/^ *\/?\*+\/?|\*\/ *$/, "", line)
  gsub(/["\\]/, "", line)
  comment = comment " " trim(line)
  if ($0 ~ /\*\/ *$/) {
    inside = 0
    if (comment ~ /@\{/) group = comment
    if (comment ~ /@\}/) group = ""
  }
  next
}
/^[a-z].*[ *]cargobay_[a-z0-9_]+\(/ && !/^typedef/ { text = ""; open = 1 }
open {
  text = text " " $0
  if ($0 ~ /;/) { open = 0; declare(text); comment = "" }
}
END {
  if (functions < 40) {
    print "every_function.sh: found hardly any function" > "/dev/stderr"
    exit 1
  }
  print "\nenum handle_of { of_none, of_robot, of_sim, of_histogram };"
  print "struct function {\n  const char* name;\n  int (*call)(void* handle);\n  enum handle_of kind;\n  const char* comment;\n};"
  print "static const struct function kFunctions[] = {"
  for (i = 1; i <= functions; ++i) {
    name = names[i]
    text = said[name]
    # "@return as cargobay_drive_wheels()": what that says holds here too.
    for (deep = 0; deep < 3 && match(text, /return as cargobay_[a-z_]+\(/); ++deep) {
      other = substr(text, RSTART + 10, RLENGTH - 11)
      sub(/return as /, "as ", text)
      text = text " " said[other]
    }
    print "    {\"" name "\", call_" name ", " kinds[i] ",\n     \"" trim(text) "\"},"
  }
  print "};"
  print "enum { kFunctionCount = sizeof kFunctions / sizeof kFunctions[0] };\n\n#endif"
  exit failed
}
' "$header"

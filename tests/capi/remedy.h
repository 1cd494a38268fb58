/* Whether a message says what to do, as the header promises. */
#ifndef REMEDY_H
#define REMEDY_H

#include <ctype.h>
#include <stdbool.h>

#include "check.h"

/* Whether a clause begins with this word, which ends there. */
static inline bool begins_with(const char* clause, const char* word) {
  const size_t length = strlen(word);
  return strncmp(clause, word, length) == 0 && !isalpha((unsigned char)clause[length]);
}

/* What people are asked to do: a clause begins with one of these words. */
static inline bool names_a_remedy(const char* message) {
  static const char* const kWords[] = {
      "add",    "allow",  "ask",    "call",   "charge",  "check",   "choose", "close", "correct",
      "enable", "end",    "free",   "give",   "install", "join",    "leave",  "let",   "lift",
      "look",   "lower",  "make",   "name",   "open",    "pass",    "plug",   "press", "put",
      "raise",  "see",    "remove", "rename", "renew",   "replace", "run",    "set",   "start",
      "stop",   "switch", "take",   "try",    "turn",    "unplug",  "use",    "wait",  "write",
  };
  for (const char* at = message; *at != '\0'; ++at) {
    if (strchr(";:,.", *at) == NULL || at[1] != ' ') continue;
    const char* clause = at + 2;
    if (strncmp(clause, "cargobay_", 9) == 0) return true; /* a function to call */
    if (begins_with(clause, "or")) clause += 3;
    if (begins_with(clause, "and") || begins_with(clause, "then")) clause = strchr(clause, ' ') + 1;
    for (size_t i = 0; i < sizeof kWords / sizeof kWords[0]; ++i) {
      if (begins_with(clause, kWords[i])) return true;
    }
  }
  return false;
}

/* The code, words about it, and a remedy, in one line. */
#define GIVES(call, code, words)                                                                \
  do {                                                                                          \
    CHECK_FAILS(call, code, words);                                                             \
    const char* const message_ = cargobay_error_message();                                      \
    if (!names_a_remedy(message_) || strchr(message_, '\n') != NULL) {                          \
      fprintf(stderr, "%s:%d: %s\n  has no remedy: %s\n", __FILE__, __LINE__, #call, message_); \
      exit(1);                                                                                  \
    }                                                                                           \
  } while (0)

#endif

/* rt/mailbox.hpp, as Promela: one thread puts, two get, and the memory in between may be as stale
 * as C++ lets it be.
 *
 * Each atomic of the mailbox keeps all that was ever stored to it, numbered: word i gets 1, 2, 3...
 * at each put, which is also its value here; sequence_ counts by itself. A load returns any store
 * that is not older than what its thread knows of already. What a thread knows grows by what it
 * loaded (coherence) and, where an acquire load meets a release store, by all that the storing
 * thread knew then. With one writing thread that follows from the number of the store alone.
 *
 * Asserted: what get() returns was put as a whole; it is what the sequence number says; it is never
 * older than what the same thread got before; and put() can always take its next step.
 *
 * Not modelled: the padding of the last word, the wrap of the 64-bit sequence number, and when
 * get() comes to an end, which it need not while values are put without pause.
 *
 * Twins that must fail, each without something that the protocol stands on:
 *   -DNO_ODD_STEP          the sequence number does not say that a put is under way
 *   -DRELAXED_WORDS        the stores of the words do not carry the odd number with them
 *   -DRELAXED_LAST_STORE   the last store does not carry the words
 */
#define WORDS 2
#ifndef PUTS
#define PUTS 2
#endif
#ifndef READERS
#define READERS 2
#endif

byte sequence = 0;   /* the latest store to each */
byte word[WORDS];
bool writer_done = false;
byte writer_pid;

proctype writer() {
  byte put = 1;
  byte i;
  do
  :: put <= PUTS ->
#ifndef NO_ODD_STEP
    sequence = 2 * put - 1;
#endif
    i = 0;
    do
    :: i < WORDS -> atomic { word[i] = put; i++ }
    :: else -> break
    od;
    atomic { sequence = 2 * put; put++ }
  :: else -> break
  od;
  writer_done = true
}

inline at_least(known, number) {
  if
  :: known < number -> known = number
  :: else
  fi
}

/* Any store from the one known to the latest. */
inline load(known, latest) {
  do
  :: known < latest -> known++
  :: break
  od
}

/* The number of the odd step of a put, or of what was there before it. */
#ifdef NO_ODD_STEP
#define BEGUN(put) (2 * (put) - 2)
#else
#define BEGUN(put) (2 * (put) - 1)
#endif

inline acquire_sequence() {
  load(known_sequence, sequence);
  before = known_sequence;
#ifndef RELAXED_LAST_STORE
  if
  :: before % 2 == 0 -> /* a release store; the odd one is relaxed */
    j = 0;
    do
    :: j < WORDS -> at_least(known_word[j], before / 2); j++
    :: else -> break
    od
  :: else
  fi;
#endif
  j = 0
}

inline acquire_word(i) {
  load(known_word[i], word[i]);
#ifndef RELAXED_WORDS
  if
  :: known_word[i] > 0 ->
    at_least(known_sequence, BEGUN(known_word[i]));
    j = 0;
    do
    :: j < i -> at_least(known_word[j], known_word[i]); j++
    :: j >= i && j < WORDS -> at_least(known_word[j], known_word[i] - 1); j++
    :: else -> break
    od
  :: else
  fi;
#endif
  got[i] = known_word[i];
  j = 0
}

proctype reader() {
  byte known_sequence = 0;
  byte known_word[WORDS];
  byte got[WORDS];
  byte before;
  byte last = 0;
  byte i;
  byte j;
again:
  do
  ::
    atomic {
      acquire_sequence();
      if
      :: before == 0 -> goto again /* nothing was put yet */
      :: else
      fi
    };
    do
    :: i < WORDS -> atomic { acquire_word(i); i++ }
    :: else -> break
    od;
    atomic {
      load(known_sequence, sequence); /* relaxed */
      if
      :: before % 2 == 0 && known_sequence == before ->
        i = 0;
        do
        :: i < WORDS -> assert(got[i] == before / 2); i++
        :: else -> break
        od;
        assert(before / 2 >= last);
        last = before / 2
      :: else
      fi;
      i = 0; /* what is over makes no other state */
      before = 0;
      do
      :: i < WORDS -> got[i] = 0; i++
      :: else -> break
      od;
      i = 0;
      if
      :: last == PUTS -> break
      :: else
      fi
    }
  od
}

init {
  byte k = 0;
  atomic {
    writer_pid = run writer();
    do
    :: k < READERS -> run reader(); k++
    :: else -> break
    od
  }
}

/* put() never waits: no state in which its next step cannot be taken. (Spin suspends a claim within
 * atomic sequences, and so asks between steps.) */
never {
  do
  :: writer_pid != 0 && !writer_done && !enabled(writer_pid) -> break
  :: else
  od
}

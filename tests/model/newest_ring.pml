/* rt/newest_ring.hpp, as Promela: one thread puts once and another twice, which is more than there
 * are slots; one reads on; and the memory in between may be as stale as C++ lets it be.
 *
 * Memory is modelled as in mailbox.pml: a load returns any store that is not older than what its
 * thread knows of already, and what a thread knows grows by what it loaded and, where an acquire
 * load meets a release store, by what the storing thread knew then. Here the stores to a word are
 * numbered by the rounds of its slot; a round is begun by the compare and swap that makes the
 * version odd. An entry is two words: its number, and a value, for which the number stands too.
 *
 * Asserted: what next() returns was put as a whole, in the slot of its number; its number was given
 * out, and is above the one that the reader has seen; put() can always take its next step.
 *
 * Not modelled: newest(), which looks at the same slots from the other end; the repeated tries of a
 * look, since one that gives up at once may happen too; the wrap of the numbers.
 *
 * Twins that must fail, each without something that the protocol stands on:
 *   -DNO_SWAP              two threads may take the same slot
 *   -DNO_ODD_STEP          the version does not say that a put is under way
 *   -DRELAXED_WORDS        the stores of the words do not carry the odd version with them
 *   -DRELAXED_LAST_STORE   the last store does not carry the words
 *   -DNO_NUMBER_CHECK      what is in a slot is taken for what was asked for
 */
#define CAPACITY 2
#define WORDS 2
#define WRITERS 2
#define ROUNDS 3 /* one more than a slot gets */

#define WORD(slot, i) ((slot) * WORDS + (i))
#define STORE(slot, i, round) (WORD(slot, i) * ROUNDS + (round))

byte last = 0;                            /* numbers given out */
byte version[CAPACITY];                   /* the latest store to each */
byte stores[CAPACITY * WORDS];            /* how many there were to each word */
byte stored[CAPACITY * WORDS * ROUNDS];   /* each of them: the number of its entry */
byte writers_done = 0;
byte writer_pid[WRITERS];

inline at_least(known, least) {
  if
  :: known < least -> known = least
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

proctype writer(byte puts) {
  byte known_version[CAPACITY];
  byte number;
  byte slot;
  byte seen;
  byte i;
  do
  :: puts > 0 ->
    atomic { last++; number = last; slot = number % CAPACITY; puts-- };
    atomic { load(known_version[slot], version[slot]); seen = known_version[slot] };
    if
    :: seen % 2 == 1 -> skip /* dropped */
    :: else ->
      atomic {
        if
#ifndef NO_SWAP
        :: version[slot] != seen -> goto dropped
#endif
        :: else ->
#ifndef NO_ODD_STEP
          version[slot] = seen + 1
#else
          skip
#endif
        fi
      };
      i = 0;
      do
      :: i < WORDS ->
        atomic {
          stores[WORD(slot, i)]++;
          stored[STORE(slot, i, stores[WORD(slot, i)])] = number;
          i++
        }
      :: else -> break
      od;
      atomic { version[slot] = seen + 2; known_version[slot] = seen + 2 }
    fi;
dropped:
    seen = 0
  :: else -> break
  od;
  writers_done++
}

/* The version that begins a round, or what was there before it. */
#ifdef NO_ODD_STEP
#define BEGUN(round) (2 * (round) - 2)
#else
#define BEGUN(round) (2 * (round) - 1)
#endif

inline acquire_version() {
  load(known_version[slot], version[slot]);
  before = known_version[slot];
#ifndef RELAXED_LAST_STORE
  if
  :: before % 2 == 0 -> /* a release store; the odd one is relaxed */
    j = 0;
    do
    :: j < WORDS -> at_least(known_word[WORD(slot, j)], before / 2); j++
    :: else -> break
    od
  :: else
  fi;
#endif
  j = 0
}

inline acquire_word() {
  load(known_word[WORD(slot, i)], stores[WORD(slot, i)]);
#ifndef RELAXED_WORDS
  if
  :: known_word[WORD(slot, i)] > 0 ->
    at_least(known_version[slot], BEGUN(known_word[WORD(slot, i)]));
    j = 0;
    do
    :: j < i -> at_least(known_word[WORD(slot, j)], known_word[WORD(slot, i)]); j++
    :: j >= i && j < WORDS ->
      at_least(known_word[WORD(slot, j)], known_word[WORD(slot, i)] - 1); j++
    :: else -> break
    od
  :: else
  fi;
#endif
  got[i] = stored[STORE(slot, i, known_word[WORD(slot, i)])];
  j = 0
}

proctype reader() {
  byte known_version[CAPACITY];
  byte known_word[CAPACITY * WORDS];
  byte known_last = 0;
  byte got[WORDS];
  byte after = 0;
  byte number = 0;
  byte slot;
  byte before;
  byte i;
  byte j;
  bool there;
next_call:
  atomic {
    got[0] = 0;
    got[1] = 0;
    number = 0;
    before = 0;
    i = 0;
    load(known_last, last);
    if
    :: after >= known_last -> goto next_call
    :: else
    fi;
    number = after + 1;
    if
    :: known_last >= CAPACITY -> at_least(number, known_last - CAPACITY + 1)
    :: else
    fi
  };
  do
  :: number <= known_last ->
    atomic { slot = number % CAPACITY; acquire_version(); there = before != 0; i = 0 };
    do
    :: there && i < WORDS -> atomic { acquire_word(); i++ }
    :: else -> break
    od;
    atomic {
      load(known_version[slot], version[slot]); /* relaxed */
      there = there && before % 2 == 0 && known_version[slot] == before;
      if
      :: there ->
        assert(got[0] == got[1]);
        assert(got[0] % CAPACITY == slot);
        assert(got[0] <= last)
      :: else
      fi;
      if
#ifndef NO_NUMBER_CHECK
      :: there && got[0] >= number ->
#else
      :: there ->
#endif
        assert(got[0] > after);
        after = got[0];
        goto next_call
      :: else
      fi;
      if
      :: known_last - number < CAPACITY / 2 -> goto next_call
      :: else -> number++
      fi
    }
  :: else -> goto next_call
  od
}

init {
  byte k = 0;
  atomic {
    do
    :: k < WRITERS -> writer_pid[k] = run writer(k + 1); k++
    :: else -> break
    od;
    run reader()
  }
}

/* put() never waits: no state in which its next step cannot be taken. (Spin suspends a claim within
 * atomic sequences, and so asks between steps.) */
#define WAITS(k) (writer_pid[k] != 0 && writers_done == 0 && !enabled(writer_pid[k]))
never {
  do
  :: WAITS(0) || WAITS(1) -> break
  :: else
  od
}

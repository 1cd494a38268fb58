/* rt/ring.hpp, as Promela: one thread pushes, one pops, and head_ and tail_ may be as stale as C++
 * lets them be. How that is modelled is told in mailbox.pml: a load returns any store that is not
 * older than what its thread knows of. The slots are no atomics: a slot must only be touched by who
 * knows that the other thread has done with it.
 *
 * Asserted: no slot is raced for; what was accepted comes out once, in its order, and nothing else
 * does; what was not is counted as dropped.
 *
 * Not modelled: the wrap of the indices at the end of size_t.
 *
 * Twins that must fail:
 *   -DRELAXED_HEAD   head_ does not carry the slot with it
 *   -DRELAXED_TAIL   tail_ does not say that the slot was read
 *   -DONE_TOO_MANY   a full ring takes one more
 */
#define CAPACITY 2
#define PUSHES 5

#ifdef ONE_TOO_MANY
#define FULL(head, tail) ((head) - (tail) == CAPACITY + 1)
#else
#define FULL(head, tail) ((head) - (tail) == CAPACITY)
#endif

byte slot[CAPACITY];
byte accepted[PUSHES]; /* what each index was given */
byte head = 0;         /* the latest store to each */
byte tail = 0;
byte dropped = 0;
bool pushed_all = false;

inline load(known, latest) {
  do
  :: known < latest -> known++
  :: break
  od
}

proctype writer() {
  byte known_tail = 0; /* loaded */
  byte read_before = 0; /* of what was popped: known to have been read */
  byte value = 1;
  do
  :: value <= PUSHES ->
    atomic {
      load(known_tail, tail);
#ifndef RELAXED_TAIL
      read_before = known_tail;
#endif
    };
    if
    :: FULL(head, known_tail) -> dropped++
    :: else ->
      atomic {
        assert(head < CAPACITY || read_before > head - CAPACITY);
        slot[head % CAPACITY] = value;
        accepted[head] = value
      };
      head++
    fi;
    value++
  :: else -> break
  od;
  pushed_all = true
}

proctype reader() {
  byte known_head = 0;     /* loaded */
  byte written_before = 0; /* of what was pushed: known to have been written */
  bool last_look;
  do
  :: true ->
    last_look = pushed_all; /* the test's own: no part of the ring */
    atomic {
      if
      :: last_look -> known_head = head
      :: else -> load(known_head, head)
      fi;
#ifndef RELAXED_HEAD
      written_before = known_head;
#endif
    };
    if
    :: tail == known_head && last_look -> break
    :: tail == known_head && !last_look
    :: else ->
      atomic {
        assert(written_before > tail);
        assert(slot[tail % CAPACITY] == accepted[tail]);
      };
      tail++
    fi
  od;
  assert(tail == head);
  assert(tail + dropped == PUSHES)
}

init {
  atomic {
    run writer();
    run reader()
  }
}

/* Names and numbers: each has one, unknown ones have none, and the library's version is the
 * header's. */
#include <stdbool.h>

#include "check.h"

typedef const char* (*naming)(int number);

static void is(const char* said, const char* wanted) {
  if (strcmp(said, wanted) == 0) return;
  fprintf(stderr, "\"%s\", not \"%s\"\n", said, wanted);
  exit(1);
}

/* From `least` to `most` each has a name of its own, in small letters; others have none. */
static void are_named(naming name, int least, int most, const char* unknown) {
  for (int i = least; i <= most; ++i) {
    const char* const said = name(i);
    CHECK(said != NULL && strlen(said) > 2 && strcmp(said, unknown) != 0);
    for (int k = least; k < i; ++k) CHECK(strcmp(said, name(k)) != 0);
  }
  const int strange[] = {least - 1, most + 1, 1000, -1000, 0x7fffffff, -0x7fffffff};
  for (int i = 0; i < 6; ++i) is(name(strange[i]), unknown);
}

static void has_a_version(void) {
  char text[32];
  snprintf(text, sizeof text, "%d.%d.%d", CARGOBAY_VERSION_MAJOR, CARGOBAY_VERSION_MINOR,
           CARGOBAY_VERSION_PATCH);
  is(cargobay_version(), text);
  CHECK(cargobay_version_number() == CARGOBAY_VERSION_NUMBER);
  CHECK(CARGOBAY_VERSION_NUMBER ==
        CARGOBAY_VERSION_MAJOR * 1000000 + CARGOBAY_VERSION_MINOR * 1000 + CARGOBAY_VERSION_PATCH);
}

/* Cut off where the room ends, and not a byte later. */
static void keeps_to_its_room(const struct cargobay_event* event, const char* whole, int length) {
  char text[300];
  for (size_t size = 0; size < (size_t)length + 2; ++size) {
    memset(text, 0x5a, sizeof text);
    CHECK(cargobay_describe_event(event, text, size) == length);
    CHECK(text[size] == 0x5a);
    if (size == 0) continue;
    CHECK(strlen(text) == (size <= (size_t)length ? size - 1 : (size_t)length));
    CHECK(strncmp(text, whole, strlen(text)) == 0);
  }
}

static void events_are_described(void) {
  char text[300];
  for (int kind = CARGOBAY_EVENT_MODE_LOST; kind <= CARGOBAY_EVENT_LIMIT_ENDED; ++kind) {
    SIZED(cargobay_event, event);
    event.kind = kind;
    const int length = cargobay_describe_event(&event, text, sizeof text);
    CHECK(length > 5 && length == (int)strlen(text) && strchr(text, '\n') == NULL);
    CHECK(length + 2 < (int)sizeof text);
    keeps_to_its_room(&event, text, length);
  }
}

int main(void) {
  are_named(cargobay_error_name, CARGOBAY_E_WHEELS, CARGOBAY_ENDED, "CARGOBAY_E_?");
  are_named(cargobay_mode_name, CARGOBAY_MODE_OFF, CARGOBAY_MODE_FULL, "");
  are_named(cargobay_event_name, CARGOBAY_EVENT_MODE_LOST, CARGOBAY_EVENT_LIMIT_ENDED, "");
  are_named(cargobay_packet_name, CARGOBAY_PACKET_BUMPS_AND_WHEEL_DROPS,
            CARGOBAY_PACKET_REQUESTED_LEFT_VELOCITY, "");
  is(cargobay_error_name(CARGOBAY_OK), "CARGOBAY_OK");
  is(cargobay_error_name(CARGOBAY_E_BUSY), "CARGOBAY_E_BUSY");
  is(cargobay_error_name(CARGOBAY_E_UNCONFIRMED), "CARGOBAY_E_UNCONFIRMED");
  is(cargobay_error_name(CARGOBAY_ENDED), "CARGOBAY_ENDED");
  is(cargobay_mode_name(CARGOBAY_MODE_PASSIVE), "passive");
  is(cargobay_event_name(CARGOBAY_EVENT_MODE_LOST), "mode_lost");
  is(cargobay_event_name(CARGOBAY_EVENT_PORT_SHARED), "port_shared");
  is(cargobay_event_name(CARGOBAY_EVENT_WHEEL_STUCK), "wheel_stuck");
  is(cargobay_error_name(CARGOBAY_E_WHEELS), "CARGOBAY_E_WHEELS");
  is(cargobay_packet_name(CARGOBAY_PACKET_WALL_SIGNAL), "wall_signal");
  is(cargobay_packet_name(CARGOBAY_PACKET_REQUESTED_LEFT_VELOCITY), "requested_left_velocity");
  has_a_version();
  events_are_described();
  return 0;
}

// What docs/protocol.md says that no table contains, such as the manual's contradictions.
#pragma once

#include <string_view>

namespace cargobay::oi {

inline constexpr std::string_view kIntroductionText =
    R"(<!-- Made by tests/oi/protocol_page.cpp from the tables of oi/. Do not edit: a test compares.
     CARGOBAY_WRITE_DOCS=1 test_oi --gtest_filter='ProtocolPage.*' rewrites it. -->

# The Open Interface, as Cargobay speaks it

The iRobot Create of 2006 is driven over a serial line. The host sends commands: an opcode and its
data bytes. The robot answers Sensors and Query List, and sends a frame of sensor packets every
15 ms where a stream has been asked for. Numbers of two bytes travel high byte first. "OI p. 9" is
a page of the manual, *iRobot Create Open Interface*.

This page says what the manual lays down, where it contradicts itself, what robots really do, and
what Cargobay does about it. Names in `code` are those of the command line and of the source.
)";

inline constexpr std::string_view kLineText = R"(
## The line

Eight data bits, no parity, one stop bit: ten bits a byte. The robot starts at 57600; three low
pulses on the Baud Rate Change (BRC) pin, or holding Play while switching on, start it at 19200.
Baud changes the rate until the robot is switched off; the next byte may follow after 100 ms. At
115200 the robot needs 200 us from the beginning of one byte to the beginning of the next.

How long a rate holds depends on how it was set. Play held: until the robot is switched off. Baud:
the same. The pulses: until the battery is lost, the power button does not end it. A Baud command
ends each of them.

)";

inline constexpr std::string_view kModesText = R"(
## Modes

| mode | value of `oi_mode` | what the robot obeys |
|---|---|---|
| Off | 0 | Start and nothing else |
| Passive | 1 | what moves, lights, sounds or switches nothing |
| Safe | 2 | everything; a cliff while driving towards it, a wheel drop or a charger stops the wheels and makes it Passive |
| Full | 3 | everything, and watches nothing |

Safe and Full end charging. The robot changes the mode by itself, so Cargobay streams `oi_mode` with
every frame and believes nothing else. No command leads to Off; Cargobay leaves a robot in Passive.

## Commands

"Safe" in the column *from* means that Off and Passive ignore the command. Arguments stand in the
order of the wire; the text form has `drive_direct LEFT RIGHT` and `pwm_low_side_drivers` for the
drivers 0, 1, 2. What is outside a range is refused, never clamped. The word `stop` is
`drive_direct 0 0`; `cargobay send` also ends a demo for it, which Drive Direct does not.

)";

inline constexpr std::string_view kCommandNotesText = R"(
- **Drive.** Straight is the radius 32768, which 16 bits with a sign write as -32768 (`80 00`); the
  robot takes 32767 for the same. Cargobay sends `80 00` and reads both. A radius of -1 turns
  clockwise on the spot, 1 counter-clockwise.
- **LEDs.** Play is bit 1, Advance is bit 3; other bits mean nothing and are refused.
- **Song** stores, so it works in Passive; **Play Song** sounds, so it does not, and is ignored while
  a song plays. A song that is stored under the number of the one that plays is for the next Play. A
  note outside 31 to 127 is a rest. In text a note may also be named: `c4` is 60, `f#5` and `bb3` are
  others.
- **Query List** is answered whole, however long: 255 times `group_6` are 13260 bytes, 2.3 s at 57600.
  Until then the robot obeys nothing else and sends no frame.
- **Stream** replaces the list; a list of length 0 ends the stream. **Pause/Resume Stream** keeps it.
- **Script.** The length counts bytes; 0 clears. **Show Script** answers with the length and the
  bytes, and halts the stream until it is resumed. A script cannot hold a script: Cargobay refuses to
  send one. A robot would play it.
- **The Wait commands** make the robot deaf until their time, distance, angle or event has come. They
  are meant for scripts. The negative of an event waits until it is over; the
  text form writes `no_bump` for that of `bump`. Wait Distance and Wait Angle reset `distance` and `angle`;
  0 is reached at once.
- A command cut short makes the robot take whatever comes next for its data.
- In `cargobay encode` and `send`, `bytes 142 100` takes any bytes, whole commands or not.
)";

inline constexpr std::string_view kTunesText = R"(
## Tunes

`tune SLOT RTTTL` in the text of commands stores a ring tone: `tune 0 name:d=4,o=5,b=120:8c,8e_,g.`
becomes Song commands for slot 0 and the slots after it, sixteen notes each. The robot ignores Play
while it plays: play each when the one before is over; `cargobay send` says how long they last. A
tune ends with its command, at `;` or the end of the line. `#` at the beginning of a word begins a
comment there too, unless it can be a sharp: after a comma or colon, or before one, a dot or an octave.

A ring tone is `name:controls:notes`. White space and case do not matter. Each note begins and ends
at its exact time, rounded to 1/64 s, so that the tempo does not drift. A note longer than 255/64 s
becomes several, and one that begins and ends in the same 1/64 s is left out. These forms are read:

| form | example | |
|---|---|---|
| note | `8c#6.` | duration, letter `a` to `g`, sharp, octave, dot; all but the letter may be left out |
| duration | `16c` | 1, 2, 4, 8, 16, 32 or 64: that part of a whole note |
| octave | `a4` | 440 Hz; what the robot plays is `g1` to `g9` |
| dot | `8c.6` `8.c6` `8c6.` | half as long again, after the duration, the letter or the octave; one |
| sharp | `c#` `c_` `#c5` `c5#` | `#` or `_`, before or after the letter, or after the octave |
| flat | `eb` `bb4` | `b` after the letter |
| German b | `h` | the same as `b` |
| rest | `8p` `8r` | an octave after it means nothing |
| defaults | `d=8,o=5,b=140` | duration, octave, beats a minute; left out: 4, 6, 63 |
| names in full | `duration=8` `octave=5` `tempo=140` `bpm=140` | the same |
| unit | `b=140bpm` | |
| controls without `=` | `d8,o5,b140,ss` | in their own section only, except `o5` and the styles |
| controls without comma | `d=8 o=5 b=140` | |
| controls among the notes | `c,d=8,o=6,b=90,e` | from there on |
| styles, repetitions | `s=c` `ss` `sn` `l=15` | no effect |
| unknown controls | `v=80` | passed over, up to the comma |
| no name | `d=4,o=5,b=140:c` `:d=4:c` | |
| no controls | `name:c` `name::c` | |
| no colon between controls and notes | `name:d=4,b=140,c,e` | |
| name with colons | `Mission: Impossible:d=4:c` | controls between two colons end it |
| comma at the end | `c,e,` | |

What is refused is shown at its place: another duration, a second dot or sharp, an octave that the
robot does not play, a style that is not `n`, `c` or `s`, two commas, notes without a comma between,
a text without a colon, and more notes than the slots hold.
)";

inline constexpr std::string_view kPacketsText = R"(
## Sensor packets

A group is sent as its members one after the other. A value outside the range is delivered as it
came, and counted.

)";

inline constexpr std::string_view kStreamText = R"(
## Stream frames

| byte | meaning |
|---|---|
| 19 | header |
| n | how many bytes follow, without the checksum |
| id, data, id, data, ... | the packets of the list, in its order |
| checksum | makes the low byte of the frame's sum 0 |

The checksum is where the manual and robots part: the manual leaves the header out of the sum, robots
take it in. The frame of the manual's example ends in 182 by the one and in 163 by the other. The
decoder takes either until four frames in a row agree and then that form only; four in a row of the
other form change its mind. One form can be laid down instead.

Nothing marks a 19 as a header: ids and data may be 19 too. The decoder therefore believes only what
has the structure of a frame, ids and lengths that fill n exactly, and the right checksum. It reads
what it refused again from the next byte on, and it drops a frame that seems to be still coming when
two whole frames have gone by inside it. After any damage the second whole frame is delivered with
its last byte. What one byte of checksum cannot see remains: of damaged bytes that have the structure
of a frame, 1 in 256 passes; and where a data byte that is 19 was lost, the header of the next frame
takes the place of the checksum and the sum is right.

A robot that is off, booting or charging prints lines of text. They are passed over and counted.

)";

inline constexpr std::string_view kContradictionsText = R"(
## Where the manual contradicts itself

| | the manual | Cargobay |
|---|---|---|
| 1 | a script's length is a number of commands, and at most 100 bytes | bytes: all its examples count bytes |
| 2 | the stream's checksum leaves the header out; manuals of later robots take it in | both are decoded; the virtual Create takes it in unless told otherwise |
| 3 | its stream example reads bytes 2 25 as 0x0225 = 549, and calls packet 29 the left cliff signal | 2 25 is 537, packet 29 is `cliff_front_left_signal` |
| 4 | Wait Event takes 1 to 20, its table has 22 events | 1 to 22 and their negatives |
| 5 | Wait Distance and Wait Angle from -32767 to 32768 | any 16 bits with a sign: -32768 to 32767 |
| 6 | low side driver 0 is pin 22 by the connector table and by Send IR, pin 23 by the table of Low Side Drivers | driver 0 is pin 22, driver 1 is pin 23; measure before you solder |
| 7 | packet 14 has driver 1 in bit 0 and driver 0 in bit 1, against the order of its neighbours | as written, both tables agree |
| 8 | driver 2 carries 1.5 A, and 1.6 A | rated 1.5 A, reported as too much at 1.6 A |
| 9 | packet 18 to 5 and to 15; packet 38 to 43 and to 42; packet 20 in degrees and in mm | buttons are bits 0 and 2; 43; degrees |
| 10 | the text of packet 35 describes packet 34 | packet 35 is the mode |
| 11 | Start is available in Passive, Safe and Full, yet it is what leaves Off | Off obeys Start and nothing else |
| 12 | the robot is Passive after switching on, and Off after a new battery | Off until Start |
| 13 | notes from 31 to 27 in the summary | 31 to 127 |
| 14 | straight is 32768 or 32767 | `80 00` is sent, both are read |
| 15 | Wait commands are for scripts only, and are listed as commands | the library refuses them outside a script; the virtual Create obeys and is deaf, as a robot is |
| 16 | Query List takes 0 to 255 packets, Stream 0 to 43 | as written; a stream must also fit n and 15 ms |
| 17 | a mode command leads to each of the four modes (p. 6), none leads to Off | off is off: the power button, pin 3, the battery |
| 18 | note 32 is 51.0 Hz (p. 12) | it is 51.9 Hz, as its octaves say; the wire carries the number, so nothing depends on it |
| 19 | 19200 by pulses holds until the processor loses its battery (p. 5), a Baud command's rate until the power button (p. 7) | as written, each its own |
| 20 | the rate follows the level of the BRC pin (p. 20), and three pulses set it (p. 5) | pulses; packet 32 shows the level |
| 21 | pins 10, 11 and 12 have 1.5 A each, or in all (p. 4) | in all: a power supply is chosen by the smaller number |
| 22 | Safe switches the LEDs off (p. 7), Safe and Full both do (p. 6) | both do, each time: LEDs are set after the mode |
| 23 | nothing reaches a robot that waits (p. 15), yet it can wait for Passive mode (p. 16), which in Safe a hazard brings | Safe is on guard during a wait too |
| 24 | Passive keeps what the actuators do (p. 6), yet a hazard stops all motors | Passive stops wheels and low side drivers, whatever led to it, and keeps the rest; Cargobay stops the wheels before |
| 25 | `distance` is negative backward (p. 18), and counts up either way if the wheels are turned by hand (p. 16) | both: the direction is not measured, it is that of the motors |
)";

inline constexpr std::string_view kOpenText = R"(
## Where the manual says nothing

What Cargobay does on its side of the line; what the virtual Create takes a robot to do is in
`docs/virtual-create.md`. Nothing of the following is needed to drive one.

| open | Cargobay |
|---|---|
| data out of range: clamped, masked or ignored by the robot | not sent |
| a demo above 9, a packet above 42, alone or in a list | not sent. How many bytes a robot answers for such a packet, nobody knows: a list with one cannot be read |
| a script of more than 100 bytes, a song of more than 16 notes, a stream of more than 43 packets | not sent |
| BRC pulses: the longest gap, the latest time, more than three | three, 250 ms apart, 2 s after power-on, and the rate is verified |
| "moving forward" (p. 6): as commanded, or in truth | as commanded; what slows down or is pushed over an edge is not held back by Safe |
| the Home Base in Safe, which only the charger's plug ends | no charging until Passive |
)";

inline constexpr std::string_view kRobotsText = R"(
## What robots do that the manual does not say

Told by owners and by published host software; none of it measured here.

| what | Cargobay |
|---|---|
| Many units cut `distance` and `angle` to whole mm and degrees at each reading and lose the rest, so that slow motion reads as none | finds out which kind it drives, and reads in windows of several ticks where the rest is lost |
| Reading `distance` or `angle` clears it, whoever reads | never streams and queries them at once |
| The direction is not measured, the sign is that of the command | the same in the virtual Create |
| The first reading after connecting is junk | discarded |
| Replies to queries come between the frames of a stream without any mark | the stream is paused for a query |
| The stream outlives changes of mode, and ends at reset, power-off and Off | a stream that stops is asked for again |
| Opcodes that the robot does not know are ignored | the virtual Create ignores them and counts |
| The robot's lines are 5 V | a transistor or level shifter stands between |
)";

}  // namespace cargobay::oi

"""Generated ring tones, in every form that docs/protocol.md names: what `cargobay encode` makes of
each is compared, note for note, with an independent reader that counts in exact fractions.

usage: generated.py COMMAND [--count N] [--seed N]
       generated.py COMMAND --self-test    a reader with each of some faults must be noticed
"""

import argparse
import random
import re
import subprocess
import sys
from fractions import Fraction

NOTES = {'c': 0, 'd': 2, 'e': 4, 'f': 5, 'g': 7, 'a': 9, 'b': 11, 'h': 11}
TEMPOS = [25, 28, 31, 35, 40, 45, 50, 56, 63, 70, 80, 90, 100, 112, 125, 140, 160, 180, 200, 225,
          250, 285, 320, 355, 400, 450, 500, 565, 635, 715, 800, 900]
LOWEST, HIGHEST = 31, 127
MOST_NOTES = 256
MOST_DURATION = 255
FAULTS = ['underscore', 'dot', 'octave', 'tempo', 'default']


class Reader:
    """RTTTL as docs/protocol.md describes it, from that page and not from the C++ reader."""

    def __init__(self, fault=None):
        self.fault = fault

    def read(self, text):
        text = ''.join(text.split()).lower()
        before, _, notes = text.rpartition(':')
        self.division, self.octave, self.tempo = 4, 6, 63
        controls = before.rpartition(':')[2] if ':' in before else before
        if '=' in controls or re.fullmatch(r'([dob]\d+,?)+', controls):
            self.controls(controls)
        self.time, self.ended, self.out = Fraction(0), 0, []
        for item in notes.split(','):
            if not item:
                continue
            if '=' in item or re.fullmatch(r'o\d+|s[ncs]', item):
                self.controls(item)
            else:
                self.note(item)
        return self.out

    def controls(self, text):
        for key, value in re.findall(r'([a-z]+?)=?(\d+(?:bpm(?!=))?|=[^,]*|(?<=s)[ncs])', text):
            number = re.match(r'\d+', value)
            if key in ('d', 'duration'):
                self.division = int(number.group())
            elif key in ('o', 'octave'):
                self.octave = int(number.group())
            elif key in ('b', 'bpm', 'tempo') and self.fault != 'tempo':
                self.tempo = int(number.group())

    def note(self, item):
        match = re.fullmatch(r'(\d*)(\.?)([#_]?)([a-hpr])([#_b]?)(\.?)(\d*)([#_]?)(\.?)', item)
        assert match, item
        division, dot1, sharp1, letter, accidental, dot2, octave, sharp2, dot3 = match.groups()
        length = Fraction(240 * 64, self.tempo * int(division or self.division))
        if self.fault == 'default' and not division:
            length = Fraction(240 * 64, self.tempo * 4)
        if dot1 or dot2 or (dot3 and self.fault != 'dot'):
            length *= Fraction(3, 2)
        pitch = 0
        if letter not in 'pr':
            octave = int(octave or self.octave) - (1 if self.fault == 'octave' and octave else 0)
            pitch = 12 * (octave + 1) + NOTES[letter]
            sharps = (sharp1 + accidental + sharp2).replace('b', '')
            if self.fault == 'underscore':
                sharps = sharps.replace('_', '')
            pitch += 1 if sharps else -1 if accidental == 'b' else 0
        self.time += length
        end = (self.time + Fraction(1, 2)).__floor__()
        while self.ended < end:
            piece = min(end - self.ended, MOST_DURATION)
            self.out.append((pitch, piece))
            self.ended += piece


class Generator:
    def __init__(self, seed):
        self.random = random.Random(seed)

    def one_of(self, *choices):
        return self.random.choice(choices)

    def some(self, share):
        return self.random.random() < share

    def tune(self):
        """A text that can be played, whatever it takes to find one."""
        while True:
            text = self.text()
            notes = Reader().read(text)
            if 0 < len(notes) <= MOST_NOTES and all(
                    pitch == 0 or LOWEST <= pitch <= HIGHEST for pitch, _ in notes):
                return text

    def text(self):
        name = self.one_of('', 'Tune', 'Ode to Joy', 'Mission: Impossible', 'a-b_c', '24')
        controls = self.controls()
        notes = ','.join(self.item() for _ in range(self.random.randint(1, 40)))
        notes += self.one_of('', '', '', ',')
        if self.some(0.1) and '=' in controls and ':' not in name:
            return name + ':' + re.sub(r',? (?!bpm(?!=))', ',', controls) + ',' + notes
        if controls and self.some(0.1) and '=' in controls:
            return controls + ':' + notes
        if not controls and ':' not in name and self.some(0.3):
            return name + ':' + notes
        return name + ':' + controls + ':' + notes

    def controls(self):
        chosen = []
        if self.some(0.9):
            chosen.append(self.one_of('d', 'D', 'd', 'duration') + '=' +
                          self.one_of('4', '8', '16', '32', '2', '1', '64'))
        if self.some(0.9):
            chosen.append(self.one_of('o', 'o', 'octave') + '=' + self.one_of('4', '5', '6', '7'))
        if self.some(0.9):
            chosen.append(self.one_of('b', 'b', 'B', 'bpm', 'tempo') + '=' + self.tempo() +
                          self.one_of('', '', '', 'bpm', ' bpm'))
        if self.some(0.2):
            chosen.append(self.one_of('s=N', 'l=15', 'v=80', 'x=a.b#c', 'i=', 'ss'))
        self.random.shuffle(chosen)
        if self.some(0.05):
            return ','.join(key[0] + key.split('=')[1] for key in chosen
                            if key[0] in 'dob' and 'bpm' not in key)
        between = self.one_of(',', ',', ', ', ' ')
        if any(key.startswith(('x=', 'i=', 'l=', 's', 'v')) for key in chosen):
            between = ','  # what is not known ends at the comma
        return between.join(chosen)

    def tempo(self):
        if self.some(0.8):
            return str(self.random.choice(TEMPOS))
        return str(self.random.randint(20, 900))

    def item(self):
        if self.some(0.03):
            return self.one_of('d=8', 'o=5', 'o6', 'b=' + self.tempo(), 'SS', 'sn', 's=c', 'v=3')
        duration = self.one_of('', '', '4', '8', '16', '32', '2', '1', '64')
        octave = self.one_of('', '', '4', '5', '6', '7', '8')
        dots = [self.one_of('', '.') if self.some(0.2) else '', '', '']
        self.random.shuffle(dots)
        if self.some(0.1):
            return duration + dots[0] + self.one_of('p', 'P', 'r') + dots[1] + dots[2]
        letter = self.one_of(*'cdefgabhCDEFGABH')
        sharps = ['', '', '']
        if self.some(0.4):
            sharps[self.random.choice([0, 1, 1, 1])] = self.one_of('#', '_')
        elif self.some(0.05):
            sharps[1] = 'b'
        elif octave and self.some(0.05):
            sharps[2] = self.one_of('#', '_')
        space = self.one_of('', '', '', '', ' ')
        return (space + duration + dots[0] + sharps[0] + letter + sharps[1] + dots[1] + octave +
                sharps[2] + dots[2])


def encoded(command, tunes):
    """The notes of each tune, from one run of the command. Each begins in slot 0 again."""
    text = ''.join('tune 0 ' + tune + '\n' for tune in tunes)
    run = subprocess.run([command, 'encode'], input=text, capture_output=True, text=True,
                         check=False)
    if run.returncode != 0:
        sys.exit(f'the command refuses a tune: {run.stderr}')
    data = bytes.fromhex(run.stdout)
    all_notes = []
    at = expected_slot = 0
    while at < len(data):
        opcode, slot, count = data[at:at + 3]
        if opcode != 140 or slot not in (0, expected_slot):
            sys.exit(f'byte {at}: {data[at:at + 3].hex()} is not the next song')
        if slot == 0:
            all_notes.append([])
        expected_slot = slot + 1
        body = data[at + 3:at + 3 + 2 * count]
        all_notes[-1] += list(zip(body[::2], body[1::2]))
        at += 3 + 2 * count
    return all_notes


def differences(tunes, notes, reader):
    return [tune for tune, found in zip(tunes, notes, strict=True) if reader.read(tune) != found]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument('command')
    parser.add_argument('--count', type=int, default=10000)
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--self-test', action='store_true')
    options = parser.parse_args()
    generator = Generator(options.seed)
    count = 300 if options.self_test else options.count
    tunes = [generator.tune() for _ in range(count)]
    notes = encoded(options.command, tunes)
    different = differences(tunes, notes, Reader())
    for tune in different[:5]:
        found = notes[tunes.index(tune)]
        print(f'{tune}\n  reader  {Reader().read(tune)}\n  command {found}')
    if different:
        sys.exit(f'{len(different)} of {count} tunes differ')
    print(f'{count} tunes, {sum(map(len, notes))} notes: all as the independent reader has them')
    if options.self_test:
        for fault in FAULTS:
            found = len(differences(tunes, notes, Reader(fault)))
            print(f'fault {fault}: {found} of {count} differ')
            if found == 0:
                sys.exit('a fault is not noticed')


main()

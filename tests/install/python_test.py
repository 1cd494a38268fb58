#!/usr/bin/env python3
"""The Python package against the library; runs the tests beside it too.

usage: python_test.py [LIBRARY]; by itself build/release/libcargobay.so.0, its guard beside it.
"""

import copy
import dataclasses
import datetime
import faulthandler
import gc
import math
import os
import pathlib
import pickle
import subprocess
import sys
import unittest

from python_support import EXAMPLES, PACKAGE, virtual

import cargobay
from cargobay import (ControlError, ErrorCode, EventKind, Flag, HandleError, Histogram, Measure,
                      Mode, ModeLost, NoFrame, Note, Packet, Robot, Sim, StateError, TimedOut,
                      Twist, Wheels)


class Driving(unittest.TestCase):
    def test_drives(self):
        with virtual() as sim, Robot(sim=sim) as robot:
            robot.start()
            for state in robot.states(2.0):
                robot.drive(200.0, 0.0)
            robot.end()
            self.assertGreater(state.x_mm, 300.0)
            self.assertIs(state.mode, Mode.SAFE)
            self.assertAlmostEqual(state.x_mm, sim.truth.x_mm, delta=20.0)
            self.assertIs(sim.truth.mode, Mode.PASSIVE)
            self.assertGreater(robot.statistics.frames_good, 100)
            self.assertEqual(robot.bring_up.baud, 57600)
            self.assertTrue(robot.end_report.passive_seen)
            self.assertIs(robot.end_report.code, ErrorCode.OK)

    def test_stands_still_and_drives_again(self):
        with virtual() as sim, Robot(sim=sim) as robot:
            robot.start()
            for _ in robot.states(1.0):
                robot.drive(200.0, 0.0)
            robot.stop()
            for state in robot.states(1.0):
                pass
            self.assertEqual(state.command, Wheels(0.0, 0.0))
            self.assertIs(state.mode, Mode.SAFE)
            for state in robot.states(1.0):
                robot.drive_wheels(100.0, 100.0)
            self.assertGreater(state.estimate.left_mm_s, 50.0)

    def test_starts_again_and_goes_on_counting(self):
        with virtual() as sim, Robot(sim=sim) as robot:
            robot.start()
            for before in robot.states(1.0):
                robot.drive(200.0, 0.0)
            robot.end()
            self.assertIsNone(robot.wait(before.tick + 1000))
            robot.start()
            after = robot.wait(robot.state.tick)
            self.assertGreater(after.tick, before.tick)
            self.assertGreater(after.x_mm, before.x_mm - 1.0)

    def test_a_cliff_is_an_event_and_ends_the_loop(self):
        with virtual() as sim, Robot(sim=sim) as robot:
            robot.start()
            with self.assertRaises(ModeLost):
                for state in robot.states(3.0):
                    robot.drive(100.0, 0.0)
                    if state.tick == 50:
                        sim.inject("cliff front_left on")
            # Refused at once; the next frames say why.
            with self.assertRaises(ModeLost):
                for state in robot.states(1.0):
                    pass
            lost = [event for event in robot.events() if event.kind == EventKind.MODE_LOST]
            self.assertEqual(len(lost), 1)
            self.assertIn("cliff", str(lost[0]))
            self.assertIn(cargobay.Hazard.CLIFF_FRONT_LEFT, robot.end_report.hazards)
            self.assertIs(robot.end_report.code, ErrorCode.MODE)

    def test_examples(self):
        for name in ("square", "teleop_and_back", "two_coroutines", "heading", "one_world",
                     "watched"):
            with self.subTest(example=name):
                done = subprocess.run(
                    [sys.executable, EXAMPLES / f"{name}.py"], text=True, stdout=subprocess.PIPE,
                    stderr=subprocess.STDOUT, env={**os.environ, "PYTHONPATH": str(PACKAGE)})
                self.assertEqual(done.returncode, 0, done.stdout)


class Records(unittest.TestCase):
    def test_a_state_kept_from_a_control_function_stays_as_it_was(self):
        kept = []

        def control(state):
            kept.append(state)
            return Wheels(100.0, 100.0)

        with virtual() as sim, Robot(sim=sim) as robot:
            robot.set_control(control)
            robot.start()
            for _ in robot.states(2.0):
                pass
            seen = robot.history()
        del robot, sim
        gc.collect()
        self.assertGreater(len(kept), 100)
        self.assertEqual([state.tick for state in kept],
                         list(range(kept[0].tick, kept[-1].tick + 1)))
        self.assertGreater(kept[-1].x_mm, kept[0].x_mm + 100.0)
        # The same as what wait() gave, except for what was not decided yet.
        by_tick = {state.tick: state for state in seen}
        for state in kept[-50:-1]:
            same = by_tick[state.tick]
            self.assertEqual((state.x_mm, state.robot_time_ns, state.estimate),
                             (same.x_mm, same.robot_time_ns, same.estimate))

    def test_cannot_be_changed_and_can_be_copied(self):
        with virtual() as sim, Robot(sim=sim) as robot:
            robot.start()
            state = robot.wait()
            for record in (state, sim.truth, robot.info, robot.end_report, robot.statistics,
                           robot.bring_up, robot.reading(Packet.VOLTAGE), cargobay.settings()[0]):
                with self.assertRaises(dataclasses.FrozenInstanceError):
                    setattr(record, dataclasses.fields(record)[0].name, 5)
                with self.assertRaises((AttributeError, TypeError)):
                    record.other = 5  # a misspelt name
                self.assertEqual(copy.copy(record), record)
                self.assertEqual(pickle.loads(pickle.dumps(record)), record)

    def test_have_enumerations_and_durations(self):
        with virtual() as sim, Robot(sim=sim) as robot:
            robot.start()
            first = robot.wait()
            sim.inject("bump left")
            for state in robot.states(0.5):
                pass
            self.assertIs(type(state.bumps), cargobay.Bump)
            self.assertEqual(state.bumps, cargobay.Bump.LEFT)
            self.assertIn("LEFT", repr(state))
            self.assertIs(type(state.hazards), cargobay.Hazard)
            self.assertIs(type(state.remainder), cargobay.Remainder)
            self.assertIs(type(state.setpoint_lapsed), bool)
            self.assertEqual(len(state.covariance), 9)
            self.assertEqual(state.elapsed, datetime.timedelta(milliseconds=15))
            self.assertEqual(state.robot_time - first.robot_time,
                             (state.tick - first.tick) * robot.info.tick)
            self.assertIn(cargobay.Feature.VIRTUAL_TIME, robot.info.features)
            self.assertEqual(robot.info.model, "iRobot Create")

    def test_readings_are_of_one_frame_and_none_before_it(self):
        with virtual() as sim, Robot(sim=sim) as robot:
            with self.assertRaises(NoFrame):
                robot.reading(Packet.VOLTAGE)
            robot.start()
            for _ in robot.states(1.5):
                pass
            signal, voltage = robot.readings(Packet.WALL_SIGNAL, Packet.VOLTAGE)
            self.assertEqual((signal.value, signal.tick), (None, -1))
            self.assertGreater(voltage.value, 10000)
            self.assertIs(voltage.packet, Packet.VOLTAGE)
            robot.subscribe(Packet.WALL_SIGNAL)
            for _ in robot.states(1.0):
                pass
            self.assertIsNotNone(robot.reading(Packet.WALL_SIGNAL).value)
            robot.unsubscribe(Packet.WALL_SIGNAL)
            with self.assertRaises(ValueError):
                robot.unsubscribe(Packet.WALL_SIGNAL)
            asked = robot.query(Packet.CLIFF_LEFT_SIGNAL)
            self.assertIs(type(asked.value), int)
            self.assertGreater(asked.tick, voltage.tick)

    def test_settings_are_listed(self):
        found = {(setting.table, setting.key): setting for setting in cargobay.settings()}
        self.assertGreater(len(found), 5)
        for setting in found.values():
            self.assertTrue(setting.words, setting)


class Readers(unittest.TestCase):
    def test_each_is_told_what_it_has_skipped(self):
        with virtual() as sim, Robot(sim=sim) as robot:
            robot.start()
            states = robot.states()
            seen = next(states)
            self.assertEqual(seen.skipped, 0)
            self.assertEqual(next(states).skipped, 0)
            for _ in range(4):  # another reader, which makes time pass
                newest = robot.wait(robot.state.tick)
            caught_up = next(states)
            self.assertEqual((caught_up.tick, caught_up.skipped), (newest.tick, 3))
            self.assertEqual(next(robot.states(after_tick=seen.tick)).skipped,
                             newest.tick - seen.tick - 1)
            missed = robot.history(seen.tick)
            self.assertEqual([state.tick for state in missed],
                             list(range(seen.tick + 1, newest.tick + 1)))
            self.assertEqual({state.skipped for state in missed}, {0})
            self.assertEqual(robot.history(seen.tick, 2), missed[:2])

    def test_of_events_see_all_of_them(self):
        with virtual() as sim, Robot(sim=sim) as robot:
            robot.start()
            for state in robot.states(3.0):
                if state.tick % 40 == 20:
                    sim.inject("bump left")
                if state.tick % 40 == 0:
                    sim.inject("bump none")
            first = list(robot.events())
            self.assertEqual(first, list(robot.events()))
            self.assertEqual([event.sequence for event in first], list(range(1, len(first) + 1)))
            self.assertIn(EventKind.BUMP_BEGAN, [event.kind for event in first])
            self.assertEqual(list(robot.events(first[-2].sequence)), first[-1:])
            self.assertIsNone(robot.next_event(first[-1].sequence))
            self.assertEqual({type(event.bumps) for event in first}, {cargobay.Bump})

    def test_wait_until_the_time_is_out(self):
        with virtual() as sim, Robot(sim=sim) as robot:
            robot.start()
            tick = robot.wait().tick
            for timeout_s in (0.3, datetime.timedelta(milliseconds=300)):
                begin_ns = sim.truth.sim_time_ns
                with self.assertRaises(TimedOut) as caught:
                    robot.wait(tick + 1000, timeout_s)
                self.assertIsInstance(caught.exception, TimeoutError)
                self.assertAlmostEqual(sim.truth.sim_time_ns - begin_ns, 300e6, delta=60e6)
            with self.assertRaises(TimedOut):
                robot.wait(tick + 1000, 0)

    def test_are_told_that_the_loop_ended_as_asked(self):
        with virtual() as sim, Robot(sim=sim) as robot:
            robot.start()
            seen = 0
            for state in robot.states():
                seen += 1
                if seen == 50:
                    robot.request_end()
            self.assertLess(seen, 60)
            self.assertIsNone(robot.wait(state.tick))
            robot.end()


class Control(unittest.TestCase):
    def test_answers_with_wheels_a_twist_or_the_setpoint(self):
        with virtual() as sim, Robot(sim=sim) as robot:
            robot.start()
            for answer, left, right in ((Wheels(100.0, -100.0), 100.0, -100.0),
                                        (Twist(100.0, 0.0), 100.0, 100.0),
                                        (cargobay.SETPOINT, 50.0, 50.0)):
                robot.set_control(lambda state: answer)
                for state in robot.states(1.0):
                    robot.drive(50.0, 0.0)
                self.assertEqual((state.target.left_mm_s, state.target.right_mm_s), (left, right))
            robot.set_control(None)
            for state in robot.states(1.0):
                robot.drive_wheels(20.0, 30.0)
            self.assertEqual(state.target, Wheels(20.0, 30.0))

    def test_finishes(self):
        with virtual() as sim, Robot(sim=sim) as robot:
            robot.set_control(
                lambda state: cargobay.FINISHED if state.tick > 50 else Twist(100.0, 0.0))
            robot.start()
            ticks = [state.tick for state in robot.states()]
            self.assertIn(ticks[-1], (50, 51, 52))
            robot.end()
            report = robot.end_report
            self.assertEqual((report.ended, report.code, report.control_result), (True, 0, 1))
            self.assertIs(sim.truth.mode, Mode.PASSIVE)

    def test_what_it_raises_comes_out_once(self):
        def control(state):
            raise KeyError("planted")

        for come_out in (lambda robot: list(robot.states(1.0)), lambda robot: robot.end(),
                         lambda robot: robot.close()):
            with virtual() as sim, Robot(sim=sim) as robot:
                robot.set_control(control)
                robot.start()
                self.step_unseen(robot)
                with self.assertRaisesRegex(KeyError, "planted"):
                    come_out(robot)
                robot.close()  # and no more

    def step_unseen(self, robot):
        """Runs the control function with nobody who would see what it raises."""
        function = cargobay.robot.library.cargobay_wait
        checked, function.errcheck = function.errcheck, lambda result, *_: result
        try:
            function(robot._handle, 0, 100_000_000, None)
        finally:
            function.errcheck = checked

    def test_what_was_caught_is_the_cause_of_what_end_raises(self):
        with virtual() as sim, Robot(sim=sim) as robot:
            robot.set_control(lambda state: 1 / 0)
            robot.start()
            with self.assertRaises(ZeroDivisionError):
                list(robot.states(1.0))
            with self.assertRaises(ControlError) as caught:
                robot.end()
            self.assertIsInstance(caught.exception.__cause__, ZeroDivisionError)

    def test_a_wrong_answer_is_a_type_error(self):
        for answer in (None, (100.0, 100.0), "no speeds", 1, Wheels("1", "2")):
            with self.assertRaises(TypeError):
                with virtual() as sim, Robot(sim=sim) as robot:
                    robot.set_control(lambda state: answer)
                    robot.start()
                    list(robot.states(1.0))


class Outputs(unittest.TestCase):
    def test_commands_and_songs(self):
        with virtual() as sim, Robot(sim=sim) as robot:
            with self.assertRaises(StateError):
                robot.set_leds(cargobay.Led.PLAY, 0, 255)
            robot.start()
            robot.wait()
            robot.set_leds(cargobay.Led.PLAY | cargobay.Led.ADVANCE, 0, 255)
            robot.store_song(0, [Note(0.25, 60), Note(datetime.timedelta(milliseconds=250), 64)])
            durations = robot.store_tune(1, "scale:d=8,o=5,b=120:c,d,e,f")
            self.assertEqual(durations, [datetime.timedelta(seconds=1)])
            robot.send_command("leds advance 128 128")
            robot.send_bytes(bytes([139, 2, 0, 255]))
            with self.assertRaises(ValueError) as caught:
                robot.send_command("no_such_command")
            self.assertIs(caught.exception.code, ErrorCode.ARGUMENT)

    def test_wheels_of_a_twist(self):
        with virtual() as sim, Robot(sim=sim, wheel_base_mm=300.0) as robot:
            wheels = robot.wheels_of(Twist(100.0, 1.0))
            self.assertAlmostEqual(wheels.right_mm_s - wheels.left_mm_s, 300.0)


class Rest(unittest.TestCase):
    def test_errors_have_code_and_remedy(self):
        with virtual() as sim, Robot(sim=sim) as robot:
            with self.assertRaises(StateError) as caught:
                robot.drive(200.0, 0.0)  # not started
            self.assertIs(caught.exception.code, ErrorCode.STATE)
            self.assertTrue(caught.exception.message)
            self.assertIn("CARGOBAY_E_STATE", str(caught.exception))
            robot.start()
            with self.assertRaises(ValueError):
                robot.drive(math.nan, 0.0)
        with self.assertRaises(HandleError):
            robot.state
        with self.assertRaises(cargobay.NoPort):
            Robot("/dev/no_such_port", flags=Flag.NO_CONFIG)

    def test_histograms_count_times(self):
        with Histogram() as histogram:
            for time_ns in (1000, 2000, 3000):
                histogram.record(time_ns)
            held = histogram.distribution
            self.assertEqual((held.count, held.min_ns, held.max_ns), (3, 1000, 3000))
            self.assertAlmostEqual(histogram.percentile_ns(50.0), 2000, delta=40)

    def test_measures_itself(self):
        steps = []
        with Sim() as sim:
            with Robot(sim.path, flags=Flag.NO_CONFIG,
                       progress=lambda step, detail: steps.append(step)) as robot:
                robot.start()
                for _ in robot.states(0.5):
                    robot.drive(100.0, 0.0)
                robot.end()
                with Histogram() as histogram:
                    robot.copy_histogram(Measure.PERIOD, histogram)
                    self.assertGreater(histogram.distribution.count, 20)
                    self.assertGreater(histogram.percentile_ns(50.0), 10_000_000)
        self.assertTrue(steps)

    def test_names(self):
        self.assertRegex(cargobay.version(), r"^\d+\.\d+\.\d+$")
        self.assertEqual(cargobay.packet_name(Packet.WALL_SIGNAL), "wall_signal")
        self.assertEqual(cargobay.event_name(EventKind.MODE_LOST), "mode_lost")
        self.assertEqual(cargobay.error_name(ErrorCode.BUSY), "CARGOBAY_E_BUSY")
        self.assertEqual([cargobay.mode_name(mode) for mode in Mode],
                         ["off", "passive", "safe", "full"])


if __name__ == "__main__":
    faulthandler.dump_traceback_later(280, exit=True)  # ctest ends it at 300 s, and says nothing
    unittest.main(module=None, argv=[
        sys.argv[0], "discover", "-s", str(pathlib.Path(__file__).parent), "-p", "python*_test.py",
        *sys.argv[1:]])

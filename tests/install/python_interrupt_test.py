#!/usr/bin/env python3
"""Ctrl-C, and what other signal handlers raise: comes out soon, and is never lost.

usage: python_interrupt_test.py [LIBRARY]
"""

import unittest

from python_support import run

# A port that never answers, and what tells whether it is free.
SILENT_PORT = """
master, slave = pty.openpty()
PORT = os.ttyname(slave)
steps = []
def interrupt(after_s, number=signal.SIGINT):
    main = threading.main_thread().ident
    threading.Timer(after_s, lambda: signal.pthread_kill(main, number)).start()
def check_free():
    fcntl.flock(slave, fcntl.LOCK_EX | fcntl.LOCK_NB)
    exclusive = struct.unpack("i", fcntl.ioctl(slave, 0x80045440, b"\\0" * 4))[0]  # TIOCGEXCL
    assert not exclusive
    others = [name for name in os.listdir("/proc/self/fd")
              if os.path.realpath(f"/proc/self/fd/{name}") == PORT]
    assert others == [str(slave)], others
"""
VIRTUAL = """
class Planted(Exception):
    pass
raised = 0
def plant(number, frame):
    global raised
    raised += 1
    raise Planted
signal.signal(signal.SIGALRM, plant)
"""


class Programs(unittest.TestCase):
    def succeeds(self, program):
        done = run(program)
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertNotIn("Exception ignored", done.stdout)
        return done.stdout


class Opening(Programs):
    def test_ctrl_c_gives_up_in_c(self):
        self.succeeds(SILENT_PORT + """
interrupt(0.55)
try:
    Robot(PORT, flags=Flag.NO_CONFIG)
except KeyboardInterrupt:  # and not Silent, which takes much longer
    check_free()
else:
    raise AssertionError("not interrupted")
""")

    def test_ctrl_c_comes_after_the_next_call_of_progress_at_the_latest(self):
        self.succeeds(SILENT_PORT + """
at = []
def kill():
    at.append(len(steps))
    os.kill(os.getpid(), signal.SIGINT)
def progress(step, detail):
    steps.append(step)
    if len(steps) == 5:
        threading.Timer(0.01, kill).start()  # when C has gone on
try:
    Robot(PORT, flags=Flag.NO_CONFIG, progress=progress)
except KeyboardInterrupt:
    assert len(steps) <= at[0] + 1, (at, steps)
    check_free()
else:
    raise AssertionError("not interrupted")
""")

    def test_ctrl_c_gives_up_in_progress(self):
        self.succeeds(SILENT_PORT + """
def progress(step, detail):
    steps.append(step)
    signal.raise_signal(signal.SIGINT)
    raise AssertionError("it goes on")
try:
    Robot(PORT, flags=Flag.NO_CONFIG, progress=progress)
except KeyboardInterrupt:
    assert len(steps) == 1
    check_free()
else:
    raise AssertionError("not interrupted")
assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
""")

    def test_progress_that_returns_false_gives_up(self):
        self.succeeds(SILENT_PORT + """
def progress(step, detail):
    assert type(step) is str and step and type(detail) is str
    steps.append(step)
    return len(steps) < 4 and None
try:
    Robot(PORT, flags=Flag.NO_CONFIG, progress=progress)
except Cancelled as error:
    assert error.code is ErrorCode.CANCELLED and error.message
    assert len(steps) == 4, steps
    check_free()
else:
    raise AssertionError("not given up")
""")

    def test_what_progress_raises_gives_up_and_comes_out(self):
        self.succeeds(SILENT_PORT + """
def progress(step, detail):
    steps.append(step)
    raise KeyError("planted")
try:
    Robot(PORT, flags=Flag.NO_CONFIG, progress=progress)
except KeyError:
    assert len(steps) == 1, steps
    check_free()
else:
    raise AssertionError("not given up")
""")

    def test_in_another_thread_is_left_alone(self):
        self.succeeds(SILENT_PORT + """
given_up = threading.Event()
def work():
    try:
        Robot(PORT, flags=Flag.NO_CONFIG, progress=lambda *_: (steps.append(1), False)[1]
              if given_up.is_set() else None)
    except Cancelled:
        steps.append("cancelled")
thread = threading.Thread(target=work)
thread.start()
interrupt(0.2)
try:
    time.sleep(60.0)
except KeyboardInterrupt:
    pass
assert thread.is_alive()
given_up.set()
thread.join()
assert steps == [1, "cancelled"], steps
check_free()
""")

    def test_the_second_start_gives_up_too(self):
        self.succeeds(SILENT_PORT + """
with tempfile.TemporaryDirectory() as folder, Sim() as sim:
    link = folder + "/create"
    os.symlink(sim.path, link)
    with Robot(link, flags=Flag.NO_CONFIG) as robot:
        robot.start()
        tick = robot.wait().tick
        robot.end()
        os.unlink(link)
        os.symlink(PORT, link)  # another robot, which does not answer
        interrupt(0.55)
        try:
            robot.start()
        except KeyboardInterrupt:
            check_free()
        else:
            raise AssertionError("not interrupted")
        os.unlink(link)
        os.symlink(sim.path, link)
        robot.start()
        assert robot.wait(tick).tick > tick
        robot.end()
""")


class Waiting(Programs):
    def test_ctrl_c_ends_a_wait(self):
        for sim in ("None", "Sim(time=SimTime.VIRTUAL)"):
            for wait in ("robot.wait(10**9)", "robot.wait(10**9, 3600)", "list(robot.states())",
                         "robot.query(Packet.VOLTAGE, None); robot.wait(10**9)"):
                with self.subTest(sim=sim, wait=wait):
                    self.succeeds(SILENT_PORT + f"""
with Robot(sim={sim}, flags=Flag.NO_CONFIG) as robot:
    robot.start()
    interrupt(0.3)
    try:
        {wait}
    except KeyboardInterrupt:
        pass
    else:
        raise AssertionError("not interrupted")
    tick = robot.state.tick
    assert robot.wait(tick).tick > tick  # it drives on
    robot.end()
""")

    def test_ctrl_c_ends_the_time_of_a_virtual_create(self):
        for time in ("REAL", "VIRTUAL"):
            self.succeeds(SILENT_PORT + f"""
with Sim(time=SimTime.{time}) as sim:
    interrupt(0.3)
    try:
        while True:
            sim.advance(datetime.timedelta(hours=1))
    except KeyboardInterrupt:
        pass
    sim.truth
""")

    def test_ctrl_c_ends_a_control_function_in_virtual_time(self):
        self.succeeds(SILENT_PORT + """
def control(state):
    while True:
        pass
with Sim(time=SimTime.VIRTUAL) as sim, Robot(sim=sim) as robot:
    robot.set_control(control)
    robot.start()
    interrupt(0.3)
    try:
        robot.wait()
        robot.wait(0)
    except KeyboardInterrupt:
        pass
    else:
        raise AssertionError("not interrupted")
""")

    def test_no_signal_is_lost_wherever_it_comes(self):
        said = self.succeeds(VIRTUAL + """
import random
caught = opened = 0
chance = random.Random(1)
def control(state):
    return Wheels(sum(range(20)) % 100, 50.0)
def check(late):
    late += raised > caught  # the state of the last frame still comes
    if late > 2:
        raise AssertionError("what the handler raised is lost")
    return late
gc.disable()  # what a handler raises in any __del__ is lost: Python's own rule
while caught < 300:
    gc.collect()
    try:
        with Sim(time=SimTime.VIRTUAL) as sim, Robot(sim=sim) as robot:
            robot.set_control(control)
            robot.start()
            opened += 1
            signal.setitimer(signal.ITIMER_REAL, chance.uniform(1e-4, 3e-3))
            late = 0
            for _ in robot.states():
                late = check(late)
    except Planted:
        caught += 1
        assert robot.closed and sim.closed
    except ControlError:
        raise AssertionError("its cause is lost")
print(caught, raised, opened)
assert caught == raised
assert signal.getsignal(signal.SIGALRM) is plant
assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
""")
        self.assertIn("300 300", said)


if __name__ == "__main__":
    unittest.main()

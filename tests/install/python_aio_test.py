#!/usr/bin/env python3
"""The Python package in asyncio.

usage: python_aio_test.py [LIBRARY]
"""

import asyncio
import gc
import os
import threading
import unittest

from python_support import virtual

from cargobay import (ControlError, EventKind, Flag, HandleError, ModeLost, Robot, Sim, StateError,
                      TimedOut, Wheels, aio)
from cargobay.errors import UnsupportedError


class Frames(unittest.IsolatedAsyncioTestCase):
    async def asyncSetUp(self):
        asyncio.get_running_loop().slow_callback_duration = 60.0  # it says so otherwise
        self.sim = self.enterContext(Sim())
        self.robot = self.enterContext(Robot(sim=self.sim))

    async def take(self, count, **options):
        ticks = []
        async for state in aio.states(self.robot, **options):
            ticks.append((state.tick, state.skipped))
            if len(ticks) == count:
                break
        return ticks

    async def lost(self):
        """How many frames had no state."""
        return self.robot.statistics.frames_lost + self.robot.statistics.frames_bad

    async def test_two_coroutines_see_every_frame(self):
        self.robot.start()
        first = (await aio.wait(self.robot)).tick
        one, two = await asyncio.gather(self.take(100, after_tick=first),
                                        self.take(100, after_tick=first))
        self.assertEqual(one, two)
        # On a machine that stands still a frame may have no state, but never without being told.
        before = first
        for tick, skipped in one:
            self.assertEqual(tick, before + 1 + skipped)
            before = tick

    async def test_a_slow_one_gets_what_it_has_missed(self):
        self.robot.start()
        first = (await aio.wait(self.robot)).tick

        async def slow():
            ticks = []
            async for state in aio.states(self.robot, after_tick=first):
                ticks.append(state.tick)
                if len(ticks) % 20 == 0:
                    await asyncio.sleep(0.3)
                if len(ticks) == 100:
                    return ticks

        slow_ticks, fast = await asyncio.gather(slow(), self.take(100, after_tick=first))
        self.assertEqual(slow_ticks, [tick for tick, _ in fast])
        self.assertEqual(await self.lost(), 0)

    async def test_begins_with_the_newest(self):
        self.robot.start()
        while self.robot.wait().tick < 20:
            await asyncio.sleep(0.01)
        (tick, skipped), *_ = await self.take(1)
        self.assertGreaterEqual(tick, 20)
        self.assertEqual(skipped, 0)

    async def test_ends_with_the_loop(self):
        self.robot.start()
        tasks = [asyncio.create_task(self.take(10**9)) for _ in range(3)]
        await aio.wait(self.robot, 30)
        self.robot.request_end()
        ticks = await asyncio.gather(*tasks)
        self.assertEqual({taken[-1] for taken in ticks}, {ticks[0][-1]})
        self.assertIsNone(await aio.wait(self.robot, ticks[0][-1][0]))
        self.robot.end()

    async def test_raises_why_it_ended(self):
        self.robot.start()
        with self.assertRaises(ModeLost):
            async for state in aio.states(self.robot):
                if state.tick < 20:  # a cliff stops a robot that drives
                    self.robot.drive(100.0, 0.0)
                if state.tick == 20:
                    self.sim.inject("cliff left on")
        kinds = [event.kind async for event in aio.events(self.robot)]
        self.assertIn(EventKind.MODE_LOST, kinds)

    async def test_raises_what_the_control_function_raised(self):
        def control(state):
            if state.tick > 20:
                raise KeyError("planted")
            return Wheels(0.0, 0.0)

        self.robot.set_control(control)
        self.robot.start()
        with self.assertRaisesRegex(KeyError, "planted"):
            await self.take(10**9)
        with self.assertRaises(ControlError):
            self.robot.end()

    async def test_events_come_to_each(self):
        self.robot.start()

        async def bumps():
            kinds = []
            async for event in aio.events(self.robot):
                if event.kind in (EventKind.BUMP_BEGAN, EventKind.BUMP_ENDED):
                    kinds.append(event.kind)
                if len(kinds) == 4:
                    return kinds

        tasks = [asyncio.create_task(bumps()) for _ in range(2)]
        for line in ("bump left", "bump none") * 2:
            self.sim.inject(line)
            # Bumps are in every other frame or more often.
            await aio.wait(self.robot, (await aio.wait(self.robot)).tick + 5)
        wanted = [EventKind.BUMP_BEGAN, EventKind.BUMP_ENDED] * 2
        self.assertEqual(await asyncio.gather(*tasks), [wanted, wanted])

    async def test_waits_no_longer_than_asked(self):
        self.robot.start()
        tick = (await aio.wait(self.robot)).tick
        with self.assertRaises(TimedOut):
            await aio.wait(self.robot, tick + 10**6, 0.1)
        with self.assertRaises(ValueError):
            await aio.wait(self.robot, tick, -1)

    async def test_before_the_start_and_after_the_close(self):
        with self.assertRaises(StateError):
            await aio.wait(self.robot)
        self.robot.start()
        task = asyncio.create_task(self.take(10**9))
        await aio.wait(self.robot)
        await asyncio.to_thread(self.robot.close)
        with self.assertRaises(HandleError):
            await task
            await self.take(1)

    async def test_costs_nothing_when_nobody_awaits(self):
        self.robot.start()
        await self.take(5)
        await aio.wait(self.robot, self.robot.state.tick + 10)
        await asyncio.sleep(0.1)
        self.assertFalse(aio._wakers[self.robot]._listening)
        await self.take(5)


class Loops(unittest.TestCase):
    def test_one_after_the_other(self):
        async def ticks(robot):
            return [state.tick async for state in self.some(robot, 10)]

        with Sim() as sim, Robot(sim=sim) as robot:
            robot.start()
            for _ in range(3):
                self.assertEqual(len(asyncio.run(ticks(robot))), 10)

    async def some(self, robot, count):
        async for state in aio.states(robot):
            yield state
            count -= 1
            if not count:
                return

    def test_beside_each_other_are_refused(self):
        async def first(robot, running, done):
            async for state in aio.states(robot):
                if state.tick > 20:  # it has awaited some
                    running.set()
                if done.is_set():
                    return

        async def second(robot):
            while True:
                await aio.wait(robot, robot.state.tick)

        with Sim() as sim, Robot(sim=sim) as robot:
            robot.start()
            running, done = threading.Event(), threading.Event()
            thread = threading.Thread(target=lambda: asyncio.run(first(robot, running, done)))
            thread.start()
            running.wait()
            with self.assertRaisesRegex(RuntimeError, "another event loop"):
                asyncio.run(second(robot))
            done.set()
            thread.join()

    def test_in_virtual_time_there_is_nothing_to_await(self):
        with virtual() as sim, Robot(sim=sim) as robot:
            robot.start()
            with self.assertRaisesRegex(UnsupportedError, r"use Robot\.states\(\)"):
                asyncio.run(aio.wait(robot))
            with self.assertRaises(UnsupportedError):
                robot.fd

    def test_its_descriptor_is_closed_with_it(self):
        gc.collect()
        before = len(os.listdir("/proc/self/fd"))
        for _ in range(5):
            with Sim() as sim, Robot(sim=sim) as robot:
                robot.start()
                asyncio.run(aio.wait(robot))
            del robot, sim
            gc.collect()
        self.assertEqual(len(os.listdir("/proc/self/fd")), before)


class Opening(unittest.IsolatedAsyncioTestCase):
    async def asyncSetUp(self):
        asyncio.get_running_loop().slow_callback_duration = 60.0

    async def test_opens_while_others_run(self):
        with Sim() as sim:
            with await aio.open_robot(sim.path, flags=Flag.NO_CONFIG) as robot:
                robot.start()
                await aio.wait(robot)

    async def test_a_cancelled_task_gives_up(self):
        master, slave = os.openpty()
        steps, begun = [], asyncio.Event()
        loop = asyncio.get_running_loop()

        def progress(step, detail):
            steps.append(step)
            loop.call_soon_threadsafe(begun.set)

        task = asyncio.create_task(
            aio.open_robot(os.ttyname(slave), flags=Flag.NO_CONFIG, progress=progress))
        await begun.wait()
        task.cancel()
        with self.assertRaises(asyncio.CancelledError):
            await task
        # Nothing is left of it: the port is free.
        users = [name for name in os.listdir("/proc/self/fd")
                 if os.path.realpath(f"/proc/self/fd/{name}") == os.ttyname(slave)]
        self.assertEqual(users, [str(slave)])
        os.close(master)
        os.close(slave)


if __name__ == "__main__":
    unittest.main()
